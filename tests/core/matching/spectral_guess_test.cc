#include "core/matching/spectral_guess.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "tests/core/matching/nearly_symmetric.h"

namespace moduli {
namespace {

using Eigen::Vector3d;

constexpr double kFine = 8, kHeight = 0.05;

/// Per vertex of one sampling of the egg the vertex of another that is nearest to where a half turn
/// takes it: off by half an edge.
std::vector<SurfacePoint> turned(const TriangleMesh& b, const Vector3d& turn) {
  const std::vector<Vector3d> to = kEgg.base(kFine + 2, 2).vertices;
  std::vector<SurfacePoint> points;
  for (const Vector3d& p : kEgg.base(kFine, 1).vertices) {
    const Vector3d wanted = turn.cwiseProduct(p);
    const auto nearest =
        std::min_element(to.begin(), to.end(), [&](const Vector3d& q, const Vector3d& r) {
          return (q - wanted).norm() < (r - wanted).norm();
        });
    points.push_back(vertexPoint(b.connectivity(), static_cast<Index>(nearest - to.begin())));
  }
  return points;
}

TriangleMesh movedBy(const TriangleMesh& mesh, const Vector3d& shift) {
  TriangleSoup soup{mesh.positions(), mesh.connectivity().faces()};
  for (Vector3d& p : soup.vertices) p += shift;
  return meshOf(soup);
}

/// The guess from places of two samplings of one egg, from one that tells nothing: the mean
/// distance of its points from the places, over the root of the area.
double errorFarAway(const Vector3d& shift) {
  const TriangleMesh a = movedBy(kEgg.mesh(kFine, 1, kHeight), shift),
                     b = movedBy(kEgg.mesh(kFine + 2, 2, kHeight), shift);
  Context context;
  const auto guess = guessFromPlaces(context, {a, b}, SpectralGuess());
  EXPECT_OK(guess);
  if (!guess.ok()) return 1;
  double sum = 0;
  for (Index v = 0; v < a.vertexCount(); ++v) {
    sum +=
        (spacePoint(b.connectivity(), b.positions(), guess->points[v]) - a.positions()[v]).norm();
  }
  return sum / static_cast<double>(a.vertexCount()) / std::sqrt(b.area());
}

// Half turns of the egg are off by half of its width.
TEST(SpectralGuess, TellsPointsThatChangeTheShapeLess) {
  const TriangleMesh a = kEgg.mesh(kFine, 1, kHeight), b = kEgg.mesh(kFine + 2, 2, kHeight);
  const std::vector<SurfacePoint> right = turned(b, {1, 1, 1});
  Context context;
  for (const Vector3d& turn : {Vector3d(1, -1, -1), Vector3d(-1, 1, -1), Vector3d(-1, -1, 1)}) {
    const std::vector<SurfacePoint> wrong = turned(b, turn);
    const auto less = changesLess(context, {a, b}, right, wrong, true);
    ASSERT_OK(less);
    EXPECT_TRUE(*less);
    const auto more = changesLess(context, {a, b}, wrong, right, true);
    ASSERT_OK(more);
    EXPECT_FALSE(*more);
  }
}

TEST(SpectralGuess, PrefersPointsThatLeadToAMap) {
  const TriangleMesh a = kRing.mesh(kFine, 1, kHeight);
  const std::vector<SurfacePoint> one(a.vertexCount(), vertexPoint(a.connectivity(), 0));
  std::vector<SurfacePoint> same;
  for (Index v = 0; v < a.vertexCount(); ++v) same.push_back(vertexPoint(a.connectivity(), v));
  Context context;
  const auto less = changesLess(context, {a, a}, same, one, true);
  ASSERT_OK(less);
  EXPECT_TRUE(*less);
  const auto more = changesLess(context, {a, a}, one, same, true);
  ASSERT_OK(more);
  EXPECT_FALSE(*more);
}

// Floats have 24 bits: a million sizes away they tell 1 / 16 of a size apart, where there is no
// origin near. Places themselves lose 1e-10 there.
TEST(SpectralGuess, FromPlacesIsThatOfModelsNearTheOrigin) {
  const double near = errorFarAway(Vector3d::Zero()), far = errorFarAway({1e6, -1e6, 1e6});
  std::printf("near the origin %.5f, far away %.5f\n", near, far);
  EXPECT_LT(near, 0.02);  // As places that modes tell.
  EXPECT_NEAR(far, near, 1e-3);
}

}  // namespace
}  // namespace moduli
