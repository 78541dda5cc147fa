#include "core/ricci/edge_pattern.h"

#include <algorithm>
#include <utility>

#include "core/ricci/scaled_face.h"

namespace moduli {

void EdgePattern::build(const IntrinsicTriangulation& triangulation,
                        const std::vector<Index>& unknown, Index count) {
  const Index halfedges = triangulation.halfedgeCount();
  slot_.assign(halfedges, kNone);

  // Edges by their lower unknown, which is their column.
  struct Entry {
    Index row, halfedge;
  };
  std::vector<Index> first(count + 1, 0);
  const auto ends = [&](Index h) {
    return std::minmax(unknown[triangulation.tail(h)], unknown[triangulation.head(h)]);
  };
  const auto stored = [&](Index h) {
    const Index twin = triangulation.twin(h);
    if (twin != kNone && twin < h) return false;
    const auto [low, high] = ends(h);
    return low != kNone && low != high;
  };
  for (Index h = 0; h < halfedges; ++h) {
    if (stored(h)) ++first[ends(h).first + 1];
  }
  for (Index column = 0; column < count; ++column) first[column + 1] += first[column];
  std::vector<Entry> entries(first[count]);
  std::vector<Index> fill(first.begin(), first.end() - 1);
  for (Index h = 0; h < halfedges; ++h) {
    if (!stored(h)) continue;
    const auto [column, row] = ends(h);
    entries[fill[column]++] = {row, h};
  }

  matrix_ = SparseMatrix(count, count);
  matrix_.resizeNonZeros(count + first[count]);
  int* outer = matrix_.outerIndexPtr();
  int* inner = matrix_.innerIndexPtr();
  Index used = 0;
  for (Index column = 0; column < count; ++column) {
    outer[column] = used;
    inner[used++] = column;
    const auto begin = entries.begin() + first[column], end = entries.begin() + first[column + 1];
    std::sort(begin, end, [](const Entry& a, const Entry& b) {
      return std::pair(a.row, a.halfedge) < std::pair(b.row, b.halfedge);
    });
    for (auto entry = begin; entry != end; ++entry) {
      if (inner[used - 1] != entry->row) inner[used++] = entry->row;
      slot_[entry->halfedge] = used - 1;
      const Index twin = triangulation.twin(entry->halfedge);
      if (twin != kNone) slot_[twin] = used - 1;
    }
  }
  outer[count] = used;
  matrix_.resizeNonZeros(used);
}

void EdgePattern::fillHessian(Geometry geometry, const IntrinsicTriangulation& triangulation,
                              const std::vector<Index>& unknown,
                              const std::vector<double>& half_tangents,
                              const std::vector<double>& half_chords) {
  double* values = matrix_.valuePtr();
  std::fill(values, values + matrix_.nonZeros(), 0.0);
  for (Index h = 0; h < triangulation.halfedgeCount(); ++h) {
    const Index j = Connectivity::next(h), k = Connectivity::previous(h);
    const double ti = half_tangents[h], tj = half_tangents[j], tk = half_tangents[k];
    if (!(ti > 0 && tj > 0 && tk > 0)) continue;
    const EdgeWeight weight = edgeWeight(geometry, ti, tj, tk, half_chords[h]);
    const Index a = unknown[triangulation.tail(h)], b = unknown[triangulation.tail(j)];
    if (a != kNone) values[diagonal(a)] += weight.diagonal;
    if (b != kNone) values[diagonal(b)] += weight.diagonal;
    if (slot_[h] != kNone) values[slot_[h]] += weight.mixed;
    if (a != kNone && a == b) values[diagonal(a)] += 2 * weight.mixed;
  }
}

}  // namespace moduli
