#include "core/parameterize/torus.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <iostream>
#include <random>
#include <string>
#include <vector>

#include "core/forms/modular.h"
#include "core/forms/torus_period.h"
#include "tests/core/parameterize/plane_targets.h"

namespace moduli {
namespace {

using ::testing::HasSubstr;
using Plane = std::complex<double>;

Result<Parameterization> mapped(const MetricSurface& given, const TorusOptions& options = {}) {
  Context context;
  return parameterizeTorus(context, given.surface, given.lengths, options);
}

Plane translateOf(const TorusDomain& torus, const std::array<int, 2>& tile) {
  return 1.0 * tile[0] * torus.generators[0] + 1.0 * tile[1] * torus.generators[1];
}

bool holds(const PlanarFaces& faces, Index f, Plane p) {
  for (Index h = 3 * f; h < 3 * f + 3; ++h) {
    if (std::imag(std::conj(faces.along(h)) * (p - faces.at(h))) <= 0) return false;
  }
  return true;
}

/// How many faces of how many copies lie over a point: 1 but on edges, if the copies tile.
int copiesOver(const PlanarFaces& faces, const Parameterization& map, Plane p) {
  int count = 0;
  for (const auto& tile : tilesOf(*map.torus, map.points, p, p)) {
    for (Index f = 0; f < faces.surface.faceCount(); ++f) {
      count += holds(faces, f, p - translateOf(*map.torus, tile)) ? 1 : 0;
    }
  }
  return count;
}

/// What every map of a torus is held to, from its points alone.
void expectDomain(const MetricSurface& given, const Parameterization& map) {
  const Connectivity surface = facesOfMap(given, map);
  const PlanarFaces faces{surface, map.points, map.corner};
  expectFlatSheets(faces, map);
  EXPECT_EQ(faces.eulerCharacteristic(), 1);
  EXPECT_NEAR(imageArea(faces), 1, 1e-9);
  const TorusDomain& torus = *map.torus;
  const Plane a = torus.generators[0], b = torus.generators[1];
  EXPECT_EQ(a.imag(), 0);
  EXPECT_NEAR(a.real() * b.imag(), 1, 1e-12);
  EXPECT_NEAR(std::abs(b / a - torus.tau), 0, 1e-12);
  EXPECT_LE(std::abs(torus.tau.real()), 0.5 + 1e-12);
  EXPECT_GE(std::abs(torus.tau), 1 - 1e-12);
  EXPECT_LE(*map.certificate.holonomy_residual, 1e-9);
  // Both sides of a cut are translates by the lattice: sums of a few numbers of about its size.
  const double size = 4 * std::abs(b);
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    if (!faces.isSeam(h)) continue;
    const Index twin = surface.twin(h);
    const Plane way = faces.at(Connectivity::next(twin)) - faces.at(h);
    const double n = std::round(way.imag() / b.imag());
    const double m = std::round((way - n * b).real() / a.real());
    EXPECT_NEAR(std::abs(way - m * a - n * b), 0, 1e-15 * size * 4);
    EXPECT_NEAR(std::abs(faces.along(h) + faces.along(twin)), 0, 1e-15 * size * 4);
    EXPECT_TRUE(m != 0 || n != 0);
  }
  std::mt19937 random(7);
  for (int n = 0; n < 50; ++n) {
    const Plane p = uniform(random) * a + uniform(random) * b;
    EXPECT_EQ(copiesOver(faces, map, p), 1);
  }
}

/// Two sides from corner to corner, and no other cuts.
void expectParallelogram(const MetricSurface& given, const Parameterization& map) {
  const Connectivity surface = facesOfMap(given, map);
  const PlanarFaces faces{surface, map.points, map.corner};
  const TorusDomain& torus = *map.torus;
  ASSERT_TRUE(torus.is_parallelogram);
  std::set<Index> walked;
  double length = 0;
  for (int k = 0; k < 2; ++k) {
    Plane sum = 0;
    const std::vector<Index>& walk = torus.walks[k];
    const Plane ahead = torus.generators[k] / std::abs(torus.generators[k]);
    double longest = 0, astray = 0;
    for (std::size_t n = 0; n < walk.size(); ++n) {
      EXPECT_EQ(surface.head(walk[n]), surface.tail(walk[(n + 1) % walk.size()]));
      EXPECT_TRUE(faces.isSeam(walk[n]));
      walked.insert(surface.edge(walk[n]));
      sum += faces.along(walk[n]);
      length += std::abs(faces.along(walk[n]));
      longest = std::max(longest, std::abs(faces.along(walk[n])));
      astray = std::max(astray, std::abs(std::imag(sum * std::conj(ahead))));
    }
    // Near the straight line: a few edges, of which the shorter ones do not count.
    EXPECT_LE(astray, 2 * longest);
    EXPECT_NEAR(std::abs(sum - torus.generators[k]), 0, 1e-12);
  }
  EXPECT_EQ(surface.tail(torus.walks[0].front()), surface.tail(torus.walks[1].front()));
  std::set<Index> seams;
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    if (faces.isSeam(h)) seams.insert(surface.edge(h));
  }
  EXPECT_EQ(seams, walked);
  for (const Plane corner : {Plane(0), torus.generators[0], torus.generators[1],
                             torus.generators[0] + torus.generators[1]}) {
    EXPECT_TRUE(std::any_of(map.points.begin(), map.points.end(),
                            [&](Plane p) { return std::abs(p - corner) < 1e-12; }));
  }
  // Edges of a triangulation zigzag: across a square grid by sqrt 2 at worst.
  EXPECT_LE(length, 1.45 * (std::abs(torus.generators[0]) + std::abs(torus.generators[1])));
}

