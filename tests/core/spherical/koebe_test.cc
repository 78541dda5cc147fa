#include "core/spherical/koebe.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <numeric>
#include <random>

#include "core/mesh/prepare.h"
#include "core/mesh/read.h"
#include "core/spherical/cap_loops.h"
#include "core/spherical/sphere_map.h"
#include "core/topology/surface_topology.h"
#include "tests/core/spherical/plane_domains.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

using Complex = std::complex<double>;
using Points = std::vector<Complex>;
using Loops = std::vector<std::vector<Index>>;

/// Normalized as koebe normalizes: the hole around 0 is the largest, the next one lies on the axis.
const std::vector<Circle> kThreeHoles = {{0, 1}, {0, 0.25}, {0.6, 0.12}, {{-0.2, 0.65}, 0.08}};

/// One to one on the disk with these holes: its derivative stays within 0.8 of 1, and the images of
/// the circles, near ellipses, do not meet. It is not so on the disk itself: with poles in the
/// holes it makes none of them round together with the outer loop.
Complex univalent(Complex z) {
  Complex sum = z + 0.1 * z * z;
  for (std::size_t k = 1; k < kThreeHoles.size(); ++k) {
    const Circle& hole = kThreeHoles[k];
    sum += std::polar(0.3 * hole.radius * hole.radius, 1.0 + static_cast<double>(k)) /
           (z - hole.center);
  }
  return sum;
}

/// One to one on the unit disk: its derivative stays within 1/2 of 1.
Complex univalentOnDisk(Complex z) {
  return z + 0.15 * z * z + 0.05 * z * z * z;
}

Points deformed(Points points, const std::function<Complex(Complex)>& map) {
  for (Complex& z : points) z = map(z);
  return points;
}

Result<CircleDomain> run(const Points& points, const Loops& loops,
                         const KoebeOptions& options = {}) {
  Context context;
  return koebe(context, points, loops, options);
}

double farthest(const Points& a, const Points& b) {
  double distance = 0;
  for (std::size_t k = 0; k < a.size(); ++k) distance = std::max(distance, std::abs(a[k] - b[k]));
  return distance;
}

double difference(const std::vector<Circle>& a, const std::vector<Circle>& b) {
  double largest = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    largest = std::max(
        {largest, std::abs(a[k].center - b[k].center), std::abs(a[k].radius - b[k].radius)});
  }
  return largest;
}

// Check E10: where the holes are, at order 2.5 in the steps between points (measured: 2.5 to 2.85),
// second order being what polygons are good for.
TEST(Koebe, RecoversRoundHolesFromAConformalImage) {
  std::vector<double> circles, points;
  for (const double h : {0.05, 0.025, 0.0125}) {
    const PlaneDomain domain = placePoints(kThreeHoles, h, 0.06);
    const auto result = run(deformed(domain.points, univalent), domain.loops);
    ASSERT_OK(result);
    EXPECT_EQ(result->centered, 1);
    EXPECT_EQ(result->aligned, 2);
    circles.push_back(difference(result->circles, kThreeHoles));
    points.push_back(farthest(result->points, domain.points));
  }
  RecordProperty("circles", std::to_string(circles[2]));
  EXPECT_LT(circles[2], 1e-4);
  EXPECT_LT(points[2], 1e-4);
  for (const auto& errors : {circles, points}) {
    EXPECT_GT(std::log2(errors[0] / errors[2]) / 2, 2.2);
  }
}

// With sides in parts the curves follow the polygons, whose distance from the circles' images is of
// second order.
TEST(Koebe, RecoversRoundHolesFromPolygonsAtSecondOrder) {
  std::vector<double> errors;
  for (const double h : {0.05, 0.0125}) {
    const PlaneDomain domain = placePoints(kThreeHoles, h, 0.1);
    const auto result = run(deformed(domain.points, univalent), domain.loops, {1e-10, 100, 3});
    ASSERT_OK(result);
    EXPECT_EQ(result->parts, std::vector<int>(4, 3));
    errors.push_back(farthest(result->points, domain.points));
  }
  EXPECT_NEAR(std::log2(errors[0] / errors[1]) / 2, 2, 0.25);
}

TEST(Koebe, LeavesACircleDomainAlone) {
  const PlaneDomain domain = triangulateDomain(kThreeHoles, 0.15);
  const auto result =
      run(deformed(domain.points, [](Complex z) { return Complex(3, 4) * z + 7.0; }), domain.loops);
  ASSERT_OK(result);
  // Unturned by its second hole. Rounding of some hundred steps.
  EXPECT_LT(difference(result->circles, kThreeHoles), 1e-11);
  EXPECT_LT(farthest(result->points, domain.points), 1e-11);
  EXPECT_EQ(result->history.size(), 1U);
}

