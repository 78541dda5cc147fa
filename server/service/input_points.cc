#include "server/service/input_points.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <utility>

namespace moduli {
namespace {

using Eigen::Vector3d;

/// The weights of the nearest point to p of a triangle: within it, or on the nearest side.
std::array<double, 3> nearestInTriangle(const Vector3d& p, const std::array<Vector3d, 3>& corner) {
  const Vector3d u = corner[1] - corner[0], w = corner[2] - corner[0], d = p - corner[0];
  const double uu = u.dot(u), uw = u.dot(w), ww = w.dot(w);
  const double det = uu * ww - uw * uw;
  if (det > 0) {
    const double s = (ww * d.dot(u) - uw * d.dot(w)) / det;
    const double t = (uu * d.dot(w) - uw * d.dot(u)) / det;
    if (s >= 0 && t >= 0 && s + t <= 1) return {1 - s - t, s, t};
  }
  std::array<double, 3> best{};
  double least = std::numeric_limits<double>::infinity();
  for (int c = 0; c < 3; ++c) {
    const Vector3d &tail = corner[c], &head = corner[(c + 1) % 3];
    const double square = (head - tail).squaredNorm();
    const double share =
        square > 0 ? std::clamp((p - tail).dot(head - tail) / square, 0.0, 1.0) : 0.0;
    const double distance = (tail + share * (head - tail) - p).squaredNorm();
    if (distance >= least) continue;
    least = distance;
    best = {};
    best[c] = 1 - share;
    best[(c + 1) % 3] = share;
  }
  return best;
}

/// The other surface, in the numbers of its file.
class Target {
 public:
  explicit Target(const Subject& subject)
      : surface_(subject.surface()),
        positions_(subject.positions()),
        corners_(subject.input_corners) {}

  bool fillsHole(Index face) const { return corners_[3 * face] == kNone; }

  /// A point of a face that is the file's, in the order of the file's corners.
  std::pair<std::int32_t, std::array<double, 3>> inFile(const SurfacePoint& point) const {
    std::array<double, 3> weights{};
    double sum = 0;
    for (int c = 0; c < 3; ++c) {
      double& weight = weights[corners_[3 * point.face + c] % 3];
      weight = std::max(0.0, point.barycentric[c]);
      sum += weight;
    }
    for (double& weight : weights) weight /= sum;
    return {corners_[3 * point.face] / 3, weights};
  }

  /// The nearest point of the file's faces around the hole that the point fills.
  SurfacePoint besideHole(const SurfacePoint& point) {
    Vector3d place = Vector3d::Zero();
    for (int c = 0; c < 3; ++c) {
      place += point.barycentric[c] * positions_[surface_.face(point.face)[c]];
    }
    SurfacePoint nearest = point;
    double least = std::numeric_limits<double>::infinity();
    for (const Index face : facesAround(point.face)) {
      std::array<Vector3d, 3> corner;
      for (int c = 0; c < 3; ++c) corner[c] = positions_[surface_.face(face)[c]];
      const std::array<double, 3> weights = nearestInTriangle(place, corner);
      Vector3d there = Vector3d::Zero();
      for (int c = 0; c < 3; ++c) there += weights[c] * corner[c];
      if (const double distance = (there - place).squaredNorm(); distance < least) {
        least = distance;
        nearest = {face, weights};
      }
    }
    return nearest;
  }

 private:
  /// The file's faces that have a vertex in common with the patch that a filling face is part of.
  const std::vector<Index>& facesAround(Index filling) {
    const auto known = patch_.find(filling);
    if (known != patch_.end()) return rims_[known->second];
    std::set<Index> rim;
    std::vector<Index> open = {filling};
    patch_[filling] = rims_.size();
    while (!open.empty()) {
      const Index face = open.back();
      open.pop_back();
      for (int c = 0; c < 3; ++c) {
        const Index first = surface_.outgoing(surface_.face(face)[c]);
        Index h = first;
        do {
          const Index other = Connectivity::faceOf(h);
          if (!fillsHole(other)) {
            rim.insert(other);
          } else if (patch_.try_emplace(other, rims_.size()).second) {
            open.push_back(other);
          }
          h = surface_.rotate(h);
        } while (h != kNone && h != first);
      }
    }
    rims_.emplace_back(rim.begin(), rim.end());
    return rims_.back();
  }

  const Connectivity& surface_;
  const std::vector<Vector3d>& positions_;
  const std::vector<Index>& corners_;
  std::map<Index, std::size_t> patch_;    ///< Per filling face seen so far, its hole.
  std::vector<std::vector<Index>> rims_;  ///< Per hole.
};

/// Per vertex of the file the lowest one of the prepared surface that it has become; kNone.
std::vector<Index> firstPlaces(const Subject& subject) {
  std::vector<Index> place(subject.soup.vertices.size(), kNone);
  for (std::size_t h = 0; h < subject.input_corners.size(); ++h) {
    const Index corner = subject.input_corners[h];
    if (corner == kNone) continue;
    Index& first = place[subject.soup.faces[corner / 3][corner % 3]];
    const Index here = subject.surface().tail(static_cast<Index>(h));
    if (first == kNone || here < first) first = here;
  }
  return place;
}

}  // namespace

InputPoints inputPoints(const Subject& from, const Subject& to,
                        const std::vector<SurfacePoint>& images) {
  InputPoints result;
  Target target(to);
  for (const Index place : firstPlaces(from)) {
    if (place == kNone) {
      ++result.without_image;
      result.faces.push_back(kNone);
      result.weights.push_back({0, 0, 0});
      continue;
    }
    SurfacePoint point = images[place];
    if (target.fillsHole(point.face)) {
      ++result.beside_hole;
      point = target.besideHole(point);
    }
    const auto [face, weights] = target.inFile(point);
    result.faces.push_back(face);
    result.weights.push_back(weights);
  }
  return result;
}

}  // namespace moduli
