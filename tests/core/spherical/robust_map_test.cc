#include "core/spherical/robust_map.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "core/forms/cotan.h"
#include "core/spherical/map_quality.h"
#include "core/spherical/mobius_map.h"
#include "tests/core/spherical/surfaces.h"

namespace moduli {
namespace {

struct Hull {
  TriangleMesh mesh;
  std::vector<double> lengths;
};

/// The convex hull of points on the sphere, the first four not in one plane; one after the other,
/// faces that see the next one make room for those to it.
TriangleSoup convexHull(std::vector<Eigen::Vector3d> points) {
  const auto side = [&](const Triangle& f, const Eigen::Vector3d& p) {
    return (p - points[f[0]]).dot((points[f[1]] - points[f[0]]).cross(points[f[2]] - points[f[0]]));
  };
  std::vector<Triangle> faces = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
  if (side(faces[0], points[3]) > 0) {
    for (Triangle& face : faces) std::swap(face[1], face[2]);
  }
  for (Index v = 4; v < static_cast<Index>(points.size()); ++v) {
    std::map<std::pair<Index, Index>, bool> rim;
    std::vector<Triangle> kept;
    for (const Triangle& face : faces) {
      if (side(face, points[v]) <= 0) {
        kept.push_back(face);
        continue;
      }
      for (int c = 0; c < 3; ++c) rim[{face[c], face[(c + 1) % 3]}] = true;
    }
    for (const auto& [edge, seen] : rim) {
      if (!rim.contains({edge.second, edge.first})) kept.push_back({edge.first, edge.second, v});
    }
    faces = std::move(kept);
  }
  return {std::move(points), std::move(faces)};
}

Hull randomHull(Index count, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<Eigen::Vector3d> points;
  for (Index n = 0; n < count; ++n) {
    points.push_back(Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized());
  }
  TriangleMesh mesh = surfaces::mesh(convexHull(std::move(points)));
  std::vector<double> lengths = mesh.edgeLengths();
  return {std::move(mesh), std::move(lengths)};
}

/// Lengths times e^{(u_i + u_j) / 2} for random u within +-size.
std::vector<double> scaled(const TriangleMesh& mesh, std::vector<double> lengths, double size,
                           unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-size, size);
  std::vector<double> u(mesh.vertexCount());
  for (double& value : u) value = uniform(random);
  const Connectivity& surface = mesh.connectivity();
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    const Index h = surface.halfedge(e);
    lengths[e] *= std::exp((u[surface.tail(h)] + u[surface.head(h)]) / 2);
  }
  return lengths;
}

Result<IdealPolyhedron> map(const TriangleMesh& mesh, const std::vector<double>& lengths,
                            bool initial_delaunay = true) {
  Context context;
  PuncturedSphereOptions options;
  options.initial_delaunay = initial_delaunay;
  return mapToIdealPolyhedron(context, mesh.connectivity(), lengths, mesh.positions(), options);
}

/// How far two placements of the same vertices on the sphere are from a Möbius map of each other.
double distanceUpToMobius(const Points3& a, const Points3& b, const std::vector<double>& weights) {
  Context context;
  const auto first = centerByMobius(context, a, weights);
  const auto second = centerByMobius(context, b, weights);
  EXPECT_OK(first);
  EXPECT_OK(second);
  return surfaces::distanceUpToRotation(first->points, second->points, weights);
}

TEST(RobustMap, LeavesAConvexInscribedPolyhedronAsItIs) {
  // Its chords are those of the ideal polyhedron itself. The tolerance is that of CHECKS B1.
  for (const Index count : {20, 200, 1000}) {
    const Hull hull = randomHull(count, 11);
    const auto found = map(hull.mesh, hull.lengths, false);
    ASSERT_OK(found);
    const std::vector<double> weights = vertexAreas(hull.mesh.connectivity(), hull.lengths);
    EXPECT_LT(distanceUpToMobius(found->points, hull.mesh.positions(), weights), 1e-9);
  }
}

TEST(RobustMap, UndoesVertexScalingOfAnInscribedPolyhedron) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    const Hull hull = randomHull(200, seed);
    const std::vector<double> lengths = scaled(hull.mesh, hull.lengths, 0.05, seed);
    const auto found = map(hull.mesh, lengths, false);
    ASSERT_OK(found);
    const std::vector<double> weights = vertexAreas(hull.mesh.connectivity(), lengths);
    EXPECT_LT(distanceUpToMobius(found->points, hull.mesh.positions(), weights), 1e-9);
  }
}

TEST(RobustMap, IsOneMapForASurfaceAndItsInversion) {
  // Inversion of space multiplies every length by factors of its two ends. The centre lies outside.
  const TriangleMesh mesh = surfaces::mesh(surfaces::sample(
      "ellipsoid", {{"a", 1}, {"b", 1.3}, {"c", 2}, {"resolution", 8}, {"seed", 1}}));
  TriangleSoup soup{mesh.positions(), mesh.connectivity().faces()};
  const Eigen::Vector3d center(4, -1, 1.5);
  for (Eigen::Vector3d& p : soup.vertices) {
    p = center + (p - center) / (p - center).squaredNorm();
  }
  const TriangleMesh inverted = surfaces::mesh(std::move(soup));
  const auto first = map(mesh, mesh.edgeLengths(), false);
  const auto second = map(inverted, inverted.edgeLengths(), false);
  ASSERT_OK(first);
  ASSERT_OK(second);
  const std::vector<double> weights(mesh.vertexCount(), 1.0);
  EXPECT_LT(distanceUpToMobius(first->points, second->points, weights), 1e-9);
}