TEST(Koebe, PutsPointsOnTheirCirclesAndKeepsTheOthersBetween) {
  const PlaneDomain domain = triangulateDomain(kThreeHoles, 0.1);
  const auto result = run(deformed(domain.points, univalent), domain.loops);
  ASSERT_OK(result);
  std::vector<int> loop_of(domain.points.size(), -1);
  for (std::size_t k = 0; k < domain.loops.size(); ++k) {
    for (const Index v : domain.loops[k]) {
      loop_of[v] = static_cast<int>(k);
      EXPECT_NEAR(result->circles[k].distance(result->points[v]), 0, 1e-15);
    }
  }
  for (std::size_t v = 0; v < domain.points.size(); ++v) {
    if (loop_of[v] >= 0) continue;
    EXPECT_LT(std::abs(result->points[v]), 1);
    for (std::size_t k = 1; k < result->circles.size(); ++k) {
      EXPECT_GT(result->circles[k].distance(result->points[v]), 0);
    }
  }
  EXPECT_EQ(result->circles[0].center, Complex(0));
  EXPECT_EQ(result->circles[0].radius, 1);
  EXPECT_EQ(result->circles[1].center, Complex(0));
  EXPECT_EQ(result->circles[2].center.imag(), 0);
}

// Each map is one of a curve through the points that Moebius maps carry along, up to the place
// where it starts; so the bound is the error of the domain itself.
TEST(Koebe, DoesNotDependOnMoebiusMapsOfThePlane) {
  std::vector<double> errors;
  for (const double h : {0.05, 0.0125}) {
    const PlaneDomain domain = placePoints(kThreeHoles, h, 0.06);
    const Points plane = deformed(domain.points, univalent);
    const auto one = run(plane, domain.loops);
    const auto other = run(
        deformed(
            plane,
            [](Complex z) { return (Complex(2, 1) * z + 5.0) / (Complex(0.3, 0.3) * z + 1.0); }),
        domain.loops);
    ASSERT_OK(one);
    ASSERT_OK(other);
    errors.push_back(farthest(one->points, other->points));
    EXPECT_LT(difference(one->circles, other->circles), errors.back());
  }
  EXPECT_GT(std::log2(errors[0] / errors[1]) / 2, 1.9);
  EXPECT_LT(errors[1], 2e-4);
}

TEST(Koebe, MirrorsWithThePlaneAndForgetsNumbers) {
  const PlaneDomain domain = placePoints(kThreeHoles, 0.0125, 0.06);
  const Points plane = deformed(domain.points, univalent);
  // Curves between the points that start elsewhere: twice the error of the domain at most.
  const auto one = run(plane, domain.loops);
  ASSERT_OK(one);

  const auto mirrored = run(deformed(plane, [](Complex z) { return std::conj(z); }), domain.loops);
  ASSERT_OK(mirrored);
  EXPECT_LT(
      farthest(deformed(mirrored->points, [](Complex z) { return std::conj(z); }), one->points),
      2e-4);

  std::vector<Index> number(plane.size());
  std::iota(number.begin(), number.end(), 0);
  std::shuffle(number.begin(), number.end(), std::mt19937(11));
  Points shuffled(plane.size());
  for (std::size_t v = 0; v < plane.size(); ++v) shuffled[number[v]] = plane[v];
  Loops loops = {domain.loops[0], domain.loops[3], domain.loops[1], domain.loops[2]};
  for (std::size_t k = 0; k < loops.size(); ++k) {
    for (Index& v : loops[k]) v = number[v];
    std::rotate(loops[k].begin(), loops[k].begin() + 2 + k, loops[k].end());
    if (k % 2 == 1) std::reverse(loops[k].begin(), loops[k].end());
  }
  const auto other = run(shuffled, loops);
  ASSERT_OK(other);
  EXPECT_EQ(other->centered, 2);
  EXPECT_EQ(other->aligned, 3);
  double distance = 0;
  for (std::size_t v = 0; v < plane.size(); ++v) {
    distance = std::max(distance, std::abs(other->points[number[v]] - one->points[v]));
  }
  EXPECT_LT(distance, 2e-4);
}

// Between the circles |z| = 1 and |z - 0.3| = 0.4, which centred has a radius known by hand.
TEST(Koebe, MakesOneHoleConcentric) {
  const std::vector<Circle> eccentric = {{0, 1}, {{0, 0.3}, 0.4}};
  const auto map = [](Complex z) {
    return univalentOnDisk(z) + Complex(0.03, 0.03) / (z - Complex(0, 0.3));
  };
  double before = 0;
  for (const double h : {0.1, 0.05, 0.025}) {
    const PlaneDomain domain = placePoints(eccentric, h, 0.1);
    const auto result = run(deformed(domain.points, map), domain.loops);
    ASSERT_OK(result);
    EXPECT_EQ(result->circles[1].center, Complex(0));
    EXPECT_LT(std::abs(result->points[domain.loops[0][0]] - 1.0), 1e-15);
    const double error = std::abs(result->circles[1].radius - centeredRadius(eccentric[1]));
    if (before > 0) {
      EXPECT_GT(std::log2(before / error), 1.9);
    }
    before = error;
  }
}

