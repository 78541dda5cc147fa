#include "core/spherical/exterior_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include "core/base/parallel.h"

namespace moduli {
namespace {

using Complex = std::complex<double>;

constexpr std::size_t kGrain = 2048;
/// Points that run through the steps together: the processor overlaps their divisions and roots,
/// and they stay in its first cache.
constexpr std::size_t kTogether = 256;
/// The series is found on a circle of this radius, at this many points, and used from kFar on: what
/// it leaves out is below 2^-64 and 2.5^-41.
constexpr double kSampleRadius = 2;
constexpr int kSamples = 64;
constexpr double kFar = 2.5;
/// Rounding of a point's image, relative to the circle.
constexpr double kRounding = 1e-12;

double twiceSignedArea(const std::vector<Complex>& curve) {
  double sum = 0;
  for (std::size_t k = 0; k < curve.size(); ++k) {
    const Complex a = curve[k] - curve[0];
    const Complex b = curve[(k + 1) % curve.size()] - curve[0];
    sum += a.real() * b.imag() - a.imag() * b.real();
  }
  return sum;
}

/// The point at which the curve turns least: there three points and the curve have one circle.
std::size_t straightestCorner(const std::vector<Complex>& curve) {
  const std::size_t n = curve.size();
  std::size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < n; ++k) {
    const Complex before = curve[k] - curve[(k + n - 1) % n];
    const Complex after = curve[(k + 1) % n] - curve[k];
    const double turn = std::abs(std::arg(after * std::conj(before)));
    // Among equals the first one, whatever rounding says.
    if (turn < least - 1e-9) {
      least = turn;
      best = k;
    }
  }
  return best;
}

Status checkCurve(const std::vector<Complex>& curve) {
  if (curve.size() < 3) {
    return {Reason::kInvalidOption,
            "a curve of " + std::to_string(curve.size()) + " points has no inside"};
  }
  for (const Complex z : curve) {
    if (std::isfinite(z.real()) && std::isfinite(z.imag())) continue;
    return {Reason::kInvalidOption, "the curve has a point that is not finite"};
  }
  for (std::size_t k = 0; k < curve.size(); ++k) {
    if (curve[k] != curve[(k + 1) % curve.size()]) continue;
    return {Reason::kFoldedMap, "the curve has its point " + std::to_string(k) + " twice in a row"};
  }
  return {};
}

/// The principal root, which carries the plane without the negative real axis to the right half
/// plane, turned into the upper one.
Complex rootInUpperHalfPlane(Complex q) {
  return Complex(0, 1) * std::sqrt(q);
}

}  // namespace

ExteriorMap::Step ExteriorMap::stepFor(Complex tip) {
  const double norm = std::norm(tip);
  return {tip.real() / norm, norm / tip.imag()};
}

void ExteriorMap::advance(const Step& step, double* x, double* y, std::size_t count) {
  const double k = step.k;
  const double c = step.c;
  for (std::size_t i = 0; i < count; ++i) {
    // L = z conj(1 - k z) / |1 - k z|^2, whose imaginary part is a quotient of positive numbers.
    const double dr = 1 - k * x[i];
    const double di = k * y[i];
    const double inverse = 1 / (dr * dr + di * di);
    const double lr = (x[i] * dr - y[i] * di) * inverse;
    const double li = y[i] * inverse;
    // The root of L^2 + c^2 that lies in the same quadrant as L.
    const double sr = lr * lr + (c - li) * (c + li);
    const double si = 2 * lr * li;
    const double modulus = std::sqrt(sr * sr + si * si);
    const double larger = std::max(std::sqrt(0.5 * (modulus + std::abs(sr))), 1e-300);
    const double smaller = std::abs(lr) * li / larger;
    x[i] = std::copysign(sr >= 0 ? larger : smaller, lr);
    y[i] = sr >= 0 ? smaller : larger;
  }
}

