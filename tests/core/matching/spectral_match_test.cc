#include "core/matching/spectral_match.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/mesh/read.h"
#include "tests/bench/retrieval/deform.h"
#include "tests/core/matching/lumps.h"
#include "tests/core/matching/renumbered.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

using Eigen::Vector3d;

TriangleMesh meshOf(const TriangleSoup& soup) {
  return *TriangleMesh::fromSoup(soup);
}

SpectralSurface spectral(const TriangleMesh& mesh, MatchMetric metric = MatchMetric::kOwn) {
  Context context;
  auto made = makeSpectralSurface(context, mesh, metric);
  EXPECT_OK(made);
  return *std::move(made);
}

Vector3d place(const TriangleMesh& mesh, const SurfacePoint& point) {
  const Triangle& face = mesh.connectivity().face(point.face);
  Vector3d sum = Vector3d::Zero();
  for (int c = 0; c < 3; ++c) sum += point.barycentric[c] * mesh.positions()[face[c]];
  return sum;
}

// Distances of the images of vertices from where they should be, over the root of the area,
// ascending. Straight ones: not above those along the surface.
std::vector<double> errors(const SpectralSurface& a, const SpectralSurface& b,
                           const Eigen::MatrixXd& functional, const std::vector<Vector3d>& truth) {
  Context context;
  const auto points = correspondingPoints(context, a, b, functional);
  EXPECT_OK(points);
  std::vector<double> result;
  for (std::size_t v = 0; v < truth.size(); ++v) {
    result.push_back((place(b.mesh, (*points)[v]) - truth[v]).norm() / std::sqrt(b.mesh.area()));
  }
  std::sort(result.begin(), result.end());
  return result;
}

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

std::vector<SpectralMatch> matches(const SpectralSurface& a, const SpectralSurface& b,
                                   const SpectralMatchOptions& options = {}) {
  Context context;
  auto found = matchSpectra(context, a, b, options);
  EXPECT_OK(found);
  return *std::move(found);
}

std::vector<Vector3d> carried(const Renumbered& other) {
  std::vector<Vector3d> truth;
  for (const Index v : other.image) truth.push_back(other.soup.vertices[v]);
  return truth;
}

TEST(SpectralSurface, HasOrthonormalModesAndSamplesOfTheWholeArea) {
  const TriangleMesh mesh = meshOf(lump(12, 1));
  const SpectralSurface surface = spectral(mesh);
  const Eigen::Map<const Eigen::VectorXd> areas(surface.areas.data(), mesh.vertexCount());
  EXPECT_NEAR(areas.sum(), 1, 1e-12);
  const Eigen::MatrixXd gram =
      surface.functions.transpose() * areas.asDiagonal() * surface.functions;
  EXPECT_LT((gram - Eigen::MatrixXd::Identity(gram.rows(), gram.cols())).cwiseAbs().maxCoeff(),
            1e-9);
  for (const MatchSamples* samples : {&surface.coarse, &surface.fine}) {
    EXPECT_NEAR(samples->weights.sum(), 1, 1e-12);
    EXPECT_GE(samples->weights.minCoeff(), 0);
  }
  EXPECT_TRUE(std::equal(surface.features.begin(), surface.features.end(),
                         surface.coarse.vertices.begin()));
}

TEST(SpectralSurface, FindsTheTipsOfThreeBumps) {
  const TriangleMesh mesh = meshOf(lump(16, 1));
  const SpectralSurface surface = spectral(mesh);
  for (const Vector3d& way : {Vector3d(1, 0, 0), Vector3d(-0.3, 0.9, 0.3).normalized(),
                              Vector3d(-0.5, -0.4, 0.8).normalized()}) {
    double nearest = 10;
    for (const Index v : surface.features) {
      const Vector3d p = mesh.positions()[v];
      // On the sphere before it was shaped.
      const Vector3d on_sphere = Vector3d(p[0] / 1.4, p[1], p[2] / 0.8).normalized();
      nearest = std::min(nearest, std::acos(std::clamp(on_sphere.dot(way), -1.0, 1.0)));
    }
    EXPECT_LT(nearest, 0.2);  // Two edges.
  }
}

TEST(FunctionalMap, IsTheIdentityOfASurfaceWithItself) {
  const TriangleMesh mesh = meshOf(lump(12, 1));
  const SpectralSurface surface = spectral(mesh);
  const SampledModes modes = sampleModes(surface, surface.coarse);
  SampleMaps maps;
  maps.there.resize(surface.coarse.vertices.size());
  std::iota(maps.there.begin(), maps.there.end(), 0);
  maps.back = maps.there;
  const Eigen::MatrixXd functional = fitFunctionalMap(modes, modes, maps, 15);
  // But for the term that keeps it solvable, 1e-9 of some tenths.
  EXPECT_LT((functional - Eigen::MatrixXd::Identity(15, 15)).cwiseAbs().maxCoeff(), 1e-7);
  EXPECT_LT(orthogonalityDefect(functional), 1e-12);
  const SampleMaps nearest = nearestSamples(modes, modes, functional);
  EXPECT_EQ(nearest.there, maps.there);
  EXPECT_EQ(nearest.back, maps.back);
}

