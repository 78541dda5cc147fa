#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

/// One flat triangle from its three lengths, by formulas that stay accurate for needles and caps.
namespace moduli {

/// Area by Kahan's ordering of Heron's formula: relative error of a few units in the last place for
/// any proper triangle; 0 for an improper one.
inline double triangleArea(double a, double b, double c) {
  if (a < b) std::swap(a, b);
  if (b < c) std::swap(b, c);
  if (a < b) std::swap(a, b);
  const double product = ((a + (b + c)) * (c + (a - b))) * ((c - (a - b)) * (a + (b - c)));
  return product > 0 ? 0.25 * std::sqrt(product) : 0;
}

/// Cotangent of the angle between the sides b and c, opposite to a. Of the squares in
/// b^2 + c^2 - a^2 the two largest are subtracted first, as a product, which is accurate for
/// needles where they nearly cancel. area: of the triangle, positive.
inline double oppositeCotangent(double a, double b, double c, double area) {
  const double longer = std::max(b, c);
  const double shorter = std::min(b, c);
  return (shorter * shorter + (longer - a) * (longer + a)) / (4 * area);
}

/// Gradients of closed forms in an orthonormal frame along the triangle's longest side.
class TriangleFrame {
 public:
  /// lengths: of the sides from corner c to c + 1; a proper triangle.
  explicit TriangleFrame(const std::array<double, 3>& lengths)
      : base_(static_cast<int>(std::max_element(lengths.begin(), lengths.end()) - lengths.begin())),
        length_(lengths[base_]),
        area_(triangleArea(lengths[0], lengths[1], lengths[2])),
        height_(2 * area_ / length_) {
    const double right = lengths[(base_ + 1) % 3];
    const double left = lengths[(base_ + 2) % 3];
    foot_ = 0.5 * (1 + ((left - right) / length_) * ((left + right) / length_));
  }

  double area() const { return area_; }
  /// The corner at which the longest side starts.
  int base() const { return base_; }
  /// The length of that side.
  double length() const { return length_; }
  /// Where the height meets it, as a fraction of it.
  double foot() const { return foot_; }
  /// Distance of the third corner from the longest side.
  double height() const { return height_; }

  /// The gradient of the closed form with the given values along the sides c -> c + 1.
  Eigen::Vector2d gradient(const std::array<double, 3>& along) const {
    const double to_apex = -along[(base_ + 2) % 3];
    return {along[base_] / length_, (to_apex - foot_ * along[base_]) / height_};
  }

 private:
  int base_;
  double length_;
  double area_;
  double height_;
  double foot_ = 0;
};

}  // namespace moduli
