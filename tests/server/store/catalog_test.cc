#include "server/store/catalog.h"

#include <atomic>
#include <fstream>
#include <map>
#include <set>
#include <thread>

#include "server/store/sqlite_catalog.h"
#include "tests/server/store/store_testing.h"

namespace moduli {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

using VectorMap = std::map<std::pair<std::int64_t, Space>, std::vector<float>>;

class CatalogTest : public testing::Test {
 protected:
  void SetUp() override { reopen(); }

  void reopen() {
    catalog_.reset();
    auto opened = SqliteCatalog::open(path(), [this] { return now_; });
    ASSERT_OK(opened);
    catalog_ = *std::move(opened);
  }

  std::filesystem::path path() const { return folder_.path() / "catalog.sqlite"; }

  void put(const std::string& collection, const std::string& name) {
    ASSERT_OK(catalog_->putShape(sampleShape(collection, name), OnExists::kError));
  }

  std::vector<std::string> names(const std::string& filter) {
    std::vector<std::string> names;
    PageRequest page{3, ""};
    do {
      Context context;
      const auto answer = catalog_->listShapes(context, "c", filter, page);
      EXPECT_OK(answer);
      if (!answer.ok()) break;
      EXPECT_LE(answer->items.size(), 3U);
      for (const ShapeRecord& shape : answer->items) names.push_back(shape.name);
      page.token = answer->next_token;
    } while (!page.token.empty());
    return names;
  }

  // Every vector of the store, by shape row and space.
  VectorMap vectors() {
    VectorMap found;
    Context context;
    EXPECT_OK(catalog_->forEachVector(context, [&](const VectorRow& row) {
      found[{row.shape_id, row.space}] = {row.values.begin(), row.values.end()};
      EXPECT_EQ(row.type, "TORUS");
      return Status();
    }));
    return found;
  }

  void runSql(const std::string& sql) {
    auto connection = SqliteConnection::open(path(), SqliteConnection::Mode::kReadWrite);
    ASSERT_OK(connection);
    ASSERT_OK((*connection)->execute(sql));
  }

