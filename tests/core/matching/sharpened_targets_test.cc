#include "core/matching/sharpened_targets.h"

#include <cmath>
#include <iostream>

#include "core/matching/harmonic_match.h"
#include "core/matching/path_search.h"
#include "core/mesh/read.h"
#include "core/mesh/sample_tools.h"
#include "tests/bench/retrieval/remesh.h"
#include "tests/core/matching/cover_samples.h"
#include "tests/core/matching/renumbered.h"
#include "tests/core/matching/tube_net.h"

namespace moduli {
namespace {

/// Per place the nearest vertex of a mesh.
std::vector<SurfacePoint> nearestVertices(const TriangleMesh& mesh,
                                          const std::vector<Eigen::Vector3d>& places) {
  std::vector<Index> nearest;
  for (const Eigen::Vector3d& place : places) {
    Index best = 0;
    for (Index v = 1; v < mesh.vertexCount(); ++v) {
      if ((mesh.positions()[v] - place).squaredNorm() <
          (mesh.positions()[best] - place).squaredNorm()) {
        best = v;
      }
    }
    nearest.push_back(best);
  }
  return vertexTargets(mesh, nearest);
}

/// Off by up to `share` of the root of the area in every coordinate, in waves of half that root.
std::vector<Eigen::Vector3d> wavy(const TriangleMesh& mesh,
                                  const std::vector<Eigen::Vector3d>& places, double share) {
  const double unit = std::sqrt(mesh.area());
  std::vector<Eigen::Vector3d> result;
  for (const Eigen::Vector3d& p : places) {
    const Eigen::Vector3d q = 4 * EIGEN_PI / unit * p;
    result.push_back(
        p + share * unit *
                Eigen::Vector3d(std::sin(q[1] + 1), std::sin(q[2] + q[0]), std::sin(q[0] + 2)));
  }
  return result;
}

/// Whether two maps are homotopic: whether a short way from the image of a vertex by one to that by
/// the other, carried along edges, is the same however it is carried.
bool areHomotopic(const Connectivity& surface, const CoverSurface& cover, const CoverMap& x,
                  const CoverMap& y) {
  const CoverPlane plane = cover.plane();
  PathSearch search(cover, cover.surface.vertexCount());
  search.searchAll();
  search.start(x.images[0]);
  std::vector<Motion> ways(surface.vertexCount());
  std::vector<bool> done(surface.vertexCount(), false);
  ways[0] = *search.find(y.images[0]);
  done[0] = true;
  std::vector<Index> queue = {0};
  const auto carried = [&](Index h) {
    return plane.normalized(
        Motion(plane.inverse(x.transitions[h]) * ways[surface.tail(h)] * y.transitions[h]));
  };
  bool same = true;
  for (std::size_t n = 0; n < queue.size(); ++n) {
    const Index first = surface.outgoing(queue[n]);
    Index h = first;
    do {
      const Index w = surface.head(h);
      if (!done[w]) {
        ways[w] = carried(h);
        done[w] = true;
        queue.push_back(w);
      }
      // Ways grow where maps differ, and rounding with them; short ones agree to 1e-9 and better.
      same = same && (carried(h) - ways[w]).cwiseAbs().maxCoeff() < 1e-5;
      h = surface.rotate(h);
    } while (h != first);
  }
  return same;
}

struct Pair {
  TriangleMesh a, b;
  std::vector<Eigen::Vector3d> truth;  ///< Per vertex of a, on b.
};

Pair remeshedNet() {
  const TriangleSoup net = tubeNet({0, 4, 9, 15, 22}, {0, 4, 10});
  const TriangleMesh a = meshOf(simplified(net, net.faces.size() * 7 / 10));
  return {a, meshOf(net), a.positions()};
}

TEST(SharpenedTargets, OfAMovedCopyComeFromWrongSidesOfLimbsToTheTruth) {
  Context context;
  const TriangleSoup net = tubeNet({0, 4, 9, 15, 22}, {0, 4, 10});
  const Renumbered other = renumbered(moved(net), 3);
  const TriangleMesh a = meshOf(net), b = meshOf(other.soup);
  const std::vector<Eigen::Vector3d> truth = vertexPlaces(b, other.image);
  const auto targets = nearestVertices(b, wavy(b, truth, 0.03));
  const auto sharp = sharpenTargets(context, a, b, targets);
  ASSERT_OK(sharp);
  const MapErrors before = errorsOf(b, targets, truth), after = errorsOf(b, sharp->vertices, truth);
  std::cout << "mean error " << before.mean << " -> " << after.mean << ", largest "
            << before.largest << " -> " << after.largest << "\n";
  EXPECT_LT(after.mean, before.mean / 10);
  // Points of edges go to where the motion takes them: straight between the ends.
  std::vector<SurfacePoint> quarters;
  std::vector<Eigen::Vector3d> there;
  for (Index e = 0; e < a.connectivity().edgeCount(); ++e) {
    const Index h = a.connectivity().halfedge(e);
    ASSERT_EQ(sharp->ways[e].size(), 3u);
    quarters.push_back(sharp->ways[e][0]);
    there.push_back(0.75 * truth[a.connectivity().tail(h)] +
                    0.25 * truth[a.connectivity().head(h)]);
  }
  EXPECT_LT(errorsOf(b, quarters, there).mean, before.mean / 10);
}

TEST(SharpenedTargets, TellTheClassOfMapsBetweenThinNetsThatWavyOnesDoNot) {
  Context context;
  const Pair pair = remeshedNet();
  const Connectivity& surface = pair.a.connectivity();
  const CoverSurface cover = coverOf(pair.b);
  const auto right = linkTargets(context, surface, cover, nearestVertices(pair.b, pair.truth));
  ASSERT_OK(right);
  const auto targets = nearestVertices(pair.b, wavy(pair.b, pair.truth, 0.03));
  const auto links = linkTargets(context, surface, cover, targets);
  std::cout << (links.ok() ? "linked" : links.status().toString()) << "\n";
  EXPECT_FALSE(links.ok() && areHomotopic(surface, cover, right->map, links->map));
  const auto sharp = sharpenTargets(context, pair.a, pair.b, targets);
  ASSERT_OK(sharp);
  const auto better = linkTargets(context, surface, cover, sharp->vertices, sharp->ways);
  ASSERT_OK(better);
  EXPECT_TRUE(areHomotopic(surface, cover, right->map, better->map));
  EXPECT_NEAR(better->degree, 1, 1e-9);
  const auto match =
      matchHarmonically(context, surface, pair.a.edgeLengths(), cover, *better, {0.02});
  ASSERT_OK(match);
  expectConsistent(surface, cover, match->map);
}

TEST(SharpenedTargets, DoNotDependOnPositionAndScale) {
  Context context;
  const Pair pair = remeshedNet();
  const TriangleMesh far = meshOf(moved({pair.b.positions(), pair.b.connectivity().faces()}));
  const auto targets = nearestVertices(pair.b, wavy(pair.b, pair.truth, 0.02));
  const auto here = sharpenTargets(context, pair.a, pair.b, targets);
  const auto there = sharpenTargets(context, pair.a, far, targets);
  ASSERT_OK(here);
  ASSERT_OK(there);
  std::vector<Eigen::Vector3d> places;
  for (const SurfacePoint& point : here->vertices) places.push_back(spaceAt(far, point));
  EXPECT_LT(errorsOf(far, there->vertices, places).mean, 1e-6);
}

TEST(SharpenedTargets, MatchAModelOfGenusTwelve) {
  Context context;
  MODULI_NEED_SHARED_MESH(path, "genus3plus/odedstein__boot.obj");
  const TriangleSoup soup = *readMeshFile(context, path);
  const TriangleMesh a = meshOf(simplified(soup, 10000));
  const TriangleMesh b = meshOf(simplified(soup, 20000));
  const CoverSurface cover = coverOf(b);
  const auto right =
      linkTargets(context, a.connectivity(), cover, nearestVertices(b, a.positions()));
  ASSERT_OK(right);
  const auto targets = nearestVertices(b, wavy(b, a.positions(), 0.01));
  const auto links = linkTargets(context, a.connectivity(), cover, targets);
  std::cout << (links.ok() ? "linked" : links.status().toString()) << "\n";
  const auto sharp = sharpenTargets(context, a, b, targets);
  ASSERT_OK(sharp);
  const double before = errorsOf(b, targets, a.positions()).mean;
  const double after = errorsOf(b, sharp->vertices, a.positions()).mean;
  std::cout << "mean error " << before << " -> " << after << "\n";
  EXPECT_LT(after, before / 3);
  const auto better = linkTargets(context, a.connectivity(), cover, sharp->vertices, sharp->ways);
  ASSERT_OK(better);
  EXPECT_TRUE(areHomotopic(a.connectivity(), cover, right->map, better->map));
}

TEST(SharpenedTargets, StopWhenTheyAreTold) {
  Context context;
  const Pair pair = remeshedNet();
  CancelToken token;
  token.cancel();
  context.setCancelToken(token);
  EXPECT_THAT(sharpenTargets(context, pair.a, pair.b, nearestVertices(pair.b, pair.truth)),
              FailsWith(Reason::kCancelled));
}

}  // namespace
}  // namespace moduli
