#include "core/matching/harmonic_match.h"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <string>

#include "core/intrinsic/edge_graph.h"
#include "core/matching/map_report.h"
#include "core/matching/match_handles.h"
#include "core/mesh/read.h"
#include "core/mesh/sample_tools.h"
#include "tests/bench/retrieval/deform.h"
#include "tests/bench/retrieval/remesh.h"
#include "tests/core/matching/cover_samples.h"
#include "tests/core/matching/renumbered.h"

namespace moduli {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

HarmonicMatch matched(const TriangleMesh& a, const CoverSurface& cover,
                      const std::vector<SurfacePoint>& targets, double smoothing) {
  Context context;
  auto match =
      matchHarmonically(context, a.connectivity(), a.edgeLengths(), cover, targets, {smoothing});
  EXPECT_OK(match);
  expectConsistent(a.connectivity(), cover, match->map);
  EXPECT_GE(match->energy_ratio, 1);
  return *std::move(match);
}

/// Per vertex the nearest one of another mesh at its place.
std::vector<Index> nearestVertices(const TriangleMesh& a, const TriangleMesh& b) {
  std::vector<Index> nearest;
  for (const Eigen::Vector3d& p : a.positions()) {
    const auto nearer = [&](const Eigen::Vector3d& q, const Eigen::Vector3d& r) {
      return (p - q).squaredNorm() < (p - r).squaredNorm();
    };
    nearest.push_back(
        static_cast<Index>(std::min_element(b.positions().begin(), b.positions().end(), nearer) -
                           b.positions().begin()));
  }
  return nearest;
}

/// One in twenty anywhere, the others moved by up to 2 % of the root of the area.
std::vector<SurfacePoint> disturbed(const TriangleMesh& b, const std::vector<Index>& image) {
  const EdgeGraph graph(b.connectivity(), b.edgeLengths());
  SampleRandom random(11);
  std::vector<SurfacePoint> targets;
  for (Index v : image) {
    if (random.uniform() < 0.05) {
      v = static_cast<Index>(random.next() % static_cast<std::uint64_t>(b.vertexCount()));
    } else {
      const auto near = graph.within(v, 0.02 * std::sqrt(b.area()));
      v = near[random.next() % near.size()].first;
    }
    targets.push_back(vertexPoint(b.connectivity(), v));
  }
  return targets;
}

TEST(HarmonicMatch, DoesNotDependOnNumberingPositionAndScale) {
  for (const TriangleSoup& soup : {lumpyTorus(12, 2), lumpyPlate(4, 2)}) {
    const Renumbered other = renumbered(moved(soup), 4), source = renumbered(soup, 9);
    const TriangleMesh a = meshOf(soup), b = meshOf(other.soup), c = meshOf(source.soup);
    const CoverSurface to_a = coverOf(a), to_b = coverOf(b);
    const auto own = matched(a, to_a, vertexTargets(a, sameNumbers(a)), 0.1);
    const auto across = matched(a, to_b, vertexTargets(b, other.image), 0.1);
    const auto renamed = matched(c, to_a,
                                 vertexTargets(a,
                                               [&] {
                                                 std::vector<Index> back(source.image.size());
                                                 for (std::size_t v = 0; v < back.size(); ++v) {
                                                   back[source.image[v]] = static_cast<Index>(v);
                                                 }
                                                 return back;
                                               }()),
                                 0.1);
    EXPECT_NEAR(own.energy_ratio, across.energy_ratio, 1e-9);
    EXPECT_NEAR(own.energy_ratio, renamed.energy_ratio, 1e-9);
    const Eigen::AngleAxisd turn(1.1, Eigen::Vector3d(1, 2, -1).normalized());
    double apart = 0;
    for (Index v = 0; v < a.vertexCount(); ++v) {
      const Eigen::Vector3d here = spaceAt(a, own.map.images[v]);
      const Eigen::Vector3d there =
          2 * (turn * here) + Eigen::Vector3d(5, -3, 1) - spaceAt(b, across.map.images[v]);
      const Eigen::Vector3d same = here - spaceAt(a, renamed.map.images[source.image[v]]);
      apart = std::max({apart, there.norm(), same.norm()});
    }
    EXPECT_LT(apart, 1e-6);
  }
}

TEST(HarmonicMatch, IsNearTheIdentityOfASurfaceAndNearerWithShorterSmoothing) {
  const TriangleMesh mesh = meshOf(lumpyPlate(8, 2));
  const CoverSurface cover = coverOf(mesh);
  double before = 1;
  for (const double smoothing : {kInfinity, 0.1, 0.03, 0.003}) {
    const auto match = matched(mesh, cover, vertexTargets(mesh, sameNumbers(mesh)), smoothing);
    const MapErrors errors = errorsOf(mesh, match.map.images, mesh.positions());
    std::cout << "smoothing " << smoothing << ": mean error " << errors.mean << ", largest "
              << errors.largest << ", energy " << match.energy_ratio << "\n";
    EXPECT_LT(errors.mean, before);
    before = errors.mean;
    EXPECT_EQ(match.smoothing, smoothing);
  }
  EXPECT_LT(before, 1e-3);
}

TEST(HarmonicMatch, NeverFoldsWhateverTheTargets) {
  // Noise as large as this leaves no face of the targets as it was. At so short a smoothing a few
  // faces of the torus fold, beside which targets fall silent, and many of the plate, for which it
  // is made longer.
  for (const bool is_torus : {true, false}) {
    const TriangleMesh mesh = meshOf(is_torus ? lumpyTorus(24, 2) : lumpyPlate(8, 2));
    const CoverSurface cover = coverOf(mesh);
    const auto match = matched(mesh, cover, disturbed(mesh, sameNumbers(mesh)), 0.0003);
    EXPECT_EQ(match.smoothing == 0.0003, is_torus);
    const auto smooth = matched(mesh, cover, disturbed(mesh, sameNumbers(mesh)), 0.04);
    const MapErrors errors = errorsOf(mesh, smooth.map.images, mesh.positions());
    std::cout << "replaced " << smooth.replaced << ", smoothing " << match.smoothing << " and "
              << smooth.smoothing << ", mean error " << errors.mean << "\n";
    EXPECT_LT(errors.mean, 0.01);
  }
}

TEST(HarmonicMatch, RefusesBadOptionsAndStopsWhenItIsTold) {
  Context context;
  const TriangleMesh mesh = meshOf(lumpyPlate(2, 0));
  const CoverSurface cover = coverOf(mesh);
  const std::vector<SurfacePoint> targets = vertexTargets(mesh, sameNumbers(mesh));
  EXPECT_THAT(
      matchHarmonically(context, mesh.connectivity(), mesh.edgeLengths(), cover, targets, {0}),
      FailsWith(Reason::kInvalidOption));
  CancelToken token;
  token.cancel();
  context.setCancelToken(token);
  EXPECT_THAT(matchHarmonically(context, mesh.connectivity(), mesh.edgeLengths(), cover, targets),
              FailsWith(Reason::kCancelled));
}

TEST(HarmonicMatch, IsNearlyConformalBetweenTriangulationsOfOneSurface) {
  // Of obtuse triangles, which simplifying makes: under positive weights alone the map would be far
  // from conformal there, with an energy of 1.2 and more.
  const TriangleSoup soup = lumpyPlate(8, 2);
  const TriangleMesh b = meshOf(soup);
  const TriangleMesh a = meshOf(simplified(soup, soup.faces.size() / 2));
  const auto match = matched(a, coverOf(b), vertexTargets(b, nearestVertices(a, b)), kInfinity);
  std::cout << "energy " << match.energy_ratio << ", error "
            << errorsOf(b, match.map.images, a.positions()).mean << "\n";
  EXPECT_LT(match.energy_ratio, 1.05);
}

TEST(HarmonicMatch, LeadsThereAndBack) {
  Context context;
  const TriangleSoup soup = lumpyPlate(4, 2);
  const TriangleMesh b = meshOf(soup);
  const TriangleMesh a = meshOf(simplified(soup, soup.faces.size() / 2));
  SpectralGuess guess;
  guess.method = MatchMethod::kMobius;
  guess.points = vertexTargets(b, nearestVertices(a, b));
  const auto match = matchHandles(context, {a, b}, coverOf(b), guess);
  ASSERT_OK(match);
  // Both ways are of straight faces, of one surface and the other: they differ within a face.
  EXPECT_LT(
      cycleError(a.connectivity(), a.positions(), match->images, b.connectivity(), match->inverse) /
          std::sqrt(a.area()),
      0.01);
}

/// Limbs turned, and the same simplified: with the truth told, and disturbed.
void matchReal(const std::string& path, double most) {
  Context context;
  const TriangleSoup soup = *readMeshFile(context, path);
  SampleRandom random(1);
  const TriangleMesh a = meshOf(soup), b = meshOf(articulated(soup, random));
  const CoverSurface cover = coverOf(b);
  const std::vector<Eigen::Vector3d>& truth = b.positions();
  const auto exact = matched(a, cover, vertexTargets(b, sameNumbers(b)), kInfinity);
  const auto match = matched(a, cover, disturbed(b, sameNumbers(b)), 0.04);
  const MapErrors harmonic = errorsOf(b, exact.map.images, truth);
  const MapErrors pulled = errorsOf(b, match.map.images, truth);
  std::cout << path << ": harmonic mean error " << harmonic.mean << ", energy "
            << exact.energy_ratio << "; disturbed targets: replaced " << match.replaced
            << ", mean error " << pulled.mean << ", largest " << pulled.largest << ", smoothing "
            << match.smoothing << "\n";
  EXPECT_LT(pulled.mean, most);
  // From fewer faces: no vertex of A is one of B.
  const TriangleSoup fewer = simplified(soup, soup.faces.size() * 6 / 10);
  const TriangleMesh c = meshOf(fewer), whole = meshOf(soup);
  const std::vector<Index> nearest = nearestVertices(c, whole);
  const auto across = matched(c, cover, disturbed(b, nearest), 0.04);
  const MapErrors coarse = errorsOf(b, across.map.images, vertexPlaces(b, nearest));
  std::cout << "  of fewer faces: energy " << across.energy_ratio << ", mean error " << coarse.mean
            << ", largest " << coarse.largest << "\n";
  // The root of the area of a face: how far the nearest vertices are from where they should be.
  EXPECT_LT(coarse.mean, most + 1 / std::sqrt(static_cast<double>(soup.faces.size())));
}

TEST(HarmonicMatch, MatchesArticulatedRealSurfaces) {
  MODULI_NEED_SHARED_MESH(eight, "genus2/ceaedf__eight.off");
  MODULI_NEED_SHARED_MESH(fertility, "genus3plus/libigl-data__fertility.off");
  MODULI_NEED_SHARED_MESH(kitten, "genus1/ceaedf__Kitten.off");
  matchReal(eight, 0.01);
  matchReal(fertility, 0.01);
  matchReal(kitten, 0.01);
}

TEST(HarmonicMatch, MatchesRealSurfacesOfTwoResolutions) {
  Context context;
  MODULI_NEED_SHARED_MESH(coarse_rocker, "genus1/ceaedf__rocker-arm2500.off");
  MODULI_NEED_SHARED_MESH(rocker, "genus1/alec__rocker-arm.obj");
  const TriangleMesh a = meshOf(*readMeshFile(context, coarse_rocker));
  const TriangleMesh b = meshOf(*readMeshFile(context, rocker));
  const CoverSurface cover = coverOf(b);
  const auto match = matched(a, cover, disturbed(b, nearestVertices(a, b)), 0.04);
  const MapErrors errors = errorsOf(b, match.map.images, a.positions());
  std::cout << "rocker-arm: replaced " << match.replaced << ", mean error " << errors.mean << "\n";
  EXPECT_LT(errors.mean, 0.01);
}

}  // namespace
}  // namespace moduli
