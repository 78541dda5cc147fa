#include "core/retrieval/evaluation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "tests/core/testing.h"

namespace moduli {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();
// Sums of a few hundred fractions in another order.
constexpr double kRounding = 1e-13;

using Labels = std::vector<std::string>;
using Ranking = std::vector<std::size_t>;

// Three of A, two of B, one of C, one without a label.
const Labels kLabels = {"A", "A", "A", "B", "B", "C", ""};

RetrievalJudge judgeOf(const Labels& labels, std::size_t recall_points = 11) {
  return *RetrievalJudge::make(labels, {.recall_points = recall_points});
}

void expectScores(const RetrievalScores& scores, const RetrievalScores& expected,
                  double tolerance) {
  EXPECT_NEAR(scores.nearest_neighbour, expected.nearest_neighbour, tolerance);
  EXPECT_NEAR(scores.first_tier, expected.first_tier, tolerance);
  EXPECT_NEAR(scores.second_tier, expected.second_tier, tolerance);
  EXPECT_NEAR(scores.mean_average_precision, expected.mean_average_precision, tolerance);
  EXPECT_NEAR(scores.dcg, expected.dcg, tolerance);
}

TEST(RetrievalJudge, AnswerWithBothRelevantItemsApartIsWorthWhatIsCountedByHand) {
  // A B A B C -: relevant at ranks 1 and 3.
  const auto answer = judgeOf(kLabels).judge(0, Ranking{1, 3, 2, 4, 5, 6});
  ASSERT_OK(answer);
  expectScores(answer->scores, {1, 0.5, 1, (1.0 + 2.0 / 3) / 2, (1 + 1 / std::log2(3.0)) / 2},
               1e-15);
  EXPECT_EQ(answer->nearest, "A");
  // Half of the relevant items at precision 1, all of them at 2 / 3.
  const std::vector<double> two_thirds(5, 2.0 / 3);
  std::vector<double> expected(6, 1.0);
  expected.insert(expected.end(), two_thirds.begin(), two_thirds.end());
  EXPECT_EQ(answer->precision, expected);
}

TEST(RetrievalJudge, OnlyRelevantItemAtRankThreeMissesBothTiers) {
  const auto answer = judgeOf(kLabels).judge(3, Ranking{5, 6, 4, 0, 1, 2});
  ASSERT_OK(answer);
  expectScores(answer->scores, {0, 0, 0, 1.0 / 3, 1 / std::log2(3.0)}, 1e-15);
  EXPECT_EQ(answer->nearest, "C");
  EXPECT_EQ(answer->precision, std::vector<double>(11, 1.0 / 3));
}

TEST(RetrievalJudge, RanksOneAndTwoGainTheSame) {
  // The gain of rank 2 is 1 / log2(2) = 1.
  const RetrievalJudge judge = judgeOf(kLabels);
  EXPECT_EQ(judge.judge(3, Ranking{0, 4})->scores.dcg, 1);
  EXPECT_EQ(judge.judge(3, Ranking{4, 0})->scores.dcg, 1);
  EXPECT_EQ(judge.judge(3, Ranking{0, 1, 5, 4})->scores.dcg, 0.5);  // 1 / log2(4).
}

TEST(RetrievalJudge, WhatIsNotFoundCountsAsNeverFound) {
  const auto part = judgeOf(kLabels).judge(1, Ranking{2});
  ASSERT_OK(part);
  expectScores(part->scores, {1, 0.5, 0.5, 0.5, 0.5}, 1e-15);
  EXPECT_EQ(part->precision, (std::vector<double>{1, 1, 1, 1, 1, 1, 0, 0, 0, 0, 0}));
  const auto nothing = judgeOf(kLabels).judge(1, Ranking{});
  ASSERT_OK(nothing);
  expectScores(nothing->scores, {0, 0, 0, 0, 0}, 0);
  EXPECT_EQ(nothing->nearest, "");
}

TEST(RetrievalJudge, PrecisionIsTheBestAtThatRecallOrAHigherOne) {
  // Relevant at ranks 3 and 4: precision 1/3, then 2/4.
  const auto answer = judgeOf(kLabels, 3).judge(0, Ranking{3, 4, 1, 2});
  ASSERT_OK(answer);
  EXPECT_EQ(answer->precision, (std::vector<double>{0.5, 0.5, 0.5}));
}

TEST(RetrievalJudge, LabelsThatNobodySharesAreNoQueries) {
  const RetrievalJudge judge = judgeOf(kLabels);
  EXPECT_TRUE(judge.isQuery(4));
  EXPECT_FALSE(judge.isQuery(5));
  EXPECT_FALSE(judge.isQuery(6));
  EXPECT_FALSE(judgeOf({"", "", "A"}).isQuery(0));
  EXPECT_THAT(judge.judge(5, Ranking{0}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(judge.judge(6, Ranking{0}), FailsWith(Reason::kInvalidOption));
}

TEST(RetrievalJudge, RefusesAnswersThatAreNone) {
  const RetrievalJudge judge = judgeOf(kLabels);
  EXPECT_THAT(judge.judge(0, Ranking{1, 0}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(judge.judge(0, Ranking{1, 2, 1}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(judge.judge(0, Ranking{7}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(judge.judge(7, Ranking{1}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(RetrievalJudge::make(kLabels, {.recall_points = 1}),
              FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(RetrievalJudge::make(kLabels, {.recall_points = 10002}),
              FailsWith(Reason::kInvalidOption));
}

// Every order of 6 items, 2 of them relevant, as often as every other: the means are those of a
// random ranking, to rounding. With r relevant ones of m, P(rank i is relevant) = r / m, and given
// that, each of the i - 1 before it is with (r - 1) / (m - 1).
TEST(RetrievalJudge, AllOrdersTogetherHaveTheExpectationsOfARandomRanking) {
  const RetrievalJudge judge = judgeOf(kLabels);
  Ranking order = {1, 2, 3, 4, 5, 6};
  RetrievalScores sum;
  double count = 0;
  do {
    const RetrievalScores scores = judge.judge(0, order)->scores;
    sum.nearest_neighbour += scores.nearest_neighbour;
    sum.first_tier += scores.first_tier;
    sum.second_tier += scores.second_tier;
    sum.mean_average_precision += scores.mean_average_precision;
    sum.dcg += scores.dcg;
    ++count;
  } while (std::next_permutation(order.begin(), order.end()));
  ASSERT_EQ(count, 720);
  constexpr double m = 6, r = 2;
  double average_precision = 0, gain = 0;
  for (double i = 1; i <= m; ++i) {
    average_precision += (1 + (i - 1) * (r - 1) / (m - 1)) / i / m;
    gain += r / m * (i < 2 ? 1 : 1 / std::log2(i));
  }
  const RetrievalScores mean = {sum.nearest_neighbour / count, sum.first_tier / count,
                                sum.second_tier / count, sum.mean_average_precision / count,
                                sum.dcg / count};
  expectScores(mean, {r / m, r / m, 2 * r / m, average_precision, gain / 2}, kRounding);
}

// Labels of unequal classes, and a matrix that is not symmetric, with ties and infinite entries.
struct Scene {
  Labels labels;
  std::vector<double> distances;
};

Scene randomScene(std::size_t items, unsigned seed) {
  std::mt19937 random(seed);
  Scene scene;
  for (std::size_t i = 0; i < items; ++i) {
    const auto label = random() % 7;
    scene.labels.push_back(label == 0 ? "" : std::string(1, static_cast<char>('a' + label)));
  }
  for (std::size_t i = 0; i < items * items; ++i) {
    const auto value = random() % 50;
    scene.distances.push_back(value == 0 ? kFar : static_cast<double>(value) / 8);
  }
  return scene;
}

// A second method: ranks by counting what is nearer, no sorting.
RetrievalScores countedScores(const Scene& scene, std::size_t query) {
  const std::size_t n = scene.labels.size();
  const double* row = scene.distances.data() + query * n;
  double relevant = 0, ideal = 0;
  std::vector<double> ranks;
  for (std::size_t i = 0; i < n; ++i) {
    if (i == query || scene.labels[i] != scene.labels[query]) continue;
    ideal += ++relevant <= 2 ? 1 : std::log(2.0) / std::log(relevant);
    if (row[i] == kFar) continue;
    double rank = 1;
    for (std::size_t k = 0; k < n; ++k) {
      if (k != query && k != i && (row[k] < row[i] || (row[k] == row[i] && k < i))) ++rank;
    }
    ranks.push_back(rank);
  }
  RetrievalScores scores;
  for (const double rank : ranks) {
    const auto found =
        std::count_if(ranks.begin(), ranks.end(), [&](double r) { return r <= rank; });
    scores.nearest_neighbour += rank == 1 ? 1 : 0;
    scores.first_tier += rank <= relevant ? 1 / relevant : 0;
    scores.second_tier += rank <= 2 * relevant ? 1 / relevant : 0;
    scores.mean_average_precision += static_cast<double>(found) / rank / relevant;
    scores.dcg += (rank <= 2 ? 1 : std::log(2.0) / std::log(rank)) / ideal;
  }
  return scores;
}

TEST(EvaluateDistances, AgreesWithRanksFoundByCounting) {
  Context context;
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Scene scene = randomScene(40, seed);
    const auto evaluation = evaluateDistances(context, scene.labels, scene.distances);
    ASSERT_OK(evaluation);
    ASSERT_GT(evaluation->queries.size(), 25U);
    for (const QueryEvaluation& query : evaluation->queries) {
      expectScores(query.scores, countedScores(scene, query.query), kRounding);
    }
  }
}

TEST(EvaluateDistances, RenumberingItemsChangesNothingWhereNoDistancesAreEqual) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  Scene scene = randomScene(40, 4);
  for (double& distance : scene.distances) distance = uniform(random);
  std::vector<std::size_t> order(40);
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), random);
  Scene renumbered;
  for (const std::size_t i : order) {
    renumbered.labels.push_back(scene.labels[i]);
    for (const std::size_t k : order) renumbered.distances.push_back(scene.distances[40 * i + k]);
  }
  Context context;
  const auto a = evaluateDistances(context, scene.labels, scene.distances);
  const auto b = evaluateDistances(context, renumbered.labels, renumbered.distances);
  ASSERT_OK(a);
  ASSERT_OK(b);
  expectScores(a->scores, b->scores, kRounding);
  EXPECT_EQ(a->tied, 0U);
  ASSERT_EQ(a->per_class.size(), b->per_class.size());
  for (std::size_t c = 0; c < a->per_class.size(); ++c) {
    EXPECT_EQ(a->per_class[c].label, b->per_class[c].label);
    EXPECT_EQ(a->per_class[c].nearest, b->per_class[c].nearest);
    expectScores(a->per_class[c].scores, b->per_class[c].scores, kRounding);
  }
  for (std::size_t j = 0; j < 11; ++j) EXPECT_NEAR(a->precision[j], b->precision[j], kRounding);
}

TEST(EvaluateDistances, SeparatedClassesScoreOneEverywhere) {
  Scene scene;
  for (int i = 0; i < 12; ++i) scene.labels.emplace_back(1, static_cast<char>('a' + i % 3));
  for (int i = 0; i < 12; ++i) {
    for (int k = 0; k < 12; ++k) scene.distances.push_back(i % 3 == k % 3 ? 0.1 : 0.2);
  }
  Context context;
  const auto evaluation = evaluateDistances(context, scene.labels, scene.distances);
  ASSERT_OK(evaluation);
  expectScores(evaluation->scores, {1, 1, 1, 1, 1}, 1e-15);
  EXPECT_EQ(evaluation->precision, std::vector<double>(11, 1.0));
  EXPECT_EQ(evaluation->tied, 0U);
}

TEST(EvaluateDistances, TableOfClassesAddsUp) {
  Context context;
  // Distances |i - k| on a line: A A A B B C -.
  std::vector<double> distances;
  for (int i = 0; i < 7; ++i) {
    for (int k = 0; k < 7; ++k) distances.push_back(std::abs(i - k));
  }
  const auto evaluation = evaluateDistances(context, kLabels, distances);
  ASSERT_OK(evaluation);
  ASSERT_EQ(evaluation->queries.size(), 5U);
  ASSERT_EQ(evaluation->per_class.size(), 2U);
  const ClassEvaluation& a = evaluation->per_class[0];
  const ClassEvaluation& b = evaluation->per_class[1];
  EXPECT_EQ(a.label, "A");
  EXPECT_EQ(a.members, 3U);
  EXPECT_EQ(a.nearest, (std::map<std::string, std::size_t>{{"A", 3}}));
  EXPECT_EQ(b.members, 2U);
  // Item 3 has 2 (A) and 4 (B) at distance 1 and takes the lower one; item 4 takes 3, not 5.
  EXPECT_EQ(b.nearest, (std::map<std::string, std::size_t>{{"A", 1}, {"B", 1}}));
  // Item 2's 1 and 3, 3's 2 and 4, and 4's 3 and 5 are of different kinds at one distance.
  EXPECT_EQ(evaluation->tied, 3U);
  EXPECT_NEAR(evaluation->scores.nearest_neighbour, 4.0 / 5, 1e-15);
  EXPECT_NEAR(evaluation->scores.dcg, (3 * a.scores.dcg + 2 * b.scores.dcg) / 5, 1e-15);
}

TEST(EvaluateDistances, NothingWithinReachScoresZero) {
  Context context;
  const auto evaluation = evaluateDistances(context, {"A", "A", "B"}, std::vector<double>(9, kFar));
  ASSERT_OK(evaluation);
  EXPECT_EQ(evaluation->queries.size(), 2U);
  expectScores(evaluation->scores, {0, 0, 0, 0, 0}, 0);
  EXPECT_EQ(evaluation->per_class[0].nearest, (std::map<std::string, std::size_t>{{"", 2}}));
}

TEST(EvaluateDistances, WithoutQueriesThereAreNoScores) {
  Context context;
  const auto empty = evaluateDistances(context, {}, {});
  ASSERT_OK(empty);
  EXPECT_TRUE(empty->queries.empty());
  const auto alone = evaluateDistances(context, {"A", "B"}, std::vector<double>(4, 1));
  ASSERT_OK(alone);
  EXPECT_TRUE(alone->queries.empty());
  EXPECT_TRUE(alone->per_class.empty());
  expectScores(alone->scores, {0, 0, 0, 0, 0}, 0);
}

TEST(EvaluateDistances, RefusesWhatIsNoDistance) {
  Context context;
  const Labels labels = {"A", "A"};
  EXPECT_THAT(evaluateDistances(context, labels, std::vector<double>(3, 1)),
              FailsWith(Reason::kInvalidOption));
  const double nan = std::nan("");
  EXPECT_THAT(evaluateDistances(context, labels, std::vector<double>{0, nan, 1, 0}),
              FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(evaluateDistances(context, labels, std::vector<double>{0, 1, -1, 0}),
              FailsWith(Reason::kInvalidOption));
  EXPECT_OK(evaluateDistances(context, labels, std::vector<double>{nan, 1, 1, -1}));
}

TEST(EvaluateDistances, StopsWhenTold) {
  Context context;
  CancelToken token;
  context.setCancelToken(token);
  token.cancel();
  EXPECT_THAT(evaluateDistances(context, {"A", "A"}, std::vector<double>(4, 1)),
              FailsWith(Reason::kCancelled));
}

}  // namespace
}  // namespace moduli
