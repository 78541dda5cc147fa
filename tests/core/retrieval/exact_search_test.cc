#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/retrieval/lead_rows.h"
#include "core/retrieval/lead_tiles.h"
#include "core/retrieval/principal_axes.h"
#include "core/retrieval/squared_distance.h"
#include "core/retrieval/vector_index.h"
#include "tests/core/retrieval/clouds.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

using Accept = std::function<bool(std::int64_t)>;
using Queries = std::vector<std::vector<float>>;
using Answers = std::vector<std::vector<Neighbor>>;

std::unique_ptr<VectorIndex> built(Result<std::unique_ptr<VectorIndex>> index) {
  EXPECT_OK(index);
  return index.ok() ? *std::move(index) : nullptr;
}

Answers oneByOne(const VectorIndex& index, const Queries& queries, std::size_t k,
                 const Accept& accept = {}) {
  Context context;
  Answers answers;
  for (const std::vector<float>& query : queries) {
    auto found = index.search(context, query, k, accept);
    EXPECT_OK(found);
    answers.push_back(found.ok() ? *std::move(found) : std::vector<Neighbor>());
  }
  return answers;
}

Answers together(const VectorIndex& index, const Queries& queries, std::size_t k,
                 const Accept& accept = {}) {
  Context context;
  auto found = index.searchMany(context, queries, k, accept);
  EXPECT_OK(found);
  return found.ok() ? *std::move(found) : Answers();
}

// Fresh ones, rows themselves, and one from so far that float32 rounds all rows into one.
Queries makeQueries(Shape shape, const Queries& vectors, std::size_t count) {
  const std::size_t dimension = vectors[0].size();
  Queries queries = shapedVectors(shape, count, dimension, 77);
  for (std::size_t q = 0; q < count; q += 3) queries[q] = vectors[(q * 331) % vectors.size()];
  for (float& value : queries[1]) value = 1e38F;
  return queries;
}

TEST(ExactSearch, IsBruteForceToTheLastBitForOneAndForManyQueries) {
  for (const Shape shape : kShapes) {
    for (const std::size_t dimension : {1, 24}) {
      const Queries vectors = shapedVectors(shape, 5000, dimension, 1);
      const VectorSet set = setOf(vectors);
      const Queries queries = makeQueries(shape, vectors, 70);
      const auto brute = built(makeBruteForceIndex(set));
      const auto exact = built(makeFlannIndex(set, 2000));
      for (const std::size_t k : {1, 100}) {
        const Answers truth = oneByOne(*brute, queries, k);
        EXPECT_EQ(oneByOne(*exact, queries, k), truth) << static_cast<int>(shape) << dimension;
        EXPECT_EQ(together(*exact, queries, k), truth) << static_cast<int>(shape) << dimension;
      }
    }
  }
}

// So many uniform rows that the trees may not ask enough, and the scan answers, on two cores.
TEST(ExactSearch, IsBruteForceToTheLastBitWhereTreesGiveUp) {
  const Queries vectors = shapedVectors(Shape::kUniform, 110000, 12, 8);
  const VectorSet set = setOf(vectors);
  const Queries queries = makeQueries(Shape::kUniform, vectors, 20);
  const auto brute = built(makeBruteForceIndex(set));
  const auto exact = built(makeFlannIndex(set));
  const Accept few = [](std::int64_t id) { return id % 1000 == 7; };
  EXPECT_EQ(oneByOne(*exact, queries, 10), oneByOne(*brute, queries, 10));
  EXPECT_EQ(oneByOne(*exact, queries, 10, few), oneByOne(*brute, queries, 10, few));
}

TEST(ExactSearch, IsBruteForceToTheLastBitUnderFilters) {
  const Queries vectors = shapedVectors(Shape::kUniform, 9000, 24, 2);
  const VectorSet set = setOf(vectors);
  const Queries queries = makeQueries(Shape::kUniform, vectors, 20);
  const auto brute = built(makeBruteForceIndex(set));
  const auto exact = built(makeFlannIndex(set));
  for (const std::int64_t modulus : {2, 50, 5000, 100000}) {
    const Accept accept = [&](std::int64_t id) { return id / 7 % modulus == 1; };
    const Answers truth = oneByOne(*brute, queries, 10, accept);
    EXPECT_EQ(oneByOne(*exact, queries, 10, accept), truth) << modulus;
    EXPECT_EQ(together(*exact, queries, 10, accept), truth) << modulus;
  }
}

TEST(ExactSearch, TheOrderOfTheRowsDoesNotMatter) {
  for (const Shape shape : {Shape::kFamilies, Shape::kLattice, Shape::kEqual}) {
    const Queries vectors = shapedVectors(shape, 5000, 12, 3);
    const VectorSet set = setOf(vectors);
    const Queries queries = makeQueries(shape, vectors, 40);
    const Answers truth = oneByOne(*built(makeFlannIndex(set)), queries, 10);
    for (const unsigned seed : {1, 2}) {
      const auto other = built(makeFlannIndex(shuffled(set, seed), 1000));
      EXPECT_EQ(oneByOne(*other, queries, 10), truth) << static_cast<int>(shape);
      EXPECT_EQ(together(*other, queries, 10), truth) << static_cast<int>(shape);
    }
  }
}

