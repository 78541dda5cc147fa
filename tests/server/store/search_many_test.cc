#include <algorithm>
#include <numeric>
#include <random>

#include "server/store/search_page.h"
#include "tests/server/store/search_testing.h"

/// Pages, many queries at once, and independence of the order in which shapes come.
namespace moduli {
namespace {

using Hits = std::vector<std::pair<double, std::string>>;

// Few values, so that equal distances are common.
Doubles coarse(std::mt19937& random) {
  return {static_cast<double>(random() % 3), static_cast<double>(random() % 3),
          static_cast<double>(random() % 3)};
}

class SearchManyTest : public SearchTest {
 protected:
  SearchAnswer answerOf(const SearchQuery& query) {
    Context context;
    auto answer = searchShapes(context, *catalog_, *keeper_, query);
    EXPECT_OK(answer);
    return answer.ok() ? *std::move(answer) : SearchAnswer();
  }

  static SearchPosition behind(const SearchAnswer& page, std::size_t count) {
    return {page.hits.back().distance, page.hits.back().name, count};
  }

  // All pages of this size, one after the other.
  Hits paged(SearchQuery query, std::size_t size) {
    Hits hits;
    query.k = size;
    for (bool more = true; more;) {
      const SearchAnswer page = answerOf(query);
      EXPECT_LE(page.hits.size(), size);
      for (const SearchHit& hit : page.hits) hits.emplace_back(hit.distance, hit.name);
      more = page.more;
      if (more) query.after = behind(page, hits.size());
    }
    return hits;
  }

