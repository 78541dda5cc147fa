#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/status.h"

namespace moduli {

/// A Möbius map of space: moves, scalings, mirrors, inversions in spheres, and what they make one
/// after another.
///
/// Kept as the linear map of the vectors (x, (|x|^2 - 1) / 2, (|x|^2 + 1) / 2), which keeps
/// x^2 + y^2 + z^2 + p^2 - q^2 but for a factor (Lorentz).
class SpaceMobius {
 public:
  using Matrix = Eigen::Matrix<double, 5, 5>;

  SpaceMobius() = default;  ///< The identity.
  static SpaceMobius translation(const Eigen::Vector3d& by);
  /// linear: orthogonal, of either determinant.
  static SpaceMobius orthogonal(const Eigen::Matrix3d& linear);
  static SpaceMobius scaling(double factor);  ///< > 0.
  static SpaceMobius inversion();             ///< In the unit sphere about 0.

  /// First `first`, then this.
  SpaceMobius operator*(const SpaceMobius& first) const;
  /// x: not what goes to infinity (then not finite).
  Eigen::Vector3d operator()(const Eigen::Vector3d& x) const;

 private:
  explicit SpaceMobius(const Matrix& matrix) : matrix_(matrix) {}
  Matrix matrix_ = Matrix::Identity();
};

struct SpaceMobiusFit {
  SpaceMobius map;
  double median = 0;  ///< Distance of an image from its target.
};

/// The Möbius map that brings points nearest to targets, some of which may be wrong.
///
/// Starts from how much distances change: the squared factor of a pair is 1 / (q_i q_j) with q a
/// quadratic function of the place. Then Gauss and Newton's method in the 10 infinitesimal Möbius
/// maps, targets farther than twice the median counting less and less. points, targets: as many, at
/// least 8, not all on one sphere or plane. Fails with kInvalidOption (sizes) and kNoConvergence
/// (nothing finite). O(n^2).
Result<SpaceMobiusFit> fitSpaceMobius(const std::vector<Eigen::Vector3d>& points,
                                      const std::vector<Eigen::Vector3d>& targets);

}  // namespace moduli
