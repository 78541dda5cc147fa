#include "core/matching/homeomorphism.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <numeric>

#include "core/matching/capped_disk.h"
#include "core/matching/disk_rim.h"
#include "core/matching/sphere_domain.h"
#include "core/matching/split_surface.h"
#include "core/spherical/exact_sign.h"
#include "tests/core/matching/disk_samples.h"
#include "tests/core/spherical/sphere_testing.h"

namespace moduli {
namespace {

using surfaces::MappedSurface;
using surfaces::RandomSphere;

/// An ellipsoid with three axes: it has no symmetry but its mirrors, and no fold seen from within.
MappedSurface ellipsoid(double resolution, double seed) {
  TriangleMesh mesh = surfaces::mesh(surfaces::sample(
      "ellipsoid", {{"a", 1.5}, {"b", 1}, {"c", 0.7}, {"resolution", resolution}, {"seed", seed}}));
  Context context;
  auto map = mapToSphereLinear(context, mesh.connectivity(), mesh.edgeLengths());
  EXPECT_OK(map);
  return {std::move(mesh), std::move(map->points)};
}

Index foldedFaces(const Connectivity& surface, const Points3& points) {
  Index folded = 0;
  for (const auto& [a, b, c] : surface.faces()) {
    if (spherical::orientationSign(points[a], points[b], points[c]) <= 0) ++folded;
  }
  return folded;
}

/// A pair of a surface with itself, or with another of the same vertices.
struct Pair {
  const MappedSurface& a;
  const MappedSurface& b;
  Points3 start;
  SphereLocator sphere = *SphereLocator::make(b.surface(), b.points);
  double unit = std::sqrt(b.mesh.area());

  Pair(const MappedSurface& from, const MappedSurface& to) : a(from), b(to), start(from.points) {}

  Result<Homeomorphism> fit(const std::vector<VertexTarget>& targets,
                            const HomeomorphismOptions& options = {}) const {
    Context context;
    return fitHomeomorphism(context, {a.surface(), a.mesh.positions(), start},
                            {sphere, b.mesh.positions()}, targets, options);
  }

  /// Each vertex to itself, with errors of that size (over the root of the area) and that share of
  /// the vertices sent anywhere.
  std::vector<VertexTarget> targets(double noise, double outliers, unsigned seed) const {
    const SphereDomain domain(sphere, b.mesh.positions(), unit);
    RandomSphere random(seed);
    std::vector<VertexTarget> result;
    for (Index v = 0; v < a.mesh.vertexCount(); ++v) {
      Image image = domain.at(vertexPoint(b.surface(), v));
      const Eigen::Vector3d step = noise * random.direction(), anywhere = random.direction();
      if (noise > 0) image = domain.walk(image, step);
      if (random.uniform() < outliers) image = domain.at(anywhere);
      result.push_back({v, image.point});
    }
    return result;
  }

  /// Mean distance of the images from the true vertices, over the root of the area.
  double error(const std::vector<SurfacePoint>& images) const {
    double sum = 0;
    for (Index v = 0; v < a.mesh.vertexCount(); ++v) {
      sum +=
          (spacePoint(b.surface(), b.mesh.positions(), images[v]) - b.mesh.positions()[v]).norm();
    }
    return sum / a.mesh.vertexCount() / unit;
  }

