#include "server/store/search.h"

#include <random>

#include "tests/server/store/search_testing.h"

namespace moduli {
namespace {

// Values that float32 cannot tell apart: only the doubles decide, as the answer must.
TEST_F(SearchTest, MetricAndShapeSpaceAreExactBeyondFloatRounding) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> tiny(-1e-9, 1e-9);
  for (int i = 0; i < 60; ++i) {
    put(numbered('s', i), {1 + tiny(random), 2 + tiny(random), 3 + tiny(random)});
  }
  for (int i = 0; i < 60; ++i) {
    put(numbered('t', i), {1 + 1e7 * tiny(random), 2, 3 + 1e9 * tiny(random)});
  }
  const Doubles values{1, 2, 3};
  for (const Space space : {Space::kMetric, Space::kShape}) {
    for (const std::size_t k : {1, 7, 59, 61, 500}) {
      EXPECT_EQ(found(query(space, values, k)), wanted(space, values, k)) << k;
    }
  }
}

TEST_F(SearchTest, ComparesLittleMoreThanItAnswers) {
  for (int i = 0; i < 200; ++i) put(numbered('s', i), {0.1 * i, 1, 2});
  found(query(Space::kShape, {3, 1, 2}, 5));
  EXPECT_LE(read_, 32);
}

TEST_F(SearchTest, AFilterStillGivesKHits) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int i = 0; i < 150; ++i) {
    put(numbered('s', i), {uniform(random), uniform(random), uniform(random)});
  }
  const Doubles values{0.5, 0.5, 0.5};
  for (const char* filter : {"name >= \"s9\"", "tags.owner = \"s77\"", "genus = 0", "genus > 5"}) {
    for (const Space space : {Space::kShape, Space::kConformal}) {
      EXPECT_EQ(found(query(space, values, 10, filter)), wanted(space, values, 10, filter))
          << filter;
    }
  }
  EXPECT_EQ(found(query(Space::kShape, values, 10, "name >= \"s9\"")).size(), 10U);
}

TEST_F(SearchTest, EqualDistancesComeByAscendingName) {
  for (const char* name : {"e", "b", "d", "a", "c", "f"}) put(name, {1, 2, 3});
  for (int i = 0; i < 50; ++i) put(numbered('x', i), {1, 2, 3});
  const auto hits = found(query(Space::kShape, {1, 2, 3}, 4));
  const std::vector<std::pair<double, std::string>> first{{0, "a"}, {0, "b"}, {0, "c"}, {0, "d"}};
  EXPECT_EQ(hits, first);
}

TEST_F(SearchTest, ConformalSpaceComparesAllOfTheTypeAndSaysWhenItDoesNot) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int i = 0; i < 80; ++i) {
    put(numbered('s', i), {uniform(random), uniform(random)}, i % 4 == 0 ? "ANNULUS" : "TORUS");
  }
  const Doubles values{0.5, 0.5};
  SearchQuery asked = query(Space::kConformal, values, 10);
  asked.exhaustive_limit = 60;  // Just all tori.
  EXPECT_EQ(found(asked), wanted(Space::kConformal, values, 10));
  asked.exhaustive_limit = 59;
  EXPECT_EQ(found(asked, false).size(), 10U);
}

TEST_F(SearchTest, SpheresAreAllTheSameAndComeByName) {
  put("b", {1, 2}, "SPHERE");
  put("a", {3, 4}, "SPHERE");
  put("c", {5, 6}, "SPHERE");
  put("t", {1, 2}, "TORUS");
  SearchQuery asked = query(Space::kConformal, {}, 2);
  asked.type = "SPHERE";
  const std::vector<std::pair<double, std::string>> first{{0, "a"}, {0, "b"}};
  EXPECT_EQ(found(asked), first);
  asked.filter = *Filter::parse("name > \"a\"");
  const std::vector<std::pair<double, std::string>> rest{{0, "b"}, {0, "c"}};
  EXPECT_EQ(found(asked), rest);
}

TEST_F(SearchTest, AShapeThatCannotBeComparedIsLeftOutAndAdmitted) {
  for (const char* name : {"a", "b", "c"}) put(name, {1, 2, 3});
  SearchQuery asked = query(Space::kShape, {1, 2, 3}, 5);
  const auto read = asked.read;
  asked.read = [&](const ShapeRecord& shape) -> Result<Signature> {
    if (shape.name == "b") return Status(Reason::kStoreCorrupt, "no signature");
    return read(shape);
  };
  const std::vector<std::pair<double, std::string>> rest{{0, "a"}, {0, "c"}};
  EXPECT_EQ(found(asked, false), rest);
  asked.read = [&](const ShapeRecord& shape) -> Result<Signature> {
    if (shape.name == "b") return Signature();
    return read(shape);
  };
  asked.distance = [](const Signature& shape) {
    return shape.conformal ? std::optional(0.0) : std::nullopt;
  };
  EXPECT_EQ(found(asked), rest);  // No distance is defined: not a failure.
}

TEST_F(SearchTest, AVectorThatIsNotItsSignaturesIsNoticed) {
  put("a", {1, 2, 3});
  ShapeRecord shape = sampleShape("c", "b");
  shape.signature = encode({9, 9, 9});
  shape.vectors.shape = {1, 2, 3};
  ASSERT_OK(catalog_->putShape(shape, OnExists::kError));
  EXPECT_EQ(found(query(Space::kShape, {1, 2, 3}, 1), false).size(), 1U);
}

TEST_F(SearchTest, ShapesRemovedBehindTheIndexAreNotAnswered) {
  for (const char* name : {"a", "b", "c"}) put(name, {1, 2, 3});
  ASSERT_OK(keeper_->refresh());
  ASSERT_OK(catalog_->deleteShape("c", "b"));
  Context context;
  const auto answer =
      searchShapes(context, *catalog_, *keeper_, query(Space::kShape, {1, 2, 3}, 3));
  ASSERT_OK(answer);
  ASSERT_EQ(answer->hits.size(), 2U);
  EXPECT_EQ(answer->hits[1].name, "c");
}

TEST_F(SearchTest, FailuresAreToldApart) {
  put("a", {1, 2, 3});
  ASSERT_OK(keeper_->refresh());
  Context context;
  SearchQuery asked = query(Space::kShape, {1, 2, 3}, 0);
  EXPECT_THAT(searchShapes(context, *catalog_, *keeper_, asked), FailsWith(Reason::kInvalidOption));
  asked = query(Space::kShape, {1, std::nan(""), 3}, 1);
  EXPECT_THAT(searchShapes(context, *catalog_, *keeper_, asked), FailsWith(Reason::kInvalidOption));
  asked = query(Space::kShape, {1, 2, 3}, 1);
  asked.collection = "nowhere";
  EXPECT_THAT(searchShapes(context, *catalog_, *keeper_, asked),
              FailsWith(Reason::kCollectionNotFound));
  asked = query(Space::kShape, {1, 2, 3}, 1);
  asked.read = [](const ShapeRecord&) -> Result<Signature> {
    return Status(Reason::kDeadlineExceeded, "too late");
  };
  EXPECT_THAT(searchShapes(context, *catalog_, *keeper_, asked),
              FailsWith(Reason::kDeadlineExceeded));
  EXPECT_TRUE(found(query(Space::kShape, {1, 2}, 1)).empty());  // Another length: incomparable.
}

}  // namespace
}  // namespace moduli
