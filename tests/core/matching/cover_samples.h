#pragma once

#include <cmath>
#include <numeric>
#include <vector>

#include "core/matching/cover_map.h"
#include "core/mesh/samples.h"
#include "core/mesh/triangle_mesh.h"
#include "tests/core/testing.h"

/// Surfaces with handles for tests of maps between their covers.
namespace moduli {

inline TriangleMesh meshOf(const TriangleSoup& soup) {
  return *TriangleMesh::fromSoup(soup);
}

inline CoverSurface coverOf(const TriangleMesh& mesh) {
  Context context;
  auto made = straightCover(context, mesh.connectivity(), mesh.edgeLengths());
  EXPECT_OK(made);
  return *std::move(made);
}

/// A torus with two bumps: no symmetries.
inline TriangleSoup lumpyTorus(int resolution, int seed) {
  TriangleSoup soup = *makeSample("torus", {{"R", 2},
                                            {"r", 0.8},
                                            {"resolution", static_cast<double>(resolution)},
                                            {"seed", static_cast<double>(seed)}});
  const auto bump = [](const Eigen::Vector3d& p, const Eigen::Vector3d& where, double width) {
    return std::exp(-(p - where).squaredNorm() / (2 * width * width));
  };
  for (Eigen::Vector3d& p : soup.vertices) {
    Eigen::Vector3d core(p[0], p[1], 0);
    core *= 2 / core.norm();
    p = core +
        (1 + 0.6 * bump(p, {2.5, 0, 0.6}, 0.5) + 0.4 * bump(p, {-1, 2.3, -0.3}, 0.4)) * (p - core);
  }
  return soup;
}

/// Two holes, and a plate that is thicker towards one side.
inline TriangleSoup lumpyPlate(int resolution, int seed) {
  TriangleSoup soup = *makeSample("genus", {{"genus", 2},
                                            {"resolution", static_cast<double>(resolution)},
                                            {"seed", static_cast<double>(seed)}});
  for (Eigen::Vector3d& p : soup.vertices) p[2] *= 1 + 0.2 * p[0] + 0.15 * p[1];
  return soup;
}

inline Eigen::Vector3d spaceAt(const TriangleMesh& mesh, const SurfacePoint& point) {
  const Triangle& face = mesh.connectivity().face(point.face);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int c = 0; c < 3; ++c) sum += point.barycentric[c] * mesh.positions()[face[c]];
  return sum;
}

/// The largest and the mean distance of images from where they should be, over the root of the
/// area.
struct MapErrors {
  double mean = 0, largest = 0;
};
inline MapErrors errorsOf(const TriangleMesh& mesh, const std::vector<SurfacePoint>& images,
                          const std::vector<Eigen::Vector3d>& truth) {
  MapErrors errors;
  for (std::size_t v = 0; v < truth.size(); ++v) {
    const double e = (spaceAt(mesh, images[v]) - truth[v]).norm() / std::sqrt(mesh.area());
    errors.mean += e / static_cast<double>(truth.size());
    errors.largest = std::max(errors.largest, e);
  }
  return errors;
}

/// image: per vertex the vertex of the other mesh that it goes to.
inline std::vector<SurfacePoint> vertexTargets(const TriangleMesh& mesh,
                                               const std::vector<Index>& image) {
  std::vector<SurfacePoint> targets;
  for (const Index v : image) targets.push_back(vertexPoint(mesh.connectivity(), v));
  return targets;
}
inline std::vector<Eigen::Vector3d> vertexPlaces(const TriangleMesh& mesh,
                                                 const std::vector<Index>& image) {
  std::vector<Eigen::Vector3d> places;
  for (const Index v : image) places.push_back(mesh.positions()[v]);
  return places;
}
inline std::vector<Index> sameNumbers(const TriangleMesh& mesh) {
  std::vector<Index> image(mesh.vertexCount());
  std::iota(image.begin(), image.end(), 0);
  return image;
}

/// What must hold of every map: places are the images', products around faces are 1, none folds.
inline void expectConsistent(const Connectivity& surface, const CoverSurface& cover,
                             const CoverMap& map) {
  double gap = 0, closure = 0;
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    gap = std::max(gap, (cover.place(map.images[v]) - map.places[v]).norm());
  }
  for (Index h = 0; h < surface.halfedgeCount(); h += 3) {
    closure = std::max(closure, distanceToUnit(map.transitions[h] * map.transitions[h + 1] *
                                               map.transitions[h + 2]));
  }
  EXPECT_LT(gap, 1e-12);
  EXPECT_LT(closure, 1e-10);
  EXPECT_EQ(countFolded(surface, map), 0);
}

}  // namespace moduli
