#include "core/spherical/slit_map.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <random>

#include "core/mesh/prepare.h"
#include "core/mesh/read.h"
#include "core/mesh/samples.h"
#include "core/mesh/triangle_mesh.h"
#include "core/spherical/circle_domain_capacity.h"
#include "core/topology/surface_topology.h"
#include "tests/core/spherical/plane_domains.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

using Complex = std::complex<double>;
using Loops = std::vector<std::vector<Index>>;
constexpr double kPi = std::numbers::pi;

const std::vector<Circle> kThreeHoles = {{0, 1}, {0, 0.25}, {0.6, 0.12}, {{-0.2, 0.65}, 0.08}};

/// A plane domain as a surface, and which boundary loop lies on which circle.
struct Sample {
  Connectivity surface;
  std::vector<double> lengths;
  std::vector<Complex> points;
  Loops loops;
  std::vector<Index> loop_of;  ///< Per circle.
};

Sample makeSurface(std::vector<Complex> points, std::vector<Triangle> faces,
                   const Loops& circle_loops) {
  auto surface = *Connectivity::fromFaces(static_cast<Index>(points.size()), std::move(faces));
  std::vector<double> lengths = planeLengths(surface, points);
  Loops loops = computeTopology(surface).boundary_loops;
  std::vector<Index> loop_of(loops.size(), kNone);
  for (std::size_t c = 0; c < circle_loops.size(); ++c) {
    for (std::size_t k = 0; k < loops.size(); ++k) {
      for (const Index h : loops[k]) {
        if (surface.tail(h) == circle_loops[c][0]) loop_of[c] = static_cast<Index>(k);
      }
    }
  }
  return {std::move(surface), std::move(lengths), std::move(points), std::move(loops),
          std::move(loop_of)};
}

Sample sampleDomain(const std::vector<Circle>& circles, double h) {
  PlaneDomain domain = triangulateDomain(circles, h);
  return makeSurface(std::move(domain.points), std::move(domain.faces), domain.loops);
}

Result<SlitMap> slitMapOf(const Sample& sample, std::size_t outer = 0, std::size_t inner = 1) {
  Context context;
  return computeSlitMap(context, sample.surface, sample.lengths, sample.loops,
                        {sample.loop_of[outer], sample.loop_of[inner]});
}

// The annulus maps to itself but for a turn: in the mean square at second order in the length of
// linear elements, and so does the radius of its hole.
TEST(SlitMap, OfARoundAnnulusIsTheIdentity) {
  std::vector<double> errors, radii;
  for (const double h : {0.12, 0.06, 0.03}) {
    const Sample sample = sampleDomain({{0, 1}, {0, 0.3}}, h);
    const auto map = slitMapOf(sample);
    ASSERT_OK(map);
    Complex turn = 0;
    for (std::size_t v = 0; v < sample.points.size(); ++v) {
      turn += map->points[v] * std::conj(sample.points[v]);
    }
    turn /= std::abs(turn);
    double squares = 0;
    for (std::size_t v = 0; v < sample.points.size(); ++v) {
      squares += std::norm(map->points[v] - turn * sample.points[v]);
    }
    errors.push_back(std::sqrt(squares / static_cast<double>(sample.points.size())));
    radii.push_back(std::abs(map->arcs[sample.loop_of[1]].radius - 0.3));
    const Index first = sample.surface.tail(sample.loops[sample.loop_of[0]][0]);
    EXPECT_LT(std::abs(map->points[first] - 1.0), 1e-14);
    EXPECT_EQ(map->quality.flipped_faces, 0);
    EXPECT_EQ(map->arcs[sample.loop_of[0]].radius, 1);
  }
  RecordProperty("error", std::to_string(errors[2]));
  EXPECT_LT(errors[2], 2e-4);
  EXPECT_GT(std::log2(errors[0] / errors[2]) / 2, 1.75);
  EXPECT_GT(std::log2(radii[0] / radii[2]) / 2, 1.75);
}

