#include "core/intrinsic/mollify.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "tests/core/testing.h"

namespace moduli {
namespace {

/// A tetrahedron; its edges in order of their lowest halfedges are 01, 12, 20, 23, 30, 31.
Connectivity tetrahedron() {
  return *Connectivity::fromFaces(4, {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}});
}

double leastSlack(const Connectivity& surface, const std::vector<double>& lengths) {
  double least = std::numeric_limits<double>::infinity();
  for (Index f = 0; f < surface.faceCount(); ++f) {
    const double a = lengths[surface.edge(3 * f)];
    const double b = lengths[surface.edge(3 * f + 1)];
    const double c = lengths[surface.edge(3 * f + 2)];
    least = std::min({least, a + b - c, b + c - a, c + a - b});
  }
  return least;
}

TEST(Mollify, LeavesSoundMeshesUntouched) {
  const Connectivity surface = tetrahedron();
  const std::vector<double> lengths{1, 1.1, 0.9, 1, 1.05, 0.95};
  const auto result = mollify(surface, lengths);
  ASSERT_OK(result);
  EXPECT_EQ(result->lengths, lengths);
  EXPECT_EQ(result->relative_shift, 0);
}

TEST(Mollify, GivesZeroAreaFacesTheAskedSlackAndNoMore) {
  const Connectivity surface = tetrahedron();
  // Face 0 is flat: 1 + 1 = 2.
  std::vector<double> lengths(6, 1.5);
  lengths[surface.edge(0)] = lengths[surface.edge(1)] = 1;
  lengths[surface.edge(2)] = 2;
  const double mean = std::accumulate(lengths.begin(), lengths.end(), 0.0) / 6;
  for (const double slack : {1e-10, 1e-3}) {
    const auto result = mollify(surface, lengths, slack);
    ASSERT_OK(result);
    // All lengths grow by the same amount, which is the slack that face 0 lacks.
    EXPECT_NEAR(result->relative_shift / slack, 1, 1e-5);
    for (int e = 0; e < 6; ++e) {
      EXPECT_NEAR(result->lengths[e] - lengths[e], slack * mean, 1e-15);
    }
    EXPECT_NEAR(leastSlack(surface, result->lengths) / (slack * mean), 1, 1e-5);
  }
}

TEST(Mollify, RepairsEdgesOfLengthZeroAndBrokenTriangles) {
  const Connectivity surface = tetrahedron();
  std::vector<double> collapsed(6, 1.0);
  collapsed[surface.edge(0)] = 0;
  const auto thin = mollify(surface, collapsed);
  ASSERT_OK(thin);
  EXPECT_GT(leastSlack(surface, thin->lengths), 0);
  std::vector<double> broken(6, 1.0);
  broken[surface.edge(0)] = 5;  // The sides 1 and 1 beside it lack 3.
  const auto mended = mollify(surface, broken);
  ASSERT_OK(mended);
  EXPECT_GT(leastSlack(surface, mended->lengths), 0);
  EXPECT_NEAR(mended->lengths[surface.edge(1)], 4, 1e-9);
}

TEST(Mollify, CommutesWithScalingAndRenumbering) {
  const Connectivity surface = tetrahedron();
  const std::vector<double> lengths{1, 1, 2, 1.5, 0.6, 1.2};
  const auto plain = mollify(surface, lengths);
  ASSERT_OK(plain);
  ASSERT_GT(plain->relative_shift, 0);
  for (const double factor : {0x1p-900, 0x1p900}) {
    std::vector<double> scaled = lengths;
    for (double& length : scaled) length *= factor;
    const auto result = mollify(surface, scaled);
    ASSERT_OK(result);
    EXPECT_NEAR(result->relative_shift / plain->relative_shift, 1, 1e-14);
    for (int e = 0; e < 6; ++e) {
      EXPECT_NEAR(result->lengths[e] / factor, plain->lengths[e], 1e-15);
    }
  }
  // Vertices 0 1 2 3 become 2 0 3 1; faces are listed in another order.
  const std::array<Index, 4> to{2, 0, 3, 1};
  std::vector<Triangle> faces;
  for (const Index f : {2, 0, 3, 1}) {
    const Triangle& face = surface.face(f);
    faces.push_back({to[face[1]], to[face[2]], to[face[0]]});
  }
  const Connectivity other = *Connectivity::fromFaces(4, faces);
  const auto edgeBetween = [](const Connectivity& s, Index v, Index w) {
    for (Index h = 0; h < s.halfedgeCount(); ++h) {
      if (s.tail(h) == v && s.head(h) == w) return s.edge(h);
    }
    return kNone;
  };
  std::vector<double> moved(6);
  std::vector<Index> image(6);
  for (Index e = 0; e < 6; ++e) {
    const Index h = surface.halfedge(e);
    image[e] = edgeBetween(other, to[surface.tail(h)], to[surface.head(h)]);
    moved[image[e]] = lengths[e];
  }
  const auto result = mollify(other, moved);
  ASSERT_OK(result);
  for (Index e = 0; e < 6; ++e) {
    EXPECT_NEAR(result->lengths[image[e]], plain->lengths[e], 1e-15);
  }
}

/// A slack far below the rounding of the lengths themselves would be lost in adding it.
TEST(Mollify, SlackIsNeverBelowTheRoundingOfTheLengths) {
  const Connectivity surface = tetrahedron();
  std::vector<double> lengths(6, 1e12);
  lengths[surface.edge(0)] = 2e12;
  const auto result = mollify(surface, lengths, 1e-30);
  ASSERT_OK(result);
  EXPECT_GT(leastSlack(surface, result->lengths), 0);
}

TEST(Mollify, RefusesWhatIsNoLength) {
  const Connectivity surface = tetrahedron();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double bad : {-1.0, infinity, std::nan("")}) {
    std::vector<double> lengths(6, 1.0);
    lengths[3] = bad;
    const auto result = mollify(surface, lengths);
    ASSERT_THAT(result, FailsWith(Reason::kInvalidOption));
    EXPECT_THAT(result.status().message(), testing::HasSubstr("edge 3"));
  }
  EXPECT_THAT(mollify(surface, std::vector<double>(6, 0.0)), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(mollify(surface, std::vector<double>(5, 1.0)), FailsWith(Reason::kInvalidOption));
}

}  // namespace
}  // namespace moduli
