#include <cmath>

#include "server/store/sqlite_catalog.h"
#include "tests/server/store/store_testing.h"

/// Changing shapes in place, and deleting many at once.
namespace moduli {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using Tags = std::map<std::string, std::string>;

class CatalogEditTest : public testing::Test {
 protected:
  void SetUp() override {
    auto opened = SqliteCatalog::open(folder_.path() / "catalog.sqlite");
    ASSERT_OK(opened);
    catalog_ = *std::move(opened);
    ASSERT_OK(catalog_->createCollection("c", ""));
    for (const std::string name : {"a", "b", "d"}) {
      ASSERT_OK(catalog_->putShape(sampleShape("c", name), OnExists::kError));
    }
  }

  ShapeRecord get(const std::string& name) {
    const auto shape = catalog_->getShape("c", name, ShapeView::kFull);
    EXPECT_OK(shape);
    return shape.ok() ? *shape : ShapeRecord();
  }

  std::vector<std::string> names() {
    Context context;
    const auto page = catalog_->listShapes(context, "c", "", {});
    EXPECT_OK(page);
    std::vector<std::string> names;
    for (const ShapeRecord& shape : page->items) names.push_back(shape.name);
    return names;
  }

  std::size_t changes() {
    const auto batch = catalog_->changesSince(0, 1000);
    EXPECT_OK(batch);
    return batch->changes.size();
  }

  Filter filter(const std::string& text) {
    const auto parsed = Filter::parse(text);
    EXPECT_OK(parsed);
    return *parsed;
  }

