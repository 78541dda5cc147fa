#include "core/intrinsic/flat_charts.h"

#include <utility>

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

FlatCharts undoFlips(IntrinsicTriangulation triangulation, FlatCharts charts) {
  while (!triangulation.history().empty()) {
    const Index h = triangulation.history().back().halfedge, t = triangulation.twin(h);
    const Index h1 = Connectivity::next(h), h2 = Connectivity::previous(h);
    const Index t1 = Connectivity::next(t), t2 = Connectivity::previous(t);
    // h runs from l to k, with i on its left and j on its right. Turns the chart of j's face.
    std::complex<double> turn = -charts[h] / charts[t];
    turn /= std::abs(turn);
    const std::complex<double> ki = charts[h1], il = charts[h2];
    const std::complex<double> lj = turn * charts[t1], jk = turn * charts[t2];
    triangulation.undoTo(triangulation.history().size() - 1);
    charts[h] = il + lj;
    charts[t] = -charts[h];
    charts[h1] = jk;
    charts[h2] = ki;
    charts[t1] = il;
    charts[t2] = lj;
  }
  return charts;
}

double doubledArea(const FlatCharts& charts, Index f) {
  return std::imag(std::conj(charts[3 * f]) * charts[3 * f + 1]);
}

}  // namespace moduli
