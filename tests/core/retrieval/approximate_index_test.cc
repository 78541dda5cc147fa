#include "core/retrieval/approximate_index.h"

#include <cmath>

#include "tests/core/retrieval/clouds.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

using Queries = std::vector<std::vector<float>>;

std::unique_ptr<ApproximateIndex> built(VectorSet set, double wanted_recall) {
  Context context;
  auto index = makeApproximateIndex(context, std::move(set), {wanted_recall});
  EXPECT_OK(index);
  return index.ok() ? *std::move(index) : nullptr;
}

struct Fresh {
  double recall = 0;
  double standard_error = 0;
};

// Against looking at every row, over queries that no index has seen.
Fresh freshRecall(const VectorIndex& index, const Queries& queries) {
  Context context;
  const auto brute = makeBruteForceIndex(index.rows());
  EXPECT_OK(brute);
  double sum = 0, squares = 0;
  for (const std::vector<float>& query : queries) {
    const auto truth = (*brute)->search(context, query, 10);
    const auto found = index.search(context, query, 10);
    EXPECT_OK(found);
    double right = 0;
    for (const Neighbor& neighbor : *found) {
      // Each is a true row at its true distance.
      if (std::find(truth->begin(), truth->end(), neighbor) != truth->end()) right += 0.1;
    }
    sum += right;
    squares += right * right;
  }
  const double n = static_cast<double>(queries.size()), mean = sum / n;
  return {mean, std::sqrt(std::max(0.0, squares / n - mean * mean) / n)};
}

// Both recalls are means of independent queries: their difference stays below four standard errors
// of it but once in 16000. The queries' share that is not seen at all in a sample is bounded too:
// 1 / queries.
TEST(ApproximateIndex, TheStatedRecallIsTrueOnFreshQueries) {
  for (const double wanted : {0.8, 0.99}) {
    for (const Shape shape : {Shape::kUniform, Shape::kFamilies}) {
      const auto index = built(setOf(shapedVectors(shape, 20000, 20, 1)), wanted);
      const MeasuredRecall& stated = index->recall();
      EXPECT_FALSE(index->exact());
      EXPECT_EQ(stated.queries, 400U);
      EXPECT_GE(stated.recall - 2 * stated.standard_error, wanted);
      const Fresh fresh = freshRecall(*index, shapedVectors(shape, 500, 20, 2));
      const double error = std::hypot(stated.standard_error, fresh.standard_error);
      // The held out rows of the stated recall are found for certain by fresh queries, which can
      // only add to it: 1 in 50 rows.
      EXPECT_GT(fresh.recall, stated.recall - 4 * error - 1.0 / 400);
      EXPECT_LT(fresh.recall,
                stated.recall + 4 * error + 1.0 / 50 * (1 - stated.recall) + 1.0 / 400);
      RecordProperty("recall", std::to_string(fresh.recall));
      std::printf("wanted %.2f stated %.4f +- %.4f fresh %.4f +- %.4f, %zu tiles\n", wanted,
                  stated.recall, stated.standard_error, fresh.recall, fresh.standard_error,
                  stated.tiles);
    }
  }
}

TEST(ApproximateIndex, LooksAtMoreForMoreRecall) {
  const VectorSet set = setOf(shapedVectors(Shape::kUniform, 10000, 20, 3));
  EXPECT_LT(built(set, 0.5)->recall().tiles, built(set, 0.95)->recall().tiles);
}

TEST(ApproximateIndex, TheOrderOfTheRowsDoesNotMatter) {
  const VectorSet set = setOf(shapedVectors(Shape::kFamilies, 8000, 12, 4));
  const auto index = built(set, 0.9), other = built(shuffled(set, 5), 0.9);
  EXPECT_EQ(index->recall().recall, other->recall().recall);
  Context context;
  for (const auto& query : shapedVectors(Shape::kFamilies, 50, 12, 6)) {
    EXPECT_EQ(*index->search(context, query, 10), *other->search(context, query, 10));
  }
}

TEST(ApproximateIndex, SmallAndPerfectOnesAreExact) {
  const VectorSet set = setOf(shapedVectors(Shape::kUniform, 5000, 8, 7));
  EXPECT_TRUE(built(set, 1)->exact());
  for (const std::size_t rows : {0, 1, 300}) {
    const auto index = built(setOf(shapedVectors(Shape::kUniform, rows, 8, 7)), 0.9);
    EXPECT_TRUE(index->exact());
    EXPECT_EQ(index->recall().recall, 1);
    EXPECT_EQ(index->recall().queries, 0U);
  }
}

TEST(ApproximateIndex, EqualRowsAndFarQueriesHaveTheirNeighbours) {
  const auto index = built(setOf(shapedVectors(Shape::kEqual, 5000, 6, 8)), 0.99);
  Context context;
  const auto near = index->search(context, std::vector<float>(6, 0.25F), 10);
  ASSERT_OK(near);
  ASSERT_EQ(near->size(), 10U);
  EXPECT_EQ(near->back().distance, 0);
  EXPECT_EQ(index->search(context, std::vector<float>(6, 1e38F), 6000)->size(), 5000U);
}

TEST(ApproximateIndex, RefusesWhatDoesNotFit) {
  Context context;
  const VectorSet set = setOf(shapedVectors(Shape::kUniform, 5000, 4, 9));
  for (const double recall : {0.0, -1.0, 1.5, std::nan("")}) {
    EXPECT_THAT(makeApproximateIndex(context, set, {recall}), FailsWith(Reason::kInvalidOption));
  }
  VectorSet bad = set;
  bad.values[17] = std::nanf("");
  EXPECT_THAT(makeApproximateIndex(context, bad), FailsWith(Reason::kInvalidOption));
  const auto index = built(set, 0.9);
  EXPECT_THAT(index->search(context, std::vector<float>(4, 0), 0),
              FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(index->search(context, std::vector<float>(3, 0), 1),
              FailsWith(Reason::kInvalidOption));
  CancelToken token;
  context.setCancelToken(token);
  token.cancel();
  EXPECT_THAT(index->search(context, std::vector<float>(4, 0), 1), FailsWith(Reason::kCancelled));
  EXPECT_THAT(makeApproximateIndex(context, set), FailsWith(Reason::kCancelled));
}

}  // namespace
}  // namespace moduli