  TemporaryFolder folder_;
  Context context_;
  std::unique_ptr<Catalog> catalog_;
};

TEST_F(CatalogEditTest, AShapeKeepsItsRowUnderAnotherNameAndLabel) {
  const ShapeRecord before = get("a");
  const std::size_t history = changes();
  ShapeUpdate update;
  update.name = "renamed";
  update.label = "another label";
  update.tags = Tags{{"only", "this"}};
  ASSERT_OK(catalog_->updateShape("c", "a", update));
  const ShapeRecord after = get("renamed");
  EXPECT_EQ(after.id, before.id);
  EXPECT_EQ(after.label, "another label");
  EXPECT_EQ(after.tags, *update.tags);
  EXPECT_EQ(after.digest, before.digest);
  EXPECT_EQ(after.signature, before.signature);
  EXPECT_EQ(after.create_time, before.create_time);
  EXPECT_EQ(changes(), history);  // Indexes have nothing to catch up with.
  EXPECT_THAT(names(), ElementsAre("b", "d", "renamed"));
  EXPECT_EQ(catalog_->getCollection("c")->shape_count, 3);
}

TEST_F(CatalogEditTest, WhatIsNotGivenStays) {
  ASSERT_OK(catalog_->updateShape("c", "a", {}));
  ShapeUpdate update;
  update.name = "a";
  update.label = "";
  ASSERT_OK(catalog_->updateShape("c", "a", update));
  const ShapeRecord after = get("a");
  EXPECT_EQ(after.label, "");
  EXPECT_EQ(after.tags, sampleShape("c", "a").tags);
}

TEST_F(CatalogEditTest, RefusesAsAWhole) {
  const auto expectRefusal = [&](const std::string& collection, const std::string& name,
                                 const ShapeUpdate& update, Reason reason) {
    EXPECT_THAT(catalog_->updateShape(collection, name, update), FailsWith(reason));
    EXPECT_EQ(get("a").label, sampleShape("c", "a").label);
    EXPECT_EQ(get("a").tags, sampleShape("c", "a").tags);
  };
  ShapeUpdate update;
  update.label = "new";
  expectRefusal("none", "a", update, Reason::kCollectionNotFound);
  expectRefusal("c", "none", update, Reason::kShapeNotFound);
  update.name = "b";
  expectRefusal("c", "a", update, Reason::kShapeExists);
  update.name = "x/y";
  expectRefusal("c", "a", update, Reason::kInvalidName);
  update.name.reset();
  update.tags = Tags{{"", "no key"}};
  expectRefusal("c", "a", update, Reason::kInvalidRequest);
  update.tags.reset();
  update.label = "\x01";
  expectRefusal("c", "a", update, Reason::kInvalidRequest);
}

TEST_F(CatalogEditTest, DeletesWhatAFilterNamesAndSaysItBefore) {
  EXPECT_THAT(*catalog_->deleteShapes(context_, "c", filter("name != \"b\""), true),
              ElementsAre("a", "d"));
  EXPECT_THAT(names(), ElementsAre("a", "b", "d"));
  const std::size_t history = changes();
  EXPECT_THAT(*catalog_->deleteShapes(context_, "c", filter("tags.owner != \"b\""), false),
              ElementsAre("a", "d"));
  EXPECT_THAT(names(), ElementsAre("b"));
  EXPECT_EQ(changes(), history + 2);
  EXPECT_EQ(catalog_->getCollection("c")->shape_count, 1);
  EXPECT_THAT(*catalog_->deleteShapes(context_, "c", filter("genus > 7"), false), IsEmpty());
  EXPECT_THAT(catalog_->deleteShapes(context_, "none", filter("genus > 7"), false),
              FailsWith(Reason::kCollectionNotFound));
}

TEST_F(CatalogEditTest, ACancelledDeletionDeletesNothing) {
  CancelToken token;
  token.cancel();
  Context context;
  context.setCancelToken(token);
  EXPECT_THAT(catalog_->deleteShapes(context, "c", filter("genus > 0"), false),
              FailsWith(Reason::kCancelled));
  EXPECT_THAT(names(), ElementsAre("a", "b", "d"));
}

TEST_F(CatalogEditTest, ACollectionKeepsTheRecallThatItWants) {
  ASSERT_OK(catalog_->createCollection("fast", "0b1e-9", 0.95));
  EXPECT_EQ(catalog_->getCollection("fast")->wanted_recall, 0.95);
  EXPECT_EQ(catalog_->createCollection("fast", "0b1e-9", 0.95)->wanted_recall, 0.95);
  EXPECT_EQ(catalog_->listCollections({})->items.back().wanted_recall, 0.95);
  EXPECT_FALSE(catalog_->getCollection("c")->wanted_recall);
  const auto id = catalog_->getCollection("c")->id;
  const auto before = catalog_->changesSince(0, 100)->changes;
  const std::int64_t sequence = before.empty() ? 0 : before.back().sequence;
  const auto updated = catalog_->updateCollection("c", 0.5);
  ASSERT_OK(updated);
  EXPECT_EQ(updated->wanted_recall, 0.5);
  ASSERT_OK(catalog_->updateCollection("c", 0.5));  // Changes nothing.
  const auto changes = catalog_->changesSince(sequence, 100)->changes;
  ASSERT_EQ(changes.size(), 1U);
  EXPECT_EQ(changes[0].kind, Change::Kind::kCollectionChanged);
  EXPECT_EQ(changes[0].collection_id, id);
  EXPECT_EQ(catalog_->wantedRecalls()->at(id), 0.5);
  EXPECT_EQ(catalog_->wantedRecalls()->size(), 2U);
  ASSERT_OK(catalog_->updateCollection("c", {}));
  EXPECT_EQ(catalog_->wantedRecalls()->size(), 1U);
  for (const double bad : {0.0, 1.0, -1.0, 2.0, std::nan("")}) {
    EXPECT_THAT(catalog_->createCollection("bad", "", bad), FailsWith(Reason::kInvalidOption));
    EXPECT_THAT(catalog_->updateCollection("c", bad), FailsWith(Reason::kInvalidOption));
  }
  EXPECT_THAT(catalog_->updateCollection("none", 0.5), FailsWith(Reason::kCollectionNotFound));
}

}  // namespace
}  // namespace moduli