TEST(RobustMap, DoesNotDependOnTheVertexAtInfinity) {
  const TriangleMesh mesh = surfaces::mesh(
      surfaces::sample("spheroid", {{"a", 1}, {"c", 2}, {"resolution", 6}, {"seed", 2}}));
  Context context;
  const std::vector<double> lengths = mesh.edgeLengths();
  const std::vector<double> weights = vertexAreas(mesh.connectivity(), lengths);
  const auto reference = map(mesh, lengths);
  ASSERT_OK(reference);
  for (const Index infinity : {0, 17, 100}) {
    PuncturedSphereOptions options;
    options.infinity = infinity;
    const auto other =
        mapToIdealPolyhedron(context, mesh.connectivity(), lengths, mesh.positions(), options);
    ASSERT_OK(other);
    EXPECT_LT(surfaces::distanceUpToRotation(other->points, reference->points, weights), 1e-9);
  }
}

TEST(RobustMap, TurnsAlongWithTheSurfaceAndForgetsNumbersAndScale) {
  const TriangleSoup soup =
      surfaces::sample("spheroid", {{"a", 1}, {"c", 2}, {"resolution", 6}, {"seed", 3}});
  const TriangleMesh mesh = surfaces::mesh(soup);
  const auto reference = map(mesh, mesh.edgeLengths());
  ASSERT_OK(reference);
  const std::vector<double> weights = vertexAreas(mesh.connectivity(), mesh.edgeLengths());
  const TriangleMesh moved = surfaces::mesh(surfaces::moved(soup, 123));
  const auto turned = map(moved, moved.edgeLengths());
  ASSERT_OK(turned);
  EXPECT_LT(surfaces::distanceUpToRotation(turned->points, reference->points, weights), 1e-9);
  // Renumbered: compared through the positions, which are distinct.
  const TriangleMesh other = surfaces::mesh(surfaces::renumbered(soup, 4));
  const auto renumbered = map(other, other.edgeLengths());
  ASSERT_OK(renumbered);
  Points3 matched(mesh.vertexCount());
  for (Index v = 0; v < mesh.vertexCount(); ++v) {
    const auto it =
        std::find(other.positions().begin(), other.positions().end(), mesh.positions()[v]);
    matched[v] = renumbered->points[it - other.positions().begin()];
  }
  EXPECT_LT(surfaces::distanceUpToRotation(matched, reference->points, weights), 1e-9);
}

/// Error in the mean square against the closed form, up to a rotation.
double spheroidError(double c, int resolution) {
  const TriangleMesh mesh = surfaces::mesh(
      surfaces::sample("spheroid", {{"a", 1}, {"c", c}, {"resolution", resolution}}));
  const std::vector<double> lengths = mesh.edgeLengths();
  const auto found = map(mesh, lengths);
  EXPECT_OK(found);
  Points3 exact;
  for (const Eigen::Vector3d& p : mesh.positions()) {
    exact.push_back(surfaces::spheroidImage(p, c).image);
  }
  return surfaces::distanceUpToRotation(found->points, exact,
                                        vertexAreas(mesh.connectivity(), lengths));
}

TEST(RobustMap, OfSpheroidsConvergesAtSecondOrder) {
  for (const double c : {0.5, 2.0}) {
    const double coarse = spheroidError(c, 8), fine = spheroidError(c, 16);
    // CHECKS B3, B4: order 2; the next term shifts it by less than 0.2 at these sizes.
    EXPECT_NEAR(std::log2(coarse / fine), 2, 0.25) << c << ": " << coarse << ", " << fine;
  }
}

TEST(RobustMap, MeanDilatationFallsAtFirstOrder) {
  const auto excess = [](int resolution) {
    const TriangleMesh mesh = surfaces::mesh(
        surfaces::sample("spheroid", {{"a", 1}, {"c", 2}, {"resolution", resolution}}));
    const auto found = map(mesh, mesh.edgeLengths());
    EXPECT_OK(found);
    return measureSphereMap(mesh.connectivity(), mesh.edgeLengths(), found->points)
               .mean_dilatation -
           1;
  };
  // The map of a face errs by its size times the curvature's change: first order.
  EXPECT_NEAR(std::log2(excess(8) / excess(16)), 1, 0.2);
}

TEST(RobustMap, OfRealSurfacesIsOneToOne) {
  for (const std::string& folder : {std::string("closed_g0"), std::string("brain")}) {
    const std::vector<std::string> paths = sharedMeshes(folder);
    if (paths.empty()) GTEST_SKIP() << "no meshes in " << folder << "; set MODULI_SHARED";
    for (const std::string& path : paths) {
      SCOPED_TRACE(path);
      const TriangleSoup soup = surfaces::read(path);
      const auto read = TriangleMesh::fromSoup(soup);
      if (!read.ok()) continue;  // A flat cortex, with vertices that no face uses.
      const TriangleMesh& mesh = *read;
      if (mesh.connectivity().eulerCharacteristic() != 2) continue;
      // One of the two starting triangulations keeps every face from folding.
      Index folds = mesh.faceCount();
      for (const bool initial_delaunay : {true, false}) {
        const auto found = map(mesh, mesh.edgeLengths(), initial_delaunay);
        ASSERT_OK(found);
        EXPECT_LT(found->centering_residual, 1e-13);
        EXPECT_LT(found->layout_closure, 1e-5);
        const MapQuality quality =
            measureSphereMap(mesh.connectivity(), mesh.edgeLengths(), found->points);
        EXPECT_NEAR(quality.covering_degree, 1, 1e-9);
        folds = std::min(folds, quality.flipped_faces);
      }
      EXPECT_EQ(folds, 0);
    }
  }
}

}  // namespace
}  // namespace moduli
