#include "core/retrieval/vector_index.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <random>
#include <thread>

#include "tests/core/testing.h"

namespace moduli {
namespace {

using Accept = std::function<bool(std::int64_t)>;

enum class Cloud { kUniform, kClustered, kDuplicates, kGeometric, kConstant };

// Ids run backwards and with gaps, so that neither index can mistake rows for ids.
VectorSet makeCloud(Cloud kind, std::size_t rows, std::size_t dimension, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(-1, 1);
  VectorSet set{dimension, {}, {}};
  for (std::size_t row = 0; row < rows; ++row) {
    set.ids.push_back(static_cast<std::int64_t>(7 * (rows - row)));
    for (std::size_t i = 0; i < dimension; ++i) {
      float value = uniform(random);
      if (kind == Cloud::kClustered) value = 1e-4F * value + static_cast<float>((row + i) % 5);
      if (kind == Cloud::kDuplicates) value = std::round(value);
      if (kind == Cloud::kGeometric) value = std::exp(30 * value);
      if (kind == Cloud::kConstant) value = 0.25F;
      set.values.push_back(value);
    }
  }
  return set;
}

// Half of the queries are rows themselves, where ties at distance 0 show.
std::vector<std::vector<float>> makeQueries(const VectorSet& set, std::size_t count,
                                            unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(-1.2F, 1.2F);
  std::vector<std::vector<float>> queries;
  for (std::size_t q = 0; q < count; ++q) {
    std::vector<float> query(set.dimension);
    for (float& value : query) value = uniform(random);
    if (q % 2 == 0 && !set.ids.empty()) {
      const std::size_t row = random() % set.ids.size();
      std::copy_n(set.values.begin() + static_cast<std::ptrdiff_t>(row * set.dimension),
                  set.dimension, query.begin());
    }
    queries.push_back(std::move(query));
  }
  return queries;
}

// Number of queries that the two answer differently, to the last bit.
std::size_t disagreements(const VectorIndex& a, const VectorIndex& b,
                          const std::vector<std::vector<float>>& queries, std::size_t k,
                          const Accept& accept = {}) {
  Context context;
  std::size_t count = 0;
  for (const std::vector<float>& query : queries) {
    const auto left = a.search(context, query, k, accept);
    const auto right = b.search(context, query, k, accept);
    EXPECT_OK(left);
    EXPECT_OK(right);
    if (!left.ok() || !right.ok() || *left != *right) ++count;
  }
  return count;
}

std::unique_ptr<VectorIndex> built(Result<std::unique_ptr<VectorIndex>> index) {
  EXPECT_OK(index);
  return index.ok() ? *std::move(index) : nullptr;
}

TEST(FlannIndex, AgreesWithBruteForceToTheLastBit) {
  for (const Cloud kind : {Cloud::kUniform, Cloud::kClustered, Cloud::kDuplicates,
                           Cloud::kGeometric, Cloud::kConstant}) {
    for (const std::size_t rows : {0, 1, 2, 15, 16, 17, 33, 700}) {
      for (const std::size_t dimension : {0, 1, 2, 3, 7, 32}) {
        const VectorSet set = makeCloud(kind, rows, dimension, 1);
        const auto queries = makeQueries(set, 20, 2);
        const auto brute = built(makeBruteForceIndex(set));
        for (const std::size_t shard_rows : {100000, 64}) {
          const auto flann = built(makeFlannIndex(set, shard_rows));
          for (const std::size_t k : {1, 5, 40, 1000}) {
            ASSERT_EQ(disagreements(*brute, *flann, queries, k), 0U)
                << "cloud " << static_cast<int>(kind) << ", " << rows << " rows, dimension "
                << dimension << ", k " << k << ", shards of " << shard_rows;
          }
        }
      }
    }
  }
}

TEST(FlannIndex, AgreesWithBruteForceUnderSelectiveFilters) {
  const VectorSet set = makeCloud(Cloud::kUniform, 3000, 12, 3);
  const auto queries = makeQueries(set, 20, 4);
  const auto brute = built(makeBruteForceIndex(set));
  const auto flann = built(makeFlannIndex(set, 1000));
  for (const std::int64_t modulus : {2, 37, 2500, 100000}) {
    const Accept accept = [&](std::int64_t id) { return id / 7 % modulus == 1; };
    EXPECT_EQ(disagreements(*brute, *flann, queries, 10, accept), 0U) << modulus;
  }
}

TEST(FlannIndex, FewerRowsThanAskedForGivesThemAll) {
  const VectorSet set = makeCloud(Cloud::kUniform, 9, 4, 5);
  const auto flann = built(makeFlannIndex(set));
  Context context;
  const auto found = flann->search(context, std::vector<float>(4, 0.5F), 50);
  ASSERT_OK(found);
  EXPECT_EQ(found->size(), 9U);
}

TEST(FlannIndex, EqualDistancesComeByAscendingId) {
  const VectorSet set = makeCloud(Cloud::kConstant, 500, 6, 6);
  const auto flann = built(makeFlannIndex(set, 90));
  Context context;
  const auto found = flann->search(context, std::vector<float>(6, 0.25F), 4);
  ASSERT_OK(found);
  EXPECT_EQ(*found, (std::vector<Neighbor>{{7, 0}, {14, 0}, {21, 0}, {28, 0}}));
}

// Wraps an index and answers wrongly now and then.
class FaultyIndex final : public VectorIndex {
 public:
  enum class Fault { kDropsRow, kBendsDistance };
  FaultyIndex(const VectorIndex& truth, Fault fault) : truth_(truth), fault_(fault) {}

