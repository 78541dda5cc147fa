#include "core/ricci/mirror_symmetry.h"

#include <algorithm>

namespace moduli {

Unknowns mirrorUnknowns(const DoubleCover& cover) {
  Unknowns unknowns;
  for (std::size_t v = 0; v < cover.involution.size(); ++v) {
    // The first copy keeps its numbering.
    const Index original = std::min(static_cast<Index>(v), cover.involution[v]);
    unknowns.of_vertex.push_back(original);
    unknowns.count = std::max(unknowns.count, original + 1);
  }
  return unknowns;
}

std::vector<double> lengthsOnDouble(const DoubleCover& cover, const std::vector<double>& lengths) {
  std::vector<double> result;
  result.reserve(cover.edge.size());
  for (const Index edge : cover.edge) result.push_back(lengths[edge]);
  return result;
}

std::vector<double> curvaturesOnDouble(const DoubleCover& cover,
                                       const std::vector<double>& curvatures) {
  std::vector<double> result(cover.involution.size());
  for (std::size_t v = 0; v < result.size(); ++v) {
    const auto own = static_cast<Index>(v);
    const Index mirror = cover.involution[v];
    result[v] = mirror == own ? 2 * curvatures[own] : curvatures[std::min(own, mirror)];
  }
  return result;
}

}  // namespace moduli
