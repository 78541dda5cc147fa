#pragma once

#include <algorithm>
#include <array>
#include <map>
#include <vector>

#include "core/mesh/triangle_soup.h"

namespace moduli {

/// A net of thin bars in a plane, as wide as the gaps between numbers are units: bars across x at
/// each of `columns` and across y at each of `rows`, ascending from 0. Every bar is two edges wide;
/// corners are rounded. Genus (columns - 1) (rows - 1).
inline TriangleSoup tubeNet(const std::vector<int>& columns, const std::vector<int>& rows) {
  using Cell = std::array<int, 3>;
  const auto has = [](const std::vector<int>& bars, int cell) {
    return std::find(bars.begin(), bars.end(), cell / 2) != bars.end();
  };
  const int wide = 2 * columns.back() + 2, high = 2 * rows.back() + 2;
  const auto isInside = [&](const Cell& c) {
    return c[0] >= 0 && c[0] < wide && c[1] >= 0 && c[1] < high && c[2] >= 0 && c[2] < 2 &&
           (has(columns, c[0]) || has(rows, c[1]));
  };
  TriangleSoup soup;
  std::map<Cell, Index> numbers;
  const auto vertex = [&](const Cell& c) {
    const auto [entry, is_new] = numbers.emplace(c, static_cast<Index>(soup.vertices.size()));
    if (is_new) soup.vertices.emplace_back(c[0] / 2.0, c[1] / 2.0, c[2] / 2.0);
    return entry->second;
  };
  const auto addSide = [&](const Cell& cell, int axis, int side) {
    std::array<Index, 4> corners;
    for (std::size_t i = 0; i < 4; ++i) {
      Cell c = cell;
      c[axis] += side;
      c[(axis + 1) % 3] += i == 1 || i == 2 ? 1 : 0;
      c[(axis + 2) % 3] += i >= 2 ? 1 : 0;
      corners[i] = vertex(c);
    }
    if (side == 0) std::reverse(corners.begin(), corners.end());
    soup.faces.push_back({corners[0], corners[1], corners[2]});
    soup.faces.push_back({corners[0], corners[2], corners[3]});
  };
  for (Cell cell{0, 0, 0}; cell[0] < wide; ++cell[0]) {
    for (cell[1] = 0; cell[1] < high; ++cell[1]) {
      for (cell[2] = 0; cell[2] < 2; ++cell[2]) {
        if (!isInside(cell)) continue;
        for (int axis = 0; axis < 3; ++axis) {
          for (const int side : {0, 1}) {
            Cell beyond = cell;
            beyond[axis] += 2 * side - 1;
            if (!isInside(beyond)) addSide(cell, axis, side);
          }
        }
      }
    }
  }
  for (int round = 0; round < 3; ++round) {
    std::vector<Eigen::Vector3d> sums(soup.vertices.size(), Eigen::Vector3d::Zero());
    std::vector<int> counts(soup.vertices.size(), 0);
    for (const Triangle& face : soup.faces) {
      for (std::size_t c = 0; c < 3; ++c) {
        sums[face[c]] += soup.vertices[face[(c + 1) % 3]];
        ++counts[face[c]];
      }
    }
    for (std::size_t v = 0; v < sums.size(); ++v) {
      soup.vertices[v] = (soup.vertices[v] + sums[v] / counts[v]) / 2;
    }
  }
  return soup;
}

}  // namespace moduli
