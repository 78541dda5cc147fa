#include "core/matching/coarse_fit.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "tests/core/matching/nearly_symmetric.h"

namespace moduli {
namespace {

using Eigen::Vector3d;

const std::vector<Vector3d> kTurns = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};

/// Per vertex of one sampling the vertex of another that is nearest to where a half turn takes it:
/// off by half an edge.
std::vector<SurfacePoint> turned(const TriangleSoup& from, const TriangleSoup& to,
                                 const Connectivity& surface, const Vector3d& turn) {
  std::vector<SurfacePoint> points;
  for (const Vector3d& p : from.vertices) {
    const Vector3d wanted = turn.cwiseProduct(p);
    const auto nearest = std::min_element(to.vertices.begin(), to.vertices.end(),
                                          [&](const Vector3d& q, const Vector3d& r) {
                                            return (q - wanted).norm() < (r - wanted).norm();
                                          });
    points.push_back(vertexPoint(surface, static_cast<Index>(nearest - to.vertices.begin())));
  }
  return points;
}

/// Of all half turns, the first of them none, between two samplings of the body.
std::vector<ShapeChange> changes(const NearlySymmetric& body, double height, double fine = 10,
                                 const std::optional<SpaceMobius>& back = {}) {
  TriangleMesh a = body.mesh(fine, 1, height);
  const TriangleMesh b = body.mesh(fine + 2, 2, height);
  if (back) {
    TriangleSoup soup{a.positions(), a.connectivity().faces()};
    for (Vector3d& p : soup.vertices) p = (*back)(p);
    a = meshOf(soup);
  }
  Context context;
  const auto fit = CoarseFit::make(context, a, b, true);
  EXPECT_OK(fit);
  std::vector<ShapeChange> found;
  for (const Vector3d& turn : kTurns) {
    const auto points = turned(body.base(fine, 1), body.base(fine + 2, 2), b.connectivity(), turn);
    const auto map = (*fit)(context, points, back.has_value());
    EXPECT_OK(map);
    if (map.ok()) found.push_back(map->change);
  }
  return found;
}

void expectTheTrueOneLeast(const NearlySymmetric& body, double height, double fine = 10) {
  const std::vector<ShapeChange> found = changes(body, height, fine);
  ASSERT_EQ(found.size(), kTurns.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    std::printf("%s %.2f: stretching %.5f, bending %.4f\n", body.sample.c_str(), height,
                found[i].stretching, found[i].bending);
    if (i > 0) {
      EXPECT_LT(found[0].product(), 0.9 * found[i].product()) << i;
    }
  }
}

TEST(CoarseFit, TellsASurfaceFromItsNearlySymmetricCopies) {
  expectTheTrueOneLeast(kEgg, 0.05);
}

TEST(CoarseFit, TellsASurfaceWithAHandleFromItsNearlySymmetricCopies) {
  expectTheTrueOneLeast(kRing, 0.05, 16);
}

TEST(CoarseFit, ThinsWhatHasManyVertices) {
  expectTheTrueOneLeast(kEgg, 0.05, 14);  // 1962 vertices.
}

// Both samplings are the same surface under each of the turns, but for the errors of its faces: by
// these the changes may differ, not by the half that a bump of a twentieth makes.
TEST(CoarseFit, TellsNoCopiesOfASymmetricSurfaceApart) {
  for (const NearlySymmetric& body : {kEgg, kRing}) {
    const std::vector<ShapeChange> found = changes(body, 0, body.sample == "torus" ? 16 : 10);
    ASSERT_EQ(found.size(), kTurns.size());
    for (const ShapeChange& change : found) {
      std::printf("%s: stretching %.5f, bending %.4f\n", body.sample.c_str(), change.stretching,
                  change.bending);
      EXPECT_NEAR(change.product() / found[0].product(), 1, 0.25);
    }
  }
}

// An inversion is its own inverse: what it made of a is taken back before anything is compared.
TEST(CoarseFit, TakesMobiusMapsOfSpaceBack) {
  const SpaceMobius inversion = SpaceMobius::translation({3, 1, 0}) * SpaceMobius::inversion() *
                                SpaceMobius::translation({-3, -1, 0});
  const std::vector<ShapeChange> plain = changes(kEgg, 0.05),
                                 back = changes(kEgg, 0.05, 10, inversion);
  ASSERT_EQ(plain.size(), back.size());
  // Another start, of another conformal map, settles to within some percent.
  EXPECT_NEAR(back[0].product() / plain[0].product(), 1, 0.1);
  for (std::size_t i = 1; i < plain.size(); ++i) {
    EXPECT_LT(back[0].product(), 0.9 * back[i].product()) << i;
  }
}

TEST(CoarseFit, FailsWherePointsTellNoMap) {
  const TriangleMesh a = kRing.mesh(8, 1, 0.05);
  Context context;
  const auto fit = CoarseFit::make(context, a, a, true);
  ASSERT_OK(fit);
  const std::vector<SurfacePoint> one(a.vertexCount(), vertexPoint(a.connectivity(), 0));
  EXPECT_THAT((*fit)(context, one), FailsWith(Reason::kNoConvergence));
}

}  // namespace
}  // namespace moduli
