#include "core/matching/ring_place.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/spherical/exact_sign.h"

namespace moduli {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Newton's method doubles the digits of a minimum; where it has not come near by then, the next
/// look at the vertex goes on.
constexpr int kSteps = 8;
/// Relative to the width of the ring: neighbours move by more before the vertex is looked at again.
constexpr double kTolerance = 1e-3;
constexpr int kHalvings = 30;
/// Sides and heights of source faces count as this part of the longest side, if they are shorter:
/// images as thin as the thinnest faces would have no room on the sphere.
constexpr double kThinnest = 1e-3;
/// Least cosine of the way from the centre of a gnomonic chart: farther out it stretches too much.
constexpr double kChartEdge = 0.1;

double cross(const Vector2d& a, const Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// The gnomonic chart around a point: great circles are straight.
class Chart {
 public:
  explicit Chart(const Vector3d& centre) : centre_(centre) {
    const Vector3d helper = std::abs(centre.x()) < 0.6 ? Vector3d::UnitX() : Vector3d::UnitY();
    first_ = centre.cross(helper).normalized();
    second_ = centre.cross(first_);
  }

  /// Nothing beyond the chart's edge. By the difference, which keeps the digits of near points.
  std::optional<Vector2d> operator()(const Vector3d& p) const {
    const double height = p.dot(centre_);
    if (!(height > kChartEdge)) return {};
    const Vector3d way = p - centre_;
    return Vector2d(way.dot(first_), way.dot(second_)) / height;
  }

  /// In the axes of the chart; the last is its centre.
  Vector3d turned(const Vector3d& p) const {
    return {p.dot(first_), p.dot(second_), p.dot(centre_)};
  }

  Vector3d lift(const Vector2d& p) const {
    return (centre_ + p.x() * first_ + p.y() * second_).normalized();
  }

 private:
  Vector3d centre_, first_, second_;
};

std::optional<std::vector<Vector2d>> chartRing(const PlacedRing& ring, const Chart& chart) {
  std::vector<Vector2d> result;
  for (const Index v : ring.ring) {
    const std::optional<Vector2d> p = chart(ring.points[v]);
    if (!p) return {};
    result.push_back(*p);
  }
  return result;
}

double widthOf(const std::vector<Vector2d>& corners) {
  double width = 0;
  for (const Vector2d& p : corners) width = std::max(width, p.norm());
  return width;
}

/// A line of the chart: what is to the left of it has positive values.
class Side {
 public:
  /// The great circle from a to b. By their places in the chart, which keep the digits of near
  /// points, where both have one.
  Side(const Chart& chart, const Vector3d& a, const Vector3d& b) {
    const auto from = chart(a), to = chart(b);
    if (from && to) {
      from_ = *from;
      way_ = *to - *from;
    } else {
      const Vector3d normal = chart.turned(a.cross(b - a).stableNormalized());
      const double slope = normal.head<2>().squaredNorm();
      if (!(slope > 0)) return;
      from_ = -normal.z() / slope * normal.head<2>();
      way_ = {normal.y(), -normal.x()};
    }
  }

  double operator()(const Vector2d& p) const { return cross(way_, p - from_); }

 private:
  Vector2d from_ = Vector2d::Zero(), way_ = Vector2d::Zero();
};

/// What is left of a convex polygon to the left of a line.
std::vector<Vector2d> clipped(const std::vector<Vector2d>& polygon, const Side& side) {
  std::vector<Vector2d> result;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const double at_p = side(p), at_q = side(q);
    if (at_p >= 0) result.push_back(p);
    if ((at_p > 0 && at_q < 0) || (at_p < 0 && at_q > 0)) {
      result.push_back(p + at_p / (at_p - at_q) * (q - p));
    }
  }
  return result;
}

std::optional<Vector2d> centroid(const std::vector<Vector2d>& polygon) {
  double area = 0;
  Vector2d sum = Vector2d::Zero();
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    const Vector2d p = polygon[i - 1] - polygon[0], q = polygon[i] - polygon[0];
    const double part = cross(p, q);
    area += part;
    sum += part / 3 * (p + q);
  }
  if (!(area > 0)) return {};
  return Vector2d(polygon[0] + sum / area);
}

/// A face of the vertex: the cotangents of its angles on the surface, its area there, and the
/// images of its other corners.
struct SourceFace {
  double cot_v = 0, cot_a = 0, cot_b = 0, area = 0;
  Vector2d a = Vector2d::Zero(), b = Vector2d::Zero();
};

SourceFace equilateral(double area) {
  const double cot = std::numbers::inv_sqrt3;
  return {cot, cot, cot, area, Vector2d::Zero(), Vector2d::Zero()};
}

SourceFace sourceFace(const Vector3d& v, const Vector3d& a, const Vector3d& b) {
  const double longest = std::max({(v - a).norm(), (v - b).norm(), (a - b).norm()});
  if (!(longest > 0)) return equilateral(0);
  SourceFace face;
  const Vector3d base = b - a, side = v - a;
  const double width = base.norm(), length = std::max(width, kThinnest * longest);
  const double along = width > 0 ? side.dot(base) / width : length / 2;
  const double across = width > 0 ? side.cross(base).norm() / width : longest;
  const double height = std::max(across, kThinnest * longest);
  face.cot_a = along / height;
  face.cot_b = (length - along) / height;
  face.cot_v = (1 - face.cot_a * face.cot_b) / (face.cot_a + face.cot_b);
  face.area = length * height / 2;
  return face;
}