  double targetError(const std::vector<VertexTarget>& targets) const {
    std::vector<SurfacePoint> images;
    for (const VertexTarget& target : targets) images.push_back(target.point);
    return error(images);
  }
};

TEST(Homeomorphism, TargetsThatAreTheIdentityGiveTheIdentity) {
  const MappedSurface surface = ellipsoid(12, 3);
  const Pair pair(surface, surface);
  const auto map = pair.fit(pair.targets(0, 0, 1));
  ASSERT_OK(map);
  // Once it is exact there is nothing to gain: no vertex moves.
  EXPECT_LT(pair.error(map->images), 1e-14);
  EXPECT_EQ(map->report.folded_faces, 0);
  EXPECT_NEAR(map->report.max_dilatation, 1, 1e-5);
  EXPECT_LT(map->mean_distance, 1e-14);
}

TEST(Homeomorphism, IsometryWithoutTargetsStays) {
  const MappedSurface surface = ellipsoid(8, 3);
  const Pair pair(surface, surface);
  const auto map = pair.fit({});
  ASSERT_OK(map);
  // The coarse mesh has nothing to gain, and a vertex comes back where the energy is least: the
  // tolerance leaves a part of it, quadratic in the distance.
  EXPECT_LT(pair.error(map->images), 5e-3);
  EXPECT_FALSE(map->began_at_targets);
}

TEST(Homeomorphism, FindsARotationOfTheSphere) {
  double last = 0;
  for (const double resolution : {6.0, 12.0}) {
    const MappedSurface a = surfaces::roundSphere(resolution, 3);
    const Pair pair(a, a);
    const Eigen::Matrix3d turn = surfaces::rotation(4);
    std::vector<VertexTarget> targets;
    for (Index v = 0; v < a.mesh.vertexCount(); ++v) {
      targets.push_back({v, pair.sphere.locate(turn * a.points[v])});
    }
    const auto map = pair.fit(targets);
    ASSERT_OK(map);
    EXPECT_EQ(foldedFaces(a.surface(), map->points), 0);
    double sum = 0;
    for (Index v = 0; v < a.mesh.vertexCount(); ++v) {
      sum += (map->points[v] - turn * a.points[v]).norm() / a.mesh.vertexCount();
    }
    // The polyhedron is not turned into itself: faces lie as deep as h^2 / 8 under the sphere, with
    // h = 1.107 / resolution, and edges differ by as much of their length.
    const double h = 1.107 / resolution;
    EXPECT_LT(sum, h * h);
    if (last > 0) {
      EXPECT_LT(sum, last / 2);
    }
    last = sum;
  }
}

TEST(Homeomorphism, WildTargetsFoldNothing) {
  for (const unsigned seed : {1u, 2u}) {
    const MappedSurface surface = ellipsoid(4, seed);
    const Pair pair(surface, surface);
    for (const auto& targets : {pair.targets(0, 1, seed), pair.targets(0.3, 0, seed)}) {
      ASSERT_GT(pair.targetError(targets), 0.1);
      const auto map = pair.fit(targets);
      ASSERT_OK(map);
      EXPECT_EQ(foldedFaces(surface.surface(), map->points), 0);
      EXPECT_EQ(map->report.folded_faces, 0);
      double degree = 0;
      for (const auto& [a, b, c] : surface.surface().faces()) {
        degree += signedSolidAngle(map->points[a], map->points[b], map->points[c]);
      }
      EXPECT_NEAR(degree, 4 * M_PI, 1e-9);
    }
  }
}

TEST(Homeomorphism, ImagesArePointsOfTheSurface) {
  const MappedSurface surface = ellipsoid(8, 3);
  const Pair pair(surface, surface);
  const auto map = pair.fit(pair.targets(0.02, 0.05, 2));
  ASSERT_OK(map);
  for (Index v = 0; v < surface.mesh.vertexCount(); ++v) {
    ASSERT_OK(checkSurfacePoint(surface.surface(), map->images[v], "image"));
    const Eigen::Vector3d there = spherePoint(surface.surface(), surface.points, map->images[v]);
    EXPECT_LT((there - map->points[v]).norm(), 1e-14);
  }
}

TEST(Homeomorphism, EvensOutErrorsAndIgnoresOutliers) {
  const MappedSurface surface = ellipsoid(16, 3);
  const Pair pair(surface, surface);
  const auto clean = pair.fit(pair.targets(0.02, 0, 2));
  ASSERT_OK(clean);
  const double error = pair.error(clean->images);
  // A target moves by some 0.8 * 0.02. Errors are averaged over a patch of radius 0.07, 1 / 65 of
  // the area with 40 of the 2562 vertices: a sixth is left.
  EXPECT_LT(error, 0.016 / 4);
  EXPECT_LT(clean->report.mean_dilatation, 1.2);
  const auto targets = pair.targets(0.02, 0.2, 2);
  ASSERT_GT(pair.targetError(targets), 0.08);
  const auto robust = pair.fit(targets);
  ASSERT_OK(robust);
  EXPECT_LT(pair.error(robust->images), 2 * error);
}

TEST(Homeomorphism, AStartFarAwayDoesNotMatterWhereTargetsAreGood) {
  const MappedSurface surface = ellipsoid(12, 3);
  Pair pair(surface, surface);
  for (Eigen::Vector3d& p : pair.start) {
    p = ballTranslate({0.5, 0.3, -0.2}, surfaces::rotation(7) * p).normalized();
  }
  ASSERT_EQ(foldedFaces(surface.surface(), pair.start), 0);
  const auto map = pair.fit(pair.targets(0.01, 0.05, 2));
  ASSERT_OK(map);
  EXPECT_TRUE(map->began_at_targets);
  EXPECT_LT(pair.error(map->images), 0.005);
}

TEST(Homeomorphism, DoesNotDependOnScaleNorNumbering) {
  const MappedSurface surface = ellipsoid(8, 3);
  const Pair pair(surface, surface);
  const std::vector<VertexTarget> targets = pair.targets(0.02, 0.05, 2);
  const auto map = pair.fit(targets);
  ASSERT_OK(map);

  TriangleSoup soup{surface.mesh.positions(), surface.surface().faces()};
  for (Eigen::Vector3d& p : soup.vertices) p *= 64;  // Exact in doubles.
  const MappedSurface large{surfaces::mesh(soup), surface.points};
  const auto same = Pair(large, surface).fit(targets);
  ASSERT_OK(same);
  for (std::size_t v = 0; v < map->points.size(); ++v) {
    EXPECT_EQ(map->points[v], same->points[v]);
  }

  const auto onto_large = Pair(surface, large).fit(targets);
  ASSERT_OK(onto_large);
  for (std::size_t v = 0; v < map->points.size(); ++v) {
    EXPECT_EQ(map->points[v], onto_large->points[v]);
  }

  // The vertices backwards: sums are taken in another order, no more. A different decision would
  // show as some thousandths.
  const auto count = surface.mesh.vertexCount();
  TriangleSoup other{surface.mesh.positions(), surface.surface().faces()};
  std::reverse(other.vertices.begin(), other.vertices.end());
  for (Triangle& face : other.faces) {
    for (Index& v : face) v = count - 1 - v;
    std::rotate(face.begin(), face.begin() + 1, face.end());
  }
  Points3 points = surface.points;
  std::reverse(points.begin(), points.end());
  const MappedSurface backwards{surfaces::mesh(other), points};
  std::vector<VertexTarget> moved = targets;
  for (VertexTarget& target : moved) target.vertex = count - 1 - target.vertex;
  const auto renumbered = Pair(backwards, surface).fit(moved);
  ASSERT_OK(renumbered);
  double sum = 0;
  for (Index v = 0; v < count; ++v) {
    sum += (map->points[v] - renumbered->points[count - 1 - v]).norm() / count;
  }
  // Twelve common steps at most, with matrices of a condition of some 1e5: 1e-9 in unit vectors,
  // and ten times that.
  EXPECT_LT(sum, 1e-8);
}

TEST(Homeomorphism, TheInverseLeadsBack) {
  const MappedSurface surface = ellipsoid(12, 3);
  const Pair pair(surface, surface);
  const auto map = pair.fit(pair.targets(0.02, 0.05, 2));
  ASSERT_OK(map);
  Context context;
  const auto back = invertHomeomorphism(context, surface.surface(), map->points, pair.sphere);
  ASSERT_OK(back);
  for (Index v = 0; v < surface.mesh.vertexCount(); ++v) {
    const Eigen::Vector3d there = spherePoint(surface.surface(), map->points, (*back)[v]);
    EXPECT_LT((there - surface.points[v]).norm(), 1e-13);
  }
  // Between vertices the two maps differ within a face: h^2 of an edge of 1.107 / 12.
  const double cycle = cycleError(surface.surface(), surface.mesh.positions(), map->images,
                                  surface.surface(), *back);
  EXPECT_GT(cycle, 0);
  EXPECT_LT(cycle, 0.01);
}

TEST(Homeomorphism, StopsWhenToldTo) {
  const MappedSurface surface = ellipsoid(8, 3);
  const Pair pair(surface, surface);
  CancelToken token;
  token.cancel();
  Context context;
  context.setCancelToken(token);
  EXPECT_THAT(fitHomeomorphism(context, {surface.surface(), surface.mesh.positions(), pair.start},
                               {pair.sphere, surface.mesh.positions()}, {}),
              FailsWith(Reason::kCancelled));
  Context late;
  late.setDeadline(Context::Clock::now() - std::chrono::seconds(1));
  EXPECT_THAT(fitHomeomorphism(late, {surface.surface(), surface.mesh.positions(), pair.start},
                               {pair.sphere, surface.mesh.positions()}, pair.targets(0, 0, 1)),
              FailsWith(Reason::kDeadlineExceeded));
}

TEST(Homeomorphism, RefusesWhatItCannotUse) {
  const MappedSurface surface = ellipsoid(4, 3);
  Pair pair(surface, surface);
  EXPECT_THAT(pair.fit({{-1, {}}}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(pair.fit({{surface.mesh.vertexCount(), {}}}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(pair.fit({{0, {surface.mesh.faceCount(), {1, 0, 0}}}}),
              FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(pair.fit({{0, {0, {1, 0, 0}}, -1}}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(pair.fit({{0, {0, {1, 0, 0}}, NAN}}), FailsWith(Reason::kInvalidOption));
  HomeomorphismOptions options;
  options.smoothing = 0;
  EXPECT_THAT(pair.fit({}, options), FailsWith(Reason::kInvalidOption));
  options = {};
  options.coarse_vertices = 3;
  EXPECT_THAT(pair.fit({}, options), FailsWith(Reason::kInvalidOption));
  std::swap(pair.start[0], pair.start[5]);
  EXPECT_THAT(pair.fit({}), FailsWith(Reason::kFoldedMap));
  pair.start.pop_back();
  EXPECT_THAT(pair.fit({}), FailsWith(Reason::kInvalidOption));
}

/// A disk with a cap, mapped to the northern half of the sphere, on itself.
struct DiskOnItself {
  SplitSurface split;
  TriangleMesh capped;
  Points3 points;
  SphereLocator sphere;
  DiskRim rim;

  static DiskOnItself make(int resolution) {
    Context context;
    SplitSurface split = *SplitSurface::make(surfaces::mesh(shield(resolution, 3)));
    TriangleMesh capped = *cappedDisk(split.mesh());
    Points3 points = *conformalHemisphere(context, split.mesh(), capped, true);
    return {std::move(split), std::move(capped), std::move(points)};
  }

  DiskOnItself(SplitSurface parts, TriangleMesh closed, Points3 there)
      : split(std::move(parts)),
        capped(std::move(closed)),
        points(std::move(there)),
        sphere(*SphereLocator::make(capped.connectivity(), points)),
        rim(capped.connectivity(), points, capped.positions()) {}
  // The locator refers to the surface.
  DiskOnItself(const DiskOnItself&) = delete;
  DiskOnItself& operator=(const DiskOnItself&) = delete;

  Index pole() const { return capped.vertexCount() - 1; }
  bool isRim(Index v) const { return split.mesh().connectivity().isBoundaryVertex(v); }

  std::vector<VertexTarget> itself() const {
    std::vector<VertexTarget> targets;
    for (Index v = 0; v < pole(); ++v) {
      targets.push_back({v, isRim(v) ? rim.at(points[v]) : vertexPoint(capped.connectivity(), v)});
    }
    return targets;
  }

  Result<Homeomorphism> fit(const std::vector<VertexTarget>& targets,
                            const std::vector<ExactVertex>& exact = {}) const {
    Context context;
    return fitHomeomorphism(context,
                            {capped.connectivity(), capped.positions(), points, pole(), exact},
                            {sphere, capped.positions(), pole()}, targets);
  }

  double error(const Homeomorphism& map) const {
    double sum = 0;
    for (Index v = 0; v < pole(); ++v) {
      sum += (spacePoint(capped.connectivity(), capped.positions(), map.images[v]) -
              capped.positions()[v])
                 .norm();
    }
    return sum / pole() / std::sqrt(split.mesh().area());
  }

  /// No fold; the boundary on edges of the boundary, and on the equator to the last bit.
  void expectOneToOne(const Homeomorphism& map) const {
    EXPECT_EQ(foldedFaces(capped.connectivity(), map.points), 0);
    for (Index v = 0; v < pole(); ++v) {
      if (!isRim(v)) {
        EXPECT_GT(map.points[v].z(), 0);
        continue;
      }
      EXPECT_EQ(map.points[v].z(), 0);
      const Index i = rim.edgeOf(map.images[v]);
      ASSERT_NE(i, kNone);
      EXPECT_EQ(map.images[v].barycentric[(rim.halfedge(i) + 2) % 3], 0);
    }
  }
};

TEST(DiskHomeomorphism, TargetsThatAreTheIdentityGiveTheIdentity) {
  const DiskOnItself disk = DiskOnItself::make(12);
  const auto map = disk.fit(disk.itself());
  ASSERT_OK(map);
  EXPECT_LT(disk.error(*map), 1e-13);
  EXPECT_TRUE(map->began_at_targets);
  EXPECT_NEAR(map->report.max_dilatation, 1, 1e-5);
  disk.expectOneToOne(*map);
}

TEST(DiskHomeomorphism, NeverFoldsWhateverTheTargets) {
  const DiskOnItself disk = DiskOnItself::make(10);
  RandomSphere random(11);
  for (int trial = 0; trial < 3; ++trial) {
    std::vector<VertexTarget> targets = disk.itself();
    for (VertexTarget& target : targets) {
      Eigen::Vector3d anywhere = random.direction();
      anywhere.z() = std::abs(anywhere.z());
      // In the first trial those of the boundary are inside, and brought there.
      const bool on_rim = disk.isRim(target.vertex) && trial > 0;
      target.point = on_rim ? disk.rim.at(anywhere) : disk.sphere.locate(anywhere);
    }
    const auto map = disk.fit(targets);
    ASSERT_OK(map);
    disk.expectOneToOne(*map);
  }
}

TEST(DiskHomeomorphism, TakesTheBoundaryBackThatWasPushedAlong) {
  // The targets of the boundary are an edge or two ahead, those inside where they belong: the
  // distortion keeps the boundary from going all the way, yet it moves, and moves ahead.
  const DiskOnItself disk = DiskOnItself::make(12);
  std::vector<VertexTarget> targets = disk.itself();
  const double ahead = 0.03 * disk.rim.length();
  for (VertexTarget& target : targets) {
    if (!disk.isRim(target.vertex)) continue;
    target.point = disk.rim.atPlace(disk.rim.place(target.point) + ahead);
  }
  const auto map = disk.fit(targets);
  ASSERT_OK(map);
  disk.expectOneToOne(*map);
  double sum = 0;
  for (Index i = 0; i < disk.rim.size(); ++i) {
    const Index v = disk.capped.connectivity().tail(disk.rim.halfedge(i));
    sum += std::remainder(disk.rim.place(map->images[v]) - disk.rim.begin(i), disk.rim.length());
  }
  EXPECT_GT(sum / disk.rim.size(), 0.05 * ahead);
  EXPECT_LT(sum / disk.rim.size(), ahead);
}

TEST(DiskHomeomorphism, MeetsExactTargets) {
  const DiskOnItself disk = DiskOnItself::make(12);
  std::vector<VertexTarget> targets = disk.itself();
  const SphereDomain domain(disk.sphere, disk.capped.positions(), 1, disk.pole());
  std::vector<ExactVertex> exact;
  Index on_rim = 0, inside = 0;
  while (!disk.isRim(on_rim)) ++on_rim;
  while (disk.points[inside].z() < 0.5) ++inside;
  for (const Index v : {on_rim, inside}) {
    Image image = disk.isRim(v) ? domain.onRim(disk.points[v]) : domain.at(disk.points[v]);
    image = disk.isRim(v) ? domain.walkRim(image, 0.2) : domain.walk(image, {0.2, 0.1, 0});
    targets[v].point = image.point;
    exact.push_back({v, "a mark"});
  }
  const auto map = disk.fit(targets, exact);
  ASSERT_OK(map);
  disk.expectOneToOne(*map);
  for (const ExactVertex& mark : exact) {
    const Eigen::Vector3d there =
        spherePoint(disk.capped.connectivity(), disk.points, targets[mark.vertex].point);
    EXPECT_LT((map->points[mark.vertex] - there).norm(), 1e-15);
  }
}

TEST(DiskHomeomorphism, NeedsPolesOfBothOrNone) {
  const DiskOnItself disk = DiskOnItself::make(4);
  Context context;
  EXPECT_THAT(
      fitHomeomorphism(
          context, {disk.capped.connectivity(), disk.capped.positions(), disk.points, disk.pole()},
          {disk.sphere, disk.capped.positions()}, {}),
      FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(fitHomeomorphism(
                  context, {disk.capped.connectivity(), disk.capped.positions(), disk.points, 0},
                  {disk.sphere, disk.capped.positions(), 0}, {}),
              FailsWith(Reason::kInvalidOption));
}

TEST(Homeomorphism, TetrahedronHasNothingToBeThinned) {
  const Points3 corners = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  TriangleSoup soup{corners, {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}}};
  Points3 points = corners;
  for (Eigen::Vector3d& p : points) p.normalize();
  const MappedSurface surface{surfaces::mesh(soup), points};
  ASSERT_EQ(foldedFaces(surface.surface(), points), 0);
  const Pair pair(surface, surface);
  const auto map = pair.fit(pair.targets(0, 0, 1));
  ASSERT_OK(map);
  EXPECT_LT(pair.error(map->images), 1e-15);
}

TEST(Homeomorphism, BringsALongLimbedSurfaceBackToItself) {
  MODULI_NEED_SHARED_MESH(path, "closed_g0/alec__spot.obj");
  const MappedSurface surface = surfaces::mappedMesh(path);
  Pair pair(surface, surface);
  for (Eigen::Vector3d& p : pair.start) {
    p = ballTranslate({0.1, 0.05, -0.1}, p).normalized();
  }
  ASSERT_EQ(foldedFaces(surface.surface(), pair.start), 0);
  const std::vector<VertexTarget> targets = pair.targets(0.03, 0.05, 2);
  const auto map = pair.fit(targets);
  ASSERT_OK(map);
  EXPECT_EQ(foldedFaces(surface.surface(), map->points), 0);
  EXPECT_LT(pair.error(map->images), pair.targetError(targets) / 4);
  EXPECT_LT(map->report.dilatation_95, 1.5);
}

}  // namespace
}  // namespace moduli