TEST(FunctionalMap, NearestSamplesAreThoseOfBruteForce) {
  const TriangleMesh a = meshOf(lump(12, 1)), b = meshOf(lump(11, 2));
  const SpectralSurface x = spectral(a), y = spectral(b);
  const SampledModes p = sampleModes(x, x.coarse), q = sampleModes(y, y.coarse);
  Eigen::MatrixXd functional = Eigen::MatrixXd::Identity(8, 8);
  functional(1, 2) = 0.3;
  functional(3, 3) = -1;
  const SampleMaps maps = nearestSamples(p, q, functional);
  const auto distance = [&](std::size_t i, std::size_t j) {
    return (functional.transpose() * p.functions.col(static_cast<Eigen::Index>(i)).head(8) -
            q.functions.col(static_cast<Eigen::Index>(j)).head(8))
        .norm();
  };
  // Half the squared distances are sums of ten products of floats; a distance d is known to 1 / d
  // of their error, and where it is 0, to the root of twice that.
  const double largest = std::max(p.functions.topRows(8).colwise().squaredNorm().maxCoeff(),
                                  q.functions.topRows(8).colwise().squaredNorm().maxCoeff());
  const double error = std::sqrt(2 * 10 * 0x1p-24 * largest);
  for (std::size_t i = 0; i < maps.there.size(); ++i) {
    for (std::size_t j = 0; j < maps.back.size(); ++j) {
      EXPECT_LE(distance(i, maps.there[i]), distance(i, j) + error);
      EXPECT_LE(distance(maps.back[j], j), distance(i, j) + error);
    }
  }
}

TEST(FunctionalMap, FitsAllPairsOfBothMaps) {
  const TriangleMesh a = meshOf(lump(12, 1)), b = meshOf(lump(11, 2));
  const SpectralSurface x = spectral(a), y = spectral(b);
  const SampledModes p = sampleModes(x, x.coarse), q = sampleModes(y, y.coarse);
  // Two samples of one go to the same of the other, and some to none.
  SampleMaps maps;
  const auto here = static_cast<Index>(p.weights.size());
  const auto there = static_cast<Index>(q.weights.size());
  for (Index i = 0; i < here; ++i) maps.there.push_back(i / 2 % there);
  for (Index j = 0; j < there; ++j) maps.back.push_back((7 * j + 3) % (here / 3));
  // One row for each pair.
  const Eigen::Index k = 9;
  Eigen::MatrixXd of_a(here + there, k), of_b(here + there, k);
  for (Index i = 0; i < here; ++i) {
    const double root = std::sqrt(p.weights[i]);
    of_a.row(i) = root * p.functions.col(i).head(k).transpose();
    of_b.row(i) = root * q.functions.col(maps.there[i]).head(k).transpose();
  }
  for (Index j = 0; j < there; ++j) {
    const double root = std::sqrt(q.weights[j]);
    of_a.row(here + j) = root * p.functions.col(maps.back[j]).head(k).transpose();
    of_b.row(here + j) = root * q.functions.col(j).head(k).transpose();
  }
  const Eigen::MatrixXd wanted = of_a.colPivHouseholderQr().solve(of_b);
  const Eigen::MatrixXd got = fitFunctionalMap(p, q, maps, k);
  // The term that keeps it solvable is 1e-9 of some tenths.
  EXPECT_LT((got - wanted).cwiseAbs().maxCoeff(), 1e-7);
}

TEST(SpectralMatch, FindsACopyThatIsMovedAndRenumbered) {
  const TriangleSoup soup = lump(16, 1);
  const Renumbered other = renumbered(moved(soup), 5);
  const TriangleMesh a = meshOf(soup), b = meshOf(other.soup);
  const SpectralSurface x = spectral(a), y = spectral(b);
  const auto found = matches(x, y);
  ASSERT_FALSE(found.empty());
  EXPECT_LT(found[0].defect, 1e-3);
  EXPECT_GT(found[0].orientation, 0.8);
  // Every vertex is nearer to its own image than to any other; edges have 0.05 and more.
  EXPECT_LT(errors(x, y, found[0].functional, carried(other)).back(), 0.01);
}

TEST(SpectralMatch, FindsItOnAnotherTriangulation) {
  // Two triangulations of one surface, of 0.06 and 0.05 an edge: that is the unit of what can be
  // told. truth: the same direction before it was shaped.
  const TriangleMesh a = meshOf(lump(16, 1)), b = meshOf(lump(19, 2));
  const SpectralSurface x = spectral(a), y = spectral(b);
  const auto found = matches(x, y);
  ASSERT_FALSE(found.empty());
  const auto error = errors(x, y, found[0].functional, a.positions());
  EXPECT_LT(mean(error), 0.02);
  EXPECT_LT(error.back(), 0.1);
}

