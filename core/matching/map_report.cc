#include "core/matching/map_report.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
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

constexpr double kMostLog = 6.9;  // Of a thousand.
// Less does not tell maps apart: a thousandth of a length; a curvature that turns the normal by a
// hundredth of a radian over the root of the area.
constexpr double kLeastStretching = 1e-3, kLeastBending = 1e-2;

/// Logarithms of both singular values, in the scale that leaves the whole area as it is; cut off.
struct StretchedFace {
  double area = 0;
  std::array<double, 2> logs = {0, 0};
};

/// Of faces that have an area; none where either surface has none.
std::vector<StretchedFace> stretchedFaces(const Connectivity& surface, const Positions& positions,
                                          const Positions& images) {
  double total = 0, image_total = 0;
  for (const Triangle& face : surface.faces()) {
    total += faceArea(positions, face);
    image_total += faceArea(images, face);
  }
  std::vector<StretchedFace> faces;
  if (!(total > 0) || !(image_total > 0)) return faces;
  const auto cut = [](double value) {
    return std::isnan(value) ? -kMostLog : std::clamp(value, -kMostLog, kMostLog);
  };
  for (const Triangle& face : surface.faces()) {
    const double area = faceArea(positions, face);
    if (!(area > 0)) continue;
    const double log_k = std::log(dilatation(positions, images, face));
    const double log_area = std::log(faceArea(images, face) / area * (total / image_total));
    // Half of the sum and of the difference.
    faces.push_back({area, {cut((log_area + log_k) / 2), cut((log_area - log_k) / 2)}});
  }
  return faces;
}

/// A geometric mean of weighted values, none of which counts less than the least.
class LogMean {
 public:
  explicit LogMean(double least) : least_(least) {}
  void add(double weight, double value) {
    weight_ += weight;
    sum_ += weight * std::log(std::max(value, least_));
  }
  double value() const { return weight_ > 0 ? std::exp(sum_ / weight_) : least_; }

 private:
  double least_, weight_ = 0, sum_ = 0;
};

double meanStretching(std::vector<StretchedFace> faces) {
  const auto middle = [](const StretchedFace& face) { return (face.logs[0] + face.logs[1]) / 2; };
  std::sort(faces.begin(), faces.end(),
            [&](const StretchedFace& x, const StretchedFace& y) { return middle(x) < middle(y); });
  double total = 0, below = 0, scale = 0;
  for (const StretchedFace& face : faces) total += face.area;
  for (const StretchedFace& face : faces) {
    scale = middle(face);
    below += face.area;
    if (below >= total / 2) break;
  }
  LogMean mean(kLeastStretching);
  for (const StretchedFace& face : faces) {
    mean.add(face.area, std::hypot(face.logs[0] - scale, face.logs[1] - scale) / std::sqrt(2.0));
  }
  return mean.value();
}

double areaOf(const Connectivity& surface, const Positions& positions) {
  double area = 0;
  for (const Triangle& face : surface.faces()) area += faceArea(positions, face);
  return area;
}

/// How a face is bent: in the frame of its first side, in units of the root of the whole area.
struct BentFace {
  Eigen::Matrix2d sides;      ///< Columns: from the first corner to the others.
  Eigen::Matrix2d curvature;  ///< The second fundamental form.
};

BentFace bentFace(const Positions& positions, const Positions& normals, const Triangle& face,
                  double unit) {
  Eigen::Matrix<double, 3, 2> sides, turns, frame;
  for (int c = 0; c < 2; ++c) {
    sides.col(c) = (positions[face[c + 1]] - positions[face[0]]) / unit;
    turns.col(c) = normals[face[c + 1]] - normals[face[0]];
  }
  const Eigen::Vector3d along = sides.col(0).stableNormalized(), second = sides.col(1);
  frame << along, along.cross(second).stableNormalized().cross(along);
  BentFace bent;
  bent.sides = frame.transpose() * sides;
  const Eigen::Matrix2d turning = frame.transpose() * turns * bent.sides.inverse();
  bent.curvature = (turning + turning.transpose()) / 2;
  return bent;
}

/// The root mean square of the eigenvalues of the difference, once a turn has brought the frames
/// together as the map between the faces does (the one of its polar decomposition).
double bendingOf(const BentFace& from, const BentFace& to) {
  const Eigen::Matrix2d map = to.sides * from.sides.inverse();
  const Eigen::Rotation2Dd turn(std::atan2(map(1, 0) - map(0, 1), map(0, 0) + map(1, 1)));
  const Eigen::Matrix2d turned =
      turn.inverse().toRotationMatrix() * to.curvature * turn.toRotationMatrix();
  return (turned - from.curvature).norm() / std::sqrt(2.0);
}

double meanBending(const Connectivity& surface, const Positions& positions,
                   const Positions& normals, const Positions& images,
                   const Positions& image_normals) {
  const double unit = std::sqrt(areaOf(surface, positions)),
               image_unit = std::sqrt(areaOf(surface, images));
  LogMean mean(kLeastBending);
  for (const Triangle& face : surface.faces()) {
    const double area = faceArea(positions, face);
    if (!(area > 0) || !(faceArea(images, face) > 0)) continue;
    const double bending = bendingOf(bentFace(positions, normals, face, unit),
                                     bentFace(images, image_normals, face, image_unit));
    if (std::isfinite(bending)) mean.add(area, bending);
  }
  return mean.value();
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
  double total = 0, sum = 0, squares = 0;
  for (const StretchedFace& face : stretchedFaces(surface, positions, images)) {
    total += face.area;
    sum += face.area * (face.logs[0] + face.logs[1]);
    squares += face.area * (face.logs[0] * face.logs[0] + face.logs[1] * face.logs[1]);
  }
  if (!(total > 0)) return 0;
  const double mean = sum / (2 * total);
  return std::sqrt(std::max(0.0, squares / (2 * total) - mean * mean));
}

ShapeChange shapeChange(const Connectivity& surface, const Positions& positions,
                        const Positions& normals, const Positions& images,
                        const Positions& image_normals) {
  return {meanStretching(stretchedFaces(surface, positions, images)),
          meanBending(surface, positions, normals, images, image_normals)};
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