  void fill(int count, unsigned seed) {
    std::mt19937 random(seed);
    for (int i = 0; i < count; ++i) {
      put(numbered('s', i), coarse(random), i % 5 == 0 ? "SPHERE" : "TORUS");
    }
    ASSERT_OK(keeper_->refresh());
  }
};

TEST_F(SearchManyTest, PagesOfAnySizeMakeTheWholeAnswer) {
  fill(60, 1);
  for (const Space space : {Space::kShape, Space::kConformal}) {
    const SearchQuery asked = query(space, {1, 1, 1}, 1000);
    const Hits all = wanted(space, {1, 1, 1}, 1000);
    for (const std::size_t size : {1, 3, 7, 59, 60, 61, 1000}) {
      EXPECT_EQ(paged(asked, size), all) << size;
    }
  }
  SearchQuery spheres = query(Space::kConformal, {1, 1, 1}, 1000);
  spheres.type = "SPHERE";
  const Hits all = paged(spheres, 1000);
  EXPECT_EQ(all.size(), 12U);
  EXPECT_EQ(paged(spheres, 5), all);
  EXPECT_EQ(paged(query(Space::kShape, {0, 1, 2}, 9, "genus = 0"), 2),
            wanted(Space::kShape, {0, 1, 2}, 1000, "genus = 0"));
}

// A hint of where the page stands that is far off costs time alone.
TEST_F(SearchManyTest, APageIsThatBehindItsHitWhateverTheCountSays) {
  fill(60, 2);
  const Hits all = wanted(Space::kShape, {1, 1, 1}, 1000);
  SearchQuery asked = query(Space::kShape, {1, 1, 1}, 5);
  for (const std::size_t count : {1, 30, 100000}) {
    asked.after = SearchPosition{all[29].first, all[29].second, count};
    EXPECT_EQ(found(asked), Hits(all.begin() + 30, all.begin() + 35)) << count;
  }
}

TEST_F(SearchManyTest, PagesGoOnWhereShapesComeAndGo) {
  fill(60, 3);
  const Hits all = wanted(Space::kShape, {1, 1, 1}, 1000);
  SearchQuery asked = query(Space::kShape, {1, 1, 1}, 20);
  const SearchAnswer first = answerOf(asked);
  asked.after = behind(first, 20);
  // The very hit that the page begins behind goes, others before it, one behind; one comes before.
  for (const std::size_t gone : {0, 7, 19, 25}) {
    ASSERT_OK(catalog_->deleteShape("c", all[gone].second));
  }
  put("a", {1, 1, 1});
  asked.k = 1000;
  Hits rest(all.begin() + 20, all.end());
  rest.erase(rest.begin() + 5);
  EXPECT_EQ(found(asked), rest);
}

TEST_F(SearchManyTest, ManyAnswersAreThoseOfSingleSearchesAndReadEachShapeOnce) {
  fill(80, 4);
  std::mt19937 random(5);
  for (const char* filter : {"", "genus = 0", "genus > 5"}) {
    for (const Space space : {Space::kShape, Space::kMetric, Space::kConformal}) {
      std::vector<SearchQuery> queries;
      for (int q = 0; q < 300; ++q) queries.push_back(query(space, coarse(random), 6, filter));
      queries[7].type = queries[9].type = "SPHERE";
      if (space != Space::kConformal) queries[5].vector = {1, 2};  // None is comparable.
      read_ = 0;
      Context context;
      const auto many = searchShapesMany(context, *catalog_, *keeper_, queries);
      ASSERT_OK(many);
      EXPECT_LE(read_, 80);
      ASSERT_EQ(many->size(), queries.size());
      for (std::size_t q = 0; q < queries.size(); ++q) {
        const SearchAnswer one = answerOf(queries[q]);
        EXPECT_EQ((*many)[q].exact, one.exact);
        EXPECT_EQ((*many)[q].more, one.more);
        ASSERT_EQ((*many)[q].hits.size(), one.hits.size()) << q;
        for (std::size_t i = 0; i < one.hits.size(); ++i) {
          EXPECT_EQ((*many)[q].hits[i].name, one.hits[i].name);
          EXPECT_EQ((*many)[q].hits[i].distance, one.hits[i].distance);
        }
      }
    }
  }
  Context context;
  EXPECT_TRUE(searchShapesMany(context, *catalog_, *keeper_, {})->empty());
}

TEST_F(SearchManyTest, AnAnswerDoesNotTellInWhichOrderShapesCame) {
  std::mt19937 random(6);
  std::vector<Doubles> values;
  for (int i = 0; i < 40; ++i) values.push_back(coarse(random));
  std::vector<Hits> first;
  for (int order = 0; order < 3; ++order) {
    std::vector<int> places(values.size());
    std::iota(places.begin(), places.end(), 0);
    std::shuffle(places.begin(), places.end(), random);
    for (const int i : places) put(numbered('s', i), values[static_cast<std::size_t>(i)]);
    for (int again = 0; again < 10; ++again) {
      const int i = places[static_cast<std::size_t>(again)];
      ASSERT_OK(catalog_->deleteShape("c", numbered('s', i)));
      put(numbered('s', i), values[static_cast<std::size_t>(i)]);
    }
    std::vector<Hits> answers;
    for (const Space space : {Space::kShape, Space::kMetric, Space::kConformal}) {
      answers.push_back(found(query(space, {1, 0, 2}, 15)));
    }
    // Ten shapes are too many to be all compared, and many are as near as the tenth.
    SearchQuery limited = query(Space::kConformal, {1, 0, 2}, 15);
    limited.exhaustive_limit = 10;
    answers.push_back(found(limited, false));
    if (order == 0) first = answers;
    EXPECT_EQ(answers, first);
  }
}

TEST_F(SearchManyTest, CollectionsOfNothingOneOrTheSameAreSearched) {
  const SearchQuery asked = query(Space::kShape, {1, 2, 3}, 10);
  EXPECT_TRUE(found(asked).empty());
  put("a", {1, 2, 3});
  EXPECT_EQ(found(asked), (Hits{{0, "a"}}));
  for (int i = 0; i < 100; ++i) put(numbered('x', i), {1, 2, 3});
  EXPECT_EQ(found(asked).size(), 10U);
  EXPECT_EQ(paged(asked, 9).size(), 101U);
  Context context;
  const std::vector<SearchQuery> queries(70, asked);
  const auto many = searchShapesMany(context, *catalog_, *keeper_, queries);
  ASSERT_OK(many);
  EXPECT_EQ(many->back().hits.back().name, "x16");  // After a, x0, x1, x10, ...
}

TEST(SearchToken, ComesBackAsItWasMade) {
  for (const SearchPosition& position :
       {SearchPosition{0, "a", 1}, SearchPosition{0.1, "\xC3\xA9t\xC3\xA9 1", 1000000},
        SearchPosition{1e-300, "x:y", 77}}) {
    const std::string token = makeSearchToken("request", "state", position);
    EXPECT_OK(checkSearchToken("request", token));
    const auto read = readSearchToken("request", "state", token);
    ASSERT_OK(read);
    EXPECT_EQ(read->distance, position.distance);
    EXPECT_EQ(read->name, position.name);
    EXPECT_EQ(read->count, position.count);
  }
  EXPECT_OK(checkSearchToken("request", ""));
}

TEST(SearchToken, OfAnotherRequestOrOfAnotherTimeIsRefused) {
  const std::string token = makeSearchToken("request", "state", {0.5, "a", 10});
  const Status foreign = checkSearchToken("another", token);
  EXPECT_THAT(foreign, FailsWith(Reason::kInvalidPageToken));
  EXPECT_THAT(foreign.message(), testing::HasSubstr("another search"));
  EXPECT_OK(checkSearchToken("request", token));
  const Status stale = readSearchToken("request", "later", token).status();
  EXPECT_THAT(stale, FailsWith(Reason::kInvalidPageToken));
  EXPECT_THAT(stale.message(), testing::HasSubstr("since this page token was given"));
}

TEST(SearchToken, ThatIsNoneIsRefusedWhereverItIsBroken) {
  const std::string token = makeSearchToken("request", "state", {0.5, "abc", 10});
  for (std::size_t length = 1; length < token.size(); ++length) {
    const std::string cut = token.substr(0, length);
    if (const auto read = readSearchToken("request", "state", cut); read.ok()) {
      EXPECT_GT(read->name.size(), 0U);  // Cut within the name: another sound position.
      EXPECT_TRUE(std::string("abc").starts_with(read->name));
    }
  }
  EXPECT_THAT(checkSearchToken("request", "nonsense"), FailsWith(Reason::kInvalidPageToken));
  const double nan = std::nan("");
  EXPECT_THAT(checkSearchToken("request", makeSearchToken("request", "state", {nan, "a", 1})),
              FailsWith(Reason::kInvalidPageToken));
  EXPECT_THAT(checkSearchToken("request", makeSearchToken("request", "state", {1, "a/b", 1})),
              FailsWith(Reason::kInvalidPageToken));
  EXPECT_THAT(checkSearchToken("request", makeSearchToken("request", "state", {1, "a", 0})),
              FailsWith(Reason::kInvalidPageToken));
}

}  // namespace
}  // namespace moduli
