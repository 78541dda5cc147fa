#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

/// How much the linear map of a triangle in space to another one distorts it.
namespace moduli {

using SpaceTriangle = std::array<Eigen::Vector3d, 3>;

/// The symmetric Dirichlet energy a |J|^2 (1 + a^2 / b^2), that is a (s1^2 + s2^2 + s1^-2 + s2^-2)
/// with the singular values s of the map J: 4 a for an isometry, more for any other map. a, b: the
/// areas before and after. Two things keep it finite: a needle (area below 1e-6 of its longest side
/// squared) counts as if it had that area, and b^2 as at least 1e-16 a^2.
///
///   const FaceDistortion face(before);
///   energy += face.energy(after);
class FaceDistortion {
 public:
  explicit FaceDistortion(const SpaceTriangle& before) {
    double longest = 0, twice_area = 0;
    std::array<Eigen::Vector3d, 3> side;  // Opposite the corner.
    for (int c = 0; c < 3; ++c) {
      side[c] = before[(c + 2) % 3] - before[(c + 1) % 3];
      longest = std::max(longest, side[c].squaredNorm());
    }
    twice_area = std::max(side[1].cross(side[2]).norm(), 2e-6 * longest);
    area_ = twice_area / 2;
    if (!(twice_area > 0)) return;
    const double inverse = 1 / twice_area;
    for (int c = 0; c < 3; ++c) {
      cotangent_[c] = -side[(c + 1) % 3].dot(side[(c + 2) % 3]) * inverse;
    }
  }

  double area() const { return area_; }

  /// In squared units of the triangle before, where both have the same unit.
  double energy(const SpaceTriangle& after) const {
    if (!(area_ > 0)) return 0;
    const double b2 = (after[1] - after[0]).cross(after[2] - after[0]).squaredNorm() / 4;
    return stretch(after) * (1 + area_ * area_ / floored(b2));
  }

  /// Derivatives by corner 0 of the triangle after: the gradient, and the part of the Hessian that
  /// is a sum of squares (Gauss and Newton). Added to what is given. Returns the energy.
  double differentiate(const SpaceTriangle& after, Eigen::Vector3d& gradient,
                       Eigen::Matrix3d& hessian) const {
    if (!(area_ > 0)) return 0;
    const Eigen::Vector3d normal = (after[1] - after[0]).cross(after[2] - after[0]);
    const double inverse = 1 / std::sqrt(floored(normal.squaredNorm() / 4));
    const double ratio = area_ * area_ * inverse * inverse, stretched = stretch(after);
    // D = a |J|^2 and b, by the corner.
    const Eigen::Vector3d by_d =
        cotangent_[1] * (after[0] - after[2]) + cotangent_[2] * (after[0] - after[1]);
    const Eigen::Vector3d by_b = normal.cross(after[2] - after[1]) * (inverse / 4);
    const double pull = ratio * stretched * inverse;
    gradient += (1 + ratio) * by_d - 2 * pull * by_b;
    hessian.diagonal().array() += (1 + ratio) * std::max(0.0, cotangent_[1] + cotangent_[2]);
    // Of b twice, less what both have.
    const Eigen::Vector3d rest = pull * inverse * by_b - ratio * inverse * by_d;
    for (int c = 0; c < 3; ++c) hessian.col(c) += rest[c] * by_b + by_b[c] * rest;
    return stretched * (1 + ratio);
  }

 private:
  /// a |J|^2: half the sum of the cotangents times the squared sides.
  double stretch(const SpaceTriangle& after) const {
    double sum = 0;
    for (int c = 0; c < 3; ++c) {
      sum += cotangent_[c] * (after[(c + 2) % 3] - after[(c + 1) % 3]).squaredNorm();
    }
    return std::max(0.0, sum / 2);
  }
  double floored(double b2) const { return std::max(b2, 1e-16 * area_ * area_); }

  double area_ = 0;
  std::array<double, 3> cotangent_ = {0, 0, 0};
};

}  // namespace moduli