TEST(ParameterizeTorus, OfTheSquareTorusIsTheSquare) {
  const MetricSurface torus = flatTorus({0, 1}, 9, 9, 0.2, 1);
  const auto map = mapped(torus);
  ASSERT_OK(map);
  expectDomain(torus, *map);
  expectParallelogram(torus, *map);
  EXPECT_NEAR(std::abs(map->torus->tau - Plane(0, 1)), 0, 1e-12);
  EXPECT_NEAR(std::abs(map->torus->generators[0] - 1.0), 0, 1e-12);
  EXPECT_NEAR(std::abs(map->torus->generators[1] - Plane(0, 1)), 0, 1e-12);
  // Its own faces, unchanged: K is 1 up to the square root of rounding.
  EXPECT_NEAR(map->certificate.quality.max_dilatation, 1, 1e-7);
  const PlanarFaces faces{torus.surface, map->points, map->corner};
  for (Index h = 0; h < torus.surface.halfedgeCount(); ++h) {
    EXPECT_NEAR(std::abs(faces.along(h)), torus.lengths[torus.surface.edge(h)], 1e-12);
  }
}

TEST(ParameterizeTorus, OfADiplotorusHasItsPeriod) {
  for (const auto& [n, phi, h, s, s2] :
       {std::tuple(6, 0.03, 0.6, -2, 0), std::tuple(6, 0.03, 1.0, -2, 0),
        std::tuple(7, 0.3, 1.0, 0, 3)}) {
    const auto exact = reduceToFundamentalDomain(diplotorusTau(n, phi, h, s, s2));
    ASSERT_OK(exact);
    const MetricSurface coarse = diplotorus(n, phi, h, s, s2);
    for (const MetricSurface& torus : {subdivide(coarse, 3), insertVertices(coarse, 60, 0.05, 3)}) {
      const auto map = mapped(torus);
      ASSERT_OK(map);
      expectDomain(torus, *map);
      EXPECT_NEAR(std::abs(map->torus->tau - exact->tau), 0, 1e-10);
      EXPECT_NEAR(map->certificate.quality.max_dilatation, 1, 1e-6);
    }
  }
}