// The radii of the slits from the fluxes of the round domain, which no mesh was needed for.
TEST(SlitMap, HasTheRadiiOfTheDomainsFluxes) {
  Context context;
  const auto exact = circleDomainCapacity(context, kThreeHoles);
  ASSERT_OK(exact);
  const Eigen::Vector3d logarithms =
      exact->capacity.ldlt().solve(-2 * kPi * Eigen::Vector3d::UnitX());
  std::vector<double> errors, defects;
  for (const double h : {0.04, 0.02}) {
    const Sample sample = sampleDomain(kThreeHoles, h);
    const auto map = slitMapOf(sample);
    ASSERT_OK(map);
    double error = 0;
    for (std::size_t k = 1; k < 4; ++k) {
      const double radius = std::exp(logarithms[static_cast<Eigen::Index>(k) - 1]);
      error = std::max(error, std::abs(map->arcs[sample.loop_of[k]].radius - radius));
    }
    errors.push_back(error);
    defects.push_back(map->quality.energy_defect);
  }
  EXPECT_LT(errors[1], 1e-3);
  EXPECT_GT(std::log2(errors[0] / errors[1]), 1.75);
  EXPECT_GT(std::log2(defects[0] / defects[1]), 1.75);
}

// Check E9.
void expectSlits(const Connectivity& surface, const Loops& loops, const SlitMapOptions& options,
                 const SlitMap& map) {
  EXPECT_LT(map.quality.period_defect, 1e-9);
  for (std::size_t k = 0; k < loops.size(); ++k) {
    const SlitArc& arc = map.arcs[k];
    const auto number = static_cast<Index>(k);
    const bool full = number == options.outer || number == options.inner;
    EXPECT_EQ(arc.length == 2 * kPi, full);
    EXPECT_LE(arc.radius, 1 + 1e-14);
    EXPECT_GE(arc.radius, map.arcs[options.inner].radius * (1 - 1e-14));
    EXPECT_LE(arc.length, 2 * kPi);
    for (const Index h : loops[k]) {
      const Complex w = map.points[surface.tail(h)];
      EXPECT_NEAR(std::abs(w) / arc.radius, 1, 1e-13);
      const double past = std::arg(w) - arc.begin;
      EXPECT_LE(past - 2 * kPi * std::floor(past / (2 * kPi) + 1e-9), arc.length + 1e-7);
    }
  }
}

TEST(SlitMap, PutsLoopsOnConcentricArcs) {
  const Sample sample = sampleDomain(kThreeHoles, 0.05);
  for (std::size_t outer = 0; outer < 4; ++outer) {
    for (std::size_t inner = 0; inner < 4; ++inner) {
      if (outer == inner) continue;
      const auto map = slitMapOf(sample, outer, inner);
      ASSERT_OK(map);
      expectSlits(sample.surface, sample.loops, {sample.loop_of[outer], sample.loop_of[inner]},
                  *map);
    }
  }
}

TEST(SlitMap, ContinuesItsLogarithmAcrossTheCut) {
  const Sample sample = sampleDomain(kThreeHoles, 0.06);
  const auto map = slitMapOf(sample, 2, 3);
  ASSERT_OK(map);
  std::map<Index, double> jumps;
  for (const CochainTerm& term : map->cut) jumps[term.edge] = static_cast<double>(term.value);
  for (Index e = 0; e < sample.surface.edgeCount(); ++e) {
    const Index h = sample.surface.halfedge(e);
    const auto at = jumps.find(e);
    const double turn = 2 * kPi * (at == jumps.end() ? 0 : at->second);
    const Complex step = map->logarithm[sample.surface.head(h)] -
                         map->logarithm[sample.surface.tail(h)] + Complex(0, turn);
    // No edge goes around: fields are smooth but near the two small loops, seen from 0.06 apart.
    EXPECT_LT(std::abs(step.imag()), 2.5);
    EXPECT_LT(std::abs(std::exp(step) * map->points[sample.surface.tail(h)] -
                       map->points[sample.surface.head(h)]),
              1e-13);
  }
}

TEST(SlitMap, IsInvertedWhereLoopsChangePlaces) {
  const Sample sample = sampleDomain(kThreeHoles, 0.08);
  const auto one = slitMapOf(sample, 0, 2);
  const auto other = slitMapOf(sample, 2, 0);
  ASSERT_OK(one);
  ASSERT_OK(other);
  const Complex product = one->points[0] * other->points[0];
  for (std::size_t v = 0; v < one->points.size(); ++v) {
    EXPECT_LT(std::abs(one->points[v] * other->points[v] / product - 1.0), 1e-11);
  }
}

