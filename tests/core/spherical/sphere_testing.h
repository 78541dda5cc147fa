#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "core/spherical/landmark_map.h"
#include "core/spherical/map_quality.h"
#include "core/spherical/sphere_map.h"
#include "core/spherical/surface_point.h"
#include "tests/core/spherical/surfaces.h"

/// Spheres and landmarks for the tests of registration.
namespace moduli::surfaces {

/// Points, landmarks and fields at random, the same for the same seed.
class RandomSphere {
 public:
  explicit RandomSphere(unsigned seed) : random_(seed) {}

  Eigen::Vector3d direction() {
    return Eigen::Vector3d(normal_(random_), normal_(random_), normal_(random_)).normalized();
  }

  double uniform() { return uniform_(random_); }

  /// The point at an angle from p, in any direction.
  Eigen::Vector3d awayFrom(const Eigen::Vector3d& p, double angle) {
    const Eigen::Vector3d d = direction();
    return std::cos(angle) * p + std::sin(angle) * (d - d.dot(p) * p).normalized();
  }

 private:
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  std::uniform_real_distribution<double> uniform_;
};

/// A surface with a map to the sphere.
struct MappedSurface {
  TriangleMesh mesh;
  Points3 points;

  const Connectivity& surface() const { return mesh.connectivity(); }
};

/// An irregular round sphere, mapped by its own points.
inline MappedSurface roundSphere(double resolution, double seed) {
  TriangleMesh round = mesh(sample("sphere", {{"resolution", resolution}, {"seed", seed}}));
  Points3 points = round.positions();
  for (Eigen::Vector3d& p : points) p.normalize();
  return {std::move(round), std::move(points)};
}

inline MappedSurface mappedMesh(const std::string& path) {
  TriangleMesh surface = mesh(read(path));
  Context context;
  auto map = mapToSphereLinear(context, surface.connectivity(), surface.edgeLengths());
  EXPECT_OK(map);
  return {std::move(surface), std::move(map->points)};
}

inline Index nearestVertex(const Points3& points, const Eigen::Vector3d& p) {
  Index best = 0;
  for (Index v = 0; v < static_cast<Index>(points.size()); ++v) {
    if ((points[v] - p).norm() < (points[best] - p).norm()) best = v;
  }
  return best;
}

/// Landmarks 0.4 apart at least, before and after, each sent `angle` away in any direction; within
/// faces or at vertices.
inline std::vector<Landmark> randomLandmarks(const MappedSurface& map, int count, double angle,
                                             bool within, unsigned seed) {
  RandomSphere random(seed);
  std::vector<Landmark> landmarks;
  Points3 starts;
  while (static_cast<int>(landmarks.size()) < count) {
    const Index v = nearestVertex(map.points, random.direction());
    SurfacePoint point = vertexPoint(map.surface(), v);
    const double s = std::sqrt(random.uniform()), t = random.uniform();
    if (within) point.barycentric = {1 - s, s * (1 - t), s * t};
    const Eigen::Vector3d start = spherePoint(map.surface(), map.points, point);
    const Landmark landmark{point, random.awayFrom(start, angle)};
    bool apart = true;
    for (std::size_t i = 0; i < landmarks.size(); ++i) {
      apart = apart && (starts[i] - start).norm() > 0.4 &&
              (landmarks[i].target - landmark.target).norm() > 0.4;
    }
    if (!apart) continue;
    landmarks.push_back(landmark);
    starts.push_back(start);
  }
  return landmarks;
}

}  // namespace moduli::surfaces
