#include "core/matching/cover_inverse.h"

#include <algorithm>
#include <cmath>

#include "core/matching/harmonic_match.h"
#include "core/matching/torus_map.h"
#include "tests/bench/retrieval/remesh.h"
#include "tests/core/matching/cover_samples.h"

namespace moduli {
namespace {

/// From B to A and back: the largest distance of vertices of B from where they return to, over the
/// root of the area.
double largestReturn(const TriangleMesh& b, const Connectivity& a, const CoverSurface& cover,
                     const CoverMap& map, const std::vector<SurfacePoint>& inverse) {
  std::vector<SurfacePoint> back;
  for (const SurfacePoint& point : inverse) back.push_back(imageOf(a, cover, map, point));
  return errorsOf(b, back, b.positions()).largest;
}

/// a: the same surface with fewer faces.
void expectInverse(const TriangleMesh& a, const TriangleMesh& b) {
  Context context;
  const CoverSurface cover = coverOf(b);
  std::vector<Index> nearest;
  for (const Eigen::Vector3d& p : a.positions()) {
    const auto nearer = [&](const Eigen::Vector3d& q, const Eigen::Vector3d& r) {
      return (p - q).squaredNorm() < (p - r).squaredNorm();
    };
    nearest.push_back(
        static_cast<Index>(std::min_element(b.positions().begin(), b.positions().end(), nearer) -
                           b.positions().begin()));
  }
  const auto match = matchHarmonically(context, a.connectivity(), a.edgeLengths(), cover,
                                       vertexTargets(b, nearest));
  ASSERT_OK(match);
  const auto inverse = invertCoverMap(context, a.connectivity(), cover, match->map);
  ASSERT_OK(inverse);
  // Steps of 1e-16 along paths of some dozen edges.
  EXPECT_LT(largestReturn(b, a.connectivity(), cover, match->map, *inverse), 1e-10);
  // Mostly where they lie: A is at B's place.
  EXPECT_LT(errorsOf(a, *inverse, b.positions()).mean, 0.03);
}

TEST(CoverInverse, LeadsFromVerticesOfBToTheirImagesOfA) {
  for (const TriangleSoup& soup : {lumpyTorus(12, 2), lumpyPlate(4, 2)}) {
    SCOPED_TRACE(soup.faces.size());
    expectInverse(meshOf(simplified(soup, soup.faces.size() * 6 / 10)), meshOf(soup));
  }
}

TEST(CoverInverse, FindsVerticesOfBThatNoneOfAGoesNear) {
  const TriangleSoup soup = lumpyTorus(24, 2);
  expectInverse(meshOf(simplified(soup, soup.faces.size() / 10)), meshOf(soup));
}

TEST(CoverInverse, OfTheIdentityIsTheIdentity) {
  Context context;
  const TriangleMesh mesh = meshOf(lumpyTorus(12, 2));
  const CoverSurface cover = coverOf(mesh);
  const auto map = affineTorusMap(context, cover, cover, vertexTargets(mesh, sameNumbers(mesh)));
  ASSERT_OK(map);
  const auto inverse = invertCoverMap(context, mesh.connectivity(), cover, map->map);
  ASSERT_OK(inverse);
  EXPECT_LT(errorsOf(mesh, *inverse, mesh.positions()).largest, 1e-9);
  CancelToken token;
  token.cancel();
  context.setCancelToken(token);
  EXPECT_THAT(invertCoverMap(context, mesh.connectivity(), cover, map->map),
              FailsWith(Reason::kCancelled));
}

}  // namespace
}  // namespace moduli