TEST(ExactSearch, EdgesOfManyQueriesAreAsTheHeaderSays) {
  using Make = Result<std::unique_ptr<VectorIndex>> (*)(VectorSet);
  const Make makers[] = {[](VectorSet set) { return makeFlannIndex(std::move(set)); },
                         [](VectorSet set) { return makeBruteForceIndex(std::move(set)); }};
  Context context;
  for (const Make make : makers) {
    const auto index = built(make({2, {0, 0, 3, 4, 0, 0}, {9, 5, 2}}));
    EXPECT_TRUE(together(*index, {}, 1).empty());
    EXPECT_THAT(index->searchMany(context, Queries{}, 0), FailsWith(Reason::kInvalidOption));
    EXPECT_THAT(index->searchMany(context, Queries{{0, 0}, {0, std::nanf("")}}, 1),
                FailsWith(Reason::kInvalidOption));
    EXPECT_THAT(index->searchMany(context, Queries{{0, 0}, {0}}, 1),
                FailsWith(Reason::kInvalidOption));
    EXPECT_EQ(together(*index, {{0, 0}, {3, 4}}, 100),
              (Answers{{{2, 0}, {9, 0}, {5, 5}}, {{5, 0}, {2, 5}, {9, 5}}}));
    EXPECT_EQ(together(*built(make({2, {}, {}})), {{0, 0}}, 3), Answers(1));
    EXPECT_EQ(together(*built(make({0, {}, {4, 3}})), {{}, {}}, 3),
              (Answers{{{3, 0}, {4, 0}}, {{3, 0}, {4, 0}}}));
  }
}

TEST(ExactSearch, ManyQueriesStopWhenCancelled) {
  const Queries vectors = shapedVectors(Shape::kUniform, 20000, 16, 4);
  const auto index = built(makeFlannIndex(setOf(vectors)));
  Context context;
  CancelToken token;
  context.setCancelToken(token);
  std::atomic<int> calls = 0;
  const Accept accept = [&](std::int64_t) {
    if (++calls == 100) token.cancel();
    return false;
  };
  EXPECT_THAT(index->searchMany(context, Queries(64, vectors[0]), 5, accept),
              FailsWith(Reason::kCancelled));
  // A tile of 256 rows for all 64 queries, on two cores, at most; all would be 1.3e6.
  EXPECT_LT(calls, 100000);
}

TEST(PrincipalAxes, TurnedDistancesAreTrueUpToTheSlackAndLeadsBoundThem) {
  for (const Shape shape : kShapes) {
    for (const std::size_t dimension : {1, 7, 60}) {
      const Queries vectors = shapedVectors(shape, 300, dimension, 5);
      const VectorSet set = setOf(vectors);
      std::vector<std::uint32_t> rows(set.ids.size());
      std::iota(rows.begin(), rows.end(), 0);
      const PrincipalAxes axes(set, rows);
      const LeadRows leads(set, axes, rows, LeadRows::few(dimension));
      std::vector<float> turned(set.values.size());
      axes.turnRows(set, rows, turned.data());
      for (const auto& query : shapedVectors(shape, 20, dimension, 6)) {
        const auto w = axes.turn(query);
        ASSERT_TRUE(w.has_value());
        const std::vector<float> lead = leads.leadOf(*w);
        const std::vector<float> zero(dimension, 0);
        const double norm = std::sqrt(squaredDistance(w->data(), zero.data(), dimension));
        for (std::size_t row = 0; row < vectors.size(); ++row) {
          const double truth = axes.scale() * std::sqrt(squaredDistance(
                                                  query.data(), vectors[row].data(), dimension));
          const double found =
              std::sqrt(squaredDistance(w->data(), turned.data() + row * dimension, dimension));
          EXPECT_NEAR(found, truth, PrincipalAxes::slack(norm));
          const double bound =
              std::sqrt(squaredDistance(lead.data(), leads.row(row), leads.columns()));
          EXPECT_LE(bound, truth + PrincipalAxes::slack(norm));
        }
      }
    }
  }
}

TEST(PrincipalAxes, TheFirstCoordinatesVaryMost) {
  const Queries vectors = shapedVectors(Shape::kFamilies, 2000, 10, 7);
  VectorSet set = setOf(vectors);
  // Mixed by a reflection, so that the axes of the coordinates are not principal.
  for (std::size_t row = 0; row < vectors.size(); ++row) {
    float* x = set.values.data() + row * 10;
    const float sum = std::accumulate(x, x + 10, 0.0F);
    for (std::size_t i = 0; i < 10; ++i) x[i] -= sum / 5;
  }
  std::vector<std::uint32_t> rows(set.ids.size());
  std::iota(rows.begin(), rows.end(), 0);
  const PrincipalAxes axes(set, rows);
  std::vector<float> turned(set.values.size());
  axes.turnRows(set, rows, turned.data());
  std::vector<double> variance(10, 0);
  for (std::size_t i = 0; i < turned.size(); ++i) {
    variance[i % 10] += static_cast<double>(turned[i]) * turned[i];
  }
  EXPECT_TRUE(std::is_sorted(variance.rbegin(), variance.rend()));
  EXPECT_GT(variance[0], 50 * variance[9]);  // 1 : 1/100 before mixing, by construction.
}

}  // namespace
}  // namespace moduli
