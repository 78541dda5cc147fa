#include "core/retrieval/clusters.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "tests/core/testing.h"

namespace moduli {
namespace {

using Members = std::vector<std::size_t>;

TEST(ClusterPairs, ChainsJoinWhatIsFarApart) {
  // 0 - 4 - 2 at 1 and 2; 1 - 5 at 0; 3 alone, with a link that is too long.
  const std::vector<ItemPair> pairs = {{4, 2, 2}, {1, 5, 0}, {0, 4, 1}, {3, 1, 2.5}, {3, 3, 0}};
  const auto clusters = clusterPairs(6, pairs, 2);
  ASSERT_OK(clusters);
  ASSERT_EQ(clusters->size(), 2U);
  EXPECT_EQ((*clusters)[0].members, (Members{0, 2, 4}));
  EXPECT_EQ((*clusters)[0].linkage, 2);
  EXPECT_EQ((*clusters)[1].members, (Members{1, 5}));
  EXPECT_EQ((*clusters)[1].linkage, 0);
}

TEST(ClusterPairs, ThresholdZeroFindsDuplicatesAlone) {
  const std::vector<ItemPair> pairs = {{0, 1, 0}, {1, 2, 1e-300}, {2, 3, 0}};
  const auto clusters = clusterPairs(4, pairs, 0);
  ASSERT_OK(clusters);
  ASSERT_EQ(clusters->size(), 2U);
  EXPECT_EQ((*clusters)[0].members, (Members{0, 1}));
  EXPECT_EQ((*clusters)[1].members, (Members{2, 3}));
}

std::vector<ItemPair> randomPairs(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<double> x, y;
  for (std::size_t i = 0; i < count; ++i) {
    x.push_back(uniform(random));
    y.push_back(uniform(random));
  }
  std::vector<ItemPair> pairs;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      pairs.push_back({i, k, std::hypot(x[i] - x[k], y[i] - y[k])});
    }
  }
  return pairs;
}

// A second method: labels spread along close pairs until nothing changes.
std::vector<std::size_t> spreadLabels(std::size_t count, const std::vector<ItemPair>& pairs,
                                      double threshold) {
  std::vector<std::size_t> label(count);
  for (std::size_t i = 0; i < count; ++i) label[i] = i;
  for (bool changed = true; changed;) {
    changed = false;
    for (const ItemPair& pair : pairs) {
      if (pair.distance > threshold || label[pair.a] == label[pair.b]) continue;
      label[pair.a] = label[pair.b] = std::min(label[pair.a], label[pair.b]);
      changed = true;
    }
  }
  return label;
}

TEST(ClusterPairs, AgreesWithLabelsSpreadAlongPairs) {
  for (const double threshold : {0.02, 0.05, 0.08, 0.12}) {
    const auto pairs = randomPairs(150, 5);
    const auto clusters = clusterPairs(150, pairs, threshold);
    ASSERT_OK(clusters);
    std::vector<std::size_t> label(150);
    for (std::size_t i = 0; i < 150; ++i) label[i] = i;
    for (const Cluster& cluster : *clusters) {
      for (const std::size_t i : cluster.members) label[i] = cluster.members.front();
    }
    EXPECT_EQ(label, spreadLabels(150, pairs, threshold)) << threshold;
  }
}

TEST(ClusterPairs, LinkageIsTheLeastThresholdThatKeepsAClusterWhole) {
  const auto pairs = randomPairs(150, 6);
  const auto clusters = clusterPairs(150, pairs, 0.07);
  ASSERT_OK(clusters);
  ASSERT_GT(clusters->size(), 5U);
  for (const Cluster& cluster : *clusters) {
    const auto holds = [&](double threshold) {
      const auto again = clusterPairs(150, pairs, threshold);
      return std::any_of(again->begin(), again->end(),
                         [&](const Cluster& c) { return c.members == cluster.members; });
    };
    EXPECT_TRUE(holds(cluster.linkage));
    EXPECT_FALSE(holds(std::nextafter(cluster.linkage, 0)));
  }
}

TEST(ClusterPairs, OrderDirectionAndRepetitionOfPairsDoNotMatter) {
  auto pairs = randomPairs(80, 7);
  const auto before = clusterPairs(80, pairs, 0.08);
  std::mt19937 random(8);
  const auto half = pairs.size() / 2;
  for (std::size_t i = 0; i < half; ++i)
    pairs.push_back({pairs[i].b, pairs[i].a, pairs[i].distance});
  std::shuffle(pairs.begin(), pairs.end(), random);
  const auto after = clusterPairs(80, pairs, 0.08);
  ASSERT_OK(before);
  ASSERT_OK(after);
  ASSERT_EQ(before->size(), after->size());
  for (std::size_t c = 0; c < before->size(); ++c) {
    EXPECT_EQ((*before)[c].members, (*after)[c].members);
    EXPECT_EQ((*before)[c].linkage, (*after)[c].linkage);
  }
}

TEST(ClusterPairs, RefusesWhatIsNoPair) {
  const auto pair = [](std::size_t a, std::size_t b, double distance) {
    return std::vector<ItemPair>{{a, b, distance}};
  };
  EXPECT_THAT(clusterPairs(2, pair(0, 2, 1), 1), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(clusterPairs(2, pair(0, 1, -1), 1), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(clusterPairs(2, pair(0, 1, std::nan("")), 1), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(clusterPairs(2, {}, std::nan("")), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(clusterPairs(std::size_t{1} << 31U, {}, 1), FailsWith(Reason::kInvalidOption));
  const auto none = clusterPairs(0, {}, std::numeric_limits<double>::infinity());
  ASSERT_OK(none);
  EXPECT_TRUE(none->empty());
}

}  // namespace
}  // namespace moduli
