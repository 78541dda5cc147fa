#include "core/hyperbolic/central_face.h"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numbers>
#include <string>
#include <vector>

#include "core/hyperbolic/developing.h"
#include "core/intrinsic/intrinsic_samples.h"
#include "core/intrinsic/mollify.h"
#include "core/mesh/prepare.h"
#include "core/mesh/read.h"
#include "core/mesh/samples.h"
#include "core/ricci/uniformize.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

HyperbolicTriangles uniformized(const TriangleSoup& soup) {
  Context context;
  const auto prepared = prepareMesh(context, soup, {});
  EXPECT_OK(prepared);
  const Connectivity& surface = prepared->mesh.connectivity();
  const auto mollified = mollify(surface, prepared->mesh.edgeLengths());
  EXPECT_OK(mollified);
  const auto found = uniformize(context, surface, mollified->lengths);
  EXPECT_OK(found);
  return *hyperbolicTriangles(found->metric);
}

double radiusFrom(const HyperbolicTriangles& triangles, Index root) {
  Context context;
  DevelopOptions options;
  options.root = root;
  const auto development = develop(context, triangles, options);
  EXPECT_OK(development);
  return development->certificate.radius;
}

/// The radius that develop() finds may be 8 % more than that of the best of roots.
void expectCentral(const HyperbolicTriangles& triangles, Index step) {
  double best = radiusFrom(triangles, 0);
  for (Index root = step; root < triangles.surface.faceCount(); root += step) {
    best = std::min(best, radiusFrom(triangles, root));
  }
  const double found = radiusFrom(triangles, kNone);
  std::cout << triangles.surface.faceCount() << " faces, radius " << found << ", best " << best
            << "\n";
  EXPECT_LE(found, 1.08 * best);
}

TEST(CentralFace, OfSamplesSeesNotMuchFurtherThanTheBestOfMany) {
  for (const double genus : {2, 3, 5}) {
    const auto soup = makeSample("genus", {{"genus", genus}, {"resolution", 4}, {"seed", 2}});
    ASSERT_OK(soup);
    expectCentral(uniformized(*soup), 29);
  }
}

class RealMesh : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Meshes, RealMesh,
                         testing::Values("genus2/ceaedf__eight.off",
                                         "genus3plus/libigl-data__3holes.off",
                                         "genus3plus/libigl-data__fertility.off",
                                         "genus3plus/odedstein__boot.obj"));

TEST_P(RealMesh, HasACentralFaceThatSeesNotMuchFurtherThanTheBestOfMany) {
  MODULI_NEED_SHARED_MESH(path, GetParam());
  Context context;
  const auto soup = readMeshFile(context, path);
  ASSERT_OK(soup);
  const HyperbolicTriangles triangles = uniformized(*soup);
  // Of twenty all over the numbers.
  expectCentral(triangles, triangles.surface.faceCount() / 20);
}

TEST(CentralFace, OfADiskIsInItsMiddle) {
  // A strip of equilateral triangles with angles pi / 4.
  std::vector<Triangle> faces;
  for (Index k = 0; k < 7; ++k) {
    faces.push_back(k % 2 == 0 ? Triangle{k, k + 1, k + 2} : Triangle{k + 1, k, k + 2});
  }
  const auto strip = Connectivity::fromFaces(9, faces);
  ASSERT_OK(strip);
  const double side = 2 * std::acosh(0.5 / std::sin(std::numbers::pi / 8));
  const HyperbolicTriangles triangles{*strip, std::vector<double>(21, side),
                                      std::vector<double>(21, std::numbers::pi / 4)};
  Context context;
  const auto development = develop(context, triangles);
  ASSERT_OK(development);
  EXPECT_EQ(development->root, 3);
}

TEST(CentralFace, IsFoundAgainWhenAskedAgain) {
  const auto soup = makeSample("genus", {{"genus", 2}, {"resolution", 4}, {"seed", 2}});
  ASSERT_OK(soup);
  const HyperbolicTriangles triangles = uniformized(*soup);
  Context context;
  EXPECT_EQ(develop(context, triangles)->root, develop(context, triangles)->root);
}

TEST(CentralFace, IsNotLookedForWhenCancelled) {
  CancelToken token;
  token.cancel();
  Context context;
  context.setCancelToken(token);
  const HyperbolicTriangles triangles = *hyperbolicTriangles(*makeIntrinsicSample("bolza"));
  EXPECT_THAT(findCentralFace(context, triangles, std::vector<Su11>(48), std::vector<Su11>(16), 3),
              FailsWith(Reason::kCancelled));
}

}  // namespace
}  // namespace moduli
