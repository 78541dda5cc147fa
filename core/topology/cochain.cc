#include "core/topology/cochain.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace moduli {

Cochain gatherTerms(std::vector<CochainTerm> terms) {
  std::sort(terms.begin(), terms.end(),
            [](const CochainTerm& a, const CochainTerm& b) { return a.edge < b.edge; });
  Cochain result;
  for (const CochainTerm& term : terms) {
    if (!result.empty() && result.back().edge == term.edge) {
      result.back().value += term.value;
    } else {
      if (!result.empty() && result.back().value == 0) result.pop_back();
      result.push_back(term);
    }
  }
  if (!result.empty() && result.back().value == 0) result.pop_back();
  return result;
}

Result<Cochain> combineCochains(const std::vector<Cochain>& cochains,
                                const IntegerMatrix& coefficients, Eigen::Index row) {
  // Terms of one edge are summed by gatherTerms: with values below 2^62 over the number of cochains
  // no sum of theirs overflows.
  const Integer largest = (Integer{1} << 62) / std::max<Integer>(1, coefficients.cols());
  std::vector<CochainTerm> terms;
  for (Eigen::Index k = 0; k < coefficients.cols(); ++k) {
    if (coefficients(row, k) == 0) continue;
    for (const CochainTerm& term : cochains[k]) {
      Integer value = 0;
      if (__builtin_mul_overflow(coefficients(row, k), term.value, &value) || value > largest ||
          value < -largest) {
        return integerOverflow();
      }
      terms.push_back({term.edge, value});
    }
  }
  Cochain result = gatherTerms(std::move(terms));
  for (const CochainTerm& term : result) {
    if (std::abs(term.value) > kLargestCochainValue) return integerOverflow();
  }
  return result;
}

IntegerMatrix intersectionMatrix(const Connectivity& surface, const std::vector<Cochain>& a,
                                 const std::vector<Cochain>& b) {
  IntegerMatrix result(a.size(), b.size());
  std::vector<Integer> dense(surface.edgeCount(), 0);
  const auto along = [&](Index h) { return surface.sign(h) * dense[surface.edge(h)]; };
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (const CochainTerm& term : a[i]) dense[term.edge] = term.value;
    for (std::size_t k = 0; k < b.size(); ++k) {
      // With values x_c, y_c along the sides of a face, which add up to 0, the integral over it is
      // (x_c y_c+1 - x_c+1 y_c) / 2 for any c, and so the sum of y_c (x_c-1 - x_c+1) / 6.
      Integer six_times = 0;
      for (const CochainTerm& term : b[k]) {
        const Index h = surface.halfedge(term.edge);
        six_times += term.value * (along(Connectivity::previous(h)) - along(Connectivity::next(h)));
        const Index twin = surface.twin(h);
        if (twin == kNone) continue;
        six_times -=
            term.value * (along(Connectivity::previous(twin)) - along(Connectivity::next(twin)));
      }
      result(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) = six_times / 6;
    }
    for (const CochainTerm& term : a[i]) dense[term.edge] = 0;
  }
  return result;
}

}  // namespace moduli