TEST(SpectralMatch, TurnsOrientationOverOnlyWhenAsked) {
  const TriangleSoup soup = lump(16, 1);
  const Renumbered other = renumbered(mirrored(soup), 5);
  const TriangleMesh a = meshOf(soup), b = meshOf(other.soup);
  const SpectralSurface x = spectral(a), y = spectral(b);
  SpectralMatchOptions options;
  options.mirror = true;
  const auto turned = matches(x, y, options);
  ASSERT_FALSE(turned.empty());
  EXPECT_LT(turned[0].orientation, -0.8);
  EXPECT_LT(errors(x, y, turned[0].functional, carried(other)).back(), 0.01);
  for (const SpectralMatch& match : matches(x, y)) {
    EXPECT_GT(match.orientation, 0);
    EXPECT_GT(match.defect, 10 * turned[0].defect);  // None is an isometry.
  }
}

TEST(SpectralMatch, FindsAnInversionOfSpaceByTheMobiusMetric) {
  const TriangleSoup soup = lump(24, 1);
  SampleRandom random(3);
  const Renumbered other = renumbered(inverted(soup, 0.5, random), 5);
  const TriangleMesh a = meshOf(soup), b = meshOf(other.soup);
  const SpectralSurface x = spectral(a, MatchMetric::kMobius);
  const SpectralSurface y = spectral(b, MatchMetric::kMobius);
  // Willmore's energy does not change; where edges are long against the curvature, its discrete
  // stand-in does, by parts of the square of their angle.
  for (Eigen::Index k = 1; k < 20; ++k) EXPECT_NEAR(x.values[k] / y.values[k], 1, 0.02) << k;
  const auto found = matches(x, y);
  ASSERT_FALSE(found.empty());
  EXPECT_LT(found[0].defect, 0.01);
  EXPECT_LT(mean(errors(x, y, found[0].functional, carried(other))), 0.01);
  // By its own metric it is no isometry.
  const auto bent = matches(spectral(a), spectral(b));
  EXPECT_TRUE(bent.empty() || bent[0].defect > 10 * found[0].defect);
}

TEST(SpectralMatch, AnswersInTheSameBytesAgain) {
  const TriangleMesh a = meshOf(lump(12, 1)), b = meshOf(lump(12, 2));
  const SpectralSurface x = spectral(a), y = spectral(b);
  const auto first = matches(x, y), second = matches(x, y);
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].functional, second[i].functional);
  }
}

TEST(SpectralMatch, WorksWithFewVertices) {
  // Fewer than modes and samples: nothing overflows, and copies are found all the same.
  const TriangleSoup soup = lump(3, 1);
  const Renumbered other = renumbered(moved(soup), 5);
  const TriangleMesh a = meshOf(soup), b = meshOf(other.soup);
  const SpectralSurface x = spectral(a), y = spectral(b);
  const auto found = matches(x, y);
  ASSERT_FALSE(found.empty());
  EXPECT_LT(errors(x, y, found[0].functional, carried(other)).back(), 0.05);
  const TriangleMesh tetrahedron = meshOf(
      {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}});
  const SpectralSurface tiny = spectral(tetrahedron);
  Context context;
  EXPECT_OK(matchSpectra(context, tiny, tiny));
}

TEST(SpectralMatch, StopsWhenCancelled) {
  const TriangleMesh mesh = meshOf(lump(8, 1));
  const SpectralSurface surface = spectral(mesh);
  Context context;
  CancelToken token;
  token.cancel();
  context.setCancelToken(token);
  EXPECT_THAT(makeSpectralSurface(context, mesh), FailsWith(Reason::kCancelled));
  EXPECT_THAT(matchSpectra(context, surface, surface), FailsWith(Reason::kCancelled));
  EXPECT_THAT(correspondingPoints(context, surface, surface, Eigen::MatrixXd::Identity(10, 10)),
              FailsWith(Reason::kCancelled));
}

// Limbs of real meshes turned by 25 to 40 degrees, whose edges change by up to a half where they
// join the body; renumbered, so that numbers do not tell.
void expectArticulatedMatch(const std::string& path) {
  Context context;
  const TriangleSoup soup = *readMeshFile(context, path);
  SampleRandom random(1);
  const Renumbered other = renumbered(moved(articulated(soup, random)), 5);
  const TriangleMesh a = meshOf(soup), b = meshOf(other.soup);
  const SpectralSurface x = spectral(a), y = spectral(b);
  const auto found = matches(x, y);
  ASSERT_FALSE(found.empty());
  const auto error = errors(x, y, found[0].functional, carried(other));
  EXPECT_LE(mean(error), 0.03);
  EXPECT_LE(error[error.size() * 9 / 10], 0.1);
}

TEST(SpectralMatch, FollowsTheLimbsOfASymmetricAnimal) {
  MODULI_NEED_SHARED_MESH(path, "closed_g0/alec__spot.obj");
  expectArticulatedMatch(path);
}

TEST(SpectralMatch, FollowsTheLimbsOfAFigure) {
  MODULI_NEED_SHARED_MESH(path, "closed_g0/alec__homer.obj");
  expectArticulatedMatch(path);
}

TEST(SpectralMatch, FollowsTheLimbsOfGenusFour) {
  MODULI_NEED_SHARED_MESH(path, "genus3plus/libigl-data__fertility.off");
  expectArticulatedMatch(path);
}

}  // namespace
}  // namespace moduli