TEST(SlitMap, ForgetsNumbersUnitsAndMirrors) {
  const Sample sample = sampleDomain(kThreeHoles, 0.08);
  const auto one = slitMapOf(sample, 0, 1);
  ASSERT_OK(one);
  std::vector<Index> number(sample.points.size());
  std::iota(number.begin(), number.end(), 0);
  std::shuffle(number.begin(), number.end(), std::mt19937(4));
  const PlaneDomain domain = triangulateDomain(kThreeHoles, 0.08);
  std::vector<Complex> points(number.size());
  for (std::size_t v = 0; v < number.size(); ++v) points[number[v]] = 1e6 * domain.points[v];
  for (const bool mirrored : {false, true}) {
    std::vector<Triangle> faces = domain.faces;
    std::shuffle(faces.begin(), faces.end(), std::mt19937(5));
    for (Triangle& face : faces) {
      face = {number[face[1]], number[face[2]], number[face[0]]};
      if (mirrored) std::swap(face[0], face[1]);
    }
    Loops loops = domain.loops;
    for (std::vector<Index>& loop : loops) {
      for (Index& v : loop) v = number[v];
    }
    const auto other = slitMapOf(makeSurface(points, faces, loops), 0, 1);
    ASSERT_OK(other);
    const auto seen = [&](std::size_t v) {
      const Complex w = other->points[number[v]];
      return mirrored ? std::conj(w) : w;
    };
    const Complex turn = seen(0) / one->points[0];
    EXPECT_NEAR(std::abs(turn), 1, 1e-12);
    for (std::size_t v = 0; v < number.size(); ++v) {
      EXPECT_LT(std::abs(seen(v) - turn * one->points[v]), 1e-11);
    }
  }
}

TEST(SlitMap, RefusesOtherSurfacesAndLoops) {
  Context context;
  const Sample disk = sampleDomain({{0, 1}}, 0.3);
  EXPECT_THAT(computeSlitMap(context, disk.surface, disk.lengths, disk.loops),
              FailsWith(Reason::kUnsupportedTopology));
  const auto torus = TriangleMesh::fromSoup(*makeSample("torus", {{"resolution", 4}}));
  EXPECT_THAT(computeSlitMap(context, torus->connectivity(), torus->edgeLengths(), {}),
              FailsWith(Reason::kUnsupportedTopology));
  const Sample good = sampleDomain(kThreeHoles, 0.2);
  for (const SlitMapOptions& bad :
       {SlitMapOptions{1, 1}, SlitMapOptions{0, 4}, SlitMapOptions{-1, 0}}) {
    EXPECT_THAT(computeSlitMap(context, good.surface, good.lengths, good.loops, bad),
                FailsWith(Reason::kInvalidOption));
  }
  EXPECT_THAT(computeSlitMap(context, good.surface, good.lengths, {good.loops[0]}),
              FailsWith(Reason::kInvalidOption));
}

class SlitMapOnMeshes : public testing::TestWithParam<const char*> {};

TEST_P(SlitMapOnMeshes, PutsLoopsOnConcentricArcs) {
  MODULI_NEED_SHARED_MESH(path, GetParam());
  Context context;
  const auto soup = readMeshFile(context, path);
  ASSERT_OK(soup);
  const auto prepared = prepareMesh(context, *soup, {});
  ASSERT_OK(prepared);
  const Connectivity& surface = prepared->mesh.connectivity();
  const Loops loops = computeTopology(surface).boundary_loops;
  const auto map = computeSlitMap(context, surface, prepared->mesh.edgeLengths(), loops);
  ASSERT_OK(map);
  expectSlits(surface, loops, {}, *map);
  // Only at the ends of slits, two a loop, do faces turn over.
  EXPECT_LE(map->quality.flipped_faces, static_cast<Index>(2 * loops.size()));
  EXPECT_LT(map->quality.energy_defect, 0.03);
  EXPECT_LT(map->quality.mean_dilatation, 1.5);
}

INSTANTIATE_TEST_SUITE_P(Shared, SlitMapOnMeshes,
                         testing::Values("multi_boundary/odedstein__plane_holes.obj",
                                         "multi_boundary/cfwen__bunny.off",
                                         "multi_boundary/gpeyre__pipes.off",
                                         "multi_boundary/gpeyre__nefertiti-entire.off"));

}  // namespace
}  // namespace moduli
