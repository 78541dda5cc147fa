#include "core/matching/settling.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "core/matching/harmonic_match.h"
#include "core/matching/isometric_step.h"
#include "core/matching/surface_walk.h"
#include "tests/core/matching/cover_samples.h"
#include "tests/core/spherical/sphere_testing.h"

namespace moduli {
namespace {

using Eigen::Vector3d;
using surfaces::MappedSurface;
using surfaces::RandomSphere;

MappedSurface ellipsoid(double resolution) {
  TriangleMesh mesh = surfaces::mesh(surfaces::sample(
      "ellipsoid", {{"a", 1.5}, {"b", 1}, {"c", 0.7}, {"resolution", resolution}, {"seed", 3}}));
  Context context;
  auto map = mapToSphereLinear(context, mesh.connectivity(), mesh.edgeLengths());
  EXPECT_OK(map);
  return {std::move(mesh), std::move(map->points)};
}

/// An ellipsoid mapped to itself; lengths in units of the root of the area.
class Settling : public testing::Test {
 protected:
  /// Every vertex walks along one field, slowly turning over the surface: all errors are alike over
  /// long distances.
  Relaxation slid(double length) const {
    Relaxation map(*RingMesh::make(surface.surface()), positions, domain, attractions);
    for (Index v = 0; v < surface.mesh.vertexCount(); ++v) {
      const Image start = domain.at(vertexPoint(surface.surface(), v));
      map.setImage(v, domain.walk(start, length * Vector3d(0.6, -0.3, 0.7)));
    }
    return map;
  }

  double error(const Relaxation& map) const {
    double sum = 0;
    for (Index v = 0; v < map.vertexCount(); ++v) {
      sum += (map.image(v).space - positions[v]).norm() / map.vertexCount();
    }
    return sum;
  }

  Index folded(const Relaxation& map) const {
    Index count = 0;
    for (const auto& [a, b, c] : surface.surface().faces()) {
      count += SphereDomain::isPositive(map.image(a), map.image(b), map.image(c)) ? 0 : 1;
    }
    return count;
  }

  static std::vector<Vector3d> scaled(const MappedSurface& surface, double unit) {
    std::vector<Vector3d> result = surface.mesh.positions();
    for (Vector3d& p : result) p /= unit;
    return result;
  }

