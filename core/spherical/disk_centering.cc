#include "core/spherical/disk_centering.h"

#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

namespace moduli {
namespace {

using Complex = std::complex<double>;
using Points = std::vector<Complex>;

constexpr int kMaxIterations = 200;
/// Newton's step as a hyperbolic half-length; longer ones are shortened.
constexpr double kMaxStep = 3;
/// What rounding may have moved a point of the circle by.
constexpr double kRim = 1e-9;

Result<std::vector<double>> checkedShares(const Points& points,
                                          const std::vector<double>& weights) {
  if (points.size() != weights.size()) {
    return Status(Reason::kInvalidOption, "there are " + std::to_string(points.size()) +
                                              " points but " + std::to_string(weights.size()) +
                                              " weights");
  }
  double total = 0;
  for (const double weight : weights) {
    if (!(weight >= 0)) return Status(Reason::kInvalidOption, "weights must not be negative");
    total += weight;
  }
  if (!(total > 0) || !std::isfinite(total)) {
    return Status(Reason::kInvalidOption, "weights must be finite and not all 0");
  }
  std::vector<double> shares(weights.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double radius = std::abs(points[i]);
    shares[i] = weights[i] / total;
    if (!(radius <= 1 + kRim)) {
      return Status(Reason::kInvalidOption,
                    "point " + std::to_string(i) + " lies outside of the unit disk");
    }
    if (radius >= 1 - kRim && shares[i] >= 0.5) {
      return Status(Reason::kInvalidOption, "point " + std::to_string(i) +
                                                " on the circle carries half of the weight or "
                                                "more: no Moebius map centres the points");
    }
  }
  return shares;
}

Complex weightedMean(const Points& points, const std::vector<double>& shares) {
  Complex sum = 0;
  for (std::size_t i = 0; i < points.size(); ++i) sum += shares[i] * points[i];
  return sum;
}

/// In the moving frame, where T_c(p) = p - c + conj(c) p^2 to first order in c.
Complex newtonDirection(const Points& points, const std::vector<double>& shares,
                        const Complex& mean) {
  Complex square = 0;
  for (std::size_t i = 0; i < points.size(); ++i) square += shares[i] * points[i] * points[i];
  const double determinant = 1 - std::norm(square);
  const Complex step = (mean + square * std::conj(mean)) / determinant;
  return determinant > 1e-14 ? step : mean;
}

/// The potential at c less its value at 0, without the constants of interior points.
double potential(const Points& points, const std::vector<double>& shares, const Complex& c) {
  double sum = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (shares[i] > 0) sum += shares[i] * std::log(std::norm(1.0 - std::conj(c) * points[i]));
  }
  return sum - std::log1p(-std::norm(c));
}

/// The disk point at the end of a geodesic from 0 with this initial velocity.
Complex geodesicEnd(const Complex& velocity) {
  const double length = std::abs(velocity);
  return length > 0 ? velocity * (std::tanh(length) / length) : velocity;
}

/// Armijo's rule; the derivative of the potential along the velocity is -2 mean.velocity.
Complex armijo(const Points& points, const std::vector<double>& shares, const Complex& mean,
               const Complex& velocity) {
  const double slope = 2 * (std::conj(mean) * velocity).real();
  double t = 1;
  while (t > 1e-6 && potential(points, shares, geodesicEnd(t * velocity)) > -1e-4 * t * slope) {
    t /= 2;
  }
  return t * velocity;
}

/// map(z) for a point of the disk, where nothing can overflow: in real numbers, four times faster.
Complex image(const MobiusMap& map, const Complex& z) {
  const double x = z.real(), y = z.imag();
  const double p = map.a.real() * x - map.a.imag() * y + map.b.real();
  const double q = map.a.real() * y + map.a.imag() * x + map.b.imag();
  const double r = map.c.real() * x - map.c.imag() * y + map.d.real();
  const double s = map.c.real() * y + map.c.imag() * x + map.d.imag();
  const double size = r * r + s * s;
  return {(p * r + q * s) / size, (q * r - p * s) / size};
}

}  // namespace

Result<DiskCentering> centerDisk(Context& context, const Points& points,
                                 const std::vector<double>& weights) {
  ASSIGN_OR_RETURN(const std::vector<double> shares, checkedShares(points, weights));
  const double rounding = 8 * std::numeric_limits<double>::epsilon();
  DiskCentering result;
  result.points = points;
  Complex mean = weightedMean(points, shares);
  while (std::abs(mean) > rounding) {
    RETURN_IF_ERROR(context.check());
    if (++result.iterations > kMaxIterations) {
      return Status(Reason::kNoConvergence,
                    "Moebius centring did not converge: half of the weight or more sits closer "
                    "together than doubles can tell apart");
    }
    Complex velocity = newtonDirection(result.points, shares, mean);
    if (std::abs(velocity) > kMaxStep) velocity *= kMaxStep / std::abs(velocity);
    // Close to the minimum the potential's own rounding would decide, so Newton runs free there.
    if (std::abs(mean) > 1e-3) velocity = armijo(result.points, shares, mean, velocity);
    const MobiusMap map = compose(diskAutomorphism(geodesicEnd(velocity)), result.map);
    Points moved(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) moved[i] = image(map, points[i]);
    const Complex moved_mean = weightedMean(moved, shares);
    // At the level of rounding a step no longer helps: keep the better of the two.
    if (std::abs(mean) < 1e-12 && std::abs(moved_mean) >= std::abs(mean)) break;
    result.points = std::move(moved);
    result.map = map;
    mean = moved_mean;
  }
  result.residual = std::abs(mean);
  return result;
}

}  // namespace moduli