// On the real line: the points right of 0 stay there, and so do those left of it. The base of the
// arc, 0, becomes c and -c; c is its side outside a curve that runs counter-clockwise.
ExteriorMap::Ratio ExteriorMap::advance(const Step& step, const Ratio& x) {
  double numerator = x.numerator;
  double denominator = x.denominator - step.k * numerator;
  if (denominator < 0) {
    numerator = -numerator;
    denominator = -denominator;
  }
  const double root = std::hypot(numerator, step.c * denominator);
  const double size = std::max(root, denominator);
  return {(numerator < 0 ? -root : root) / size, denominator / size};
}

ExteriorMap::Jet ExteriorMap::advance(const Step& step, const Jet& jet) {
  const Complex d = 1.0 - step.k * jet.value;
  const Complex slope = 1.0 / (d * d);
  const Complex value = jet.value / d;
  const Complex first = slope * jet.first;
  const Complex second = slope * (jet.second + step.k / d * jet.first * jet.first);
  double x = jet.value.real();
  double y = jet.value.imag();
  advance(step, &x, &y, 1);
  const Complex root(x, y);
  const Complex root_first = value * first / root;
  const Complex root_second =
      (2.0 * value * second + first * first - root_first * root_first) / (2.0 * root);
  return {root, root_first, root_second};
}

Result<ExteriorMap> ExteriorMap::make(const std::vector<Complex>& curve) {
  RETURN_IF_ERROR(checkCurve(curve));
  ExteriorMap map;
  RETURN_IF_ERROR(map.build(curve));
  return map;
}

Status ExteriorMap::build(const std::vector<Complex>& curve) {
  const std::size_t n = curve.size();
  const double area = twiceSignedArea(curve);
  if (!(std::abs(area) > 0)) return {Reason::kInvalidOption, "the curve encloses no area"};

  // The points in the order of the algorithm: counter-clockwise, the straightest corner second.
  const std::size_t second = straightestCorner(curve);
  std::vector<std::size_t> order(n);
  for (std::size_t k = 0; k < n; ++k) {
    order[k] = area > 0 ? (second + n - 1 + k) % n : (second + 1 + n - k) % n;
  }
  origin_ = 0;
  for (const Complex z : curve) origin_ += z / static_cast<double>(n);
  scale_ = 0;
  for (const Complex z : curve) scale_ = std::max(scale_, std::abs(z - origin_));
  std::vector<Complex> unit(n);
  for (std::size_t k = 0; k < n; ++k) unit[k] = (curve[order[k]] - origin_) / scale_;

  // The first arc, on the circle of the first three points: its complement is a half plane in which
  // the third point is i.
  start_ = unit[0];
  tip_ = unit[1];
  third_ = (unit[2] - tip_) / (unit[2] - start_);
  std::vector<double> x(n), y(n);
  for (std::size_t k = 2; k < n; ++k) {
    const Complex w = rootInUpperHalfPlane((unit[k] - tip_) / (unit[k] - start_) / third_);
    x[k] = w.real();
    y[k] = w.imag();
  }
  Jet infinity;
  infinity.value = rootInUpperHalfPlane(1.0 / third_);
  infinity.first = infinity.value * (start_ - tip_) / 2.0;
  infinity.second = infinity.value * (start_ - tip_) * (3.0 * start_ + tip_) / 8.0;

  std::vector<Ratio> opened(n);
  opened[0] = {1, 0};
  opened[1] = {0, 1};
  for (std::size_t k = 2; k < n; ++k) {
    const Complex tip(x[k], y[k]);
    const Step step = stepFor(tip);
    if (!(tip.imag() > 0) || !std::isfinite(step.k) || !std::isfinite(step.c)) {
      return {Reason::kFoldedMap, "the curve touches itself at its point " +
                                      std::to_string(order[k]) + " as far as doubles can tell"};
    }
    steps_.push_back(step);
    advance(step, x.data() + k + 1, y.data() + k + 1, n - k - 1);
    for (std::size_t i = 0; i < k; ++i) opened[i] = advance(step, opened[i]);
    infinity = advance(step, infinity);
    opened[k] = {0, 1};
  }
  finish(opened[0], infinity);

  images_.resize(n);
  for (std::size_t k = 0; k < n; ++k) {
    // M^2 of M = x / (1 - x / start), as a quotient of real numbers that are not both 0.
    const double numerator = opened[k].numerator;
    const double denominator =
        k == 0 ? 0.0 : opened[k].denominator - inverse_start_ * opened[k].numerator;
    const Complex below = numerator * numerator - denominator * denominator * infinity_;
    const Complex turn = std::conj(below) / below;
    images_[order[k]] = center_ + scale_ * (factor_ * (turn / std::abs(turn)));
  }
  findSeries();
  return {};
}

