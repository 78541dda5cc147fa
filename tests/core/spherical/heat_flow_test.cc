#include "core/spherical/heat_flow.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/forms/cotan.h"
#include "tests/core/mesh/shapes.h"
#include "tests/core/spherical/surfaces.h"

namespace moduli {
namespace {

Result<HeatFlowMap> flow(const TriangleMesh& mesh, const HeatFlowOptions& options = {}) {
  Context context;
  return mapToSphereHeatFlow(context, mesh.connectivity(), mesh.edgeLengths(), mesh.positions(),
                             options);
}

double distance(const TriangleMesh& mesh, const Points3& a, const Points3& b) {
  return surfaces::distanceUpToRotation(a, b, vertexAreas(mesh.connectivity(), mesh.edgeLengths()));
}

/// The flow stops where the energy, some 4 pi, falls by 1e-13 of itself in a step; steps shrink it
/// by a third or more, so that 1e-12 is left, and the least eigenvalue of its second derivative is
/// 4: positions are off by below 1e-6 in the mean square over 4 pi, and steps and starts differ by
/// twice that. Crowded meshes have smaller eigenvalues: ten times more.
constexpr double kStopping = 1e-5;

TriangleMesh spheroid(double c, double resolution, double seed = 0) {
  return surfaces::mesh(surfaces::sample(
      "spheroid", {{"a", 1}, {"c", c}, {"resolution", resolution}, {"seed", seed}}));
}

/// Both methods' errors in the mean square against the closed form, and what lies between them.
struct Errors {
  double flow = 0, linear = 0, between = 0;
};

template <typename Image>
Errors errors(const TriangleMesh& mesh, const Image& image) {
  Points3 exact;
  for (const Eigen::Vector3d& p : mesh.positions()) exact.push_back(image(p));
  const auto a = flow(mesh);
  Context context;
  const auto b = mapToSphereLinear(context, mesh.connectivity(), mesh.edgeLengths());
  EXPECT_OK(a);
  EXPECT_OK(b);
  EXPECT_NEAR(a->quality.covering_degree, 1, 1e-12);
  return {distance(mesh, a->points, exact), distance(mesh, b->points, exact),
          distance(mesh, a->points, b->points)};
}

void expectSecondOrder(const std::vector<Errors>& e) {
  for (std::size_t i = 0; i + 1 < e.size(); ++i) {
    // The limit is 4. The linear method's pole lies elsewhere on each mesh, which scatters it.
    EXPECT_NEAR(e[i].flow / e[i + 1].flow, 4, 0.5);
    EXPECT_GT(e[i].linear / e[i + 1].linear, 2.8);
    EXPECT_GT(e[i].between / e[i + 1].between, 2.8);
  }
}

class HeatFlowOnSpheroids : public testing::TestWithParam<double> {};

TEST_P(HeatFlowOnSpheroids, ConvergesAtSecondOrderAndToTheLinearMap) {
  const double c = GetParam();
  const auto image = [c](const auto& p) { return surfaces::spheroidImage(p, c).image; };
  std::vector<Errors> all;
  for (const double resolution : {8.0, 16.0, 32.0}) {
    all.push_back(errors(spheroid(c, resolution), image));
  }
  EXPECT_LT(all[0].flow, 5e-3);
  expectSecondOrder(all);
}

TEST_P(HeatFlowOnSpheroids, ConvergesOnIrregularTriangulations) {
  const double c = GetParam();
  const auto image = [c](const auto& p) { return surfaces::spheroidImage(p, c).image; };
  const Errors coarse = errors(spheroid(c, 8, 3), image), fine = errors(spheroid(c, 32, 3), image);
  // Four times finer, second order: 16.
  EXPECT_NEAR(coarse.flow / fine.flow, 16, 2);
}

INSTANTIATE_TEST_SUITE_P(OblateAndProlate, HeatFlowOnSpheroids, testing::Values(0.5, 2.0));

TEST(HeatFlow, OfACappedCylinderConvergesAtSecondOrder) {
  // Mercator: height s on the tube, and L + atanh(cos theta) on the caps.
  const double half = 1;
  const auto image = [half](const Eigen::Vector3d& p) {
    const double over = std::abs(p.z()) - half;
    const double psi = over < 0 ? std::abs(p.z()) : half + std::atanh(std::min(over, 1.0));
    const double across = 1 / std::cosh(psi), longitude = std::atan2(p.y(), p.x());
    return Eigen::Vector3d(across * std::cos(longitude), across * std::sin(longitude),
                           std::copysign(std::tanh(psi), p.z()));
  };
  std::vector<Errors> all;
  for (const double resolution : {8.0, 16.0, 32.0}) {
    all.push_back(errors(
        surfaces::mesh(surfaces::sample(
            "capped-cylinder", {{"radius", 1}, {"half_length", half}, {"resolution", resolution}})),
        image));
  }
  expectSecondOrder(all);
}

TEST(HeatFlow, EnergyFallsToFourPiAndExceedsTheAreaAtSecondOrder) {
  double previous_gap = 0, previous_energy = 0;
  for (const double resolution : {6.0, 12.0, 24.0}) {
    const TriangleMesh mesh = surfaces::mesh(surfaces::sample(
        "ellipsoid", {{"a", 1}, {"b", 0.8}, {"c", 0.6}, {"resolution", resolution}}));
    const auto map = flow(mesh);
    ASSERT_OK(map);
    for (std::size_t i = 1; i < map->energies.size(); ++i) {
      EXPECT_LT(map->energies[i], map->energies[i - 1]);
    }
    EXPECT_GT(map->energies.size(), 5U);
    double area = 0;
    for (const auto& [a, b, c] : mesh.connectivity().faces()) {
      area += 0.5 * (map->points[b] - map->points[a]).cross(map->points[c] - map->points[a]).norm();
    }
    const double gap = map->energies.back() - area;
    const double below = 4 * std::numbers::pi - map->energies.back();
    EXPECT_GT(gap, 0);
    if (previous_gap > 0) {
      EXPECT_NEAR(previous_gap / gap, 4, 0.5);
      EXPECT_NEAR(previous_energy / below, 4, 0.5);
    }
    previous_gap = gap;
    previous_energy = below;
  }
}

TEST(HeatFlow, EndsAtTheSameMapForAnyStepAndAnyStart) {
  const TriangleMesh mesh = spheroid(2, 8, 3);
  const auto map = flow(mesh);
  ASSERT_OK(map);
  EXPECT_TRUE(map->from_gauss_map);
  for (const double step : {3.0, 1e4}) {
    HeatFlowOptions options;
    options.step = step;
    const auto other = flow(mesh, options);
    ASSERT_OK(other);
    EXPECT_LT(distance(mesh, map->points, other->points), kStopping) << step;
  }
  Context context;
  const auto tutte = mapToSphereHeatFlow(context, mesh.connectivity(), mesh.edgeLengths(), {});
  ASSERT_OK(tutte);
  EXPECT_FALSE(tutte->from_gauss_map);
  EXPECT_LT(distance(mesh, map->points, tutte->points), kStopping);
}

TEST(HeatFlow, LeavesTheIcosahedronWhereItIs) {
  // Its symmetries fix every vertex.
  const TriangleMesh mesh = surfaces::mesh(shapes::icosahedron());
  const auto map = flow(mesh);
  ASSERT_OK(map);
  Points3 exact = mesh.positions();
  for (Eigen::Vector3d& p : exact) p.normalize();
  EXPECT_LT(distance(mesh, map->points, exact), 1e-14);
}

TEST(HeatFlow, TurnsScalesRenumbersAndMirrorsWithTheSurface) {
  const TriangleSoup soup = surfaces::sample(
      "ellipsoid", {{"a", 1}, {"b", 0.7}, {"c", 0.5}, {"resolution", 6}, {"seed", 2}});
  const TriangleMesh mesh = surfaces::mesh(soup);
  const auto map = flow(mesh);
  ASSERT_OK(map);
  const auto moved = flow(surfaces::mesh(surfaces::moved(soup, 1e-3)));
  ASSERT_OK(moved);
  EXPECT_LT(distance(mesh, map->points, moved->points), kStopping);

  TriangleSoup mirror = surfaces::reversed(soup);
  for (Eigen::Vector3d& p : mirror.vertices) p.x() = -p.x();
  auto mirrored = flow(surfaces::mesh(mirror));
  ASSERT_OK(mirrored);
  for (Eigen::Vector3d& p : mirrored->points) p.x() = -p.x();
  EXPECT_LT(distance(mesh, map->points, mirrored->points), kStopping);

  const auto renumbered = flow(surfaces::mesh(surfaces::renumbered(soup, 1)));
  ASSERT_OK(renumbered);
  EXPECT_NEAR(renumbered->energies.back() / map->energies.back(), 1, 1e-12);
  EXPECT_NEAR(renumbered->quality.max_dilatation, map->quality.max_dilatation, 10 * kStopping);
}

TEST(HeatFlow, UnfoldsRealSurfacesFromTuttesMap) {
  for (const char* name : {"alec__spot.obj", "odedstein__bunny.obj", "libigl-data__fandisk.off",
                           "alec__homer.obj", "odedstein__penguin.obj"}) {
    MODULI_NEED_SHARED_MESH(path, std::string("closed_g0/") + name);
    const auto map = flow(surfaces::mesh(surfaces::read(path)));
    ASSERT_OK(map);
    EXPECT_FALSE(map->from_gauss_map) << name;
    EXPECT_EQ(map->quality.flipped_faces, 0) << name;
    EXPECT_NEAR(map->quality.covering_degree, 1, 1e-12) << name;
    EXPECT_LT(map->quality.mean_dilatation, 1.25) << name;
  }
}

TEST(HeatFlow, NamesTheFoldsOfACoarseSurface) {
  MODULI_NEED_SHARED_MESH(path, "closed_g0/libigl-data__decimated-knight.off");
  const auto map = flow(surfaces::mesh(surfaces::read(path)));
  EXPECT_THAT(map, FailsWith(Reason::kFoldedMap));
  EXPECT_THAT(map.status().message(), testing::HasSubstr("of 1000 faces"));
  EXPECT_THAT(map.status().hint(), testing::HasSubstr("robust"));
}

TEST(HeatFlow, RefusesWhatItCannotDo) {
  EXPECT_THAT(flow(surfaces::mesh(shapes::torusGrid(6, 6))),
              FailsWith(Reason::kUnsupportedTopology));
  EXPECT_THAT(flow(surfaces::mesh(shapes::disk())), FailsWith(Reason::kUnsupportedTopology));
  const TriangleMesh mesh = spheroid(2, 4);
  HeatFlowOptions options;
  options.step = 0;
  EXPECT_THAT(flow(mesh, options), FailsWith(Reason::kInvalidOption));
  options = {};
  options.max_steps = 3;
  EXPECT_THAT(flow(mesh, options), FailsWith(Reason::kNoConvergence));
  Context context;
  EXPECT_THAT(mapToSphereHeatFlow(context, mesh.connectivity(), mesh.edgeLengths(), {{1, 0, 0}}),
              FailsWith(Reason::kInvalidOption));
  CancelToken token;
  token.cancel();
  context.setCancelToken(token);
  EXPECT_THAT(mapToSphereHeatFlow(context, mesh.connectivity(), mesh.edgeLengths(), {}),
              FailsWith(Reason::kCancelled));
}

}  // namespace
}  // namespace moduli
