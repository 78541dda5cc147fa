#include "core/parameterize/cones.h"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "core/parameterize/flat.h"
#include "tests/core/parameterize/plane_targets.h"

namespace moduli {
namespace {

using ::testing::HasSubstr;
constexpr double kPi = std::numbers::pi;

Result<ChosenCones> chosen(const MetricSurface& given, const ConeOptions& options = {}) {
  Context context;
  return chooseCones(context, given.surface, given.lengths, options);
}

double sumOf(const std::vector<Cone>& cones) {
  double sum = 0;
  for (const Cone& cone : cones) sum += cone.curvature;
  return sum;
}

double areaDistortion(const MetricSurface& given, const std::vector<Cone>& cones) {
  Context context;
  FlatOptions options;
  options.cones = cones;
  const auto flat = parameterizeFlat(context, given.surface, given.lengths, options);
  EXPECT_OK(flat);
  return flat->certificate.quality.area_distortion;
}

MetricSurface cubeOf(int n) {
  return surfaceOfCubes({{0, 0, 0}}, n);
}

TEST(ChooseCones, FindsTheCornersOfACube) {
  // It is flat but for its corners: with these u = 0, and nothing is stretched.
  for (const MetricSurface& cube : {cubeOf(4), renumber(cubeOf(5), 3)}) {
    std::set<Index> corners;
    const std::vector<double> curvatures = curvaturesOf(cube);
    for (Index v = 0; v < cube.surface.vertexCount(); ++v) {
      if (curvatures[v] > 1) corners.insert(v);
    }
    ASSERT_EQ(corners.size(), 8U);
    ConeOptions options;
    options.spread = 1e-6;
    const auto cones = chosen(cube, options);
    ASSERT_OK(cones);
    ASSERT_EQ(cones->cones.size(), 8U);
    EXPECT_LE(cones->spread, 1e-9);
    for (const Cone& cone : cones->cones) {
      EXPECT_EQ(corners.count(cone.vertex), 1U);
      EXPECT_NEAR(cone.curvature, kPi / 2, 1e-9);
    }
  }
}

TEST(ChooseCones, FindsTheConesOfOtherPolyhedra) {
  // The double of a regular octagon's surface: one vertex of -4 pi; a tetrahedron: four of pi.
  const MetricSurface octagon = subdivide(gluedPolygon(8), 4);
  ConeOptions options;
  options.spread = 1e-6;
  const auto one = chosen(octagon, options);
  ASSERT_OK(one);
  ASSERT_EQ(one->cones.size(), 1U);
  EXPECT_NEAR(one->cones[0].curvature, -4 * kPi, 1e-9);
  EXPECT_LE(one->spread, 1e-9);
  const std::vector<Eigen::Vector3d> corners = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  const MetricSurface tetrahedron =
      subdivide(fromPositions(corners, {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}}), 5);
  const auto four = chosen(tetrahedron, options);
  ASSERT_OK(four);
  ASSERT_EQ(four->cones.size(), 4U);
  for (const Cone& cone : four->cones) EXPECT_NEAR(cone.curvature, kPi, 1e-9);
}

TEST(ChooseCones, AsksForNoneOfAFlatTorus) {
  const auto cones = chosen(flatTorus({0.2, 1.3}, 7, 7, 0.2, 1));
  ASSERT_OK(cones);
  EXPECT_TRUE(cones->cones.empty());
  EXPECT_LE(cones->spread, 1e-10);
}

TEST(ChooseCones, KeepsGaussAndBonnetAndTheSpread) {
  for (const MetricSurface& given :
       {planeSample("ellipsoid", {{"resolution", 8}, {"a", 3}}),
        planeSample("torus", {{"R", 1.3}, {"r", 1}, {"resolution", 14}, {"seed", 1}}),
        planeSample("genus", {{"genus", 2}, {"resolution", 8}, {"seed", 1}})}) {
    const double sum = 2 * kPi * given.surface.eulerCharacteristic();
    for (const double spread : {2.0, 1.0, 0.5}) {
      ConeOptions options;
      options.spread = spread;
      const auto cones = chosen(given, options);
      ASSERT_OK(cones);
      EXPECT_NEAR(sumOf(cones->cones), sum, 1e-9);
      EXPECT_LE(cones->spread, spread);
      for (const Cone& cone : cones->cones) EXPECT_LT(cone.curvature, 2 * kPi);
      EXPECT_TRUE(std::is_sorted(cones->cones.begin(), cones->cones.end(),
                                 [](const Cone& a, const Cone& b) { return a.vertex < b.vertex; }));
    }
  }
}

TEST(ChooseCones, TakesMultiplesOfAQuarter) {
  for (const MetricSurface& given :
       {planeSample("ellipsoid", {{"resolution", 8}, {"a", 3}}),
        planeSample("genus", {{"genus", 2}, {"resolution", 8}, {"seed", 1}})}) {
    for (const int most : {1, 3}) {
      ConeOptions options;
      options.quantum = kPi / 2;
      options.most_quanta = most;
      const auto cones = chosen(given, options);
      ASSERT_OK(cones);
      EXPECT_NEAR(sumOf(cones->cones), 2 * kPi * given.surface.eulerCharacteristic(), 1e-12);
      for (const Cone& cone : cones->cones) {
        const double quanta = cone.curvature / (kPi / 2);
        EXPECT_NEAR(quanta, std::round(quanta), 1e-14);
        EXPECT_NE(std::round(quanta), 0);
        EXPECT_LE(std::abs(std::round(quanta)), most);
      }
      // They are admissible.
      EXPECT_GT(areaDistortion(given, cones->cones), 0);
    }
  }
}

TEST(ChooseCones, LowersTheAreaDistortion) {
  const MetricSurface given =
      planeSample("torus", {{"R", 1.15}, {"r", 1}, {"resolution", 16}, {"seed", 1}});
  const double before = areaDistortion(given, {});
  double last = before;
  for (const double spread : {1.5, 0.75}) {
    ConeOptions options;
    options.spread = spread;
    const auto cones = chosen(given, options);
    ASSERT_OK(cones);
    const double after = areaDistortion(given, cones->cones);
    std::cout << cones->cones.size() << " cones: " << before << " -> " << after << '\n';
    EXPECT_LT(after, last);
    last = after;
  }
}

TEST(ChooseCones, KnowsNoNumberingOrUnit) {
  const MetricSurface given =
      planeSample("torus", {{"R", 1.3}, {"r", 1}, {"resolution", 10}, {"seed", 4}});
  const auto cones = chosen(given);
  ASSERT_OK(cones);
  for (const MetricSurface& same : {renumber(given, 5), scale(given, 1e6)}) {
    const auto other = chosen(same);
    ASSERT_OK(other);
    EXPECT_EQ(other->cones.size(), cones->cones.size());
    EXPECT_NEAR(other->spread, cones->spread, 1e-6);
  }
}

TEST(ChooseCones, LeavesABoundaryFree) {
  // A long thimble: capped, its end open.
  std::vector<Eigen::Vector3d> positions = {{0, 0, 3}};
  std::vector<Triangle> faces;
  const int n = 12, rows = 14;
  for (int i = 0; i < rows; ++i) {
    for (int k = 0; k < n; ++k) {
      const double angle = 2 * kPi * k / n, t = std::min(1.0, (i + 1) / 4.0);
      positions.emplace_back(std::sin(t * kPi / 2) * std::cos(angle),
                             std::sin(t * kPi / 2) * std::sin(angle),
                             2 + std::cos(t * kPi / 2) - std::max(0, i - 3) * 0.5);
      const Index a = 1 + n * i + k, b = 1 + n * i + (k + 1) % n;
      if (i == 0) {
        faces.push_back({0, a, b});
      } else {
        faces.push_back({a - n, a, b});
        faces.push_back({a - n, b, b - n});
      }
    }
  }
  const MetricSurface given = fromPositions(positions, faces);
  const auto cones = chosen(given);
  ASSERT_OK(cones);
  EXPECT_FALSE(cones->cones.empty());
  EXPECT_LE(cones->spread, 1);
  EXPECT_GT(cones->spread_before, 3);
  for (const Cone& cone : cones->cones) {
    EXPECT_FALSE(given.surface.isBoundaryVertex(cone.vertex));
  }
  EXPECT_LT(areaDistortion(given, cones->cones), areaDistortion(given, {}) / 2);
}

TEST(ChooseCones, SaysWhichTheoremForbidsTooFew) {
  const MetricSurface sphere = planeSample("sphere", {{"resolution", 3}});
  ConeOptions options;
  options.most = 1;
  const auto one = chosen(sphere, options);
  EXPECT_THAT(one, FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(one.status().message(), HasSubstr("Gauss and Bonnet"));
  options.most = 7;
  options.quantum = kPi / 2;
  options.most_quanta = 1;
  EXPECT_THAT(chosen(sphere, options), FailsWith(Reason::kInvalidOption));
  options.most = 8;
  EXPECT_OK(chosen(sphere, options));
  options.quantum = 1;
  EXPECT_THAT(chosen(sphere, options), FailsWith(Reason::kInvalidOption));
  // A torus has a flat metric without any.
  options = {};
  options.most = 0;
  options.spread = 1e-3;
  const auto none = chosen(torusOfRevolution(1.5, 1, 12, 8), options);
  ASSERT_OK(none);
  EXPECT_TRUE(none->cones.empty());
  EXPECT_EQ(none->spread, none->spread_before);
  options = {};
  options.spread = 0;
  EXPECT_THAT(chosen(sphere, options), FailsWith(Reason::kInvalidOption));
  options.spread = std::nan("");
  EXPECT_THAT(chosen(sphere, options), FailsWith(Reason::kInvalidOption));
}

class ConeMesh : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Meshes, ConeMesh,
                         testing::Values("closed_g0/alec__spot.obj",
                                         "closed_g0/odedstein__bunny.obj",
                                         "genus1/ceaedf__Kitten.off", "genus2/cfwen__eight.off",
                                         "genus2/cfwen__eight.hole.off"));

TEST_P(ConeMesh, LiesFlatWithLittleStretching) {
  MODULI_NEED_SHARED_MESH(path, GetParam());
  const MetricSurface given = surfaceOfFile(path);
  const auto cones = chosen(given);
  ASSERT_OK(cones);
  EXPECT_LE(cones->spread, 1);
  Context context;
  FlatOptions options;
  options.cones = cones->cones;
  const auto flat = parameterizeFlat(context, given.surface, given.lengths, options);
  ASSERT_OK(flat);
  const Connectivity surface = facesOfMap(given, *flat);
  expectFlatSheets({surface, flat->points, flat->corner}, *flat);
  EXPECT_LE(*flat->certificate.curvature_residual, 1e-9);
  // To first order the logarithms of areas spread by twice that; their standard deviation by less.
  EXPECT_LE(flat->certificate.quality.area_distortion, 1);
  std::cout << cones->cones.size() << " cones, spread " << cones->spread_before << " -> "
            << cones->spread << ", area distortion " << flat->certificate.quality.area_distortion
            << ", islands " << *flat->certificate.islands << '\n';
}

}  // namespace
}  // namespace moduli
