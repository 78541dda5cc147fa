#include "core/intrinsic/flat_charts.h"

namespace moduli {

FlatCharts chartsOfTriangles(const std::vector<double>& lengths,
                             const std::vector<double>& angles) {
  FlatCharts charts(lengths.size());
  for (std::size_t f = 0; f < lengths.size(); f += 3) {
    std::size_t longest = 0;
    for (std::size_t c = 1; c < 3; ++c) {
      if (lengths[f + c] > lengths[f + longest]) longest = c;
    }
    // The corner opposite the longest side is the tail of the one before it.
    const std::size_t base = f + (longest + 2) % 3, last = f + (longest + 1) % 3;
    charts[base] = lengths[base];
    charts[last] = -std::polar(lengths[last], angles[base]);
    charts[f + longest] = -(charts[base] + charts[last]);
  }
  return charts;
}

double doubledArea(const FlatCharts& charts, Index f) {
  return std::imag(std::conj(charts[3 * f]) * charts[3 * f + 1]);
}

}  // namespace moduli