/// What closes the curve: the last arc is the geodesic from 0 to the image of the first point. It
/// becomes the imaginary axis, and the square of what lies right of it a half plane.
void ExteriorMap::finish(const Ratio& start, const Jet& infinity) {
  inverse_start_ = start.denominator / start.numerator;
  const Complex d = 1.0 - inverse_start_ * infinity.value;
  const Complex slope = 1.0 / (d * d);
  const Complex value = infinity.value / d;
  const Complex first = slope * infinity.first;
  const Complex second =
      slope * (infinity.second + inverse_start_ / d * infinity.first * infinity.first);
  infinity_ = value * value;
  const Complex square_first = 2.0 * value * first;
  const Complex square_second = 2.0 * value * second + first * first;
  // (w - conj(W)) / (w - W) = 1 + 2 i Im W / (w - W), and w - W = first / z + second / z^2 + ...
  factor_ = square_first / Complex(0, 2 * infinity_.imag());
  shift_ = square_second / square_first - factor_;
  center_ = origin_ + scale_ * shift_;
  radius_ = scale_ * std::abs(factor_);
}

Complex ExteriorMap::halfPlaneToCircle(Complex w) const {
  return shift_ + factor_ * (w - std::conj(infinity_)) / (w - infinity_);
}

/// Points of the curve's frame that are not far.
void ExteriorMap::applyNear(std::span<Complex> points) const {
  std::array<double, kTogether> x;
  std::array<double, kTogether> y;
  for (std::size_t begin = 0; begin < points.size(); begin += kTogether) {
    const std::span<Complex> some =
        points.subspan(begin, std::min(kTogether, points.size() - begin));
    for (std::size_t i = 0; i < some.size(); ++i) {
      const Complex w = rootInUpperHalfPlane((some[i] - tip_) / (some[i] - start_) / third_);
      x[i] = w.real();
      y[i] = std::abs(w.imag());
    }
    for (const Step& step : steps_) advance(step, x.data(), y.data(), some.size());
    for (std::size_t i = 0; i < some.size(); ++i) {
      const Complex w(x[i], y[i]);
      const Complex m = w / (1.0 - inverse_start_ * w);
      some[i] = halfPlaneToCircle(m * m);
    }
  }
}

void ExteriorMap::findSeries() {
  std::array<Complex, kSamples> samples;
  for (int j = 0; j < kSamples; ++j) {
    samples[j] = std::polar(kSampleRadius, 2 * std::numbers::pi * j / kSamples);
  }
  const std::array<Complex, kSamples> places = samples;
  applyNear(samples);
  for (int j = 0; j < kSamples; ++j) samples[j] -= places[j];
  for (int m = 1; m <= kTerms; ++m) {
    Complex sum = 0;
    for (int j = 0; j < kSamples; ++j) {
      sum += samples[j] * std::polar(1.0, 2 * std::numbers::pi * ((m * j) % kSamples) / kSamples);
    }
    series_[m - 1] = sum / static_cast<double>(kSamples) * std::pow(kSampleRadius, m);
  }
}

