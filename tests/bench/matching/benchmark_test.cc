#include <algorithm>
#include <cmath>

#include "core/matching/map_report.h"
#include "core/mesh/samples.h"
#include "core/topology/surface_topology.h"
#include "tests/bench/matching/errors.h"
#include "tests/bench/matching/pairs.h"
#include "tests/core/matching/lumps.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

MatchBase base(int resolution = 12) {
  return {"lump", lump(resolution, 1)};
}

KnownPair pairOf(const std::string& kind, double noise = 0) {
  auto pair = makePair(base(), kind, {1, noise});
  EXPECT_OK(pair);
  return *std::move(pair);
}

/// Per vertex of a the vertex of b nearest to the truth.
std::vector<SurfacePoint> nearestVertices(const KnownPair& pair) {
  std::vector<SurfacePoint> images;
  for (const Eigen::Vector3d& p : pair.truth) {
    Index nearest = 0;
    for (Index v = 0; v < pair.b.vertexCount(); ++v) {
      if ((pair.b.positions()[v] - p).norm() < (pair.b.positions()[nearest] - p).norm()) {
        nearest = v;
      }
    }
    images.push_back(vertexPoint(pair.b.connectivity(), nearest));
  }
  return images;
}

double longestEdge(const TriangleMesh& mesh) {
  const std::vector<double> lengths = mesh.edgeLengths();
  return *std::max_element(lengths.begin(), lengths.end()) / std::sqrt(mesh.area());
}

TEST(KnownPairs, KnowTheTruth) {
  for (const std::string& kind : matchKinds()) {
    const KnownPair pair = pairOf(kind);
    ASSERT_EQ(pair.truth.size(), static_cast<std::size_t>(pair.a.vertexCount()));
    const std::vector<double> errors = matchErrors(pair, nearestVertices(pair));
    // Vertices that simplifying took lie within an edge of one that stayed.
    const bool same = kind == "copy" || kind == "inverted";
    EXPECT_LE(errors.back(), same ? 1e-12 : longestEdge(pair.b)) << kind;
  }
}

TEST(KnownPairs, HaveTheNoiseAskedFor) {
  const KnownPair clean = pairOf("copy"), noisy = pairOf("copy", 0.01);
  double squares = 0;
  for (std::size_t v = 0; v < clean.truth.size(); ++v) {
    squares += (noisy.b.positions()[v] - clean.b.positions()[v]).squaredNorm();
  }
  const double n = 3 * static_cast<double>(clean.truth.size());
  // Five standard errors of a deviation.
  EXPECT_NEAR(std::sqrt(squares / n / clean.b.area()) / 0.01, 1, 5 / std::sqrt(2 * n));
}

TEST(KnownPairs, AreOfTheKindsThatThereAre) {
  EXPECT_THAT(makePair(base(), "bent"), FailsWith(Reason::kInvalidOption));
}

TEST(KnownPairs, KeepBoundaries) {
  MODULI_NEED_SHARED_MESH(open, "genus2/cfwen__eight.hole.off");
  Context context;
  const auto base = readBase(context, open, 1000);
  ASSERT_OK(base);
  for (const std::string& kind : matchKinds()) {
    const auto pair = makePair(*base, kind);
    ASSERT_OK(pair) << kind;
    EXPECT_EQ(computeTopology(pair->b.connectivity()).boundary_loops.size(), 1U) << kind;
  }
}

TEST(MatchErrors, AreLengthsWithinTheSurface) {
  // On a sphere the way from everywhere to the north pole is the angle to it; along edges of these
  // triangles it is up to 1 / cos 30 degrees = 1.155 times as long.
  TriangleSoup sphere = *makeSample("sphere", {{"resolution", 8}});
  auto made = makePair({"sphere", sphere}, "copy");
  ASSERT_OK(made);
  KnownPair pair = *std::move(made);
  const double whole = std::sqrt(pair.b.area());
  const Eigen::Vector3d centre(5, -3, 1);  // moved() puts it there, and doubles the radius.
  const SurfacePoint pole = vertexPoint(pair.b.connectivity(), 0);
  const std::vector<SurfacePoint> images(pair.truth.size(), pole);
  std::vector<double> angles;
  const Eigen::Vector3d to_pole = (pair.b.positions()[0] - centre).normalized();
  for (const Eigen::Vector3d& p : pair.truth) {
    angles.push_back(2 * std::acos(std::clamp((p - centre).normalized().dot(to_pole), -1.0, 1.0)) /
                     whole);
  }
  std::sort(angles.begin(), angles.end());
  const std::vector<double> errors = matchErrors(pair, images, pair.truth.size());
  const double edge = longestEdge(pair.b);
  ASSERT_EQ(errors.size(), angles.size());
  for (std::size_t i = 0; i < errors.size(); ++i) {
    EXPECT_LE(errors[i], 1.16 * angles[i] + edge);
    EXPECT_GE(errors[i], 0.99 * angles[i] - edge);
  }
}

// Of a thin sheet, vertices of the other side are nearer to points within faces than their corners.
TEST(MatchErrors, StayOnTheirSideOfThinParts) {
  TriangleSoup sheet = *makeSample("sphere", {{"resolution", 12}, {"seed", 2}});
  for (Eigen::Vector3d& p : sheet.vertices) p.z() *= 0.01;
  const TriangleMesh mesh = *TriangleMesh::fromSoup(sheet);
  KnownPair pair{"sheet", "copy", mesh, mesh, {}};
  std::vector<SurfacePoint> images;
  for (Index f = 0; f < mesh.faceCount(); ++f) {
    images.push_back({f, {1.0 / 3, 1.0 / 3, 1.0 / 3}});
    pair.truth.push_back(spacePoint(mesh.connectivity(), mesh.positions(), images.back()));
  }
  EXPECT_LE(matchErrors(pair, images).back(), 1e-12);
}

TEST(PairScores, AreGoodForAGoodMatchAndTellFailures) {
  MatchOptions options;
  const PairScore good = scorePair(pairOf("copy"), options);
  EXPECT_EQ(good.failure, "");
  EXPECT_LE(good.mean, 0.02);
  EXPECT_EQ(good.near, 1);
  EXPECT_EQ(good.folded, 0);
  KnownPair wrong = pairOf("copy");
  wrong.b = *TriangleMesh::fromSoup(*makeSample("torus", {{"resolution", 8}}));
  const PairScore failed = scorePair(wrong, options);
  EXPECT_THAT(failed.failure, testing::HasSubstr("UNSUPPORTED_TOPOLOGY"));
  const std::vector<PairScore> scores = {good, failed};
  const MeanScore mean = meanScore(scores, "copy");
  EXPECT_EQ(mean.pairs, 1U);
  EXPECT_EQ(mean.failures, 1U);
  EXPECT_EQ(mean.mean, good.mean);
  EXPECT_THAT(meanLines(scores), testing::HasSubstr("1 without a map"));
  EXPECT_THAT(scoreJson(scores), testing::HasSubstr("\"failures\":1"));
}

}  // namespace
}  // namespace moduli
