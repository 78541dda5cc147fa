#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "core/base/status.h"

/// Conformal maps of the outside and of the inside of a Jordan curve that is given by points.
///
///   ASSIGN_OR_RETURN(const ExteriorMap map, ExteriorMap::make(curve));
///   map.images();          // where the curve's points lie on the circle
///   map.apply(others);     // points outside the curve, moved in place
///
/// The geodesic algorithm ("zipper"): the curve through the points grows arc by arc, each a
/// hyperbolic geodesic of the complement of what is there, and one square root opens each arc to
/// the real line. What comes out is the exact map of a smooth curve through the points, whatever
/// their number; it converges to the map of the curve they are taken from. The first arc lies on
/// the circle of three neighbouring points, so that points of a circle give that very circle, and
/// Möbius images of the points give Möbius images of the curve where they start the curve at the
/// same place. Source: Kühnau 1983; Marshall and Rohde 2007.
namespace moduli {

/// Outside of the curve -> outside of a round circle with h(z) = z + O(1 / z) at infinity.
/// Immutable; safe to use from several threads. About 60 bytes a point.
class ExteriorMap {
 public:
  /// curve: 3 points at least, in order and either orientation, without repetition; the polygon
  /// need not be convex. Any units. Fails with kInvalidOption (fewer points, not finite, no area)
  /// and kFoldedMap (neighbours that doubles do not tell apart, a curve that touches itself).
  /// O(n^2), some 10 ns a pair.
  static Result<ExteriorMap> make(const std::vector<std::complex<double>>& curve);

  /// The circle that the curve becomes. Its radius is the capacity (transfinite diameter) of the
  /// curve, its centre the conformal centre.
  std::complex<double> center() const { return center_; }
  double radius() const { return radius_; }
  /// Per point of the curve its image, on the circle up to rounding.
  const std::vector<std::complex<double>>& images() const { return images_; }

  /// Moves points outside the curve. Returns how many lie on it or inside instead: their images,
  /// within the circle, mean nothing. O(n) elementary maps a point near the curve, and a series of
  /// 40 terms for points farther than 2.5 times the curve's radius, where it is as exact as the map
  /// and keeps the small difference h(z) - z to its own precision.
  std::size_t apply(std::span<std::complex<double>> points) const;
  std::complex<double> operator()(std::complex<double> z) const;

 private:
  friend class InteriorMap;

  /// z -> sqrt(L^2 + c^2) with L = z / (1 - k z), from the upper half plane less the arc of a
  /// circle that leaves 0 at a right angle to the half plane.
  struct Step {
    double k = 0;
    double c = 0;
  };
  /// A real number or infinity: numerator / denominator, the latter >= 0.
  struct Ratio {
    double numerator = 0;
    double denominator = 1;
  };
  /// The first terms of a power series at infinity, in 1 / z.
  struct Jet {
    std::complex<double> value, first, second;
  };
  static constexpr int kTerms = 40;

  ExteriorMap() = default;
  Status build(const std::vector<std::complex<double>>& curve);
  static Step stepFor(std::complex<double> tip);
  static void advance(const Step& step, double* x, double* y, std::size_t count);
  static Ratio advance(const Step& step, const Ratio& x);
  static Jet advance(const Step& step, const Jet& jet);
  void finish(const Ratio& start, const Jet& infinity);
  void findSeries();
  std::complex<double> halfPlaneToCircle(std::complex<double> w) const;
  void applyNear(std::span<std::complex<double>> points) const;
  std::complex<double> displacement(std::complex<double> v) const;

  // The curve's frame: unit_z = (z - origin_) / scale_, in which it reaches to distance 1 from 0.
  // All that follows but for center_, radius_ and images_ is in this frame.
  std::complex<double> origin_;
  double scale_ = 1;
  std::complex<double> start_, tip_;  ///< Ends of the first arc.
  std::complex<double> third_;        ///< (z - tip) / (z - start) of the point after it.
  std::vector<Step> steps_;
  double inverse_start_ = 0;             ///< 1 / the image of the first point after all steps.
  std::complex<double> infinity_;        ///< Where infinity lies in the half plane.
  std::complex<double> factor_, shift_;  ///< From the unit circle to the image circle.
  std::array<std::complex<double>, kTerms> series_{};  ///< h(z) - z = sum of [m - 1] / z^m.

  std::complex<double> center_;
  double radius_ = 0;
  std::vector<std::complex<double>> images_;
};

/// Inside of the curve -> unit disk, with w(base) = 0 and w'(base) > 0. Immutable; safe to use from
/// several threads.
class InteriorMap {
 public:
  /// curve: as for ExteriorMap; base: a point inside. Fails as ExteriorMap::make. O(n^2).
  static Result<InteriorMap> make(const std::vector<std::complex<double>>& curve,
                                  std::complex<double> base);

  /// w'(base): the reciprocal of the conformal radius.
  double derivative() const { return exterior_.radius(); }
  /// Per point of the curve its image, on the unit circle up to rounding.
  const std::vector<std::complex<double>>& images() const { return images_; }

  /// Moves points inside the curve; returns how many do not lie there. As ExteriorMap::apply.
  std::size_t apply(std::span<std::complex<double>> points) const;
  std::complex<double> operator()(std::complex<double> z) const;

 private:
  InteriorMap(ExteriorMap exterior, std::complex<double> base);
  void applyBlock(std::span<std::complex<double>> points) const;

  ExteriorMap exterior_;  ///< Of the curve under z -> 1 / (z - base).
  std::complex<double> base_;
  std::vector<std::complex<double>> images_;
};

}  // namespace moduli
