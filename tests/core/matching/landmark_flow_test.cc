#include "core/matching/landmark_flow.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iostream>

#include "core/intrinsic/edge_graph.h"
#include "core/matching/cover_inverse.h"
#include "core/matching/harmonic_match.h"
#include "tests/core/matching/cover_samples.h"
#include "tests/core/matching/renumbered.h"

namespace moduli {
namespace {

/// The map that takes every vertex to itself.
CoverMap identity(const TriangleMesh& mesh, const CoverSurface& cover) {
  Context context;
  auto match = matchHarmonically(context, mesh.connectivity(), mesh.edgeLengths(), cover,
                                 vertexTargets(mesh, sameNumbers(mesh)), {1e-4});
  EXPECT_OK(match);
  return match->map;
}

/// Evenly spread, each to a vertex `way` from it, in roots of the area.
std::vector<CoverLandmark> spread(const TriangleMesh& mesh, Index count, double way, bool within) {
  const EdgeGraph graph(mesh.connectivity(), mesh.edgeLengths());
  std::vector<CoverLandmark> landmarks;
  for (const Index v : graph.farthestSamples({}, count).vertices) {
    const Index to = graph.within(v, way * std::sqrt(mesh.area())).back().first;
    CoverLandmark landmark{vertexPoint(mesh.connectivity(), v),
                           vertexPoint(mesh.connectivity(), to),
                           "mark " + std::to_string(landmarks.size())};
    if (within) {
      landmark.point.barycentric = {0.5, 0.3, 0.2};
      landmark.target.barycentric = {0.1, 0.3, 0.6};
    }
    landmarks.push_back(landmark);
  }
  return landmarks;
}

LandmarkFlow flowed(const TriangleMesh& mesh, const CoverSurface& cover, const CoverMap& map,
                    const std::vector<CoverLandmark>& landmarks) {
  Context context;
  auto flow = flowToLandmarks(context, mesh.connectivity(), cover, map, landmarks);
  EXPECT_OK(flow);
  expectConsistent(mesh.connectivity(), cover, flow->map);
  return *std::move(flow);
}

/// In roots of the area.
double largestError(const TriangleMesh& mesh, const CoverSurface& cover, const CoverMap& map,
                    const std::vector<CoverLandmark>& landmarks) {
  double largest = 0;
  for (const CoverLandmark& landmark : landmarks) {
    const SurfacePoint image = imageOf(mesh.connectivity(), cover, map, landmark.point);
    largest = std::max(largest, (spaceAt(mesh, image) - spaceAt(mesh, landmark.target)).norm());
  }
  return largest / std::sqrt(mesh.area());
}

TEST(LandmarkFlow, MeetsVerticesAndPointsWithinFaces) {
  for (const TriangleSoup& soup : {lumpyTorus(12, 2), lumpyPlate(6, 2)}) {
    const TriangleMesh mesh = meshOf(soup);
    const CoverSurface cover = coverOf(mesh);
    const CoverMap map = identity(mesh, cover);
    for (const bool within : {false, true}) {
      const auto landmarks = spread(mesh, 6, 0.08, within);
      EXPECT_GT(largestError(mesh, cover, map, landmarks), 0.05);
      const LandmarkFlow flow = flowed(mesh, cover, map, landmarks);
      EXPECT_TRUE(flow.met);
      const double error = largestError(mesh, cover, flow.map, landmarks);
      std::cout << flow.steps << " steps, error " << error << "\n";
      // 1e-7 of edges of 0.05.
      EXPECT_LE(error, 1e-8);
    }
  }
}

TEST(LandmarkFlow, LeavesAMapAloneThatMeetsThem) {
  const TriangleMesh mesh = meshOf(lumpyPlate(4, 2));
  const CoverSurface cover = coverOf(mesh);
  const CoverMap map = identity(mesh, cover);
  std::vector<CoverLandmark> landmarks;
  for (const Index v : {3, 100, 400}) {
    landmarks.push_back({vertexPoint(mesh.connectivity(), v), map.images[v], ""});
  }
  const LandmarkFlow flow = flowed(mesh, cover, map, landmarks);
  EXPECT_TRUE(flow.met);
  EXPECT_EQ(flow.steps, 0);
  for (Index v = 0; v < mesh.vertexCount(); ++v) {
    EXPECT_LE((spaceAt(mesh, flow.map.images[v]) - spaceAt(mesh, map.images[v])).norm(), 1e-12);
  }
}

TEST(LandmarkFlow, MovesOnlyWhatIsNear) {
  // Six ways, in the cover's metric, which is that of space but for a factor that varies by less
  // than 2 around a landmark of a torus.
  const TriangleMesh mesh = meshOf(lumpyTorus(24, 2));
  const CoverSurface cover = coverOf(mesh);
  const CoverMap map = identity(mesh, cover);
  const auto landmarks = spread(mesh, 1, 0.03, false);
  const LandmarkFlow flow = flowed(mesh, cover, map, landmarks);
  const double way = largestError(mesh, cover, map, landmarks) * std::sqrt(mesh.area());
  double nearest_rest = 1e300, farthest_moved = 0;
  for (Index v = 0; v < mesh.vertexCount(); ++v) {
    const Eigen::Vector3d before = spaceAt(mesh, map.images[v]);
    const double away = (before - spaceAt(mesh, landmarks[0].point)).norm();
    const bool moves = (spaceAt(mesh, flow.map.images[v]) - before).norm() > 1e-9;
    if (moves) {
      farthest_moved = std::max(farthest_moved, away);
    } else {
      nearest_rest = std::min(nearest_rest, away);
    }
  }
  std::cout << "way " << way << ", at rest from " << nearest_rest << ", moved up to "
            << farthest_moved << "\n";
  EXPECT_GT(nearest_rest, 2 * way);
  EXPECT_LT(farthest_moved, 14 * way);
}

TEST(LandmarkFlow, DoesNotDependOnNumberingPositionAndScale) {
  const TriangleSoup soup = lumpyPlate(4, 2);
  const Renumbered other = renumbered(moved(soup), 4);
  const TriangleMesh a = meshOf(soup), b = meshOf(other.soup);
  const CoverSurface to_a = coverOf(a), to_b = coverOf(b);
  const auto here = spread(a, 5, 0.05, false);
  std::vector<CoverLandmark> there;
  const auto vertexOf = [&](const SurfacePoint& point) {
    const Triangle& face = a.connectivity().face(point.face);
    for (int c = 0; c < 3; ++c) {
      if (point.barycentric[c] == 1) return face[c];
    }
    return kNone;
  };
  for (const CoverLandmark& landmark : here) {
    there.push_back({vertexPoint(b.connectivity(), other.image[vertexOf(landmark.point)]),
                     vertexPoint(b.connectivity(), other.image[vertexOf(landmark.target)]), ""});
  }
  const LandmarkFlow one = flowed(a, to_a, identity(a, to_a), here);
  const LandmarkFlow two = flowed(b, to_b, identity(b, to_b), there);
  const Eigen::AngleAxisd turn(1.1, Eigen::Vector3d(1, 2, -1).normalized());
  double apart = 0;
  for (Index v = 0; v < a.vertexCount(); ++v) {
    const Eigen::Vector3d moved_here =
        2 * (turn * spaceAt(a, one.map.images[v])) + Eigen::Vector3d(5, -3, 1);
    apart = std::max(apart, (moved_here - spaceAt(b, two.map.images[other.image[v]])).norm());
  }
  EXPECT_LT(apart, 1e-6);
}

TEST(LandmarkFlow, StopsBeforeAFoldAndTellsWhichLandmarksContradictEachOther) {
  for (const TriangleSoup& soup : {lumpyTorus(12, 2), lumpyPlate(4, 2)}) {
    const TriangleMesh mesh = meshOf(soup);
    const Connectivity& surface = mesh.connectivity();
    const CoverSurface cover = coverOf(mesh);
    // Two corners of a face stay, the third one goes beyond the edge between them; one far away.
    const auto& [a, b, c] = surface.face(40);
    const Index beyond = surface.head(Connectivity::next(surface.twin(3 * 40)));
    std::vector<CoverLandmark> landmarks = spread(mesh, 1, 0, false);
    for (const auto& [from, to] : {std::pair(a, a), std::pair(b, b), std::pair(c, beyond)}) {
      landmarks.push_back({vertexPoint(surface, from), vertexPoint(surface, to), ""});
    }
    const LandmarkFlow flow = flowed(mesh, cover, identity(mesh, cover), landmarks);
    EXPECT_FALSE(flow.met);
    ASSERT_EQ(flow.around.size(), 2U);
    EXPECT_GT(flow.around[0], 0U);
    EXPECT_LT(flow.around[0], flow.around[1]);
  }
}

TEST(LandmarkFlow, StopsWhenCancelled) {
  const TriangleMesh mesh = meshOf(lumpyPlate(2, 0));
  const CoverSurface cover = coverOf(mesh);
  const CoverMap map = identity(mesh, cover);
  Context context;
  CancelToken token;
  token.cancel();
  context.setCancelToken(token);
  EXPECT_THAT(
      flowToLandmarks(context, mesh.connectivity(), cover, map, spread(mesh, 2, 0.1, false)),
      FailsWith(Reason::kCancelled));
}

}  // namespace
}  // namespace moduli
