#include "core/spherical/curve_landmarks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "tests/core/mesh/shapes.h"
#include "tests/core/spherical/sphere_testing.h"

namespace moduli {
namespace {

using surfaces::MappedSurface;

/// A path along edges from vertex to vertex, always to the neighbour nearest to the goal.
std::vector<Index> pathBetween(const MappedSurface& map, Index from, Index to) {
  std::vector<Index> path = {from};
  while (path.back() != to) {
    Index best = path.back();
    Index h = map.surface().outgoing(path.back());
    do {
      const Index v = map.surface().head(h);
      if ((map.points[v] - map.points[to]).norm() < (map.points[best] - map.points[to]).norm()) {
        best = v;
      }
      h = map.surface().rotate(h);
    } while (h != map.surface().outgoing(path.back()));
    if (best == path.back()) break;
    path.push_back(best);
  }
  return path;
}

Eigen::Vector3d positionOf(const TriangleMesh& mesh, const SurfacePoint& point) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int c = 0; c < 3; ++c) {
    sum += point.barycentric[c] * mesh.positions()[mesh.connectivity().face(point.face)[c]];
  }
  return sum;
}

TEST(ResampleCurve, TakesEqualSharesOfLength) {
  // Around the rim of an octahedron's upper half: edges of length sqrt 2.
  const TriangleMesh mesh = surfaces::mesh(shapes::octahedron());
  const Connectivity& surface = mesh.connectivity();
  const std::vector<double> lengths = mesh.edgeLengths();
  const Index start = surface.face(0)[0], middle = surface.face(0)[1], end = surface.face(0)[2];
  const auto points = resampleCurve(surface, lengths, {start, middle, end}, 5);
  ASSERT_OK(points);
  const auto at = [&](Index v) { return mesh.positions()[v]; };
  const std::vector<Eigen::Vector3d> expected = {at(start), 0.5 * (at(start) + at(middle)),
                                                 at(middle), 0.5 * (at(middle) + at(end)), at(end)};
  for (int i = 0; i < 5; ++i) {
    EXPECT_LT((positionOf(mesh, (*points)[i]) - expected[i]).norm(), 1e-15);
  }
  const auto closed = resampleCurve(surface, lengths, {start, middle, end}, 2, true);
  ASSERT_OK(closed);
  EXPECT_LT((positionOf(mesh, (*closed)[1]) - expected[3]).norm(), 1e-15);
}

TEST(ResampleCurve, KeepsEqualStepsOnAnIrregularPath) {
  const MappedSurface map = surfaces::roundSphere(10, 6);
  const std::vector<double> lengths = map.mesh.edgeLengths();
  const std::vector<Index> path =
      pathBetween(map, 0, surfaces::nearestVertex(map.points, -map.points[0]));
  ASSERT_GT(path.size(), 10U);
  double total = 0;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    total += (map.mesh.positions()[path[i]] - map.mesh.positions()[path[i + 1]]).norm();
  }
  // Points so dense that few steps turn a corner: chords sum to the length but for the corners.
  const int count = 5000;
  const auto points = resampleCurve(map.surface(), lengths, path, count);
  ASSERT_OK(points);
  int short_steps = 0;
  for (int i = 0; i + 1 < count; ++i) {
    const double step =
        (positionOf(map.mesh, (*points)[i]) - positionOf(map.mesh, (*points)[i + 1])).norm();
    EXPECT_LT(step, total / (count - 1) * (1 + 1e-9));
    if (step < total / (count - 1) * (1 - 1e-9)) ++short_steps;
  }
  EXPECT_LE(short_steps, static_cast<int>(path.size()));
  // The other way round are the same places.
  const auto back =
      resampleCurve(map.surface(), lengths, std::vector<Index>(path.rbegin(), path.rend()), count);
  ASSERT_OK(back);
  for (int i = 0; i < count; i += 100) {
    EXPECT_LT(
        (positionOf(map.mesh, (*points)[i]) - positionOf(map.mesh, (*back)[count - 1 - i])).norm(),
        1e-12);
  }
}

