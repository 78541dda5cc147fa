#include <algorithm>

#include "tests/client/cli_test.h"

/// search for one surface and for many, and collections that are searched approximately.
namespace moduli {
namespace {

using testing::HasSubstr;

class Search : public CliTest {
 protected:
  void SetUp() override {
    CliTest::SetUp();
    sample("in/ball.obj", {"sphere", "resolution=4"});
    sample("in/egg.obj", {"spheroid", "c=1.4", "resolution=4"});
    sample("in/ring.obj", {"torus", "resolution=8"});
    sample("in/thick.obj", {"torus", "r=0.9", "resolution=8"});
    write("in/twin.obj", read("in/ring.obj"));
  }

  // Adds the files in this order to a collection.
  void add(const std::string& collection, const std::vector<std::string>& names) const {
    for (const std::string& name : names) {
      ASSERT_THAT(run({"add", "-c", collection, "in/" + name + ".obj"}), Succeeds());
    }
  }

  void addAll() const { add("c", {"ball", "egg", "ring", "thick", "twin"}); }

  static std::vector<std::string> namesOf(const Json& hits) {
    std::vector<std::string> names;
    for (int i = 0; i < hits.size(); ++i) names.push_back(hits.at(i)["name"].string());
    return names;
  }
};

TEST_F(Search, OneQueryAnswersAsEverAndManyWithAListEach) {
  addAll();
  const Json one = json({"search", "-c", "c", "in/ring.obj"});
  EXPECT_THAT(one.keys(), testing::UnorderedElementsAre("hits", "exact"));
  EXPECT_EQ(one["hits"].size(), 5);  // Fewer than ten: all.
  EXPECT_THAT(namesOf(one["hits"]), testing::Contains("egg"));

  const Json many = json({"search", "-c", "c", "in/ring.obj", "c/egg", "in/ball.obj", "-k", "2"});
  EXPECT_THAT(many.keys(), testing::ElementsAre("results"));
  ASSERT_EQ(many["results"].size(), 3);
  EXPECT_EQ(many["results"].at(0)["query"].string(), "in/ring.obj");
  EXPECT_EQ(many["results"].at(1)["query"].string(), "c/egg");
  EXPECT_THAT(many["results"].at(0).keys(),
              testing::UnorderedElementsAre("query", "hits", "exact"));
  EXPECT_EQ(namesOf(many["results"].at(0)["hits"]), (std::vector<std::string>{"ring", "twin"}));
  EXPECT_EQ(namesOf(many["results"].at(1)["hits"])[0], "egg");
  EXPECT_EQ(namesOf(many["results"].at(2)["hits"])[0], "ball");

  const std::string text = run({"search", "-c", "c", "--id", "ball", "--id", "egg", "-k", "1"}).out;
  EXPECT_THAT(text, HasSubstr("ball\n#  distance"));
  EXPECT_THAT(text, HasSubstr("\n\negg\n#  distance"));
}

TEST_F(Search, AllShapesOfACollectionAreSearchedForAsOneByOne) {
  addAll();
  for (const char* space : {"shape", "metric", "conformal"}) {
    const Json all = json({"search", "-c", "c", "--all", "--space", space})["results"];
    ASSERT_EQ(all.size(), 5);
    for (int i = 0; i < all.size(); ++i) {
      const Json result = all.at(i);
      const Json one =
          json({"search", "-c", "c", "--id", result["query"].string(), "--space", space});
      EXPECT_EQ(namesOf(result["hits"]), namesOf(one["hits"]));
      for (int h = 0; h < one["hits"].size(); ++h) {
        EXPECT_EQ(result["hits"].at(h)["distance"].number(),
                  one["hits"].at(h)["distance"].number());
      }
      EXPECT_TRUE(result["exact"].boolean());
    }
  }
  EXPECT_EQ(json({"search", "-c", "c", "--all", "--filter", "genus = 1", "--explain"})["results"]
                .at(0)["hits"]
                .at(0)["parts"]
                .size(),
            6);
}

TEST_F(Search, AListNamesWhatIsSearchedFor) {
  addAll();
  write("list", "in/ring.obj\n\nc/egg\n");
  const Json listed = json({"search", "-c", "c", "in/ball.obj", "--from-file", "list"})["results"];
  ASSERT_EQ(listed.size(), 3);
  EXPECT_EQ(listed.at(2)["query"].string(), "c/egg");
  Process::Options options;
  options.input = "c/ball\n";
  const ProcessResult piped = run({"search", "-c", "c", "--from-file", "-", "--json"}, options);
  EXPECT_THAT(piped, Succeeds());
  EXPECT_EQ(Json::parse(piped.out)["results"].size(), 1);
}

TEST_F(Search, AQueryThatFailsIsToldBesideTheOthers) {
  addAll();
  write("broken.obj", "v 0 0 0\nf 1 2 3\n");
  const ProcessResult result =
      run({"search", "-c", "c", "in/ring.obj", "none.obj", "broken.obj", "c/none", "--json"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, testing::StartsWith("moduli: error: 3 of 4 queries failed: none.obj: "));
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1);
  const Json results = Json::parse(result.out)["results"];
  ASSERT_EQ(results.size(), 4);
  EXPECT_FALSE(results.at(0).has("failure"));
  EXPECT_EQ(results.at(0)["hits"].size(), 5);
  EXPECT_EQ(results.at(1)["failure"]["reason"].string(), "FILE_NOT_FOUND");
  EXPECT_EQ(results.at(2)["failure"]["reason"].string(), "INDEX_OUT_OF_RANGE");
  EXPECT_EQ(results.at(3)["failure"]["reason"].string(), "SHAPE_NOT_FOUND");
  EXPECT_THAT(run({"search", "-c", "c", "none.obj", "in/ring.obj"}).out,
              HasSubstr("none.obj\nfailed: "));
  expectRefusal({"search", "-c", "none", "--all"}, "COLLECTION_NOT_FOUND");
  expectRefusal({"search", "-c", "none", "in/ring.obj", "in/egg.obj"}, "COLLECTION_NOT_FOUND");
  expectRefusal({"search", "-c", "c", "in/ring.obj", "in/egg.obj", "--filter", "colour = 3"},
                "column 1");
  expectRefusal({"search", "-c", "c", "in/ring.obj", "-k", "1000001"}, "not in 1 to 1000000");
}

// Ids, indexes and rows on disk differ; what is stored is the same.
TEST_F(Search, TheAnswerDoesNotTellInWhichOrderShapesCame) {
  add("c", {"ball", "egg", "ring", "thick", "twin"});
  add("d", {"twin", "thick", "ring", "egg", "ball"});
  add("e", {"ring", "ball", "twin", "egg", "thick"});
  ASSERT_THAT(run({"remove", "-c", "e", "ring", "ball", "thick"}), Succeeds());
  add("e", {"thick", "ball", "ring"});
  for (const char* space : {"shape", "metric", "conformal"}) {
    std::vector<std::string> answers;
    for (const char* collection : {"c", "d", "e"}) {
      std::vector<std::string> words = {"search", "-c", collection, "--space", space, "--json"};
      std::string answer;
      for (const char* mesh : {"in/ring.obj", "in/ball.obj"}) {
        std::vector<std::string> one = words;
        one.emplace_back(mesh);
        answer += run(one).out;
        one.insert(one.end(), {"-k", "2"});
        answer += run(one).out;
      }
      words.emplace_back("--all");
      answers.push_back(answer + run(words).out);
    }
    EXPECT_THAT(answers[0], HasSubstr("\"twin\""));
    EXPECT_EQ(answers[1], answers[0]) << space;
    EXPECT_EQ(answers[2], answers[0]) << space;
  }
}

TEST_F(Search, ACollectionTellsHowItIsSearched) {
  const Json made = json({"collection", "create", "fast", "--approximate"});
  EXPECT_EQ(made["wanted_recall"].number(), 0.99);
  EXPECT_FALSE(json({"collection", "create", "c"}).has("wanted_recall"));
  EXPECT_EQ(json({"collection", "edit", "c", "--approximate=0.9"})["wanted_recall"].number(), 0.9);
  EXPECT_EQ(json({"collection", "show", "c"})["wanted_recall"].number(), 0.9);
  EXPECT_EQ(run({"collection", "show", "c"}).out,
            "c: 0 shapes, approximate search (recall 0.9 wanted, exact so far)\n");
  add("c", {"ball", "ring"});
  const Json found = json({"search", "-c", "c", "in/ring.obj"});
  EXPECT_TRUE(found["exact"].boolean()) << "a small collection";
  EXPECT_FALSE(found.has("recall"));
  EXPECT_FALSE(json({"collection", "edit", "c", "--exact"}).has("wanted_recall"));
  EXPECT_EQ(run({"collection", "show", "c"}).out, "c: 2 shapes\n");
  expectRefusal({"collection", "edit", "none", "--exact"}, "COLLECTION_NOT_FOUND");
}

}  // namespace
}  // namespace moduli
