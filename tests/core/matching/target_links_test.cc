#include "core/matching/target_links.h"

#include <algorithm>
#include <cmath>
#include <iostream>

#include "core/matching/close_links.h"
#include "core/mesh/sample_tools.h"
#include "core/topology/homotopy_basis.h"
#include "core/topology/tree_cotree.h"
#include "tests/core/matching/cover_samples.h"
#include "tests/core/matching/renumbered.h"

namespace moduli {
namespace {

/// The product of transitions along a walk of the surface.
Motion productAlong(const Connectivity& surface, const CoverSurface& cover,
                    const std::vector<Motion>& transitions, const Walk& walk) {
  Motion product = Motion::Identity();
  for (const Step& step : walk) {
    const Index h = surface.halfedge(step.edge);
    product = cover.plane().normalized(
        Motion(product * transitions[step.sign > 0 ? h : surface.twin(h)]));
  }
  return product;
}

Motion productOfWord(const CoverSurface& cover, const std::vector<Motion>& letters,
                     const Word& word) {
  Motion product = Motion::Identity();
  for (const int letter : word) {
    const Motion& m = letters[std::abs(letter) - 1];
    product = product * (letter > 0 ? m : cover.plane().inverse(m));
  }
  return product;
}

TEST(TargetLinks, SendTheRelationOfTheFundamentalGroupToOne) {
  Context context;
  const TriangleMesh mesh = meshOf(lumpyPlate(4, 2));
  const CoverSurface cover = coverOf(mesh);
  const auto links =
      linkTargets(context, mesh.connectivity(), cover, vertexTargets(mesh, sameNumbers(mesh)));
  ASSERT_OK(links);
  EXPECT_NEAR(links->degree, 1, 1e-10);
  EXPECT_EQ(std::count(links->replaced.begin(), links->replaced.end(), true), 0);
  expectConsistent(mesh.connectivity(), cover, links->map);
  // Another way to see it: the loops of a cut graph, multiplied in the order of the polygon.
  const auto trees = computeTreeCotree(mesh.connectivity());
  ASSERT_OK(trees);
  std::vector<Motion> letters;
  for (std::size_t k = 0; k < trees->leftover.size(); ++k) {
    letters.push_back(productAlong(mesh.connectivity(), cover, links->map.transitions,
                                   basedLoop(mesh.connectivity(), *trees, k)));
    // No loop of the surface can be shrunk: each moves every point.
    EXPECT_GT(cover.plane().wayTo(letters.back().col(2)).norm(), 0.1);
  }
  const Motion relation = productOfWord(cover, letters, polygonWord(mesh.connectivity(), *trees));
  // Letters of displacements up to 10, eight of them: 1e-16 e^10 and some more.
  EXPECT_LT(distanceToUnit(relation), 1e-6);
  std::swap(letters[0], letters[1]);
  EXPECT_GT(distanceToUnit(productOfWord(cover, letters, polygonWord(mesh.connectivity(), *trees))),
            1e-2);
}

TEST(TargetLinks, KeepTheClassAndReplaceFewOtherThanWrongTargets) {
  Context context;
  for (const TriangleSoup& soup : {lumpyTorus(16, 1), lumpyPlate(8, 2)}) {
    const TriangleMesh mesh = meshOf(soup);
    const CoverSurface cover = coverOf(mesh);
    std::vector<SurfacePoint> targets = vertexTargets(mesh, sameNumbers(mesh));
    const auto right = linkTargets(context, mesh.connectivity(), cover, targets);
    ASSERT_OK(right);
    SampleRandom random(7);
    Index wrong = 0;
    for (SurfacePoint& target : targets) {
      if (random.uniform() > 0.02) continue;
      ++wrong;
      target = vertexPoint(mesh.connectivity(), static_cast<Index>(random.next() % targets.size()));
    }
    const auto links = linkTargets(context, mesh.connectivity(), cover, targets);
    ASSERT_OK(links);
    const auto replaced = std::count(links->replaced.begin(), links->replaced.end(), true);
    std::cout << wrong << " wrong, " << replaced << " replaced\n";
    // Those not too far away to contradict their neighbours' stay.
    EXPECT_GT(replaced, 0);
    EXPECT_LT(replaced, 4 * wrong);
    EXPECT_NEAR(links->degree, 1, 1e-9);
    // The same class: loops move points alike up to the change of the base point, vertex 0.
    if (links->replaced[0]) continue;
    const auto trees = computeTreeCotree(mesh.connectivity());
    for (std::size_t k = 0; k < trees->leftover.size(); ++k) {
      const Walk loop = basedLoop(mesh.connectivity(), *trees, k);
      const Motion a = productAlong(mesh.connectivity(), cover, right->map.transitions, loop);
      const Motion b = productAlong(mesh.connectivity(), cover, links->map.transitions, loop);
      EXPECT_LT((a - b).cwiseAbs().maxCoeff(), 1e-9 * a.cwiseAbs().maxCoeff());
    }
  }
}

TEST(TargetLinks, CloseAfterEdgesHaveGoneAroundAHandle) {
  Context context;
  const TriangleMesh mesh = meshOf(lumpyTorus(12, 1));
  const Connectivity& surface = mesh.connectivity();
  const CoverSurface cover = coverOf(mesh);
  const auto links = linkTargets(context, surface, cover, vertexTargets(mesh, sameNumbers(mesh)));
  ASSERT_OK(links);
  const auto trees = computeTreeCotree(surface);
  const Motion around =
      productAlong(surface, cover, links->map.transitions, basedLoop(surface, *trees, 0));
  std::vector<Motion> broken = links->map.transitions;
  // Every fortieth edge goes once around; their faces are apart from each other.
  for (Index e = 0; e < surface.edgeCount(); e += 40) {
    const Index h = surface.halfedge(e);
    broken[h] = broken[h] * around;
    broken[surface.twin(h)] = cover.plane().inverse(broken[h]);
  }
  EXPECT_GT(openFaces(surface, broken).size(), 30u);
  const auto closed = closeLinks(context, surface, cover.plane(), links->map.places, broken);
  ASSERT_OK(closed);
  EXPECT_TRUE(openFaces(surface, *closed).empty());
  double change = 0;
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    change = std::max(change, ((*closed)[h] - links->map.transitions[h]).cwiseAbs().maxCoeff());
  }
  EXPECT_LT(change, 1e-12);
}

TEST(TargetLinks, RefuseMirrorImagesAndMapsToAPoint) {
  Context context;
  TriangleSoup soup = lumpyPlate(2, 0);
  const TriangleMesh mesh = meshOf(soup);
  const CoverSurface cover = coverOf(mesh);
  for (Triangle& face : soup.faces) std::swap(face[1], face[2]);
  const TriangleMesh reversed = meshOf(soup);
  const auto mirror =
      linkTargets(context, reversed.connectivity(), cover, vertexTargets(mesh, sameNumbers(mesh)));
  EXPECT_THAT(mirror, FailsWith(Reason::kNoConvergence));
  EXPECT_THAT(mirror.status().message(), testing::HasSubstr("-1 times"));
  const std::vector<Index> zeros(mesh.vertexCount(), 0);
  const auto point = linkTargets(context, mesh.connectivity(), cover, vertexTargets(mesh, zeros));
  EXPECT_THAT(point.status().message(), testing::HasSubstr("0 times"));
  std::vector<SurfacePoint> targets = vertexTargets(mesh, sameNumbers(mesh));
  targets[3].barycentric = {2, -1, 0};
  EXPECT_THAT(linkTargets(context, mesh.connectivity(), cover, targets),
              FailsWith(Reason::kInvalidOption));
  const TriangleMesh torus = meshOf(lumpyTorus(8, 1));
  EXPECT_THAT(
      linkTargets(context, torus.connectivity(), cover, vertexTargets(mesh, sameNumbers(torus))),
      FailsWith(Reason::kUnsupportedTopology));
}

}  // namespace
}  // namespace moduli