TEST(ParameterizeTorus, OfATorusOfRevolutionConvergesAtSecondOrder) {
  // tau = i sqrt(R^2 - r^2) / r; halving the grid divides the error by 4.
  std::vector<double> errors;
  for (const int k : {16, 32, 64}) {
    const auto map = mapped(torusOfRevolution(2, 1, 2 * k, k));
    ASSERT_OK(map);
    errors.push_back(std::abs(map->torus->tau - Plane(0, std::sqrt(3.0))));
  }
  EXPECT_GT(errors[0] / errors[1], 3.5);
  EXPECT_LT(errors[0] / errors[1], 4.5);
  EXPECT_GT(errors[1] / errors[2], 3.5);
  EXPECT_LT(errors[1] / errors[2], 4.5);
}

TEST(ParameterizeTorus, AgreesWithThePeriodOfHarmonicForms) {
  // Another method: of flat tori the same number; of others nearer with every refinement.
  Context context;
  const MetricSurface flat = flatTorus({0.3, 1.4}, 8, 7, 0.2, 5);
  const auto map = mapped(flat);
  const auto period = computeTorusPeriod(context, flat.surface, flat.lengths);
  ASSERT_OK(map);
  ASSERT_OK(period);
  EXPECT_NEAR(std::abs(map->torus->tau - period->tau), 0, 1e-11);
  std::vector<double> gaps;
  for (const int k : {12, 24}) {
    const MetricSurface torus =
        planeSample("torus", {{"R", 2}, {"r", 0.8}, {"resolution", k}, {"seed", 3}});
    const auto fine = mapped(torus);
    const auto other = computeTorusPeriod(context, torus.surface, torus.lengths);
    ASSERT_OK(fine);
    ASSERT_OK(other);
    gaps.push_back(teichmullerDistance(fine->torus->tau, other->tau));
  }
  EXPECT_LT(gaps[1], gaps[0] / 2);
}

TEST(ParameterizeTorus, KnowsNoNumberingUnitOrSide) {
  const MetricSurface torus =
      planeSample("torus", {{"R", 2}, {"r", 0.9}, {"resolution", 9}, {"seed", 5}});
  const auto map = mapped(torus);
  ASSERT_OK(map);
  for (const MetricSurface& same : {renumber(torus, 2), scale(torus, 1e-6), scale(torus, 1e6)}) {
    const auto other = mapped(same);
    ASSERT_OK(other);
    expectDomain(same, *other);
    EXPECT_LE(teichmullerDistance(other->torus->tau, map->torus->tau), 1e-9);
  }
  const MetricSurface mirrored = mirror(torus);
  const auto other = mapped(mirrored);
  ASSERT_OK(other);
  expectDomain(mirrored, *other);
  EXPECT_LE(teichmullerDistance(other->torus->tau, -std::conj(map->torus->tau)), 1e-9);
}

TEST(ParameterizeTorus, CutsFacesThatFold) {
  // Needles at the corners of faces: their straight edges cross in the flat metric.
  const MetricSurface torus = insertNearCorners(
      planeSample("torus", {{"R", 1.2}, {"r", 1}, {"resolution", 6}, {"seed", 2}}), 0.02, 4);
  TorusOptions plain;
  plain.refine = false;
  const auto folded = mapped(torus, plain);
  EXPECT_THAT(folded, FailsWith(Reason::kFoldedMap));
  const auto map = mapped(torus);
  ASSERT_OK(map);
  ASSERT_TRUE(map->subdivision.has_value());
  expectDomain(torus, *map);
  std::cout << torus.surface.faceCount() << " faces, cut into " << map->subdivision->faces.size()
            << '\n';
}

TEST(ParameterizeTorus, KeepsTheShapeOfATorusWithCapsAndNeedles) {
  // New vertices within flat faces, next to edges and corners, change nothing of the metric; its
  // Delaunay triangulation only has more vertices. tau moves by less than the grid's own error.
  const MetricSurface smooth =
      planeSample("torus", {{"R", 1.2}, {"r", 1}, {"resolution", 12}, {"seed", 2}});
  const auto before = mapped(smooth);
  ASSERT_OK(before);
  const double exact = std::sqrt(1.2 * 1.2 - 1);
  const double error =
      std::abs(before->torus->tau - Plane(0, 1 / exact)) + std::abs(before->torus->tau.real());
  for (const MetricSurface& torus :
       {insertNearEdges(smooth, 0.01, 3), insertNearCorners(smooth, 0.01, 3)}) {
    const auto map = mapped(torus);
    ASSERT_OK(map);
    ASSERT_TRUE(map->subdivision.has_value());
    expectDomain(torus, *map);
    std::cout << map->torus->tau << " and " << before->torus->tau << ", error " << error << '\n';
    EXPECT_LE(std::abs(map->torus->tau - before->torus->tau), error);
  }
}