/// h(z) - z in the curve's frame, v = 1 / z small.
Complex ExteriorMap::displacement(Complex v) const {
  Complex sum = 0;
  for (int m = kTerms; m-- > 0;) {
    const Complex next = sum + series_[m];
    sum = {next.real() * v.real() - next.imag() * v.imag(),
           next.real() * v.imag() + next.imag() * v.real()};
  }
  return sum;
}

std::size_t ExteriorMap::apply(std::span<Complex> points) const {
  std::vector<std::size_t> misplaced((points.size() + kGrain - 1) / kGrain, 0);
  parallelBlocks(points.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<Complex> near;
    std::vector<std::size_t> place;
    for (std::size_t i = begin; i < end; ++i) {
      const Complex unit = (points[i] - origin_) / scale_;
      if (std::norm(unit) >= kFar * kFar) {
        points[i] += scale_ * displacement(1.0 / unit);
      } else {
        near.push_back(unit);
        place.push_back(i);
      }
    }
    applyNear(near);
    for (std::size_t i = 0; i < near.size(); ++i) {
      if (!(std::abs(near[i] - shift_) > (1 - kRounding) * std::abs(factor_))) {
        ++misplaced[begin / kGrain];
      }
      points[place[i]] = origin_ + scale_ * near[i];
    }
  });
  std::size_t sum = 0;
  for (const std::size_t count : misplaced) sum += count;
  return sum;
}

Complex ExteriorMap::operator()(Complex z) const {
  apply({&z, 1});
  return z;
}

Result<InteriorMap> InteriorMap::make(const std::vector<Complex>& curve, Complex base) {
  RETURN_IF_ERROR(checkCurve(curve));
  std::vector<Complex> inverted(curve.size());
  for (std::size_t k = 0; k < curve.size(); ++k) inverted[k] = 1.0 / (curve[k] - base);
  ASSIGN_OR_RETURN(ExteriorMap exterior, ExteriorMap::make(inverted));
  return InteriorMap(std::move(exterior), base);
}

InteriorMap::InteriorMap(ExteriorMap exterior, Complex base)
    : exterior_(std::move(exterior)), base_(base), images_(exterior_.images().size()) {
  for (std::size_t k = 0; k < images_.size(); ++k) {
    const Complex w = exterior_.radius() / (exterior_.images()[k] - exterior_.center());
    images_[k] = w / std::abs(w);
  }
}

/// w = r / (h(u) - c) with u = 1 / (z - base). Where u is far, h(u) = u + a small difference, and
/// everything is written in d = z - base, which may be 0.
void InteriorMap::applyBlock(std::span<Complex> points) const {
  std::vector<Complex> near;
  std::vector<std::size_t> place;
  const ExteriorMap& outer = exterior_;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Complex d = points[i] - base_;
    const Complex rest = 1.0 - outer.origin_ * d;
    if (std::norm(rest) >= kFar * kFar * outer.scale_ * outer.scale_ * std::norm(d)) {
      const Complex moved = outer.scale_ * outer.displacement(outer.scale_ * d / rest);
      points[i] = outer.radius_ * d / (1.0 + d * (moved - outer.center_));
    } else {
      near.push_back(rest / d / outer.scale_);
      place.push_back(i);
    }
  }
  outer.applyNear(near);
  for (std::size_t i = 0; i < near.size(); ++i) {
    points[place[i]] = std::abs(outer.factor_) / (near[i] - outer.shift_);
  }
}

std::size_t InteriorMap::apply(std::span<Complex> points) const {
  std::vector<std::size_t> misplaced((points.size() + kGrain - 1) / kGrain, 0);
  parallelBlocks(points.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    const std::span<Complex> block = points.subspan(begin, end - begin);
    applyBlock(block);
    for (const Complex w : block) {
      if (!(std::abs(w) < 1 + kRounding)) ++misplaced[begin / kGrain];
    }
  });
  std::size_t sum = 0;
  for (const std::size_t count : misplaced) sum += count;
  return sum;
}

Complex InteriorMap::operator()(Complex z) const {
  apply({&z, 1});
  return z;
}

}  // namespace moduli
