#include "core/spherical/sphere_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/forms/cotan.h"
#include "core/spherical/face_frame.h"
#include "tests/core/mesh/shapes.h"
#include "tests/core/spherical/surfaces.h"

namespace moduli {
namespace {

Result<SphereMap> mapMesh(const TriangleMesh& mesh) {
  Context context;
  return mapToSphereLinear(context, mesh.connectivity(), mesh.edgeLengths());
}

TEST(Dilatation, IsTheRatioOfSingularValues) {
  const FaceFrame face{1, 0.3, 0.8};
  EXPECT_NEAR(dilatation(face, {2, 0.6, 1.6}), 1, 1e-15);  // a similarity
  EXPECT_NEAR(dilatation(face, {3, 0.9, 0.8}), 3, 1e-14);  // stretched along x
  EXPECT_NEAR(dilatation(face, {1, 0.3, 0.2}), 4, 1e-14);  // squeezed along y
  // Shear [[1, k], [0, 1]]: |mu| = k / sqrt(4 + k^2).
  const double mu = 0.5 / std::sqrt(4.25);
  EXPECT_NEAR(dilatation(face, {1, 0.3 + 0.5 * 0.8, 0.8}), (1 + mu) / (1 - mu), 1e-14);
  EXPECT_TRUE(std::isinf(dilatation(face, {1, 0.5, 0})));
}

TEST(SignedSolidAngle, OfAnOctantIsHalfPiAndOfTinyTrianglesTheirArea) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX();
  const Eigen::Vector3d y = Eigen::Vector3d::UnitY();
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  EXPECT_NEAR(signedSolidAngle(x, y, z), std::numbers::pi / 2, 1e-15);
  EXPECT_NEAR(signedSolidAngle(y, x, z), -std::numbers::pi / 2, 1e-15);
  const double h = std::ldexp(1, -20);
  const Eigen::Vector3d a = (x + h * y).normalized();
  const Eigen::Vector3d b = (x + h * z).normalized();
  // Curvature changes the area by h^2 relative, rounding of the points by 1e-16 / h.
  EXPECT_NEAR(signedSolidAngle(x, a, b) / (h * h / 2), 1, 1e-9);
}

TEST(MeasureSphereMap, CountsFoldsByHand) {
  const TriangleMesh mesh = surfaces::mesh(surfaces::sample("sphere", {{"resolution", 4}}));
  const std::vector<double> lengths = mesh.edgeLengths();
  Points3 points = mesh.positions();
  const MapQuality whole = measureSphereMap(mesh.connectivity(), lengths, points);
  EXPECT_EQ(whole.flipped_faces, 0);
  EXPECT_NEAR(whole.covering_degree, 1, 1e-14);
  EXPECT_NEAR(whole.max_dilatation, 1, 1e-12);

  // A vertex pushed across the opposite edge of one of its faces turns just that face over.
  const Triangle& face = mesh.connectivity().face(0);
  points[face[0]] =
      (0.6 * (points[face[1]] + points[face[2]]) - 0.2 * points[face[0]]).normalized();
  const MapQuality folded = measureSphereMap(mesh.connectivity(), lengths, points);
  EXPECT_EQ(folded.flipped_faces, 1);
  EXPECT_NEAR(folded.covering_degree, 1, 1e-14);
  EXPECT_GT(folded.max_dilatation, 1.5);

  for (Eigen::Vector3d& p : points) p = -p;
  const MapQuality inside_out = measureSphereMap(mesh.connectivity(), lengths, points);
  EXPECT_EQ(inside_out.flipped_faces, mesh.faceCount() - 1);
  EXPECT_NEAR(inside_out.covering_degree, -1, 1e-14);
}

TEST(MapToSphere, IsTheIdentityOnPlatonicSolids) {
  for (const TriangleSoup& soup :
       {shapes::tetrahedron(), shapes::octahedron(), shapes::icosahedron()}) {
    const TriangleMesh mesh = surfaces::mesh(soup);
    const auto map = mapMesh(mesh);
    ASSERT_OK(map);
    EXPECT_EQ(map->quality.flipped_faces, 0);
    EXPECT_NEAR(map->quality.covering_degree, 1, 1e-12);
  }
}

/// Error in the mean square against the closed form, up to rotation.
double spheroidError(double c, double resolution, double seed) {
  const TriangleMesh mesh = surfaces::mesh(surfaces::sample(
      "spheroid", {{"a", 1}, {"c", c}, {"resolution", resolution}, {"seed", seed}}));
  const auto map = mapMesh(mesh);
  EXPECT_OK(map);
  EXPECT_EQ(map->quality.flipped_faces, 0);
  EXPECT_NEAR(map->quality.covering_degree, 1, 1e-12);
  EXPECT_LT(map->centering_residual, 1e-14);
  Points3 exact;
  for (const Eigen::Vector3d& p : mesh.positions()) {
    exact.push_back(surfaces::spheroidImage(p, c).image);
  }
  return surfaces::distanceUpToRotation(map->points, exact,
                                        vertexAreas(mesh.connectivity(), mesh.edgeLengths()));
}

class Spheroids : public testing::TestWithParam<double> {};

TEST_P(Spheroids, PositionsConvergeAtSecondOrder) {
  const double coarse = spheroidError(GetParam(), 8, 0);
  const double middle = spheroidError(GetParam(), 16, 0);
  const double fine = spheroidError(GetParam(), 32, 0);
  EXPECT_LT(coarse, 5e-3);
  // The limit is 4; the pole lies elsewhere on each mesh, which scatters the constant.
  EXPECT_GT(coarse / middle, 2.8);
  EXPECT_GT(middle / fine, 2.8);
  EXPECT_GT(coarse / fine, 11);
}

TEST_P(Spheroids, IrregularTriangulationsConvergeToTheSameMap) {
  const double coarse = spheroidError(GetParam(), 8, 3);
  const double fine = spheroidError(GetParam(), 32, 3);
  EXPECT_LT(coarse, 2e-2);
  // Four times finer: at least order 1.5.
  EXPECT_GT(coarse / fine, 8);
}

INSTANTIATE_TEST_SUITE_P(OblateAndProlate, Spheroids, testing::Values(0.5, 2.0));

TEST(MapToSphere, DirichletEnergyExceedsAreaByASecondOrderGap) {
  // E >= area of the image with equality for a conformal map (the inscribed polyhedron's area tends
  // to 4 pi as well).
  double previous = 0;
  for (const double resolution : {6.0, 12.0, 24.0}) {
    const TriangleMesh mesh = surfaces::mesh(surfaces::sample(
        "ellipsoid", {{"a", 1}, {"b", 0.8}, {"c", 0.6}, {"resolution", resolution}}));
    const auto map = mapMesh(mesh);
    ASSERT_OK(map);
    const Connectivity& surface = mesh.connectivity();
    const std::vector<double> weights = cotanWeights(surface, mesh.edgeLengths());
    double energy = 0, area = 0;
    for (Index e = 0; e < surface.edgeCount(); ++e) {
      const Index h = surface.halfedge(e);
      energy += 0.5 * weights[e] *
                (map->points[surface.head(h)] - map->points[surface.tail(h)]).squaredNorm();
    }
    for (const auto& [a, b, c] : surface.faces()) {
      area += 0.5 * (map->points[b] - map->points[a]).cross(map->points[c] - map->points[a]).norm();
    }
    const double gap = energy - area;
    EXPECT_GT(gap, 0);
    if (previous > 0) {
      EXPECT_NEAR(previous / gap, 4, 1);
    }
    previous = gap;
  }
}

TEST(MapToSphere, DependsOnTheSurfaceAloneUpToRotation) {
  MODULI_NEED_SHARED_MESH(path, "closed_g0/alec__spot.obj");
  const TriangleSoup soup = surfaces::read(path);
  const TriangleMesh mesh = surfaces::mesh(soup);
  const TriangleMesh other = surfaces::mesh(surfaces::moved(soup, 1e-3));
  const auto a = mapMesh(mesh);
  const auto b = mapMesh(other);
  ASSERT_OK(a);
  ASSERT_OK(b);
  // Rounding of the lengths, 1e-16, times the condition of the solves, some 1e5.
  EXPECT_LT(surfaces::distanceUpToRotation(a->points, b->points,
                                           vertexAreas(mesh.connectivity(), mesh.edgeLengths())),
            1e-10);
  EXPECT_EQ(a->quality.flipped_faces, 0);
  EXPECT_LT(a->quality.mean_dilatation, 1.2);
  EXPECT_LT(a->quality.max_dilatation, 2);
}

TEST(MapToSphere, CarriesLongLimbsWithoutAFold) {
  MODULI_NEED_SHARED_MESH(path, "closed_g0/alec__homer.obj");
  const auto map = mapMesh(surfaces::mesh(surfaces::read(path)));
  ASSERT_OK(map);
  EXPECT_NEAR(map->quality.covering_degree, 1, 1e-12);
  EXPECT_LT(map->quality.mean_dilatation, 1.36);
}

TEST(MapToSphere, NamesTheFoldsOfACoarseSurface) {
  MODULI_NEED_SHARED_MESH(path, "closed_g0/libigl-data__decimated-knight.off");
  const auto map = mapMesh(surfaces::mesh(surfaces::read(path)));
  EXPECT_THAT(map, FailsWith(Reason::kFoldedMap));
  EXPECT_THAT(map.status().message(), testing::HasSubstr("of 1000 faces"));
}

TEST(MapToSphere, RefusesOtherTopologies) {
  EXPECT_THAT(mapMesh(surfaces::mesh(shapes::torusGrid(6, 6))),
              FailsWith(Reason::kUnsupportedTopology));
  EXPECT_THAT(mapMesh(surfaces::mesh(shapes::disk())), FailsWith(Reason::kUnsupportedTopology));
  // Euler characteristic 2 in all, yet no sphere.
  EXPECT_THAT(
      mapMesh(surfaces::mesh(shapes::together(shapes::torusGrid(6, 6), shapes::octahedron()))),
      FailsWith(Reason::kUnsupportedTopology));
}

TEST(MapToSphere, StopsWhenCancelled) {
  const TriangleMesh mesh = surfaces::mesh(surfaces::sample("sphere", {{"resolution", 4}}));
  Context context;
  CancelToken token;
  token.cancel();
  context.setCancelToken(token);
  EXPECT_THAT(mapToSphereLinear(context, mesh.connectivity(), mesh.edgeLengths()),
              FailsWith(Reason::kCancelled));
}

}  // namespace
}  // namespace moduli
