#include "core/matching/landmark_meeting.h"

#include <cmath>
#include <iostream>

#include "core/intrinsic/edge_graph.h"
#include "core/matching/border_places.h"
#include "core/matching/boundary_links.h"
#include "core/matching/cover_inverse.h"
#include "core/matching/landmark_flow.h"
#include "core/mesh/double_cover.h"
#include "tests/core/matching/bordered_samples.h"

namespace moduli {
namespace {

using Eigen::Vector3d;

/// A surface and nearly the identity of it, in the cover that belongs to it.
struct Identity {
  TriangleMesh mesh;
  CoverSurface cover;
  HarmonicMatch match;

  static Identity of(const TriangleSoup& soup) {
    Context context;
    const TriangleMesh mesh = chordFree(soup);
    const auto targets = vertexTargets(mesh, sameNumbers(mesh));
    if (BorderPlaces(mesh).loops().empty()) {
      CoverSurface cover = coverOf(mesh);
      auto match = matchHarmonically(context, mesh.connectivity(), mesh.edgeLengths(), cover,
                                     targets, {1e-3});
      EXPECT_OK(match);
      return {mesh, std::move(cover), *std::move(match)};
    }
    const DoubleCover doubled = *doubleCover(mesh.connectivity());
    std::vector<double> lengths;
    for (const Index e : doubled.edge) lengths.push_back(mesh.edgeLengths()[e]);
    CoverSurface cover = *straightCover(context, doubled.connectivity, lengths);
    const auto links = linkBordered(context, mesh.connectivity(), mesh.connectivity(), cover,
                                    *fitBoundary(mesh, mesh, targets), targets);
    EXPECT_OK(links);
    auto match =
        matchHarmonically(context, mesh.connectivity(), mesh.edgeLengths(), cover, *links, {1e-3});
    EXPECT_OK(match);
    return {mesh, std::move(cover), *std::move(match)};
  }

  bool isClosed() const { return cover.surface.vertexCount() == mesh.vertexCount(); }

  /// Vertices far from each other; sent some edges off, those of the boundary along it.
  std::vector<MatchLandmark> marks() const {
    const Connectivity& surface = mesh.connectivity();
    const EdgeGraph graph(surface, mesh.edgeLengths());
    std::vector<MatchLandmark> result;
    for (const Index v : graph.farthestSamples({}, 8).vertices) {
      Index to = v;
      for (const auto& [w, distance] : graph.within(v, 0.06 * std::sqrt(mesh.area()))) {
        if (!surface.isBoundaryVertex(v) && !surface.isBoundaryVertex(w)) to = w;
      }
      if (surface.isBoundaryVertex(v)) to = surface.head(surface.outgoing(v));
      result.push_back({vertexPoint(surface, v), vertexPoint(surface, to),
                        "mark " + std::to_string(result.size() + 1)});
    }
    return result;
  }

  double largestMiss(const CoverMap& map, const std::vector<MatchLandmark>& landmarks) const {
    double largest = 0;
    for (const MatchLandmark& mark : landmarks) {
      const SurfacePoint image =
          foldedBack(imageOf(mesh.connectivity(), cover, map, mark.a), mesh.faceCount());
      largest = std::max(largest, (spaceAt(mesh, image) - spaceAt(mesh, mark.b)).norm());
    }
    return largest / std::sqrt(mesh.area());
  }
};

std::vector<TriangleSoup> samples() {
  return {ring(10, 2, 3), bentPlate(4, 2), openTorus(16, 2), lumpyTorus(12, 2), lumpyPlate(4, 2)};
}

// The energy's minimizer is off by the square of the length over which is evened out.
TEST(LandmarkMeeting, SoftLandmarksTendToExactOnesAsTheyGainWeight) {
  for (const TriangleSoup& soup : samples()) {
    const Identity identity = Identity::of(soup);
    const std::vector<MatchLandmark> marks = identity.marks(), none;
    std::vector<double> misses = {identity.largestMiss(identity.match.map, marks)};
    EXPECT_GT(misses[0], 0.02);
    for (const double smoothing : {0.02, 0.005, 0.00125}) {
      Context context;
      const auto drawn = meetOnCover(
          context, {identity.mesh, identity.mesh, identity.cover, none, marks, smoothing},
          identity.match);
      ASSERT_OK(drawn);
      EXPECT_EQ(countFolded(identity.mesh.connectivity(), drawn->map), 0);
      misses.push_back(identity.largestMiss(drawn->map, marks));
    }
    for (const double miss : misses) std::cout << miss << " ";
    std::cout << "\n";
    EXPECT_LT(misses[1], misses[0]);
    EXPECT_LT(misses[2], misses[1] / 4);
    EXPECT_LT(misses[3], misses[2] / 8);
  }
}

TEST(LandmarkMeeting, ExactOnesAreMetBesideSoftOnes) {
  for (const TriangleSoup& soup : samples()) {
    const Identity identity = Identity::of(soup);
    std::vector<MatchLandmark> exact = identity.marks();
    const std::vector<MatchLandmark> soft(exact.begin() + 4, exact.end());
    exact.resize(4);
    Context context;
    const auto met = meetOnCover(
        context, {identity.mesh, identity.mesh, identity.cover, exact, soft}, identity.match);
    ASSERT_OK(met);
    EXPECT_LT(identity.largestMiss(met->map, exact), 1e-8);
    EXPECT_LT(identity.largestMiss(met->map, soft), identity.largestMiss(identity.match.map, soft));
  }
}

// Up to rounding boundary vertices stay on the geodesics, and all others between these.
TEST(LandmarkMeeting, TheFlowKeepsTheBoundary) {
  for (const TriangleSoup& soup : {ring(10, 2, 3), bentPlate(4, 2), openTorus(16, 2)}) {
    const Identity identity = Identity::of(soup);
    const Connectivity& surface = identity.mesh.connectivity();
    std::vector<CoverLandmark> marks;
    for (const MatchLandmark& mark : identity.marks()) marks.push_back({mark.a, mark.b, mark.name});
    Context context;
    const auto flow =
        flowToLandmarks(context, surface, identity.mesh, identity.cover, identity.match.map, marks);
    ASSERT_OK(flow);
    EXPECT_TRUE(flow->met);
    EXPECT_GT(flow->steps, 0);
    expectConsistent(surface, identity.cover, flow->map);
    double off = 0;
    for (Index v = 0; v < surface.vertexCount(); ++v) {
      const SurfacePoint point = foldedBack(flow->map.images[v], identity.mesh.faceCount());
      if (surface.isBoundaryVertex(v)) {
        const SurfacePoint on = ontoBoundary(surface, point);
        off = std::max(off, (spaceAt(identity.mesh, on) - spaceAt(identity.mesh, point)).norm());
      } else {
        EXPECT_LT(flow->map.images[v].face, identity.mesh.faceCount());
      }
    }
    std::cout << "off the boundary by " << off << "\n";
    EXPECT_LT(off, 1e-9);
    // A second way: angles of the boundary stay half turns.
    const VertexLinks links = linksOf(surface, identity.cover, flow->map);
    double bend = 0;
    for (Index h = 0; h < surface.halfedgeCount(); ++h) {
      if (surface.twin(h) != kNone) continue;
      const Index next = surface.outgoing(surface.head(h));
      const auto on = links[next].col(2).head<2>().normalized();
      const Motion back = identity.cover.plane().inverse(links[h]);
      bend = std::max(bend, (on + back.col(2).head<2>().normalized()).norm());
    }
    EXPECT_LT(bend, 1e-6);
  }
}

}  // namespace
}  // namespace moduli
