#include "core/parameterize/polycube.h"

#include <cmath>
#include <complex>
#include <iostream>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "core/parameterize/holonomy.h"
#include "tests/core/parameterize/plane_targets.h"

namespace moduli {
namespace {

using ::testing::HasSubstr;
using Plane = std::complex<double>;
constexpr double kPi = std::numbers::pi;

Result<Parameterization> mapped(const MetricSurface& given, const PolycubeOptions& options = {}) {
  Context context;
  return parameterizePolycube(context, given.surface, given.lengths, options);
}

/// The corners that a surface of cubes has of its own: three or five squares meet there.
std::vector<PolycubeCorner> ownCorners(const MetricSurface& cubes) {
  std::vector<PolycubeCorner> corners;
  const std::vector<double> curvatures = curvaturesOf(cubes);
  for (Index v = 0; v < cubes.surface.vertexCount(); ++v) {
    if (std::abs(curvatures[v]) > 1) corners.push_back({v, curvatures[v] > 0 ? 1 : -1});
  }
  return corners;
}

/// Angles around every vertex are 2 pi less a whole number of right angles, by the layout itself.
void expectCorners(const MetricSurface& given, const Parameterization& map) {
  const Connectivity surface = facesOfMap(given, map);
  const PlanarFaces faces{surface, map.points, map.corner};
  expectFlatSheets(faces, map);
  std::vector<double> wanted(surface.vertexCount(), 2 * kPi);
  double sum = 0;
  for (const Cone& cone : map.cones->cones) {
    EXPECT_NEAR(std::abs(cone.curvature), kPi / 2, 1e-15);
    wanted[cone.vertex] -= cone.curvature;
    sum += cone.curvature;
  }
  EXPECT_NEAR(sum, 2 * kPi * given.surface.eulerCharacteristic(), 1e-9);
  const std::vector<double> sums = faces.angleSums();
  for (Index v = 0; v < surface.vertexCount(); ++v) EXPECT_NEAR(sums[v], wanted[v], 1e-9);
  EXPECT_LE(*map.certificate.curvature_residual, 1e-9);
}

/// Every face keeps its shape and its size, and edges of the grid stay on a square grid.
void expectOwnLayout(const MetricSurface& given, const Parameterization& map) {
  const PlanarFaces faces{given.surface, map.points, map.corner};
  EXPECT_NEAR(map.certificate.quality.max_dilatation, 1, 1e-6);
  Plane direction = 0;
  for (Index h = 0; h < given.surface.halfedgeCount(); ++h) {
    EXPECT_NEAR(std::abs(faces.along(h)), given.lengths[given.surface.edge(h)], 1e-9);
    const Plane unit = faces.along(h) / std::abs(faces.along(h));
    if (direction == 0.0) direction = unit;
    // Sides and diagonals of squares differ by multiples of pi / 4.
    EXPECT_NEAR(std::remainder(std::arg(unit / direction), kPi / 4), 0, 1e-9);
  }
}

TEST(ParameterizePolycube, UnfoldsACubeAsItIs) {
  // Its corners are found, and the metric is its own.
  for (const int n : {2, 5}) {
    const MetricSurface cube = surfaceOfCubes({{0, 0, 0}}, n);
    const auto map = mapped(cube);
    ASSERT_OK(map);
    expectCorners(cube, *map);
    expectOwnLayout(cube, *map);
    EXPECT_EQ(map->cones->cones.size(), 8U);
    EXPECT_EQ(*map->certificate.holonomy_residual, 0);
  }
}

TEST(ParameterizePolycube, UnfoldsSurfacesOfCubesWithTheirCorners) {
  std::set<std::array<int, 3>> ring;
  for (int x = 0; x < 3; ++x) {
    for (int y = 0; y < 3; ++y) {
      if (x != 1 || y != 1) ring.insert({x, y, 0});
    }
  }
  const std::set<std::array<int, 3>> angle = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  std::set<std::array<int, 3>> eight = ring;
  for (const std::array<int, 3>& cube : ring) eight.insert({cube[0] + 2, cube[1], 0});
  for (const auto& [cubes, chi] : {std::pair(angle, 2), std::pair(ring, 0), std::pair(eight, -2)}) {
    const MetricSurface given = surfaceOfCubes(cubes, 3);
    ASSERT_EQ(given.surface.eulerCharacteristic(), chi);
    PolycubeOptions options;
    options.corners = ownCorners(given);
    const auto map = mapped(given, options);
    ASSERT_OK(map);
    expectCorners(given, *map);
    expectOwnLayout(given, *map);
    // Around its handles squares close up.
    EXPECT_EQ(map->cones->handle_turns.size(), static_cast<std::size_t>(2 - chi));
    EXPECT_LE(*map->certificate.holonomy_residual, 1e-9);
    EXPECT_TRUE(map->certificate.warnings.empty());
  }
}

TEST(ParameterizePolycube, TurnsASphereIntoACube) {
  // Corners at those of an inscribed cube: the image has the symmetry of the cube, six squares.
  const MetricSurface sphere = planeSample("sphere", {{"resolution", 6}, {"seed", 2}});
  const auto map = mapped(sphere);
  ASSERT_OK(map);
  expectCorners(sphere, *map);
  EXPECT_EQ(map->cones->cones.size(), 8U);
}

TEST(ParameterizePolycube, SaysWhereHandlesTurn) {
  // Corners anywhere on a torus: directions turn around its handles by some angle.
  const MetricSurface torus =
      planeSample("torus", {{"R", 2}, {"r", 0.8}, {"resolution", 10}, {"seed", 3}});
  PolycubeOptions options;
  options.corners = {{3, 1}, {77, 1}, {130, -1}, {161, -1}};
  const auto map = mapped(torus, options);
  ASSERT_OK(map);
  expectCorners(torus, *map);
  EXPECT_GT(*map->certificate.holonomy_residual, 1e-3);
  ASSERT_EQ(map->certificate.warnings.size(), 1U);
  EXPECT_THAT(map->certificate.warnings[0], HasSubstr("HANDLES_TURN"));
}

TEST(HandleTurns, AreMultiplesOfWhatCornersTurnBy) {
  // Turns about cones of pi / 2 change nothing modulo pi / 2, whichever tree the loops come from.
  std::set<std::array<int, 3>> ring;
  for (int x = 0; x < 4; ++x) {
    for (int y = 0; y < 3; ++y) {
      if (y != 1 || x == 0 || x == 3) ring.insert({x, y, 0});
    }
  }
  const MetricSurface given = surfaceOfCubes(ring, 2);
  for (const MetricSurface& same : {given, renumber(given, 1), renumber(given, 2)}) {
    PolycubeOptions options;
    options.corners = ownCorners(same);
    const auto map = mapped(same, options);
    ASSERT_OK(map);
    EXPECT_LE(distanceFromMultiples(map->cones->handle_turns, kPi / 2), 1e-9);
  }
  EXPECT_NEAR(distanceFromMultiples({0.1, kPi / 2 - 0.2, -3 * kPi}, kPi / 2), 0.2, 1e-12);
  EXPECT_EQ(distanceFromMultiples({}, kPi / 2), 0);
}

TEST(ParameterizePolycube, SaysWhichTheoremForbidsIt) {
  const MetricSurface cube = surfaceOfCubes({{0, 0, 0}}, 2);
  PolycubeOptions options;
  options.corners = {{0, 1}, {1, 1}, {2, 1}, {3, 1}, {4, 1}, {5, 1}};
  const auto few = mapped(cube, options);
  EXPECT_THAT(few, FailsWith(Reason::kInvalidOption));
  EXPECT_EQ(few.status().message(),
            "by the theorem of Gauss and Bonnet the corners of a PolyCube of this genus, convex "
            "ones less concave ones, number 8, and these number 6");
  options.corners = {{0, 2}};
  EXPECT_THAT(mapped(cube, options), FailsWith(Reason::kInvalidOption));
  options.corners = ownCorners(cube);
  options.corners[1].vertex = options.corners[0].vertex;
  EXPECT_THAT(mapped(cube, options), FailsWith(Reason::kInvalidOption));
  options.corners[1].vertex = 1000;
  EXPECT_THAT(mapped(cube, options), FailsWith(Reason::kInvalidOption));
  options = {};
  options.most_corners = 6;
  const auto no_room = mapped(cube, options);
  EXPECT_THAT(no_room, FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(no_room.status().message(), HasSubstr("Gauss and Bonnet"));
  EXPECT_THAT(mapped(plate(3, 3, {})), FailsWith(Reason::kUnsupportedTopology));
}

TEST(ParameterizePolycube, TakesAsManyCornersAsATheoremAsksFor) {
  // Genus 14: 104 concave corners more than convex ones.
  const MetricSurface holes = planeSample("genus", {{"genus", 14}, {"resolution", 2}});
  const auto map = mapped(holes);
  ASSERT_OK(map);
  EXPECT_GE(map->cones->cones.size(), 104U);
  EXPECT_EQ(map->certificate.quality.flipped_faces, 0);
}

class PolycubeMesh : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Meshes, PolycubeMesh,
                         testing::Values("closed_g0/alec__spot.obj", "closed_g0/cfwen__sphere.off",
                                         "closed_g0/libigl-data__decimated-knight.off",
                                         "genus1/ceaedf__Kitten.off", "genus2/cfwen__eight.off"));

TEST_P(PolycubeMesh, HasCornersOfRightAngles) {
  MODULI_NEED_SHARED_MESH(path, GetParam());
  const MetricSurface given = surfaceOfFile(path);
  const auto map = mapped(given);
  ASSERT_OK(map);
  expectCorners(given, *map);
  std::cout << map->cones->cones.size() << " corners, handles "
            << *map->certificate.holonomy_residual << ", islands " << *map->certificate.islands
            << ", area distortion " << map->certificate.quality.area_distortion << '\n';
}

}  // namespace
}  // namespace moduli