TEST(Koebe, MapsADiskToTheDisk) {
  const PlaneDomain domain = triangulateDomain({{0, 1}}, 0.1);
  const auto result = run(deformed(domain.points, univalentOnDisk), domain.loops);
  ASSERT_OK(result);
  EXPECT_EQ(result->centered, kNone);
  EXPECT_EQ(result->aligned, kNone);
  EXPECT_EQ(result->history.size(), 1U);
  for (const Index v : domain.loops[0]) EXPECT_NEAR(std::abs(result->points[v]), 1, 1e-15);
}

TEST(Koebe, ConvergesGeometrically) {
  const PlaneDomain domain = triangulateDomain(kThreeHoles, 0.1);
  // Holes that are far from round: the smooth image of a domain with stars for holes.
  Points plane = domain.points;
  for (std::size_t k = 1; k < 4; ++k) {
    for (const Index v : domain.loops[k]) {
      const Complex spoke = plane[v] - kThreeHoles[k].center;
      plane[v] = kThreeHoles[k].center + spoke * (0.75 + 0.2 * std::cos(3 * std::arg(spoke)));
    }
  }
  const auto result = run(plane, domain.loops);
  ASSERT_OK(result);
  ASSERT_GE(result->history.size(), 3U);
  for (std::size_t k = 1; k < result->history.size(); ++k) {
    EXPECT_LT(result->history[k], 0.3 * result->history[k - 1]);
  }
  EXPECT_LE(result->history.back(), 1e-10);
  EXPECT_GT(result->rate, 0);
  EXPECT_LT(result->rate, 0.3);
  EXPECT_THAT(run(plane, domain.loops, {1e-10, 1, 1}), FailsWith(Reason::kNoConvergence));
}

/// A square with a triangular hole, and points that lie close to its sides.
struct TightPoints {
  Points points;
  Loops loops;
  explicit TightPoints(double gap) {
    const auto add = [&](const Points& corners, int parts) {
      loops.emplace_back();
      for (std::size_t k = 0; k < corners.size(); ++k) {
        for (int i = 0; i < parts; ++i) {
          const Complex step = corners[(k + 1) % corners.size()] - corners[k];
          loops.back().push_back(static_cast<Index>(points.size()));
          points.push_back(corners[k] + step * (static_cast<double>(i) / parts));
        }
      }
    };
    add({{2, 2}, {-2, 2}, {-2, -2}, {2, -2}}, 8);
    const Points triangle = {std::polar(1.0, 0.3), std::polar(1.0, 2.6), std::polar(1.0, 4.1)};
    add(triangle, 1);
    for (int k = 0; k < 3; ++k) {
      const Complex step = triangle[(k + 1) % 3] - triangle[k];
      points.push_back(triangle[k] + step * Complex(0.5, -gap));
    }
  }
};

TEST(Koebe, CutsSidesWherePointsAreCloseToThem) {
  const TightPoints tight(0.01);
  const auto result = run(tight.points, tight.loops);
  ASSERT_OK(result);
  EXPECT_GT(result->parts[1], 1);
  for (std::size_t v = tight.points.size() - 3; v < tight.points.size(); ++v) {
    EXPECT_GT(result->circles[1].distance(result->points[v]), 0);
  }
  const TightPoints loose(0.4);
  const auto other = run(loose.points, loose.loops);
  ASSERT_OK(other);
  EXPECT_EQ(other->parts[1], 1);
}

TEST(Koebe, RefusesPointsBeyondALoop) {
  const TightPoints beyond(-0.05);
  EXPECT_THAT(run(beyond.points, beyond.loops), FailsWith(Reason::kFoldedMap));
  TightPoints outside(0.1);
  outside.points.back() = {2.5, 0};
  EXPECT_THAT(run(outside.points, outside.loops), FailsWith(Reason::kFoldedMap));
}

