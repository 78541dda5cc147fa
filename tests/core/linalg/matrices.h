#pragma once

#include <array>
#include <random>
#include <vector>

#include "core/linalg/spd_solver.h"

/// Matrices for the tests of the solvers.
namespace moduli {

/// Lower triangle of the graph Laplacian of a grid of n[0] x n[1] x n[2] points plus `shift` times
/// the identity.
inline SparseMatrix gridLaplacian(std::array<int, 3> n, double shift) {
  std::vector<Eigen::Triplet<double>> entries;
  const auto index = [&](int i, int j, int k) { return (i * n[1] + j) * n[2] + k; };
  const auto link = [&](int a, int b) {
    entries.emplace_back(a, a, 1.0);
    entries.emplace_back(b, b, 1.0);
    entries.emplace_back(b, a, -1.0);
  };
  for (int i = 0; i < n[0]; ++i) {
    for (int j = 0; j < n[1]; ++j) {
      for (int k = 0; k < n[2]; ++k) {
        const int here = index(i, j, k);
        entries.emplace_back(here, here, shift);
        if (i + 1 < n[0]) link(here, index(i + 1, j, k));
        if (j + 1 < n[1]) link(here, index(i, j + 1, k));
        if (k + 1 < n[2]) link(here, index(i, j, k + 1));
      }
    }
  }
  const int size = n[0] * n[1] * n[2];
  SparseMatrix result(size, size);
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

inline Eigen::MatrixXd randomMatrix(Eigen::Index rows, Eigen::Index columns, unsigned seed) {
  std::mt19937 random(seed);
  return Eigen::MatrixXd::NullaryExpr(
      rows, columns, [&] { return static_cast<double>(random()) / 2147483648.0 - 1.0; });
}

}  // namespace moduli