  Result<std::vector<Neighbor>> search(Context& context, std::span<const float> query,
                                       std::size_t k, const Accept& accept) const override {
    const Accept without = [&](std::int64_t id) {
      return id != truth_.rows().ids.front() && (!accept || accept(id));
    };
    auto found = truth_.search(context, query, k, fault_ == Fault::kDropsRow ? without : accept);
    if (found.ok() && fault_ == Fault::kBendsDistance && !found->empty()) {
      double& distance = found->back().distance;
      distance = std::nextafter(distance, 2 * distance + 1);
    }
    return found;
  }
  const VectorSet& rows() const override { return truth_.rows(); }
  bool exact() const override { return true; }

 private:
  const VectorIndex& truth_;
  Fault fault_;
};

TEST(FlannIndex, TheTwinCatchesPlantedFaults) {
  const VectorSet set = makeCloud(Cloud::kUniform, 200, 5, 7);
  auto queries = makeQueries(set, 40, 8);
  queries.emplace_back(set.values.begin(), set.values.begin() + 5);  // The row that gets dropped.
  const auto brute = built(makeBruteForceIndex(set));
  const auto flann = built(makeFlannIndex(set));
  const FaultyIndex dropping(*flann, FaultyIndex::Fault::kDropsRow);
  const FaultyIndex bending(*flann, FaultyIndex::Fault::kBendsDistance);
  EXPECT_GT(disagreements(*brute, dropping, queries, 20), 0U);
  EXPECT_EQ(disagreements(*brute, bending, queries, 20), queries.size());
}

TEST(VectorIndex, RefusesWhatIsNotFiniteOrDoesNotFit) {
  using Make = Result<std::unique_ptr<VectorIndex>> (*)(VectorSet);
  const Make makers[] = {[](VectorSet set) { return makeFlannIndex(std::move(set)); },
                         [](VectorSet set) { return makeBruteForceIndex(std::move(set)); }};
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  for (const Make make : makers) {
    EXPECT_THAT(make({2, {0, nan}, {1}}), FailsWith(Reason::kInvalidOption));
    EXPECT_THAT(make({2, {-infinity, 0}, {1}}), FailsWith(Reason::kInvalidOption));
    EXPECT_THAT(make({1, {3e38F}, {1}}), FailsWith(Reason::kInvalidOption));
    EXPECT_THAT(make({2, {1, 2, 3}, {1}}), FailsWith(Reason::kInvalidOption));
    const auto index = built(make({2, {0, 0, 1, 1}, {1, 2}}));
    Context context;
    const std::vector<float> good{0, 0}, short_one{0}, bad{0, nan};
    EXPECT_THAT(index->search(context, bad, 1), FailsWith(Reason::kInvalidOption));
    EXPECT_THAT(index->search(context, short_one, 1), FailsWith(Reason::kInvalidOption));
    EXPECT_THAT(index->search(context, good, 0), FailsWith(Reason::kInvalidOption));
    EXPECT_OK(index->search(context, good, 1));
  }
  EXPECT_THAT(makeFlannIndex({1, {1}, {1}}, 0), FailsWith(Reason::kInvalidOption));
}

TEST(VectorIndex, StopsWhenCancelled) {
  const VectorSet set = makeCloud(Cloud::kUniform, 20000, 16, 9);
  for (const auto& index : {built(makeFlannIndex(set)), built(makeBruteForceIndex(set))}) {
    Context context;
    CancelToken token;
    context.setCancelToken(token);
    // The caller gives up in the middle: a filter that lets nothing through makes the search long.
    std::atomic<int> calls = 0;
    const Accept accept = [&](std::int64_t) {
      if (++calls == 100) token.cancel();
      return false;
    };
    EXPECT_THAT(index->search(context, std::vector<float>(16, 0), 5, accept),
                FailsWith(Reason::kCancelled));
    EXPECT_LT(calls, 15000);
  }
}

TEST(VectorIndex, SearchesRunSideBySide) {
  const VectorSet set = makeCloud(Cloud::kClustered, 2000, 8, 10);
  const auto queries = makeQueries(set, 30, 11);
  const auto brute = built(makeBruteForceIndex(set));
  const auto flann = built(makeFlannIndex(set, 500));
  std::atomic<std::size_t> wrong = 0;
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&] { wrong += disagreements(*brute, *flann, queries, 7); });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, 0U);
}

}  // namespace
}  // namespace moduli