TEST(Koebe, RefusesWhatIsNoDomain) {
  const TightPoints good(0.1);
  const auto with = [&](const Loops& loops) { return run(good.points, loops); };
  const std::vector<Index>& outer = good.loops[0];
  EXPECT_THAT(with({}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(with({outer, {32, 33}}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(with({outer, {32, 33, -1}}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(with({outer, {32, 33, 99}}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(with({outer, {32, 33, 0}}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(run(good.points, good.loops, {0, 10, 1}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(run(good.points, good.loops, {1e-10, 0, 1}), FailsWith(Reason::kInvalidOption));
  for (const int parts : {0, 33}) {
    EXPECT_THAT(run(good.points, good.loops, {1e-10, 9, parts}), FailsWith(Reason::kInvalidOption));
  }
  Points infinite = good.points;
  infinite[3] = std::numeric_limits<double>::infinity();
  EXPECT_THAT(run(infinite, good.loops), FailsWith(Reason::kInvalidOption));
}

TEST(Koebe, StopsWhenCancelled) {
  const PlaneDomain domain = triangulateDomain(kThreeHoles, 0.2);
  Context context;
  CancelToken token;
  context.setCancelToken(token);
  token.cancel();
  EXPECT_THAT(koebe(context, domain.points, domain.loops), FailsWith(Reason::kCancelled));
}

/// The plane domain of a mesh of genus 0: capped, mapped to the sphere, seen from the apex over its
/// longest loop.
struct OpenedSphere {
  Points plane;
  Loops loops;
};

Result<OpenedSphere> openedSphere(Context& context, const TriangleMesh& mesh) {
  const Connectivity& surface = mesh.connectivity();
  const std::vector<double> lengths = mesh.edgeLengths();
  auto loops = computeTopology(surface).boundary_loops;
  const auto length = [&](const std::vector<Index>& loop) {
    double sum = 0;
    for (const Index h : loop) sum += lengths[surface.edge(h)];
    return sum;
  };
  std::sort(loops.begin(), loops.end(),
            [&](const auto& a, const auto& b) { return length(a) > length(b); });
  ASSIGN_OR_RETURN(const CappedSurface capped, capLoops(surface, lengths, loops));
  ASSIGN_OR_RETURN(const SphereMap sphere,
                   mapToSphereLinear(context, capped.connectivity, capped.lengths));
  const Eigen::Quaterniond turn =
      Eigen::Quaterniond::FromTwoVectors(sphere.points[capped.apex[0]], Eigen::Vector3d::UnitZ());
  OpenedSphere opened;
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    const Eigen::Vector3d p = turn * sphere.points[v];
    opened.plane.push_back(Complex(p.x(), -p.y()) / (1 - p.z()));
  }
  for (const std::vector<Index>& loop : loops) {
    opened.loops.emplace_back();
    for (const Index h : loop) opened.loops.back().push_back(surface.tail(h));
  }
  return opened;
}

Index turnedFaces(const TriangleMesh& mesh, const Points& points) {
  Index turned = 0;
  for (const Triangle& face : mesh.connectivity().faces()) {
    const Complex a = points[face[1]] - points[face[0]];
    const Complex b = points[face[2]] - points[face[0]];
    if (!((std::conj(a) * b).imag() > 0)) ++turned;
  }
  return turned;
}

class KoebeOnMeshes : public testing::TestWithParam<const char*> {};

TEST_P(KoebeOnMeshes, MakesAllLoopsRound) {
  MODULI_NEED_SHARED_MESH(path, GetParam());
  Context context;
  const auto soup = readMeshFile(context, path);
  ASSERT_OK(soup);
  const auto prepared = prepareMesh(context, *soup, {});
  ASSERT_OK(prepared);
  const auto opened = openedSphere(context, prepared->mesh);
  ASSERT_OK(opened);
  const auto result = koebe(context, opened->plane, opened->loops);
  ASSERT_OK(result);
  EXPECT_LE(result->history.back(), 1e-10);
  EXPECT_EQ(result->circles.size(), opened->loops.size());
  EXPECT_LE(result->rate, 0.1);
  // Three corners on the circle of a hole, in the order of its loop: the straight triangle between
  // them lies within the hole, turned over, whatever the map.
  std::vector<int> loop_of(result->points.size(), -1);
  for (std::size_t k = 1; k < opened->loops.size(); ++k) {
    for (const Index v : opened->loops[k]) loop_of[v] = static_cast<int>(k);
  }
  const std::vector<Triangle>& faces = prepared->mesh.connectivity().faces();
  const auto inscribed = std::count_if(faces.begin(), faces.end(), [&](const Triangle& face) {
    const int k = loop_of[face[0]];
    return k >= 0 && loop_of[face[1]] == k && loop_of[face[2]] == k;
  });
  EXPECT_LE(turnedFaces(prepared->mesh, result->points), inscribed);
  RecordProperty("seconds", std::to_string(context.timing().at("circles")));
}

INSTANTIATE_TEST_SUITE_P(Shared, KoebeOnMeshes,
                         testing::Values("multi_boundary/odedstein__plane_holes.obj",
                                         "multi_boundary/cfwen__bunny.off",
                                         "multi_boundary/gpeyre__pipes.off",
                                         "multi_boundary/libigl-data__halftunnel.off",
                                         "multi_boundary/gpeyre__nefertiti-entire.off"));

}  // namespace
}  // namespace moduli