  TemporaryFolder folder_;
  Timestamp now_{std::chrono::seconds(1'700'000'000)};
  std::unique_ptr<Catalog> catalog_;
};

TEST_F(CatalogTest, AShapeComesBackAsItWasPut) {
  ASSERT_OK(catalog_->createCollection("c", ""));
  const ShapeRecord put_shape = sampleShape("c", "\xC3\xA9t\xC3\xA9 1");
  const auto put_result = catalog_->putShape(put_shape, OnExists::kError);
  ASSERT_OK(put_result);
  EXPECT_EQ(put_result->outcome, PutOutcome::kAdded);
  reopen();
  for (const ShapeView view : {ShapeView::kFull, ShapeView::kSummary}) {
    const auto shape = catalog_->getShape("c", put_shape.name, view);
    ASSERT_OK(shape);
    EXPECT_EQ(shape->id, put_result->id);
    EXPECT_EQ(shape->collection, "c");
    EXPECT_EQ(shape->name, put_shape.name);
    EXPECT_EQ(shape->label, put_shape.label);
    EXPECT_EQ(shape->tags, put_shape.tags);
    EXPECT_EQ(shape->digest, put_shape.digest);
    EXPECT_EQ(shape->format, put_shape.format);
    EXPECT_EQ(shape->file_name, put_shape.file_name);
    EXPECT_EQ(shape->create_time, now_);
    EXPECT_EQ(shape->mesh_bytes, put_shape.mesh_bytes);
    EXPECT_EQ(shape->topology.type, "TORUS");
    EXPECT_EQ(shape->topology.genus, 1);
    EXPECT_EQ(shape->topology.vertices, 100);
    EXPECT_EQ(shape->topology.faces, 200);
    EXPECT_EQ(shape->topology.area, 2.5);
    EXPECT_EQ(shape->descriptor_version, kDescriptorVersion);
    EXPECT_EQ(shape->signature, view == ShapeView::kFull ? put_shape.signature : "");
  }
  EXPECT_EQ(vectors().at(std::pair(put_result->id, Space::kMetric)), put_shape.vectors.metric);
  EXPECT_EQ(vectors().size(), 3U);
}

TEST_F(CatalogTest, CollectionsAreCreatedCountedListedAndDeleted) {
  EXPECT_THAT(catalog_->getCollection("c"), FailsWith(Reason::kCollectionNotFound));
  ASSERT_OK(catalog_->createCollection("c", ""));
  EXPECT_THAT(catalog_->createCollection("c", ""), FailsWith(Reason::kCollectionExists));
  EXPECT_EQ(catalog_->getCollection("c")->create_time, now_);
  put("c", "a");
  put("c", "b");
  EXPECT_EQ(catalog_->getCollection("c")->shape_count, 2);
  ASSERT_OK(catalog_->deleteShape("c", "a"));
  EXPECT_EQ(catalog_->getCollection("c")->shape_count, 1);
  EXPECT_THAT(catalog_->deleteShape("c", "a"), FailsWith(Reason::kShapeNotFound));
  EXPECT_THAT(catalog_->deleteShape("d", "a"), FailsWith(Reason::kCollectionNotFound));
  EXPECT_THAT(catalog_->deleteCollection("c", false), FailsWith(Reason::kCollectionNotEmpty));
  EXPECT_EQ(*catalog_->deleteCollection("c", true), 1);
  EXPECT_THAT(catalog_->deleteCollection("c", true), FailsWith(Reason::kCollectionNotFound));
  EXPECT_THAT(catalog_->getShape("c", "b", ShapeView::kFull),
              FailsWith(Reason::kCollectionNotFound));
  EXPECT_TRUE(vectors().empty());
}

TEST_F(CatalogTest, NamesThatMakeNoSenseAreRefused) {
  for (const char* name : {"", ".hidden", "-x", "a/b", "a b", "\xC3\xA9"}) {
    EXPECT_THAT(catalog_->createCollection(name, ""), FailsWith(Reason::kInvalidName)) << name;
  }
  EXPECT_THAT(catalog_->createCollection(std::string(64, 'a'), ""),
              FailsWith(Reason::kInvalidName));
  ASSERT_OK(catalog_->createCollection(std::string(63, 'a'), ""));
  ASSERT_OK(catalog_->createCollection("c", ""));
  for (const char* name : {"", "a/b", "a\nb", "\xFF"}) {
    EXPECT_THAT(catalog_->putShape(sampleShape("c", name), OnExists::kError),
                FailsWith(Reason::kInvalidName));
  }
}

TEST_F(CatalogTest, RecordsThatMakeNoSenseAreRefused) {
  ASSERT_OK(catalog_->createCollection("c", ""));
  const auto refuses = [&](const std::function<void(ShapeRecord&)>& bend) {
    ShapeRecord shape = sampleShape("c", "x");
    bend(shape);
    EXPECT_THAT(catalog_->putShape(shape, OnExists::kError), FailsWith(Reason::kInvalidRequest));
  };
  refuses([](ShapeRecord& shape) { shape.digest = "ABC"; });
  refuses([](ShapeRecord& shape) { shape.label = "\xFF"; });
  refuses([](ShapeRecord& shape) { shape.tags[""] = "x"; });
  refuses([](ShapeRecord& shape) { shape.tags["x"] = std::string(2000, 'x'); });
  refuses([](ShapeRecord& shape) { shape.vectors.shape[1] = std::nanf(""); });
  refuses([](ShapeRecord& shape) { shape.vectors.metric[1] = INFINITY; });
  refuses([](ShapeRecord& shape) { shape.topology.area = std::nan(""); });
  EXPECT_THAT(catalog_->putShape(sampleShape("d", "x"), OnExists::kError),
              FailsWith(Reason::kCollectionNotFound));
  EXPECT_EQ(catalog_->getCollection("c")->shape_count, 0);
}

TEST_F(CatalogTest, TheSameRequestIsAnsweredTheSame) {
  const auto first = catalog_->createCollection("c", "0b1e-1");
  ASSERT_OK(first);
  now_ += std::chrono::hours(1);
  reopen();
  const auto again = catalog_->createCollection("c", "0b1e-1");
  ASSERT_OK(again);
  EXPECT_EQ(again->id, first->id);
  EXPECT_EQ(again->create_time, first->create_time);
  EXPECT_THAT(catalog_->createCollection("d", "0b1e-1"), FailsWith(Reason::kInvalidRequest));
  EXPECT_THAT(catalog_->createCollection("c", "0b1e-2"), FailsWith(Reason::kCollectionExists));
  EXPECT_THAT(catalog_->createCollection("e", "no blanks"), FailsWith(Reason::kInvalidRequest));
  now_ += std::chrono::hours(24);  // Forgotten after a day.
  EXPECT_THAT(catalog_->createCollection("c", "0b1e-1"), FailsWith(Reason::kCollectionExists));
}

TEST_F(CatalogTest, WhatHappensToAnExistingShapeIsAsAsked) {
  ASSERT_OK(catalog_->createCollection("c", ""));
  ShapeRecord shape = sampleShape("c", "x");
  const auto first = catalog_->putShape(shape, OnExists::kSkip);
  ASSERT_OK(first);
  const std::string old_digest = shape.digest;
  shape.digest = sha256Hex("another file");
  shape.tags = {{"new", "tag"}};

  EXPECT_THAT(catalog_->putShape(shape, OnExists::kError), FailsWith(Reason::kShapeExists));
  const auto skipped = catalog_->putShape(shape, OnExists::kSkip);
  ASSERT_OK(skipped);
  EXPECT_EQ(skipped->outcome, PutOutcome::kSkipped);
  EXPECT_EQ(skipped->id, first->id);
  EXPECT_EQ(skipped->existing_digest, old_digest);
  EXPECT_EQ(catalog_->getShape("c", "x", ShapeView::kSummary)->digest, old_digest);

  const auto replaced = catalog_->putShape(shape, OnExists::kReplace);
  ASSERT_OK(replaced);
  EXPECT_EQ(replaced->outcome, PutOutcome::kReplaced);
  EXPECT_GT(replaced->id, first->id);
  EXPECT_EQ(catalog_->getShape("c", "x", ShapeView::kSummary)->tags, shape.tags);
  EXPECT_EQ(catalog_->getCollection("c")->shape_count, 1);
  EXPECT_EQ(vectors().size(), 3U);
  EXPECT_EQ(*catalog_->hasMesh(old_digest), false);
  EXPECT_EQ(*catalog_->hasMesh(shape.digest), true);
}

TEST_F(CatalogTest, AConditionalPutReplacesThatRowOnly) {
  ASSERT_OK(catalog_->createCollection("c", ""));
  const auto first = catalog_->putShape(sampleShape("c", "x"), OnExists::kError);
  ASSERT_OK(first);
  ShapeRecord signed_anew = sampleShape("c", "x");
  signed_anew.descriptor_version = kDescriptorVersion + 1;
  ASSERT_EQ(catalog_->outdatedShapes(kDescriptorVersion + 1, 10)->size(), 1U);
  const auto second = catalog_->putShape(signed_anew, OnExists::kError, first->id);
  ASSERT_OK(second);
  EXPECT_EQ(second->outcome, PutOutcome::kReplaced);
  EXPECT_TRUE(catalog_->outdatedShapes(kDescriptorVersion + 1, 10)->empty());
  const auto late = catalog_->putShape(sampleShape("c", "x"), OnExists::kReplace, first->id);
  ASSERT_OK(late);
  EXPECT_EQ(late->outcome, PutOutcome::kSkipped);
  ASSERT_OK(catalog_->deleteShape("c", "x"));
  const auto gone = catalog_->putShape(sampleShape("c", "x"), OnExists::kReplace, second->id);
  ASSERT_OK(gone);
  EXPECT_EQ(gone->outcome, PutOutcome::kSkipped);
  EXPECT_EQ(catalog_->getCollection("c")->shape_count, 0);
}

TEST_F(CatalogTest, RowNumbersAreNeverGivenTwice) {
  ASSERT_OK(catalog_->createCollection("c", ""));
  std::set<std::int64_t> ids;
  for (int round = 0; round < 5; ++round) {
    const auto result = catalog_->putShape(sampleShape("c", "x"), OnExists::kError);
    ASSERT_OK(result);
    EXPECT_TRUE(ids.insert(result->id).second);
    ASSERT_OK(catalog_->deleteShape("c", "x"));
    reopen();
  }
}

TEST_F(CatalogTest, PagesCoverTheListOnceInOrder) {
  ASSERT_OK(catalog_->createCollection("c", ""));
  ASSERT_OK(catalog_->createCollection("d", ""));
  put("d", "stranger");
  for (const char* name : {"b", "a", "d", "c", "B", "\xC3\xA9", "a1"}) put("c", name);
  EXPECT_THAT(names(""), ElementsAre("B", "a", "a1", "b", "c", "d", "\xC3\xA9"));
  EXPECT_THAT(names("name >= \"a\" AND name < \"c\""), ElementsAre("a", "a1", "b"));
  EXPECT_THAT(names("tags.owner = \"d\""), ElementsAre("d"));
  EXPECT_THAT(names("genus = 7"), ElementsAre());

  const auto collections = catalog_->listCollections({1, ""});
  ASSERT_OK(collections);
  ASSERT_EQ(collections->items.size(), 1U);
  EXPECT_EQ(collections->items[0].name, "c");
  EXPECT_EQ(collections->items[0].shape_count, 7);
  const auto rest = catalog_->listCollections({1, collections->next_token});
  ASSERT_OK(rest);
  EXPECT_EQ(rest->items[0].name, "d");
  EXPECT_EQ(rest->next_token, "");
}

TEST_F(CatalogTest, PagesGoOnWhereTheyWereThoughShapesComeAndGo) {
  ASSERT_OK(catalog_->createCollection("c", ""));
  for (const char* name : {"b", "d", "f", "h"}) put("c", name);
  Context context;
  const auto first = catalog_->listShapes(context, "c", "", {2, ""});
  ASSERT_OK(first);
  ASSERT_OK(catalog_->deleteShape("c", "d"));  // The last one seen.
  put("c", "a");
  put("c", "e");
  const auto second = catalog_->listShapes(context, "c", "", {2, first->next_token});
  ASSERT_OK(second);
  ASSERT_EQ(second->items.size(), 2U);
  EXPECT_EQ(second->items[0].name, "e");
  EXPECT_EQ(second->items[1].name, "f");
}

TEST_F(CatalogTest, ListedShapesCarryTheirTagsWithAndWithoutFilter) {
  ASSERT_OK(catalog_->createCollection("c", ""));
  put("c", "x");
  Context context;
  for (const char* filter : {"", "genus = 1", "tags.owner = \"x\""}) {
    const auto page = catalog_->listShapes(context, "c", filter, {});
    ASSERT_OK(page);
    ASSERT_EQ(page->items.size(), 1U);
    EXPECT_EQ(page->items[0].tags.size(), 2U) << filter;
  }
}

TEST_F(CatalogTest, TokensAreGoodForTheirOwnListOnly) {
  ASSERT_OK(catalog_->createCollection("c", ""));
  ASSERT_OK(catalog_->createCollection("d", ""));
  for (const char* name : {"a", "b", "c"}) put("c", name);
  Context context;
  const std::string token = catalog_->listShapes(context, "c", "", {1, ""})->next_token;
  ASSERT_NE(token, "");
  ASSERT_OK(catalog_->listShapes(context, "c", "", {1, token}));
  const auto refuses = [&](const char* parent, const char* filter, const std::string& with) {
    EXPECT_THAT(catalog_->listShapes(context, parent, filter, {1, with}),
                FailsWith(Reason::kInvalidPageToken))
        << with;
  };
  refuses("d", "", token);
  refuses("c", "genus = 1", token);
  refuses("c", "", "x");
  refuses("c", "", token + "0");
  refuses("c", "", token.substr(0, 17));
  refuses("c", "", "2" + token.substr(1));
  EXPECT_THAT(catalog_->listCollections({1, token}), FailsWith(Reason::kInvalidPageToken));
  EXPECT_THAT(catalog_->listShapes(context, "c", "", {-1, ""}), FailsWith(Reason::kInvalidRequest));
  EXPECT_THAT(catalog_->listShapes(context, "c", "colour = 1", {}),
              FailsWith(Reason::kInvalidFilter));
}

TEST_F(CatalogTest, PageSizesAreDefaultedAndCapped) {
  EXPECT_EQ(*effectivePageSize({0, ""}), 100U);
  EXPECT_EQ(*effectivePageSize({7, ""}), 7U);
  EXPECT_EQ(*effectivePageSize({1'000'000, ""}), 1000U);
}

TEST_F(CatalogTest, ScansStopWhenTheVisitorOrTheCallerHasEnough) {
  ASSERT_OK(catalog_->createCollection("c", ""));
  for (const char* name : {"a", "b", "c"}) put("c", name);
  Context context;
  int seen = 0;
  ASSERT_OK(
      catalog_->scanShapes(context, "c", Filter(), [&](const ShapeRecord&) { return ++seen < 2; }));
  EXPECT_EQ(seen, 2);
  CancelToken token;
  token.cancel();
  context.setCancelToken(token);
  EXPECT_THAT(catalog_->scanShapes(context, "c", Filter(), [](const ShapeRecord&) { return true; }),
              FailsWith(Reason::kCancelled));
}

TEST_F(CatalogTest, ChangesTellWhatHappenedInOrder) {
  using Kind = Change::Kind;
  const auto collection = catalog_->createCollection("c", "");
  ASSERT_OK(collection);
  const std::int64_t first = catalog_->putShape(sampleShape("c", "x"), OnExists::kError)->id;
  Context context;
  const auto snapshot = catalog_->forEachVector(context, [](const VectorRow&) { return Status(); });
  ASSERT_OK(snapshot);
  const std::int64_t second = catalog_->putShape(sampleShape("c", "x"), OnExists::kReplace)->id;
  ASSERT_OK(catalog_->deleteCollection("c", true));
  const auto all = catalog_->changesSince(0, 100);
  ASSERT_OK(all);
  EXPECT_TRUE(all->complete);
  std::vector<std::pair<Kind, std::int64_t>> steps;
  for (const Change& change : all->changes) {
    EXPECT_EQ(change.collection_id, collection->id);
    steps.emplace_back(change.kind, change.shape_id);
  }
  EXPECT_THAT(
      steps, ElementsAre(std::pair(Kind::kShapeAdded, first), std::pair(Kind::kShapeRemoved, first),
                         std::pair(Kind::kShapeAdded, second),
                         std::pair(Kind::kCollectionRemoved, std::int64_t{0})));
  const auto late = catalog_->changesSince(*snapshot, 2);
  ASSERT_OK(late);
  EXPECT_EQ(late->changes.size(), 2U);
  EXPECT_EQ(late->changes[0].sequence, all->changes[1].sequence);
}

TEST_F(CatalogTest, ForgottenChangesAreAdmitted) {
  ASSERT_OK(catalog_->createCollection("c", ""));
  for (const char* name : {"a", "b", "c"}) put("c", name);
  runSql("DELETE FROM changes WHERE sequence < 3");
  EXPECT_FALSE(catalog_->changesSince(1, 10)->complete);
  EXPECT_TRUE(catalog_->changesSince(2, 10)->complete);
  EXPECT_TRUE(catalog_->changesSince(3, 10)->complete);
  EXPECT_FALSE(catalog_->changesSince(4, 10)->complete);  // From a store that knew more.
}

TEST_F(CatalogTest, VectorsOfSomeShapesSkipThoseThatAreGone) {
  ASSERT_OK(catalog_->createCollection("c", ""));
  const std::int64_t a = catalog_->putShape(sampleShape("c", "a"), OnExists::kError)->id;
  const std::int64_t b = catalog_->putShape(sampleShape("c", "b"), OnExists::kError)->id;
  ASSERT_OK(catalog_->deleteShape("c", "a"));
  std::set<std::int64_t> seen;
  const std::vector<std::int64_t> ids{a, b, 999};
  ASSERT_OK(catalog_->forEachVectorOf(ids, [&](const VectorRow& row) {
    seen.insert(row.shape_id);
    return Status();
  }));
  EXPECT_EQ(seen, std::set<std::int64_t>{b});
  EXPECT_EQ(catalog_->getShapesById(ids, ShapeView::kFull)->size(), 1U);
}

TEST_F(CatalogTest, ADamagedRowDoesNotTakeTheOthersDown) {
  ASSERT_OK(catalog_->createCollection("c", ""));
  for (const char* name : {"a", "b", "c", "d"}) put("c", name);
  runSql(
      "UPDATE shapes SET format = 'nonsense' WHERE name = 'a';"
      "UPDATE vectors SET bytes = x'0102' WHERE shape_id = 2 AND space = 1;"
      "UPDATE vectors SET bytes = x'0000C07F' WHERE shape_id = 2 AND space = 2;"  // NaN.
      "DELETE FROM signatures WHERE shape_id = 3");
  EXPECT_THAT(catalog_->getShape("c", "a", ShapeView::kSummary), FailsWith(Reason::kStoreCorrupt));
  EXPECT_THAT(catalog_->getShape("c", "c", ShapeView::kFull), FailsWith(Reason::kStoreCorrupt));
  EXPECT_THAT(names(""), ElementsAre("b", "c", "d"));
  EXPECT_EQ(vectors().size(), 4U * 3 - 2);
  EXPECT_EQ(
      catalog_->getShapesById(std::vector<std::int64_t>{1, 2, 3, 4}, ShapeView::kFull)->size(), 2U);
}

TEST_F(CatalogTest, WritersAndReadersRunSideBySide) {
  ASSERT_OK(catalog_->createCollection("c", ""));
  std::atomic<bool> stop = false;
  std::vector<std::thread> threads;
  for (int t = 0; t < 2; ++t) {
    threads.emplace_back([&, t] {
      for (int i = 0; i < 15; ++i) {
        const std::string name = std::to_string(t) + "-" + std::to_string(i);
        EXPECT_OK(catalog_->putShape(sampleShape("c", name), OnExists::kError));
        if (i % 3 == 0) {
          EXPECT_OK(catalog_->deleteShape("c", name));
        }
      }
    });
    threads.emplace_back([&] {
      while (!stop) {
        Context context;
        const auto page = catalog_->listShapes(context, "c", "", {});
        ASSERT_OK(page);
        for (const ShapeRecord& shape : page->items) EXPECT_EQ(shape.tags.size(), 2U);
        // A snapshot holds whole shapes: three vectors each.
        EXPECT_EQ(vectors().size() % 3, 0U);
      }
    });
  }
  threads[0].join();
  threads[2].join();
  stop = true;
  threads[1].join();
  threads[3].join();
  EXPECT_EQ(catalog_->getCollection("c")->shape_count, 20);
}

// ---- The file itself.

TEST_F(CatalogTest, AStoreOfANewerProgramIsRefused) {
  runSql("PRAGMA user_version = 9999");
  catalog_.reset();
  const auto opened = SqliteCatalog::open(path());
  EXPECT_THAT(opened, FailsWith(Reason::kStoreTooNew));
  EXPECT_THAT(opened.status().message(), HasSubstr("9999"));
}

TEST_F(CatalogTest, ADatabaseOfAnotherProgramIsRefused) {
  const auto other = folder_.path() / "other.sqlite";
  {
    auto connection = SqliteConnection::open(other, SqliteConnection::Mode::kReadWrite);
    ASSERT_OK(connection);
    ASSERT_OK((*connection)->execute("CREATE TABLE recipes (name TEXT)"));
  }
  EXPECT_THAT(SqliteCatalog::open(other), FailsWith(Reason::kStoreCorrupt));
}

TEST_F(CatalogTest, GarbageInPlaceOfTheDatabaseIsAnErrorAndNoCrash) {
  ASSERT_OK(catalog_->createCollection("c", ""));
  for (int i = 0; i < 50; ++i) put("c", "shape-" + std::to_string(i));
  catalog_.reset();
  std::ifstream file(path(), std::ios::binary);
  const std::string good((std::istreambuf_iterator<char>(file)), {});
  const auto tryBytes = [&](const std::string& bytes) -> Status {
    std::ofstream(path(), std::ios::binary).write(bytes.data(), std::ssize(bytes));
    auto opened = SqliteCatalog::open(path());
    if (!opened.ok()) return opened.status();
    Context context;
    const auto page = (*opened)->listShapes(context, "c", "", {});
    const Status vectors =
        (*opened)->forEachVector(context, [](const VectorRow&) { return Status(); }).status();
    return page.ok() ? vectors : page.status();
  };
  EXPECT_THAT(tryBytes(randomBytes(8192, 1)), FailsWith(Reason::kStoreCorrupt));
  EXPECT_THAT(tryBytes(good.substr(0, good.size() / 2)), FailsWith(Reason::kStoreCorrupt));
  std::mt19937 random(5);
  for (int round = 0; round < 30; ++round) {
    std::string bent = good;
    const std::size_t at = 100 + random() % (good.size() - 200);
    for (std::size_t i = 0; i < 64; ++i) bent[at + i] = static_cast<char>(random());
    const Status status = tryBytes(bent);  // Some damage shows, some hits unused bytes.
    if (!status.ok()) {
      EXPECT_THAT(status.reason(), testing::AnyOf(Reason::kStoreCorrupt, Reason::kStoreFailure,
                                                  Reason::kCollectionNotFound))
          << status.toString();
    }
  }
}

}  // namespace
}  // namespace moduli
