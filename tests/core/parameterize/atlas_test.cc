#include "core/parameterize/atlas.h"

#include <cmath>
#include <complex>
#include <iostream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "core/parameterize/holonomy.h"
#include "tests/core/parameterize/plane_targets.h"

namespace moduli {
namespace {

using ::testing::HasSubstr;
using Plane = std::complex<double>;
constexpr double kPi = std::numbers::pi;

Result<Parameterization> mapped(const MetricSurface& given, const AtlasOptions& options = {}) {
  Context context;
  return parameterizeAtlas(context, given.surface, given.lengths, options);
}

Plane pointIn(const nlohmann::json& pair) {
  return {pair[0].get<double>(), pair[1].get<double>()};
}

/// The atlas as the file tells it, judged by nothing else: stars that close up, transitions that
/// carry common corners to each other, and the cocycle condition around every face.
struct FileAtlas {
  std::map<Index, std::map<Index, Plane>> chart;  ///< Where neighbours lie.
  std::map<std::pair<Index, Index>, PlaneMotion> transition;
  std::vector<Triangle> faces;
  std::map<Index, double> extraordinary;

  explicit FileAtlas(const std::string& text) {
    const nlohmann::json file = nlohmann::json::parse(text);
    EXPECT_EQ(file["format"], "moduli-affine-atlas");
    EXPECT_EQ(file["version"], 1);
    for (const auto& face : file["faces"]) faces.push_back(face.get<Triangle>());
    for (const auto& cone : file["extraordinary"]) {
      extraordinary[cone["vertex"].get<Index>()] = cone["curvature"].get<double>();
    }
    for (const auto& star : file["charts"]) {
      auto& places = chart[star["vertex"].get<Index>()];
      for (std::size_t n = 0; n < star["points"].size(); ++n) {
        places[star["neighbours"][n].get<Index>()] = pointIn(star["points"][n]);
      }
    }
    for (const auto& change : file["transitions"]) {
      const Index from = change["from"].get<Index>(), to = change["to"].get<Index>();
      const PlaneMotion there{std::polar(1.0, change["angle"].get<double>()),
                              pointIn(change["translation"])};
      transition[{from, to}] = there;
      transition[{to, from}] = {std::conj(there.turn), -there.shift * std::conj(there.turn)};
    }
  }