/// The faces around the vertex. Areas are of a surface scaled to that of the sphere.
std::vector<SourceFace> facesOf(const PlacedRing& ring, const std::vector<Vector2d>& corners) {
  std::vector<SourceFace> faces;
  const double scale = 4 * std::numbers::pi / ring.area;
  const auto& p = ring.positions;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const std::size_t j = (i + 1) % corners.size();
    faces.push_back(ring.alike ? equilateral(1)
                               : sourceFace(p[ring.vertex], p[ring.ring[i]], p[ring.ring[j]]));
    faces.back().area *= scale;
    faces.back().a = corners[i];
    faces.back().b = corners[j];
  }
  return faces;
}

struct Energy {
  double value = 0;
  Vector2d gradient = Vector2d::Zero();
  Eigen::Matrix2d hessian = Eigen::Matrix2d::Zero();
};

/// The distortion of the faces with the vertex at p; infinite outside of the kernel.
Energy energyAt(const std::vector<SourceFace>& faces, double least_scale, const Vector2d& p) {
  Energy sum;
  for (const SourceFace& face : faces) {
    const double d = cross(face.a - p, face.b - p) / 2;
    if (!(d > 0)) {
      sum.value = std::numeric_limits<double>::infinity();
      return sum;
    }
    const Vector2d to_a = p - face.a, to_b = p - face.b;
    const double n = (face.cot_v * (face.a - face.b).squaredNorm() +
                      face.cot_a * to_b.squaredNorm() + face.cot_b * to_a.squaredNorm()) /
                         4 +
                     least_scale * least_scale * face.area;
    const Vector2d dn = (face.cot_a * to_b + face.cot_b * to_a) / 2;
    const double ddn = (face.cot_a + face.cot_b) / 2;
    const Vector2d dd = Vector2d(face.a.y() - face.b.y(), face.b.x() - face.a.x()) / 2;
    sum.value += face.area * n / d;
    sum.gradient += face.area * (dn / d - n / (d * d) * dd);
    sum.hessian += face.area * (ddn / d * Eigen::Matrix2d::Identity() -
                                (dn * dd.transpose() + dd * dn.transpose()) / (d * d) +
                                2 * n / (d * d * d) * dd * dd.transpose());
  }
  return sum;
}

}  // namespace

bool isInKernel(const PlacedRing& ring, const Vector3d& p) {
  const std::size_t degree = ring.ring.size();
  for (std::size_t i = 0; i < degree; ++i) {
    const Vector3d &a = ring.points[ring.ring[i]], &b = ring.points[ring.ring[(i + 1) % degree]];
    if (spherical::orientationSign(p, a, b) <= 0) return false;
  }
  return true;
}

std::optional<Vector3d> kernelCentre(const PlacedRing& ring, const Vector3d& near) {
  const Chart chart(near);
  const auto corners = chartRing(ring, chart);
  const double width = corners ? 2 * widthOf(*corners) : 1 / kChartEdge;
  std::vector<Vector2d> kernel = {
      {-width, -width}, {width, -width}, {width, width}, {-width, width}};
  for (std::size_t i = 0; i < ring.ring.size(); ++i) {
    const Index a = ring.ring[i], b = ring.ring[(i + 1) % ring.ring.size()];
    kernel = clipped(kernel, Side(chart, ring.points[a], ring.points[b]));
  }
  const std::optional<Vector2d> middle = centroid(kernel);
  if (!middle) return {};
  const Vector3d p = chart.lift(*middle);
  if (!isInKernel(ring, p)) return {};
  return p;
}

Vector3d leastDistorted(const PlacedRing& ring, const Vector3d& start) {
  const Chart chart(start);
  const auto corners = chartRing(ring, chart);
  if (!corners) return start;
  const std::vector<SourceFace> faces = facesOf(ring, *corners);
  Vector2d at = Vector2d::Zero();
  Energy here = energyAt(faces, ring.least_scale, at);
  if (!std::isfinite(here.value)) return start;
  const double width = widthOf(*corners);
  for (int step = 0; step < kSteps; ++step) {
    Vector2d way = -here.hessian.ldlt().solve(here.gradient);
    if (!way.allFinite() || !(way.dot(here.gradient) < 0)) break;
    Energy there;
    int halvings = 0;
    for (; halvings < kHalvings; ++halvings, way /= 2) {
      there = energyAt(faces, ring.least_scale, at + way);
      if (there.value < here.value) break;
    }
    if (halvings == kHalvings) break;
    at += way;
    here = there;
    if (way.norm() < kTolerance * width) break;
  }
  const Vector3d best = chart.lift(at);
  return isInKernel(ring, best) ? best : start;
}

}  // namespace moduli
