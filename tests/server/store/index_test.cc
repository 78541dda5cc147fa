#include <atomic>
#include <map>
#include <mutex>
#include <random>
#include <thread>
#include <vector>

#include "core/retrieval/nearest_set.h"
#include "server/store/index_keeper.h"
#include "server/store/live_index.h"
#include "server/store/sqlite_catalog.h"
#include "tests/server/store/store_testing.h"

namespace moduli {
namespace {

constexpr std::size_t kDimension = 3;

// Few values, so that ties are common.
std::vector<float> randomVector(std::mt19937& random) {
  std::vector<float> values(kDimension);
  for (float& value : values) value = static_cast<float>(random() % 5);
  return values;
}

// Id to vector: what an index should hold.
using Model = std::map<std::int64_t, std::vector<float>>;

std::vector<Neighbor> expected(const Model& model, std::span<const float> query, std::size_t k,
                               const std::function<bool(std::int64_t)>& accept = {}) {
  std::vector<Neighbor> all;
  for (const auto& [id, values] : model) {
    double sum = 0;
    for (std::size_t i = 0; i < kDimension; ++i) sum += std::pow(values[i] - query[i], 2);
    if (!accept || accept(id)) all.push_back({id, std::sqrt(sum)});
  }
  std::sort(all.begin(), all.end(), nearer);
  all.resize(std::min(k, all.size()));
  return all;
}

std::shared_ptr<LiveIndex> emptyIndex(std::size_t rebuild_minimum) {
  auto index = LiveIndex::build({kDimension, {}, {}}, {0.1, rebuild_minimum});
  EXPECT_OK(index);
  return index.ok() ? *index : nullptr;
}

void appendTo(VectorSet& set, std::int64_t id, const std::vector<float>& values) {
  set.dimension = kDimension;
  set.ids.push_back(id);
  set.values.insert(set.values.end(), values.begin(), values.end());
}

TEST(LiveIndex, AnyInterleavingOfWritesAndRebuildsAnswersLikeTheModel) {
  for (unsigned seed = 0; seed < 8; ++seed) {
    std::mt19937 random(seed);
    const auto index = emptyIndex(20);
    Model model;
    std::int64_t next_id = 1;
    for (int step = 0; step < 400; ++step) {
      VectorSet added{kDimension, {}, {}};
      std::vector<std::int64_t> removed;
      for (auto count = random() % 4; count > 0; --count) {
        model[next_id] = randomVector(random);
        appendTo(added, next_id, model[next_id]);
        ++next_id;
      }
      for (auto count = random() % 3; count > 0 && next_id > 1; --count) {
        const auto id = static_cast<std::int64_t>(1 + random() % (next_id - 1));
        if (std::count(added.ids.begin(), added.ids.end(), id) > 0) continue;
        removed.push_back(id);  // Perhaps removed before, which must not matter.
        model.erase(id);
      }
      ASSERT_OK(index->apply(added, removed));
      if (index->rebuildDue() || random() % 50 == 0) {
        ASSERT_OK(index->rebuild());
      }
      ASSERT_EQ(index->size(), model.size());
      Context context;
      const auto query = randomVector(random);
      const std::size_t k = 1 + random() % 12;
      const auto odd = [](std::int64_t id) { return id % 2 == 1; };
      ASSERT_EQ(index->search(context, query, k)->neighbors, expected(model, query, k))
          << seed << step;
      ASSERT_EQ(index->search(context, query, k, odd)->neighbors, expected(model, query, k, odd));
    }
  }
}

// Large enough that there are several indexes of different sizes beside the tail; rows come in any
// order of ids, and some go again.
TEST(LiveIndex, SnapshotsAndTailAnswerLikeLookingAtEveryRow) {
  constexpr std::size_t kWide = 10;
  std::mt19937 random(5);
  std::normal_distribution<float> normal;
  VectorSet all{kWide, {}, {}};
  for (std::int64_t id = 0; id < 6000; ++id) {
    all.ids.push_back((id * 2741) % 6007);  // Distinct, for 6007 is prime.
    for (std::size_t i = 0; i < kWide; ++i) all.values.push_back(std::round(3 * normal(random)));
  }
  const auto rows = [&](std::size_t begin, std::size_t end) {
    return VectorSet{kWide,
                     {all.values.begin() + begin * kWide, all.values.begin() + end * kWide},
                     {all.ids.begin() + begin, all.ids.begin() + end}};
  };
  const auto index = *LiveIndex::build(rows(0, 2000), {0.125, 100});
  std::vector<bool> removed(6007, false);
  for (std::size_t row = 2000; row < 6000; row += 50) {
    const auto gone = std::span(all.ids).subspan(row / 3, 5);
    for (const std::int64_t id : gone) removed[id] = true;
    ASSERT_OK(index->apply(rows(row, row + 50), gone));
    if (index->rebuildDue()) {
      ASSERT_OK(index->rebuild());
    }
    if (row % 400 != 0) continue;
    const auto present = [&](std::int64_t id) { return !removed[id]; };
    const auto brute = *makeBruteForceIndex(rows(0, row + 50));
    Context context;
    for (int q = 0; q < 5; ++q) {
      std::vector<float> query(kWide);
      for (float& value : query) value = std::round(3 * normal(random));
      ASSERT_EQ(index->search(context, query, 20)->neighbors,
                *brute->search(context, query, 20, present));
    }
  }
}

TEST(LiveIndex, RefusesWhatDoesNotFitAndStaysAsItWas) {
  const auto index = emptyIndex(10);
  Context context;
  EXPECT_THAT(index->apply({2, {1, 2}, {1}}, {}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(index->apply({3, {1, 2, std::nanf("")}, {1}}, {}), FailsWith(Reason::kInvalidOption));
  EXPECT_EQ(index->size(), 0U);
  EXPECT_THAT(index->search(context, std::vector<float>{1, 2}, 1),
              FailsWith(Reason::kInvalidOption));
  EXPECT_TRUE(index->search(context, std::vector<float>{1, 2, 3}, 5)->neighbors.empty());
}

TEST(LiveIndex, AsksForARebuildWhenTailAndHolesGrow) {
  const auto index = emptyIndex(10);
  VectorSet set{kDimension, {}, {}};
  for (std::int64_t id = 0; id < 11; ++id) appendTo(set, id, {1, 2, 3});
  ASSERT_OK(index->apply(set, {}));
  EXPECT_TRUE(index->rebuildDue());
  ASSERT_OK(index->rebuild());
  EXPECT_FALSE(index->rebuildDue());
  std::vector<std::int64_t> removed{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10};
  ASSERT_OK(index->apply({kDimension, {}, {}}, removed));
  EXPECT_TRUE(index->rebuildDue());
  ASSERT_OK(index->rebuild());
  EXPECT_EQ(index->size(), 0U);
  EXPECT_FALSE(index->rebuildDue());
}

// One write moves a row: the old id goes and a new one comes at the same place. Whatever a search
// sees, it must see exactly one row there, and all rows that never change.
TEST(LiveIndex, SearchesSeeWholeWritesWhileIndexIsRebuilt) {
  const auto index = emptyIndex(4);
  VectorSet first{kDimension, {}, {}};
  for (std::int64_t id = 1; id <= 50; ++id) {
    appendTo(first, id, {static_cast<float>(id), 0, 0});
  }
  // Rows far away, so that a rebuild takes long enough for writes to fall into it.
  for (std::int64_t id = 51; id < 3000; ++id)
    appendTo(first, id, {1e3F, static_cast<float>(id), 0});
  constexpr std::int64_t kMoving = 3000;
  appendTo(first, kMoving, {0, 0, 0});
  ASSERT_OK(index->apply(first, {}));
  std::atomic<int> searching = 2;
  std::thread writer([&] {
    for (std::int64_t id = kMoving; searching > 0; ++id) {
      const std::int64_t gone[] = {id};
      ASSERT_OK(index->apply({kDimension, {0, 0, 0}, {id + 1}}, gone));
    }
  });
  std::thread rebuilder([&] {
    while (searching > 0) ASSERT_OK(index->rebuild());
  });
  std::vector<std::thread> searchers;
  for (int t = 0; t < 2; ++t) {
    searchers.emplace_back([&] {
      std::int64_t last = kMoving;
      for (int round = 0; round < 300; ++round) {
        Context context;
        const auto answer = index->search(context, std::vector<float>(kDimension, 0), 51);
        EXPECT_OK(answer);
        const std::vector<Neighbor>& found = answer->neighbors;
        EXPECT_EQ(found.size(), 51U);
        EXPECT_GE(found[0].id, last);  // Never back to an older state.
        last = found[0].id;
        for (std::size_t i = 1; i < found.size(); ++i) {
          EXPECT_EQ(found[i].id, static_cast<std::int64_t>(i));
        }
      }
      --searching;
    });
  }
  for (std::thread& searcher : searchers) searcher.join();
  writer.join();
  rebuilder.join();
}

// ---- The keeper, on a true catalogue.

class IndexKeeperTest : public testing::Test {
 protected:
  void SetUp() override {
    auto opened = SqliteCatalog::open(folder_.path() / "catalog.sqlite");
    ASSERT_OK(opened);
    catalog_ = *std::move(opened);
    for (const char* name : {"c", "d"}) {
      const auto collection = catalog_->createCollection(name, "");
      ASSERT_OK(collection);
      ids_[name] = collection->id;
    }
  }

  std::unique_ptr<IndexKeeper> openKeeper(IndexKeeper::Options options = {}) {
    Context context;
    auto keeper = IndexKeeper::open(context, *catalog_, std::move(options));
    EXPECT_OK(keeper);
    return keeper.ok() ? *std::move(keeper) : nullptr;
  }

  std::int64_t put(const std::string& collection, const std::string& name,
                   const std::vector<float>& vector, const std::string& type = "TORUS") {
    ShapeRecord shape = sampleShape(collection, name);
    shape.topology.type = type;
    shape.vectors = {vector, vector, vector};
    const auto result = catalog_->putShape(shape, OnExists::kReplace);
    EXPECT_OK(result);
    return result.ok() ? result->id : 0;
  }

  // Ids in the order of distance from the origin.
  std::vector<std::int64_t> found(const IndexKeeper& keeper, const std::string& collection,
                                  Space space, const std::string& type = "TORUS") {
    Context context;
    const auto rows = keeper.search(context, ids_[collection], space, type,
                                    std::vector<float>(kDimension, 0), 100);
    EXPECT_OK(rows);
    std::vector<std::int64_t> ids;
    if (rows.ok()) {
      for (const Neighbor& neighbor : rows->neighbors) ids.push_back(neighbor.id);
    }
    return ids;
  }

  TemporaryFolder folder_;
  std::unique_ptr<Catalog> catalog_;
  std::map<std::string, std::int64_t> ids_;
};

using Ids = std::vector<std::int64_t>;

TEST_F(IndexKeeperTest, KeepsCollectionsSpacesAndTypesApart) {
  const std::int64_t a = put("c", "a", {1, 0, 0});
  const std::int64_t b = put("c", "b", {2, 0, 0}, "ANNULUS");
  const std::int64_t other = put("d", "a", {3, 0, 0});
  const auto keeper = openKeeper();
  EXPECT_EQ(found(*keeper, "c", Space::kConformal, "TORUS"), Ids{a});
  EXPECT_EQ(found(*keeper, "c", Space::kConformal, "ANNULUS"), Ids{b});
  EXPECT_EQ(found(*keeper, "c", Space::kConformal, "DISK"), Ids{});
  EXPECT_EQ(found(*keeper, "c", Space::kMetric), (Ids{a, b}));
  EXPECT_EQ(found(*keeper, "c", Space::kShape), (Ids{a, b}));
  EXPECT_EQ(found(*keeper, "d", Space::kShape), Ids{other});
  EXPECT_EQ(keeper->size(ids_["c"], Space::kShape, "", kDimension), 2U);
  EXPECT_EQ(keeper->size(ids_["c"], Space::kShape, "", kDimension + 1), 0U);
}

TEST_F(IndexKeeperTest, RefreshTakesInAllThatHappened) {
  const auto keeper = openKeeper();
  const std::int64_t a = put("c", "a", {1, 0, 0});
  const std::int64_t b = put("c", "b", {2, 0, 0});
  EXPECT_EQ(found(*keeper, "c", Space::kShape), Ids{});
  ASSERT_OK(keeper->refresh());
  EXPECT_EQ(found(*keeper, "c", Space::kShape), (Ids{a, b}));
  const std::int64_t new_a = put("c", "a", {3, 0, 0});
  ASSERT_OK(keeper->refresh());
  EXPECT_EQ(found(*keeper, "c", Space::kShape), (Ids{b, new_a}));
  ASSERT_OK(catalog_->deleteShape("c", "b"));
  const std::int64_t d = put("d", "x", {1, 1, 1});
  ASSERT_OK(keeper->refresh());
  EXPECT_EQ(found(*keeper, "c", Space::kShape), Ids{new_a});
  ASSERT_OK(catalog_->deleteCollection("c", true));
  ASSERT_OK(keeper->refresh());
  EXPECT_EQ(found(*keeper, "c", Space::kShape), Ids{});
  EXPECT_EQ(found(*keeper, "d", Space::kShape), Ids{d});
}

TEST_F(IndexKeeperTest, OtherDescriptorVersionsAreLeftOut) {
  put("c", "a", {1, 0, 0});
  IndexKeeper::Options options;
  options.descriptor_version = kDescriptorVersion + 1;
  const auto keeper = openKeeper(options);
  put("c", "b", {1, 0, 0});
  ASSERT_OK(keeper->refresh());
  EXPECT_EQ(found(*keeper, "c", Space::kShape), Ids{});
}

TEST_F(IndexKeeperTest, ForgottenHistoryIsReadAnew) {
  put("c", "a", {1, 0, 0});
  const auto keeper = openKeeper();
  const std::int64_t a = put("c", "a", {2, 0, 0});
  const std::int64_t b = put("c", "b", {3, 0, 0});
  {
    auto connection = SqliteConnection::open(folder_.path() / "catalog.sqlite",
                                             SqliteConnection::Mode::kReadWrite);
    ASSERT_OK(connection);
    ASSERT_OK((*connection)->execute("DELETE FROM changes WHERE sequence < 4"));
  }
  ASSERT_OK(keeper->refresh());
  EXPECT_EQ(found(*keeper, "c", Space::kShape), (Ids{a, b}));
  EXPECT_EQ(keeper->sequence(), catalog_->changesSince(0, 10)->changes.back().sequence);
}

TEST_F(IndexKeeperTest, RebuildsAreHandedToTheCallersBackground) {
  std::vector<std::function<void()>> tasks;
  IndexKeeper::Options options;
  options.index = {0.1, 3};
  options.background = [&](std::function<void()> task) { tasks.push_back(std::move(task)); };
  const auto keeper = openKeeper(options);
  for (int i = 0; i < 4; ++i) {
    put("c", std::to_string(i), {static_cast<float>(i), 0, 0});
    ASSERT_OK(keeper->refresh());
  }
  EXPECT_EQ(tasks.size(), 3U);  // One for each space.
  const Ids before = found(*keeper, "c", Space::kShape);
  for (const auto& task : tasks) task();
  EXPECT_EQ(found(*keeper, "c", Space::kShape), before);
}

TEST_F(IndexKeeperTest, WritersAndSearchersRunSideBySide) {
  IndexKeeper::Options options;
  options.index = {0.1, 8};
  const auto keeper = openKeeper(options);
  std::mutex model_mutex;
  std::map<std::string, std::int64_t> model;
  std::atomic<bool> stop = false;
  std::vector<std::thread> writers, searchers;
  for (unsigned t = 0; t < 2; ++t) {
    writers.emplace_back([&, t] {
      std::mt19937 random(t);
      for (int i = 0; i < 25; ++i) {
        const std::string name = std::to_string(t) + "-" + std::to_string(random() % 10);
        if (random() % 3 == 0) {
          const Status status = catalog_->deleteShape("c", name);
          const std::lock_guard lock(model_mutex);
          if (status.ok()) model.erase(name);
        } else {
          const std::int64_t id = put("c", name, randomVector(random));
          const std::lock_guard lock(model_mutex);
          model[name] = id;
        }
        ASSERT_OK(keeper->refresh());
      }
    });
  }
  for (int t = 0; t < 2; ++t) {
    searchers.emplace_back([&] {
      while (!stop) found(*keeper, "c", Space::kShape);
    });
  }
  for (std::thread& writer : writers) writer.join();
  stop = true;
  for (std::thread& searcher : searchers) searcher.join();
  std::vector<std::int64_t> ids = found(*keeper, "c", Space::kShape);
  std::sort(ids.begin(), ids.end());
  std::vector<std::int64_t> wanted;
  for (const auto& [name, id] : model) wanted.push_back(id);
  std::sort(wanted.begin(), wanted.end());
  EXPECT_EQ(ids, wanted);
}

}  // namespace
}  // namespace moduli