  /// The worst of all conditions, in lengths of the largest edge of a face.
  double residual() const {
    double worst = 0;
    for (const auto& [a, b, c] : faces) {
      for (const auto& [i, j, k] : {Triangle{a, b, c}, Triangle{b, c, a}, Triangle{c, a, b}}) {
        if (chart.count(i) == 0) continue;
        const Plane to_j = chart.at(i).at(j), to_k = chart.at(i).at(k);
        const double size = std::max({std::abs(to_j), std::abs(to_k), std::abs(to_j - to_k)});
        // Counter-clockwise in every chart.
        EXPECT_GT(std::imag(std::conj(to_j) * to_k), 0);
        if (chart.count(j) == 0) continue;
        const PlaneMotion change = transition.at({i, j});
        worst = std::max({worst, std::abs(change(0) - chart.at(j).at(i)) / size,
                          std::abs(change(to_j)) / size,
                          std::abs(change(to_k) - chart.at(j).at(k)) / size});
        if (chart.count(k) == 0) continue;
        const PlaneMotion around = transition.at({k, i}) * transition.at({j, k}) * change;
        worst = std::max({worst, std::abs(around.turn - 1.0), std::abs(around.shift) / size});
      }
    }
    return worst;
  }
};

void expectAtlas(const MetricSurface& given, const Parameterization& map) {
  ASSERT_TRUE(map.atlas.has_value());
  const AffineAtlas& atlas = *map.atlas;
  EXPECT_LE(atlas.overlap_residual, 1e-9);
  EXPECT_LE(atlas.cocycle_residual, 1e-9);
  const FileAtlas file(writeAtlasJson(atlas));
  EXPECT_LE(file.residual(), 1e-9);
  EXPECT_EQ(file.faces, facesOfMap(given, map).faces());
  EXPECT_EQ(file.extraordinary.size(), atlas.cones.size());
  EXPECT_EQ(file.chart.size() + file.extraordinary.size(),
            static_cast<std::size_t>(atlas.surface.vertexCount()));
  double sum = 0;
  for (const auto& [vertex, curvature] : file.extraordinary) sum += curvature;
  EXPECT_NEAR(sum, 2 * kPi * given.surface.eulerCharacteristic(), 1e-9);
}

TEST(ParameterizeAtlas, OfATranslationSurfaceIsItsOwn) {
  // The octagon with opposite sides glued has one cone of 6 pi, and nothing turns around handles.
  const MetricSurface octagon = subdivide(gluedPolygon(8), 4);
  const std::vector<double> curvatures = curvaturesOf(octagon);
  const auto cone = std::min_element(curvatures.begin(), curvatures.end()) - curvatures.begin();
  for (const bool named : {true, false}) {
    AtlasOptions options;
    if (named) options.extraordinary = {static_cast<Index>(cone)};
    const auto map = mapped(octagon, options);
    ASSERT_OK(map);
    expectAtlas(octagon, *map);
    ASSERT_EQ(map->atlas->cones.size(), 1U);
    EXPECT_EQ(map->atlas->cones[0].vertex, cone);
    EXPECT_NEAR(map->certificate.quality.max_dilatation, 1, 1e-6);
    EXPECT_LE(distanceFromMultiples(map->cones->handle_turns, 2 * kPi), 1e-9);
    for (Index h = 0; h < octagon.surface.halfedgeCount(); ++h) {
      if (!map->atlas->has_chart[octagon.surface.tail(h)]) continue;
      EXPECT_NEAR(std::abs(map->atlas->spoke[h]), octagon.lengths[octagon.surface.edge(h)], 1e-9);
    }
  }
}

TEST(ParameterizeAtlas, LeavesOutAsFewPointsAsThereCanBe) {
  EXPECT_EQ(leastExtraordinary(2), 3);
  EXPECT_EQ(leastExtraordinary(0), 0);
  EXPECT_EQ(leastExtraordinary(-2), 1);
  EXPECT_EQ(leastExtraordinary(-20), 1);
  for (const MetricSurface& given :
       {planeSample("ellipsoid", {{"resolution", 6}, {"a", 2}}), torusOfRevolution(2, 1, 20, 10),
        planeSample("genus", {{"genus", 2}, {"resolution", 8}, {"seed", 1}})}) {
    const auto map = mapped(given);
    ASSERT_OK(map);
    expectAtlas(given, *map);
    EXPECT_EQ(static_cast<Index>(map->atlas->cones.size()),
              leastExtraordinary(given.surface.eulerCharacteristic()));
  }
}

TEST(ParameterizeAtlas, KnowsNoNumberingOrUnit) {
  const MetricSurface torus =
      planeSample("torus", {{"R", 2}, {"r", 0.8}, {"resolution", 8}, {"seed", 3}});
  const auto map = mapped(torus);
  ASSERT_OK(map);
  for (const double unit : {1e-5, 1e5}) {
    const auto other = mapped(scale(torus, unit));
    ASSERT_OK(other);
    expectAtlas(torus, *other);
    for (Index h = 0; h < torus.surface.halfedgeCount(); ++h) {
      EXPECT_NEAR(std::abs(other->atlas->spoke[h]) / unit, std::abs(map->atlas->spoke[h]), 1e-9);
      EXPECT_NEAR(std::abs(other->atlas->transition[h].turn - map->atlas->transition[h].turn), 0,
                  1e-8);
    }
  }
  const MetricSurface same = renumber(torus, 4);
  const auto other = mapped(same);
  ASSERT_OK(other);
  expectAtlas(same, *other);
}

TEST(AffineAtlas, OfChartsThatDoNotFitIsToldApart) {
  // One side of one face a thousandth longer than its twin: stars and transitions no longer fit.
  const MetricSurface torus = flatTorus({0, 1}, 6, 6, 0.2, 2);
  const auto map = mapped(torus);
  ASSERT_OK(map);
  FlatCharts charts(torus.surface.halfedgeCount());
  const PlanarFaces faces{torus.surface, map->points, map->corner};
  for (Index h = 0; h < torus.surface.halfedgeCount(); ++h) charts[h] = faces.along(h);
  const AffineAtlas sound = atlasOfCharts(torus.surface, charts, {});
  EXPECT_LE(std::max(sound.overlap_residual, sound.cocycle_residual), 1e-12);
  const Index h = torus.surface.halfedge(10);
  charts[h] *= 1.001;
  const AffineAtlas broken = atlasOfCharts(torus.surface, charts, {});
  EXPECT_GT(broken.overlap_residual, 1e-5);
  EXPECT_GT(FileAtlas(writeAtlasJson(broken)).residual(), 1e-5);
}

TEST(ParameterizeAtlas, SaysWhichTheoremForbidsIt) {
  const MetricSurface sphere = planeSample("sphere", {{"resolution", 3}});
  AtlasOptions options;
  options.extraordinary = {4};
  const auto one = mapped(sphere, options);
  EXPECT_THAT(one, FailsWith(Reason::kInvalidOption));
  EXPECT_EQ(one.status().message(),
            "by the theorem of Gauss and Bonnet the extraordinary points of a sphere share a "
            "curvature of 4 pi, and each has less than 2 pi: 1 cannot, three can");
  options.extraordinary = {4, 9};
  EXPECT_THAT(mapped(sphere, options), FailsWith(Reason::kInvalidOption));
  options.extraordinary = {4, 9, 9};
  EXPECT_THAT(mapped(sphere, options), FailsWith(Reason::kInvalidOption));
  options.extraordinary = {4, 9, 5000};
  EXPECT_THAT(mapped(sphere, options), FailsWith(Reason::kInvalidOption));
  options.extraordinary = {4, 9, 20};
  EXPECT_OK(mapped(sphere, options));
  options.extraordinary = {4};
  const auto torus = mapped(torusOfRevolution(2, 1, 8, 6), options);
  EXPECT_THAT(torus, FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(torus.status().message(), HasSubstr("a torus share a curvature of 0"));
  EXPECT_THAT(mapped(plate(3, 3, {})), FailsWith(Reason::kUnsupportedTopology));
}

class AtlasMesh : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Meshes, AtlasMesh,
                         testing::Values("closed_g0/alec__spot.obj", "genus1/cfwen__knot.obj",
                                         "genus2/cfwen__eight.off", "genus2/ceaedf__eight.off",
                                         "genus3plus/libigl-data__3holes.off"));

TEST_P(AtlasMesh, HasChartsThatFit) {
  MODULI_NEED_SHARED_MESH(path, GetParam());
  const MetricSurface given = surfaceOfFile(path);
  const auto map = mapped(given);
  ASSERT_OK(map);
  expectAtlas(given, *map);
  const Connectivity surface = facesOfMap(given, *map);
  expectFlatSheets({surface, map->points, map->corner}, *map);
  std::cout << map->atlas->cones.size() << " points, overlap " << map->atlas->overlap_residual
            << ", cocycle " << map->atlas->cocycle_residual << '\n';
}

}  // namespace
}  // namespace moduli
