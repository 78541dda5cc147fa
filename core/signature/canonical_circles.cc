#include "core/signature/canonical_circles.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <utility>

namespace moduli {
namespace {

using Circles = std::vector<Circle>;

constexpr double kTie = 1e-3;
constexpr double kTelling = 1e-4;

/// Of the planes over two circles, one of which may enclose the other one.
double hyperbolicDistance(const Circle& a, const Circle& b) {
  const double squares = a.radius * a.radius + b.radius * b.radius;
  const double product =
      std::abs(std::norm(a.center - b.center) - squares) / (2 * a.radius * b.radius);
  return std::acosh(std::max(1.0, product));
}

/// The numbers from `begin` to `end` for which `size` is the largest but for ties.
template <typename Size>
std::vector<std::size_t> largestOf(std::size_t begin, std::size_t end, const Size& size) {
  double largest = 0;
  for (std::size_t k = begin; k < end; ++k) largest = std::max(largest, size(k));
  std::vector<std::size_t> result;
  for (std::size_t k = begin; k < end; ++k) {
    if (size(k) >= (1 - kTie) * largest) result.push_back(k);
  }
  return result;
}

/// How near a circle is to all others.
double closeness(const Circles& circles, std::size_t k) {
  double sum = 0;
  for (std::size_t j = 0; j < circles.size(); ++j) {
    if (j != k) sum += hyperbolicDistance(circles[j], circles[k]);
  }
  return 1 / sum;
}

/// The domain turned inside out, so that a hole's circle becomes the unit circle.
Circles turnedInsideOut(Circles circles, std::size_t hole) {
  std::swap(circles[0], circles[hole]);
  const Circle outer = circles[0];
  for (Circle& circle : circles) {
    // z -> r / (z - c).
    const std::complex<double> center = circle.center - outer.center;
    const double power = std::norm(center) - circle.radius * circle.radius;
    circle = {outer.radius * std::conj(center) / power,
              outer.radius * circle.radius / std::abs(power)};
  }
  return circles;
}

/// The outer circle becomes the unit circle.
Circles scaled(Circles circles) {
  const Circle outer = circles[0];
  for (Circle& circle : circles) {
    circle = {(circle.center - outer.center) / outer.radius, circle.radius / outer.radius};
  }
  return circles;
}

/// A hole within the unit circle goes to 0, and to place 1.
Circles centred(Circles circles, std::size_t hole) {
  std::swap(circles[1], circles[hole]);
  const DiskTranslation map = centeringMap(circles[1]);
  for (std::size_t k = 2; k < circles.size(); ++k) circles[k] = map(circles[k]);
  circles[0] = {0, 1};
  circles[1] = {0, centeredRadius(circles[1])};
  return circles;
}

/// In [0, 2 pi), up to ties.
double angleOf(const Circle& circle) {
  constexpr double kTurn = 2 * std::numbers::pi;
  const double angle = std::arg(circle.center);
  return angle < -kTie ? angle + kTurn : angle;
}

void sortHoles(Circles& circles, std::size_t begin) {
  const auto larger = [](const Circle& a, const Circle& b) { return a.radius > b.radius; };
  const auto earlier = [](const Circle& a, const Circle& b) { return angleOf(a) < angleOf(b); };
  std::sort(circles.begin() + static_cast<std::ptrdiff_t>(begin), circles.end(), larger);
  for (auto first = circles.begin() + static_cast<std::ptrdiff_t>(begin); first != circles.end();) {
    const double least = (1 - kTie) * first->radius;
    const auto next = std::find_if(first, circles.end(),
                                   [least](const Circle& circle) { return circle.radius < least; });
    std::sort(first, next, earlier);
    first = next;
  }
}

/// A hole's centre goes to the positive real axis, and the hole to place 2.
Circles aligned(Circles circles, std::size_t hole) {
  std::swap(circles[2], circles[hole]);
  const double distance = std::abs(circles[2].center);
  const std::complex<double> turn = std::conj(circles[2].center) / distance;
  for (std::size_t k = 3; k < circles.size(); ++k) circles[k].center *= turn;
  circles[2].center = distance;
  sortHoles(circles, 3);
  return circles;
}

bool comesFirst(const Circles& a, const Circles& b) {
  for (std::size_t k = 1; k < a.size(); ++k) {
    const double differences[] = {a[k].radius - b[k].radius,
                                  a[k].center.real() - b[k].center.real(),
                                  a[k].center.imag() - b[k].center.imag()};
    for (const double difference : differences) {
      if (std::abs(difference) > kTelling) return difference > 0;
    }
  }
  return false;
}

}  // namespace

std::vector<Circle> canonicalCircles(const std::vector<Circle>& circles) {
  const std::size_t count = circles.size();
  Circles best;
  for (const std::size_t outer :
       largestOf(0, count, [&](std::size_t k) { return closeness(circles, k); })) {
    const Circles disk = scaled(outer == 0 ? circles : turnedInsideOut(circles, outer));
    for (const std::size_t central :
         largestOf(1, count, [&](std::size_t k) { return centeredRadius(disk[k]); })) {
      const Circles annulus = centred(disk, central);
      for (const std::size_t second :
           largestOf(2, count, [&](std::size_t k) { return annulus[k].radius; })) {
        Circles found = aligned(annulus, second);
        if (best.empty() || comesFirst(found, best)) best = std::move(found);
      }
    }
  }
  return best;
}

}  // namespace moduli