TEST(ResampleCurve, FollowsBoundariesInBothDirections) {
  const TriangleMesh mesh = surfaces::mesh(shapes::disk());
  const Connectivity& surface = mesh.connectivity();
  Index rim = kNone;
  for (Index e = 0; e < surface.edgeCount() && rim == kNone; ++e) {
    if (surface.isBoundaryEdge(e)) rim = surface.halfedge(e);
  }
  ASSERT_NE(rim, kNone);
  const std::vector<double> lengths = mesh.edgeLengths();
  // Against the rim there is no halfedge that leaves: the one that arrives is walked backwards.
  for (const auto& [from, to] : {std::pair(surface.tail(rim), surface.head(rim)),
                                 std::pair(surface.head(rim), surface.tail(rim))}) {
    const auto points = resampleCurve(surface, lengths, {from, to}, 4);
    ASSERT_OK(points);
    for (int i = 0; i < 4; ++i) {
      const Eigen::Vector3d expected =
          (1 - i / 3.0) * mesh.positions()[from] + i / 3.0 * mesh.positions()[to];
      EXPECT_LT((positionOf(mesh, (*points)[i]) - expected).norm(), 1e-15);
    }
  }
}

TEST(ResampleCurve, NamesWhatIsNoPath) {
  const MappedSurface map = surfaces::roundSphere(4, 0);
  const std::vector<double> lengths = map.mesh.edgeLengths();
  const Index far = surfaces::nearestVertex(map.points, -map.points[0]);
  const auto refuses = [&](const std::vector<Index>& path, int count, const std::string& words) {
    const auto result = resampleCurve(map.surface(), lengths, path, count);
    EXPECT_THAT(result, FailsWith(Reason::kInvalidOption));
    EXPECT_THAT(result.status().message(), testing::HasSubstr(words));
  };
  refuses({0, far}, 3, "no edge from vertex 0 to vertex " + std::to_string(far));
  refuses({0, 0}, 3, "no edge from vertex 0 to vertex 0");
  refuses({0, -1}, 3, "no vertex -1");
  refuses({0}, 3, "two vertices");
  refuses({}, 3, "two vertices");
  refuses({0, far}, 1, "not 1");
}

TEST(CurveLandmarks, OfASurfaceWithItselfAreWhereTheyAre) {
  const MappedSurface map = surfaces::roundSphere(8, 6);
  const std::vector<double> lengths = map.mesh.edgeLengths();
  const MeasuredSurface metric{map.surface(), lengths};
  const Index goal = surfaces::nearestVertex(map.points, {0, 0, 1});
  const Index other = surfaces::nearestVertex(map.points, {0, 1, 0});
  const std::vector<Index> one = pathBetween(map, 0, goal), two = pathBetween(map, other, goal);
  ASSERT_EQ(one.back(), goal);
  ASSERT_EQ(two.back(), goal);
  const auto landmarks =
      curveLandmarks(metric, metric, map.points, {{one, one, 5, false}, {two, two, 7, false}});
  ASSERT_OK(landmarks);
  EXPECT_EQ(landmarks->size(), 11U);  // Their common end counts once.
  for (const Landmark& landmark : *landmarks) {
    EXPECT_LT((spherePoint(map.surface(), map.points, landmark.point) - landmark.target).norm(),
              1e-15);
  }
  const auto wrong = curveLandmarks(metric, metric, map.points, {{one, {0, goal}, 5, false}});
  EXPECT_THAT(wrong.status().message(), testing::HasSubstr("curve 0 of the second surface"));
}

TEST(CurveLandmarks, BringCurvesOfOneSurfaceToThoseOfAnother) {
  // A curve on the round sphere is to lie where one runs on another triangulation, turned a little.
  const MappedSurface a = surfaces::roundSphere(12, 1), b = surfaces::roundSphere(10, 2);
  const std::vector<double> lengths_a = a.mesh.edgeLengths(), lengths_b = b.mesh.edgeLengths();
  const auto curve = [](const MappedSurface& map, double turn) {
    const Index from = surfaces::nearestVertex(map.points, {std::cos(turn), std::sin(turn), -0.3});
    const Index to = surfaces::nearestVertex(map.points, {std::cos(turn), std::sin(turn), 0.6});
    return pathBetween(map, from, to);
  };
  const auto landmarks = curveLandmarks(
      {a.surface(), lengths_a}, {b.surface(), lengths_b}, b.points,
      {{curve(a, 0), curve(b, 0.3), 6, false}, {curve(a, 2), curve(b, 1.8), 6, false}});
  ASSERT_OK(landmarks);
  Context context;
  const auto result = meetLandmarks(context, a.surface(), lengths_a, a.points, *landmarks);
  ASSERT_OK(result);
  EXPECT_EQ(result->quality.flipped_faces, 0);
  for (const double distance : result->distances) EXPECT_LT(distance, 1e-12);
}

}  // namespace
}  // namespace moduli