  MappedSurface surface = ellipsoid(10);
  SphereLocator sphere = *SphereLocator::make(surface.surface(), surface.points);
  double unit = std::sqrt(surface.mesh.area());
  std::vector<Vector3d> positions = scaled(surface, unit);
  SphereDomain domain{sphere, surface.mesh.positions(), unit};
  std::vector<Attraction> attractions =
      std::vector<Attraction>(static_cast<std::size_t>(surface.mesh.vertexCount()));
  Context context;
};

TEST_F(Settling, LeavesAnIsometryAlone) {
  Relaxation map = slid(0);
  ASSERT_OK(settle(context, surface.surface(), domain, attractions, map));
  EXPECT_LT(error(map), 1e-12);
}

/// Sweeps vertex by vertex even out within some edges; a step of all finds the way back. The last
/// step is one that takes away less than a fiftieth of the excess, which is quadratic in the slide:
/// there is no more than a seventh of it left, and mostly far less, for steps converge faster.
TEST_F(Settling, BringsALongSlideBackWhereSweepsDoNot) {
  const Relaxation start = slid(0.03);
  ASSERT_EQ(folded(start), 0);
  Relaxation swept = start, settled = start;
  ASSERT_OK(swept.relaxAll(context, swept.inSweepOrder(), 40, 0));
  ASSERT_OK(settle(context, surface.surface(), domain, attractions, settled));
  RecordProperty("errors", std::to_string(error(start)) + ", swept " +
                               std::to_string(error(swept)) + ", settled " +
                               std::to_string(error(settled)));
  std::printf("errors: %.5f, swept %.5f, settled %.5f\n", error(start), error(swept),
              error(settled));
  EXPECT_LT(error(settled), error(start) / 7);
  EXPECT_LT(error(settled), 0.5 * error(swept));
  EXPECT_EQ(folded(settled), 0);
}

TEST_F(Settling, NeverFoldsAndNeverRaisesTheExcess) {
  Relaxation map = slid(0.03);
  RandomSphere random(5);
  for (Index v = 0; v < map.vertexCount(); ++v) {  // Contradictory places.
    attractions[v].image = domain.at(random.direction());
    attractions[v].place = attractions[v].image.space;
    attractions[v].weight = 1;
  }
  SettlingOptions strong;
  strong.pull = 1000;
  strong.scale = 0.5;
  map.setPull(strong.pull, strong.scale);
  const double before = map.excess(map.present());
  ASSERT_OK(settle(context, surface.surface(), domain, attractions, map, strong));
  EXPECT_EQ(folded(map), 0);
  EXPECT_LT(map.excess(map.present()), before);
}

TEST_F(Settling, StopsWhenCancelled) {
  Relaxation map = slid(0.03);
  CancelToken token;
  token.cancel();
  context.setCancelToken(token);
  EXPECT_THAT(settle(context, surface.surface(), domain, attractions, map),
              FailsWith(Reason::kCancelled));
}

/// Gauss and Newton's step is exact at an isometry: what it leaves of the displacement is of second
/// order in it, and of the excess, of fourth. A wrong derivative leaves a share that does not fall.
TEST_F(Settling, OneStepConvergesFasterThanTheDisplacement) {
  IsometricStep step(surface.surface(), positions, attractions);
  std::vector<double> left;
  for (const double length : {0.004, 0.002}) {
    const Relaxation map = slid(length);
    std::vector<Vector3d> places, normals;
    for (Index v = 0; v < map.vertexCount(); ++v) {
      places.push_back(map.image(v).space);
      normals.push_back(domain.normal(map.image(v).point.face));
    }
    const double before = step.excess(places);
    const auto steps = step(context, places, normals);
    ASSERT_OK(steps);
    std::vector<Vector3d> then;
    for (Index v = 0; v < map.vertexCount(); ++v) {
      EXPECT_LT(std::abs((*steps)[v].dot(normals[v])), 1e-12);
      then.push_back(domain.walk(map.image(v), (*steps)[v]).space);
    }
    left.push_back(step.excess(then) / before);
  }
  std::printf("left of the excess: %.4f, %.4f\n", left[0], left[1]);
  EXPECT_LT(left[0], 0.2);
  EXPECT_LT(left[1], 0.5 * left[0]);
}

/// Of surfaces with handles: their targets slide along, and the harmonic map with them.
TEST(SettlingOfHandles, BringsALongSlideBackInTheSameClass) {
  for (const TriangleSoup& soup : {lumpyTorus(24, 2), lumpyPlate(8, 2)}) {
    const TriangleMesh mesh = meshOf(soup);
    const CoverSurface cover = coverOf(mesh);
    const double unit = std::sqrt(mesh.area());
    const SurfaceWalk walk(mesh.connectivity(), mesh.positions(), unit);
    std::vector<SurfacePoint> targets;
    for (Index v = 0; v < mesh.vertexCount(); ++v) {
      targets.push_back(walk(vertexPoint(mesh.connectivity(), v), 0.03 * Vector3d(0.6, -0.3, 0.7)));
    }
    Context context;
    auto match =
        matchHarmonically(context, mesh.connectivity(), mesh.edgeLengths(), cover, targets);
    ASSERT_OK(match);
    const double before = errorsOf(mesh, match->map.images, mesh.positions()).mean;
    SettlingOptions free;
    free.pull = 0;
    ASSERT_OK(settle(context, mesh, mesh, cover, targets, match->map, free));
    const double after = errorsOf(mesh, match->map.images, mesh.positions()).mean;
    std::printf("errors %.5f, settled %.5f\n", before, after);
    EXPECT_LT(after, before / 7);
    EXPECT_EQ(countFolded(mesh.connectivity(), match->map), 0);
    // The lifts still close around every face, and cover the surface once.
    const VertexLinks links = linksOf(mesh.connectivity(), cover, match->map);
    EXPECT_LT(closureResidual(mesh.connectivity(), links), 1e-9);
    EXPECT_NEAR(coveredArea(cover.geometry, mesh.connectivity(), links), cover.area,
                1e-6 * cover.area);
  }
}

TEST(SurfaceWalk, TellsOfTheEdgesThatItCrosses) {
  const TriangleMesh mesh = surfaces::mesh(surfaces::sample("ellipsoid", {{"resolution", 6}}));
  const SurfaceWalk walk(mesh.connectivity(), mesh.positions(), 1);
  const SurfacePoint start{5, {0.2, 0.3, 0.5}};
  std::vector<Index> crossed;
  const SurfacePoint end =
      walk(start, Vector3d(0.5, 0.4, -0.6), 256, [&](Index h) { crossed.push_back(h); });
  ASSERT_GT(crossed.size(), 3u);
  Index face = start.face;
  for (const Index h : crossed) {
    EXPECT_EQ(Connectivity::faceOf(h), face);
    face = Connectivity::faceOf(mesh.connectivity().twin(h));
  }
  EXPECT_EQ(end.face, face);
}

}  // namespace
}  // namespace moduli
