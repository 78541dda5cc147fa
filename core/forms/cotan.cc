#include "core/forms/cotan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/forms/flat_triangle.h"

namespace moduli {
namespace {

std::array<double, 3> sidesOf(const Connectivity& surface, const std::vector<double>& lengths,
                              Index f) {
  return {lengths[surface.edge(3 * f)], lengths[surface.edge(3 * f + 1)],
          lengths[surface.edge(3 * f + 2)]};
}

/// The stiffness matrix on the vertices v with row[v] >= 0, rows ascending with vertices.
SparseMatrix assemble(const Connectivity& surface, const std::vector<double>& weights,
                      const std::vector<Index>& row, Index size) {
  // Two counting sorts, by row and then by column, leave each column sorted by row; equal entries
  // (several edges between two vertices) are neighbours and are summed.
  struct Entry {
    Index row;
    Index column;
    double value;
  };
  std::vector<double> diagonal(size, 0.0);
  std::vector<Entry> entries;
  entries.reserve(surface.edgeCount());
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    const Index h = surface.halfedge(e);
    const Index i = row[surface.tail(h)];
    const Index j = row[surface.head(h)];
    if (i == j) continue;  // A loop: every function has difference 0 along it.
    if (i >= 0) diagonal[i] += weights[e];
    if (j >= 0) diagonal[j] += weights[e];
    if (i >= 0 && j >= 0) entries.push_back({std::max(i, j), std::min(i, j), -weights[e]});
  }
  std::vector<Entry> sorted(entries.size());
  std::vector<Index> start;
  const auto sortBy = [&](Index Entry::*key) {
    start.assign(size + 1, 0);
    for (const Entry& entry : entries) ++start[entry.*key + 1];
    for (Index k = 0; k < size; ++k) start[k + 1] += start[k];
    for (const Entry& entry : entries) sorted[start[entry.*key]++] = entry;
    entries.swap(sorted);
  };
  sortBy(&Entry::row);
  sortBy(&Entry::column);

  SparseMatrix matrix(size, size);
  matrix.reserve(static_cast<Eigen::Index>(entries.size()) + size);
  std::size_t at = 0;
  for (Index column = 0; column < size; ++column) {
    matrix.startVec(column);
    matrix.insertBack(column, column) = diagonal[column];
    Index last = column;
    for (; at < entries.size() && entries[at].column == column; ++at) {
      if (entries[at].row == last) {
        matrix.valuePtr()[matrix.data().size() - 1] += entries[at].value;
      } else {
        last = entries[at].row;
        matrix.insertBack(last, column) = entries[at].value;
      }
    }
  }
  matrix.finalize();
  return matrix;
}

}  // namespace

int lengthExponent(const std::vector<double>& lengths) {
  int exponent = 0;
  static_cast<void>(std::frexp(*std::max_element(lengths.begin(), lengths.end()), &exponent));
  return exponent;
}

std::vector<double> unitLengths(const std::vector<double>& lengths) {
  const int exponent = lengthExponent(lengths);
  std::vector<double> result(lengths.size());
  std::transform(lengths.begin(), lengths.end(), result.begin(),
                 [exponent](double length) { return std::ldexp(length, -exponent); });
  return result;
}

std::vector<double> faceAreas(const Connectivity& surface, const std::vector<double>& lengths) {
  std::vector<double> areas(surface.faceCount());
  for (Index f = 0; f < surface.faceCount(); ++f) {
    const auto [a, b, c] = sidesOf(surface, lengths, f);
    areas[f] = triangleArea(a, b, c);
  }
  return areas;
}

std::vector<double> oppositeCotangents(const Connectivity& surface,
                                       const std::vector<double>& lengths) {
  std::vector<double> cotangents(surface.halfedgeCount());
  for (Index f = 0; f < surface.faceCount(); ++f) {
    const auto [a, b, c] = sidesOf(surface, lengths, f);
    const double area = triangleArea(a, b, c);
    cotangents[3 * f] = oppositeCotangent(a, b, c, area);
    cotangents[3 * f + 1] = oppositeCotangent(b, c, a, area);
    cotangents[3 * f + 2] = oppositeCotangent(c, a, b, area);
  }
  return cotangents;
}

std::vector<double> cotanWeights(const Connectivity& surface, const std::vector<double>& lengths) {
  const std::vector<double> cotangents = oppositeCotangents(surface, lengths);
  std::vector<double> weights(surface.edgeCount(), 0.0);
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    weights[surface.edge(h)] += 0.5 * cotangents[h];
  }
  return weights;
}

SparseMatrix stiffnessMatrix(const Connectivity& surface, const std::vector<double>& weights) {
  std::vector<Index> row(surface.vertexCount());
  for (Index v = 0; v < surface.vertexCount(); ++v) row[v] = v;
  return assemble(surface, weights, row, surface.vertexCount());
}

SparseMatrix pinnedStiffness(const Connectivity& surface, const std::vector<double>& weights,
                             Index pinned) {
  std::vector<Index> row(surface.vertexCount());
  for (Index v = 0; v < surface.vertexCount(); ++v) row[v] = v < pinned ? v : v - 1;
  row[pinned] = kNone;
  return assemble(surface, weights, row, surface.vertexCount() - 1);
}

std::vector<double> vertexAreas(const Connectivity& surface, const std::vector<double>& lengths) {
  const std::vector<double> areas = faceAreas(surface, lengths);
  std::vector<double> result(surface.vertexCount(), 0.0);
  for (Index f = 0; f < surface.faceCount(); ++f) {
    for (const Index v : surface.face(f)) result[v] += areas[f] / 3;
  }
  return result;
}

}  // namespace moduli
