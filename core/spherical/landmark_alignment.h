#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/status.h"
#include "core/spherical/mobius.h"
#include "core/spherical/mobius_map.h"

/// Rotations and Möbius maps that bring landmarks of one sphere to those of another.
///
///   ASSIGN_OR_RETURN(const LandmarkAlignment best, alignLandmarks({{p0, q0}, {p1, q1}, {p2,
///   q2}})); Eigen::Vector3d moved = best.map(point);
namespace moduli {

/// Where a point of the unit sphere ought to go on another unit sphere.
struct PointPair {
  Eigen::Vector3d source, target;
  double weight = 1;  ///< > 0; only ratios count.
};

/// A rotation as a Möbius map: an element of SU(2).
MobiusMap mobiusOfRotation(const Eigen::Matrix3d& rotation);

struct AlignmentOptions {
  /// Weight of a preference for rotations, beside the mean squared distance of the pairs: it adds
  /// preference * 2 (cosh d - 1), where d is the hyperbolic distance by which the map moves the
  /// centre of the ball; 0 for rotations and near d^2. Free of scale. 0 lets the pairs decide.
  double rotation_preference = 0;
  /// Rotations only.
  bool rigid = false;
};

struct LandmarkAlignment {
  MobiusMap map;
  bool is_rotation = false;
  Points3 moved;                  ///< Per pair, the image of its source.
  std::vector<double> residuals;  ///< Per pair |moved - target|, a chord.
  double rms = 0;                 ///< Weighted, of the residuals.
  int iterations = 0;
};

/// The rotation with the least weighted sum of squared distances. Where the pairs leave a turn free
/// (one pair, or all on one axis) the rotation through the smallest angle.
/// pairs: at least one. Fails with kInvalidOption naming the pair (a point is not of unit length to
/// 1e-6, a weight is not positive). O(k). Source: Kabsch 1976; MATH 9.2.
Result<Eigen::Matrix3d> bestRotation(const std::vector<PointPair>& pairs);

/// The Möbius map with the least weighted sum of squared distances. With one or two pairs, and with
/// fewer than three that differ by 1e-8 on both spheres, the pairs do not determine it: then the
/// best rotation. Three pairs are met exactly. More: Newton's method on the Lie
/// algebra of the group, from the best rotation and from a map that meets three pairs far from
/// each other, the better end of both.
/// Commutes with rotations of either sphere.
/// Fails as bestRotation does, with kInvalidOption (preference < 0) and with kNoConvergence where
/// the sum falls for ever towards infinity in the group (the hint names the preference). O(k) a
/// step. Source: MATH 9.2; derivatives of exp(X) p = p + V + DV V / 2 with V = w x p + b - (b.p) p.
Result<LandmarkAlignment> alignLandmarks(const std::vector<PointPair>& pairs,
                                         const AlignmentOptions& options = {});

}  // namespace moduli
