#include "core/matching/map_report.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace moduli {
namespace {

using Positions = std::vector<Eigen::Vector3d>;

double faceArea(const Positions& positions, const Triangle& face) {
  const Eigen::Vector3d& p = positions[face[0]];
  return (positions[face[1]] - p).cross(positions[face[2]] - p).norm() / 2;
}

/// The ratio of the singular values of the map between two triangles in space. With D = |J|^2 and
/// d = det J it is (s + sqrt(s^2 - 1)) for s = D / 2 d.
double dilatation(const Positions& positions, const Positions& images, const Triangle& face) {
  const double area = faceArea(positions, face), image_area = faceArea(images, face);
  if (!(image_area > 0)) return std::numeric_limits<double>::infinity();
  double sum = 0;  // Of 2 area cot(angle) times the image's squared side opposite to it.
  for (int c = 0; c < 3; ++c) {
    const Index here = face[c], next = face[(c + 1) % 3], last = face[(c + 2) % 3];
    sum += (positions[next] - positions[here]).dot(positions[last] - positions[here]) *
           (images[next] - images[last]).squaredNorm();
  }
  const double s = std::max(1.0, sum / (8 * area * image_area));
  return s + std::sqrt(s * s - 1);
}

}  // namespace

Eigen::Vector3d spacePoint(const Connectivity& surface, const Positions& positions,
                           const SurfacePoint& point) {
  const auto& [a, b, c] = surface.face(point.face);
  return point.barycentric[0] * positions[a] + point.barycentric[1] * positions[b] +
         point.barycentric[2] * positions[c];
}

MapReport measureSpaceMap(const Connectivity& surface, const Positions& positions,
                          const Positions& images) {
  MapReport report;
  std::vector<std::pair<double, double>> faces;  // Dilatation and area.
  double total = 0, sum = 0, log_sum = 0, log_squares = 0;
  for (const Triangle& face : surface.faces()) {
    const double area = faceArea(positions, face);
    if (!(area > 0)) continue;
    const double k = dilatation(positions, images, face);
    const double log_ratio = std::log(faceArea(images, face) / area);
    faces.emplace_back(k, area);
    total += area;
    sum += area * k;
    log_sum += area * log_ratio;
    log_squares += area * log_ratio * log_ratio;
  }
  if (faces.empty()) return report;
  std::sort(faces.begin(), faces.end());
  report.mean_dilatation = sum / total;
  report.max_dilatation = faces.back().first;
  double below = 0;
  for (const auto& [k, area] : faces) {
    report.dilatation_95 = k;
    below += area;
    if (below >= 0.95 * total) break;
  }
  const double mean = log_sum / total;
  report.area_distortion = std::isfinite(mean)
                               ? std::sqrt(std::max(0.0, log_squares / total - mean * mean))
                               : std::numeric_limits<double>::infinity();
  return report;
}

double isometricDistortion(const Connectivity& surface, const Positions& positions,
                           const Positions& images) {
  constexpr double kMostLog = 6.9;  // Of a thousand.
  double total = 0, image_total = 0;
  for (const Triangle& face : surface.faces()) {
    total += faceArea(positions, face);
    image_total += faceArea(images, face);
  }
  if (!(total > 0) || !(image_total > 0)) return 0;
  double sum = 0, squares = 0;
  for (const Triangle& face : surface.faces()) {
    const double area = faceArea(positions, face);
    if (!(area > 0)) continue;
    const double log_k = std::log(dilatation(positions, images, face));
    const double log_area = std::log(faceArea(images, face) / area * (total / image_total));
    // Of the singular values: half of the sum and of the difference.
    for (const double log_value : {(log_area + log_k) / 2, (log_area - log_k) / 2}) {
      const double cut =
          std::isnan(log_value) ? -kMostLog : std::clamp(log_value, -kMostLog, kMostLog);
      sum += area * cut;
      squares += area * cut * cut;
    }
  }
  const double mean = sum / (2 * total);
  return std::sqrt(std::max(0.0, squares / (2 * total) - mean * mean));
}

double cycleError(const Connectivity& a, const Positions& positions,
                  const std::vector<SurfacePoint>& to, const Connectivity& b,
                  const std::vector<SurfacePoint>& back) {
  Positions returned;
  returned.reserve(back.size());
  for (const SurfacePoint& point : back) returned.push_back(spacePoint(a, positions, point));
  double sum = 0, total = 0;
  for (const Triangle& face : a.faces()) {
    const double third = faceArea(positions, face) / 3;
    for (const Index v : face) {
      sum += third * (spacePoint(b, returned, to[v]) - positions[v]).norm();
      total += third;
    }
  }
  return total > 0 ? sum / total : 0;
}

}  // namespace moduli
