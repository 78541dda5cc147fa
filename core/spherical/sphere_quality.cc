#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/forms/cotan.h"
#include "core/spherical/face_frame.h"
#include "core/spherical/sphere_map.h"

namespace moduli {
namespace {

FaceFrame chordFrame(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const Eigen::Vector3d u = b - a;
  const Eigen::Vector3d w = c - a;
  const double base = u.norm();
  return {base, u.dot(w) / base, u.cross(w).norm() / base};
}

}  // namespace

double signedSolidAngle(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                        const Eigen::Vector3d& c) {
  const double volume = a.dot((b - a).cross(c - a));
  return 2 * std::atan2(volume, 1 + a.dot(b) + b.dot(c) + c.dot(a));
}

SphereQuality measureSphereMap(const Connectivity& surface, const std::vector<double>& lengths,
                               const Points3& points) {
  const std::vector<double> areas = faceAreas(surface, lengths);
  SphereQuality quality;
  double total_area = 0, weighted = 0, solid_angle = 0;
  for (Index f = 0; f < surface.faceCount(); ++f) {
    const auto& [a, b, c] = surface.face(f);
    const double angle = signedSolidAngle(points[a], points[b], points[c]);
    solid_angle += angle;
    if (!(angle > 0)) ++quality.flipped_faces;
    const double k =
        dilatation(frameFromSides(lengths[surface.edge(3 * f)], lengths[surface.edge(3 * f + 1)],
                                  lengths[surface.edge(3 * f + 2)], areas[f]),
                   chordFrame(points[a], points[b], points[c]));
    quality.max_dilatation = std::max(quality.max_dilatation, k);
    weighted += areas[f] * k;
    total_area += areas[f];
  }
  quality.mean_dilatation = weighted / total_area;
  quality.covering_degree = solid_angle / (4 * std::numbers::pi);
  return quality;
}

}  // namespace moduli