TEST(ParameterizeTorus, OfVeryFewFacesHasADomainAllTheSame) {
  // One square with opposite sides identified: one vertex, two faces.
  const Plane i(0, 1);
  const MetricSurface torus = glueTriangles({{0.0, 1.0, 1.0 + i}, {0.0, 1.0 + i, i}},
                                            {{{0, 0}, {1, 1}}, {{0, 1}, {1, 2}}, {{0, 2}, {1, 0}}});
  const auto map = mapped(torus);
  ASSERT_OK(map);
  expectDomain(torus, *map);
  EXPECT_NEAR(std::abs(map->torus->tau - i), 0, 1e-14);
  const auto shallow = mapped(disphenoidCover(2, 3, 4));
  ASSERT_OK(shallow);
  expectDomain(disphenoidCover(2, 3, 4), *shallow);
}

TEST(ParameterizeTorus, TilesARectangle) {
  const MetricSurface torus = flatTorus({0.4, 1.1}, 6, 6, 0.2, 3);
  const auto map = mapped(torus);
  ASSERT_OK(map);
  const PlanarFaces faces{torus.surface, map->points, map->corner};
  const Plane lower(-1.5, -1), upper(2, 1.7);
  const auto tiles = tilesOf(*map->torus, map->points, lower, upper);
  std::mt19937 random(1);
  for (int n = 0; n < 200; ++n) {
    const Plane p(lower.real() + uniform(random) * (upper - lower).real(),
                  lower.imag() + uniform(random) * (upper - lower).imag());
    int count = 0;
    for (const auto& tile : tiles) {
      for (Index f = 0; f < torus.surface.faceCount(); ++f) {
        count += holds(faces, f, p - translateOf(*map->torus, tile)) ? 1 : 0;
      }
    }
    EXPECT_EQ(count, 1);
  }
}

TEST(ParameterizeTorus, SaysWhatIsNoTorus) {
  const auto sphere = mapped(planeSample("sphere", {{"resolution", 2}}));
  EXPECT_THAT(sphere, FailsWith(Reason::kUnsupportedTopology));
  EXPECT_THAT(sphere.status().message(), HasSubstr("genus 1, and this one has genus 0"));
  EXPECT_THAT(mapped(squareFrame(2, 1)), FailsWith(Reason::kUnsupportedTopology));
  EXPECT_THAT(mapped(squareTiledL()), FailsWith(Reason::kUnsupportedTopology));
  Context context;
  CancelToken token;
  token.cancel();
  context.setCancelToken(token);
  const MetricSurface torus = torusOfRevolution(2, 1, 8, 6);
  EXPECT_THAT(parameterizeTorus(context, torus.surface, torus.lengths, {}),
              FailsWith(Reason::kCancelled));
}

class TorusMesh : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Meshes, TorusMesh,
                         testing::Values("alec__rocker-arm.obj", "ceaedf__Kitten.off",
                                         "ceaedf__rocker-arm2500.off", "cfwen__kitten.nf20k.off",
                                         "cfwen__knot.obj", "cfwen__torus.off"));

TEST_P(TorusMesh, HasADomainBetweenShortSides) {
  MODULI_NEED_SHARED_MESH(path, std::string("genus1/") + GetParam());
  const MetricSurface given = surfaceOfFile(path);
  const auto map = mapped(given);
  ASSERT_OK(map);
  expectDomain(given, *map);
  expectParallelogram(given, *map);
  std::cout << "tau " << map->torus->tau << ", residual " << *map->certificate.holonomy_residual
            << ", K " << map->certificate.quality.max_dilatation << '\n';
}

}  // namespace
}  // namespace moduli
