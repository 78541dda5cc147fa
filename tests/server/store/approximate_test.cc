#include <cmath>
#include <random>

#include "core/retrieval/vector_index.h"
#include "server/store/index_keeper.h"
#include "server/store/live_index.h"
#include "server/store/sqlite_catalog.h"
#include "tests/server/store/store_testing.h"

/// Many queries at once, and collections that want a recall below 1.
namespace moduli {
namespace {

constexpr std::size_t kDimension = 8;
constexpr std::int64_t kRows = 6000;  // Above what is always searched exactly (4000).

// Points around some sixty centres, so that few of them are near each other.
std::vector<float> point(std::mt19937& random) {
  std::mt19937 centre(random() % 60);
  std::normal_distribution<float> far(0, 3), near(0, 0.3F);
  std::vector<float> values(kDimension);
  for (float& value : values) value = far(centre) + near(random);
  return values;
}

VectorSet points(std::int64_t count, unsigned seed) {
  std::mt19937 random(seed);
  VectorSet set{kDimension, {}, {}};
  for (std::int64_t id = 0; id < count; ++id) {
    const auto values = point(random);
    set.ids.push_back(id);
    set.values.insert(set.values.end(), values.begin(), values.end());
  }
  return set;
}

std::vector<std::vector<float>> queries(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<std::vector<float>> result;
  for (int q = 0; q < count; ++q) result.push_back(point(random));
  return result;
}

std::shared_ptr<LiveIndex> indexOf(std::optional<double> wanted_recall) {
  LiveIndex::Options options;
  options.wanted_recall = wanted_recall;
  auto index = LiveIndex::build(points(kRows, 1), options);
  EXPECT_OK(index);
  return *index;
}

bool odd(std::int64_t id) {
  return id % 2 == 1;
}

TEST(ApproximateLiveIndex, FindsTheShareThatItIsAskedForAndSaysSo) {
  const auto index = indexOf(0.9);
  const auto brute = *makeBruteForceIndex(points(kRows, 1));
  ASSERT_TRUE(index->recall());
  EXPECT_GE(*index->recall(), 0.9);
  Context context;
  double sum = 0, squares = 0;
  const auto asked = queries(300, 2);
  for (const auto& query : asked) {
    const auto found = index->search(context, query, 10);
    ASSERT_OK(found);
    EXPECT_EQ(found->recall, index->recall());
    ASSERT_EQ(found->neighbors.size(), 10U);
    const double farthest = brute->search(context, query, 10)->back().distance;
    const auto right = std::count_if(found->neighbors.begin(), found->neighbors.end(),
                                     [&](const Neighbor& n) { return n.distance <= farthest; });
    sum += static_cast<double>(right) / 10;
    squares += std::pow(static_cast<double>(right) / 10, 2);
  }
  const auto count = static_cast<double>(asked.size());
  const double mean = sum / count;
  const double error = std::sqrt((squares / count - mean * mean) / (count - 1));
  EXPECT_GE(mean, 0.9 - 4 * error);
}

TEST(ApproximateLiveIndex, IsExactWithAFilterAndWhereAllRowsAreAskedFor) {
  const auto index = indexOf(0.5);
  const auto brute = *makeBruteForceIndex(points(kRows, 1));
  Context context;
  for (const auto& query : queries(10, 3)) {
    const auto some = index->search(context, query, 20, odd);
    ASSERT_OK(some);
    EXPECT_FALSE(some->recall);
    EXPECT_EQ(some->neighbors, *brute->search(context, query, 20, odd));
  }
  const auto all = index->search(context, queries(1, 4)[0], kRows + 5);
  ASSERT_OK(all);
  EXPECT_EQ(all->neighbors, *brute->search(context, queries(1, 4)[0], kRows + 5));
}

// Whatever tiles an index looks at, k rows are found while there are k.
TEST(ApproximateLiveIndex, GivesAsManyAsThereAreWhereNearOnesHaveGone) {
  const auto index = indexOf(0.5);
  const auto brute = *makeBruteForceIndex(points(kRows, 1));
  Context context;
  const auto query = queries(1, 5)[0];
  std::vector<std::int64_t> gone;
  const auto nearest = brute->search(context, query, 5900);
  for (const Neighbor& n : *nearest) gone.push_back(n.id);
  ASSERT_OK(index->apply({kDimension, {}, {}}, gone));
  std::sort(gone.begin(), gone.end());
  const auto left = [&](std::int64_t id) {
    return !std::binary_search(gone.begin(), gone.end(), id);
  };
  for (const std::size_t k : {50, 6000}) {
    const auto found = index->search(context, query, k);
    ASSERT_OK(found);
    EXPECT_EQ(found->neighbors, *brute->search(context, query, k, left));
  }
}

TEST(ApproximateLiveIndex, ManyAnswersAreThoseOfSingleSearches) {
  for (const std::optional<double> wanted : {std::optional<double>(), std::optional(0.8)}) {
    const auto index = indexOf(wanted);
    // A smaller base, a tail, and holes in all of them.
    VectorSet more = points(2300, 6);
    for (std::int64_t& id : more.ids) id += kRows;
    VectorSet tail = points(100, 7);
    for (std::int64_t& id : tail.ids) id += 2 * kRows;
    ASSERT_OK(index->apply(more, {}));
    ASSERT_OK(index->rebuild());
    std::vector<std::int64_t> gone;
    for (std::int64_t id = 0; id < 3 * kRows; id += 17) gone.push_back(id);
    ASSERT_OK(index->apply(tail, gone));
    const auto asked = queries(150, 8);
    for (const auto& accept : {std::function<bool(std::int64_t)>(), {odd}}) {
      Context context;
      const auto many = index->searchMany(context, asked, 12, accept);
      ASSERT_OK(many);
      ASSERT_EQ(many->size(), asked.size());
      for (std::size_t q = 0; q < asked.size(); ++q) {
        const auto one = index->search(context, asked[q], 12, accept);
        ASSERT_OK(one);
        EXPECT_EQ((*many)[q].neighbors, one->neighbors);
        EXPECT_EQ((*many)[q].recall, one->recall);
      }
    }
  }
}

TEST(ApproximateLiveIndex, ManyAreRefusedAndCancelledAsOneIs) {
  const auto index = indexOf(0.9);
  Context context;
  auto asked = queries(3, 9);
  EXPECT_THAT(index->searchMany(context, asked, 0), FailsWith(Reason::kInvalidOption));
  asked[1].pop_back();
  EXPECT_THAT(index->searchMany(context, asked, 1), FailsWith(Reason::kInvalidOption));
  asked[1].push_back(std::nanf(""));
  EXPECT_THAT(index->searchMany(context, asked, 1), FailsWith(Reason::kInvalidOption));
  EXPECT_TRUE(index->searchMany(context, {}, 1)->empty());
  CancelToken token;
  context.setCancelToken(token);
  token.cancel();
  EXPECT_THAT(index->searchMany(context, queries(3, 9), 1), FailsWith(Reason::kCancelled));
}

TEST(ApproximateLiveIndex, AnotherRecallTakesEffectWithTheRebuildThatIsDue) {
  const auto index = indexOf({});
  EXPECT_FALSE(index->recall());
  index->setWantedRecall(0.9);
  EXPECT_TRUE(index->rebuildDue());
  EXPECT_FALSE(index->recall());
  ASSERT_OK(index->rebuild());
  EXPECT_FALSE(index->rebuildDue());
  EXPECT_TRUE(index->recall());
  index->setWantedRecall({});
  ASSERT_OK(index->rebuild());
  EXPECT_FALSE(index->recall());
  EXPECT_EQ(index->size(), static_cast<std::size_t>(kRows));
}

TEST(ApproximateKeeper, FollowsWhatTheCollectionWants) {
  const TemporaryFolder folder;
  const std::unique_ptr<Catalog> catalog = *SqliteCatalog::open(folder.path() / "catalog.sqlite");
  ASSERT_OK(catalog->createCollection("small", "", 0.9));
  const auto collection = catalog->createCollection("c", "", 0.9);
  ASSERT_OK(collection);
  const VectorSet set = points(4500, 10);
  for (std::size_t i = 0; i < set.ids.size(); ++i) {
    ShapeRecord shape = sampleShape(i == 0 ? "small" : "c", std::to_string(i));
    const auto row = std::span(set.values).subspan(i * kDimension, kDimension);
    shape.vectors.conformal = shape.vectors.metric = shape.vectors.shape = {row.begin(), row.end()};
    ASSERT_OK(catalog->putShape(shape, OnExists::kError));
  }
  Context context;
  std::vector<std::function<void()>> tasks;
  IndexKeeper::Options options;
  options.background = [&](std::function<void()> task) { tasks.push_back(std::move(task)); };
  const auto keeper = *IndexKeeper::open(context, *catalog, options);
  const auto recall = [&](Space space, const char* name) {
    return keeper
        ->search(context, catalog->getCollection(name)->id, space, "TORUS", queries(1, 11)[0], 10)
        ->recall;
  };
  EXPECT_TRUE(keeper->recall(collection->id));
  EXPECT_TRUE(recall(Space::kShape, "c"));
  EXPECT_TRUE(recall(Space::kMetric, "c"));
  EXPECT_FALSE(recall(Space::kConformal, "c"));  // A stand-in whose answers are all compared.
  EXPECT_FALSE(recall(Space::kShape, "small"));

  ASSERT_OK(catalog->updateCollection("c", {}));
  ASSERT_OK(keeper->refresh());
  EXPECT_EQ(tasks.size(), 2U);
  EXPECT_TRUE(keeper->recall(collection->id)) << "searches go on in the old indexes";
  for (const auto& task : tasks) task();
  EXPECT_FALSE(keeper->recall(collection->id));
  ASSERT_OK(catalog->updateCollection("c", 0.95));
  ASSERT_OK(keeper->refresh());
  for (std::size_t i = 2; i < tasks.size(); ++i) tasks[i]();
  EXPECT_GE(keeper->recall(collection->id).value_or(0), 0.95);
}

}  // namespace
}  // namespace moduli
