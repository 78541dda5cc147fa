#include "core/spherical/map_quality.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "core/forms/cotan.h"
#include "core/spherical/exact_sign.h"
#include "core/spherical/face_frame.h"

namespace moduli {
namespace {

FaceFrame chordFrame(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const Eigen::Vector3d u = b - a;
  const Eigen::Vector3d w = c - a;
  const double base = u.norm();
  return {base, u.dot(w) / base, u.cross(w).norm() / base};
}

FaceFrame planeFrame(const std::complex<double>& a, const std::complex<double>& b,
                     const std::complex<double>& c) {
  const double base = std::abs(b - a);
  const std::complex<double> apex = std::conj(b - a) * (c - a) / base;
  return {base, apex.real(), std::abs(apex.imag())};
}

/// What the faces contribute, one after the other.
class Tally {
 public:
  explicit Tally(Index face_count) { dilatations_.reserve(face_count); }

  /// A face and its image, both laid out counter-clockwise.
  void add(const FaceFrame& face, const FaceFrame& image, int orientation) {
    if (orientation <= 0) ++flipped_faces_;
    const double k = dilatation(face, image);
    // What is no number (an image in one point) is no map either.
    dilatations_.emplace_back(k >= 1 ? k : std::numeric_limits<double>::infinity(), face.area());
    log_ratios_.push_back(std::log(image.area() / face.area()));
  }

  MapQuality finish() {
    MapQuality quality;
    quality.flipped_faces = flipped_faces_;
    double total = 0, weighted = 0, log_sum = 0;
    quality.dilatation_histogram.assign(kDilatationBounds.size() + 1, 0.0);
    for (std::size_t f = 0; f < dilatations_.size(); ++f) {
      const auto& [k, area] = dilatations_[f];
      total += area;
      weighted += area * k;
      log_sum += area * log_ratios_[f];
      const auto bin = std::upper_bound(kDilatationBounds.begin(), kDilatationBounds.end(), k);
      quality.dilatation_histogram[bin - kDilatationBounds.begin()] += area;
    }
    for (double& share : quality.dilatation_histogram) share /= total;
    quality.mean_dilatation = weighted / total;
    quality.area_distortion = deviation(log_sum / total, total);
    sortDilatations(quality, total);
    return quality;
  }

 private:
  double deviation(double mean, double total) const {
    if (!std::isfinite(mean)) return std::numeric_limits<double>::infinity();
    double sum = 0;
    for (std::size_t f = 0; f < dilatations_.size(); ++f) {
      const double off = log_ratios_[f] - mean;
      sum += dilatations_[f].second * off * off;
    }
    return std::sqrt(sum / total);
  }

  void sortDilatations(MapQuality& quality, double total) {
    std::sort(dilatations_.begin(), dilatations_.end());
    quality.max_dilatation = dilatations_.back().first;
    double beyond = 0;
    for (auto it = dilatations_.rbegin(); it != dilatations_.rend(); ++it) {
      quality.dilatation_95 = it->first;
      beyond += it->second;
      if (beyond > 0.05 * total) return;
    }
  }

  Index flipped_faces_ = 0;
  std::vector<std::pair<double, double>> dilatations_;  ///< K and area per face.
  std::vector<double> log_ratios_;
};

/// Measures a map whose images are laid out by `frame` and turned as `orientation` says. corner:
/// the point of corner c of face f.
template <typename Points, typename Corner, typename Frame>
MapQuality measure(const Connectivity& surface, const std::vector<double>& any_lengths,
                   const Points& points, const Corner& corner, const Frame& frame) {
  const std::vector<double> lengths = unitLengths(any_lengths);
  const std::vector<double> areas = faceAreas(surface, lengths);
  Tally tally(surface.faceCount());
  for (Index f = 0; f < surface.faceCount(); ++f) {
    const auto &a = points[corner(f, 0)], &b = points[corner(f, 1)], &c = points[corner(f, 2)];
    tally.add(frameFromSides(lengths[surface.edge(3 * f)], lengths[surface.edge(3 * f + 1)],
                             lengths[surface.edge(3 * f + 2)], areas[f]),
              frame(a, b, c), spherical::orientationSign(a, b, c));
  }
  return tally.finish();
}

}  // namespace

double signedSolidAngle(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                        const Eigen::Vector3d& c) {
  const double volume = a.dot((b - a).cross(c - a));
  return 2 * std::atan2(volume, 1 + a.dot(b) + b.dot(c) + c.dot(a));
}

MapQuality measureSphereMap(const Connectivity& surface, const std::vector<double>& lengths,
                            const Points3& points) {
  MapQuality quality = measure(
      surface, lengths, points, [&](Index f, int c) { return surface.face(f)[c]; }, chordFrame);
  double solid_angle = 0;
  for (const auto& [a, b, c] : surface.faces()) {
    solid_angle += signedSolidAngle(points[a], points[b], points[c]);
  }
  quality.covering_degree = solid_angle / (4 * std::numbers::pi);
  return quality;
}

MapQuality measurePlaneMap(const Connectivity& surface, const std::vector<double>& lengths,
                           const std::vector<std::complex<double>>& points) {
  return measure(
      surface, lengths, points, [&](Index f, int c) { return surface.face(f)[c]; }, planeFrame);
}

MapQuality measurePlaneMap(const Connectivity& surface, const std::vector<double>& lengths,
                           const std::vector<std::complex<double>>& points,
                           const std::vector<Index>& corner) {
  return measure(
      surface, lengths, points, [&](Index f, int c) { return corner[3 * f + c]; }, planeFrame);
}

}  // namespace moduli
