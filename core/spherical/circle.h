#pragma once

#include <complex>
#include <vector>

/// Round circles in the plane and what Möbius maps of the unit disk make of them.
namespace moduli {

struct Circle {
  std::complex<double> center;
  double radius = 0;

  /// How far a point is from the circle, negative inside.
  double distance(std::complex<double> z) const { return std::abs(z - center) - radius; }
  /// The nearest point of the circle.
  std::complex<double> project(std::complex<double> z) const {
    return center + radius * ((z - center) / std::abs(z - center));
  }
};

/// The circle closest to points in the mean square of (|z - c|^2 - r^2): theirs, where they lie on
/// one. points: 3 at least, not on a line. O(n).
Circle fitCircle(const std::vector<std::complex<double>>& points);

/// The largest | |z - c| - r | of points.
double roundnessError(const Circle& circle, const std::vector<std::complex<double>>& points);

/// z -> (z - p) / (1 - conj(p) z), which keeps the unit disk and carries p (|p| < 1) to 0.
struct DiskTranslation {
  std::complex<double> zero;

  std::complex<double> operator()(std::complex<double> z) const {
    return (z - zero) / (1.0 - std::conj(zero) * z);
  }
  Circle operator()(const Circle& circle) const;
};

/// The map that makes a circle within the unit disk concentric with it.
DiskTranslation centeringMap(const Circle& circle);

/// The radius that a circle within the unit disk has after centeringMap.
double centeredRadius(const Circle& circle);

}  // namespace moduli
