#pragma once

#include <Eigen/Core>
#include <array>
#include <complex>

#include "core/base/status.h"

/// Möbius maps z -> (a z + b) / (c z + d) of the plane with infinity, which is the sphere:
///
///   const MobiusMap map = compose(diskAutomorphism(w0), halfPlaneToDisk(z0));
///   w = map(z);
///
/// The plane and the unit sphere are one by the stereographic projection from the north pole,
/// z = (x + i y) / (1 - height): the unit circle is the equator and infinity the north pole.
/// Source: MATH 0.5, 0.6, 2.7.
namespace moduli {

/// An element of SL(2, C): a d - b c = 1. Two elements that differ by a sign are the same map.
struct MobiusMap {
  using Complex = std::complex<double>;
  Complex a = 1, b = 0, c = 0, d = 1;

  /// The image of a point of the plane. Infinity is any number with an infinite part, on both
  /// sides; the image of the pole is infinity. Nothing overflows for |z| below 1e300.
  Complex operator()(const Complex& z) const;

  /// The image of a point of the unit sphere, of length 1. In homogeneous coordinates: nothing is
  /// divided by what could be 0, at the poles neither.
  Eigen::Vector3d operator()(const Eigen::Vector3d& point) const;

  /// (a' z + b') / (c' z + d') undone.
  MobiusMap inverse() const { return {d, -b, -c, a}; }

  /// Whether the unit disk goes to itself: d is conj a and c is conj b up to `tolerance`, relative
  /// to |a| + |b|.
  bool keepsDisk(double tolerance = 1e-12) const;
};

/// The map that applies `first` and then `then`, scaled back to determinant 1.
MobiusMap compose(const MobiusMap& then, const MobiusMap& first);

/// The map with any coefficients whose determinant is not 0. Fails with kInvalidOption where the
/// determinant is 0 to rounding or a coefficient is not finite.
Result<MobiusMap> makeMobiusMap(MobiusMap::Complex a, MobiusMap::Complex b, MobiusMap::Complex c,
                                MobiusMap::Complex d);

/// The map that carries three points of the plane, infinity among them, to three others. Fails with
/// kInvalidOption where two points on one side are equal or one is no number.
Result<MobiusMap> mobiusThrough(const std::array<MobiusMap::Complex, 3>& from,
                                const std::array<MobiusMap::Complex, 3>& to);

/// The same for points of the unit sphere.
Result<MobiusMap> mobiusThrough(const std::array<Eigen::Vector3d, 3>& from,
                                const std::array<Eigen::Vector3d, 3>& to);

/// The automorphism w -> e^{i angle} (w - w0) / (1 - conj(w0) w) of the unit disk, which carries w0
/// to 0. |w0| < 1.
MobiusMap diskAutomorphism(const MobiusMap::Complex& w0, double angle = 0);

/// The map z -> (z - z0) / (z - conj z0) of the upper half plane to the unit disk, which carries z0
/// to 0 and infinity to 1. Im z0 > 0.
MobiusMap halfPlaneToDisk(const MobiusMap::Complex& z0);

}  // namespace moduli
