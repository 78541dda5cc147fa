#include <cmath>

#include "tests/client/cli_test.h"

/// evaluate, duplicates, edit, and remove by filter, as their users see them.
namespace moduli {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class Evaluate : public CliTest {
 protected:
  void SetUp() override {
    CliTest::SetUp();
    sample("s1.obj", {"sphere", "resolution=5"});
    sample("s2.obj", {"spheroid", "c=0.9", "resolution=5"});
    sample("t1.obj", {"torus", "resolution=10"});
    sample("t2.obj", {"torus", "r=0.95", "resolution=10"});
    sample("c1.obj", {"capped-cylinder", "resolution=5", "half_length=3"});
    write("copy.obj", read("t1.obj"));
    EXPECT_THAT(
        run({"add", "-c", "z", "s1.obj", "s2.obj", "t1.obj", "t2.obj", "copy.obj", "c1.obj"}),
        Succeeds());
    for (const auto& [shape, label] :
         std::vector<std::pair<std::string, std::string>>{{"s1", "ball"},
                                                          {"s2", "ball"},
                                                          {"t1", "ring"},
                                                          {"t2", "ring"},
                                                          {"copy", "ring"},
                                                          {"c1", "rod"}}) {
      EXPECT_THAT(run({"edit", "-c", "z", shape, "--label", label}), Succeeds());
    }
  }
};

TEST_F(Evaluate, LabelsThatDistancesFollowAreFoundWhole) {
  const Json report = json({"evaluate", "-c", "z", "--curve", "curve.svg"});
  EXPECT_EQ(report["space"].string(), "SHAPE");
  EXPECT_EQ(report["queries"].number(), 5);  // The rod has no other.
  for (const char* score :
       {"nearest_neighbour", "first_tier", "second_tier", "mean_average_precision", "dcg"}) {
    EXPECT_EQ(report[score].number(), 1) << score;
  }
  ASSERT_EQ(report["per_class"].size(), 2);
  EXPECT_EQ(report["per_class"].at(0)["label"].string(), "ball");
  EXPECT_EQ(report["per_class"].at(1)["members"].number(), 3);
  EXPECT_EQ(report["per_class"].at(1)["nearest"]["ring"].number(), 3);
  EXPECT_EQ(report["precision"].size(), 11);
  EXPECT_THAT(read("curve.svg"), HasSubstr("<svg"));
  EXPECT_THAT(run({"evaluate", "-c", "z", "--confusion"}).out, HasSubstr("ring 3"));
  // Conformally all spheres are one: the rod stands between the balls.
  const Json conformal = json({"evaluate", "-c", "z", "--space", "conformal"});
  EXPECT_EQ(conformal["tied"].number(), 2);
}

TEST_F(Evaluate, RefusesWhatHasNoLabelsToJudge) {
  expectRefusal({"evaluate", "-c", "z", "--filter", "label = \"rod\""}, "share a label");
  expectRefusal({"evaluate", "-c", "none"}, "none");
  expectRefusal({"evaluate", "-c", "z", "--filter", "colour = 3"}, "column 1");
}

TEST_F(Evaluate, DuplicatesComeInGroups) {
  Json report = json({"duplicates", "-c", "z"});
  EXPECT_EQ(report["shapes"].number(), 6);
  ASSERT_EQ(report["clusters"].size(), 1);
  EXPECT_EQ(report["clusters"].at(0)["names"].at(0).string(), "copy");
  EXPECT_EQ(report["clusters"].at(0)["names"].at(1).string(), "t1");
  EXPECT_EQ(report["clusters"].at(0)["linkage"].number(), 0);
  report = json({"duplicates", "-c", "z", "--threshold", "100"});
  ASSERT_EQ(report["clusters"].size(), 1);
  EXPECT_EQ(report["clusters"].at(0)["names"].size(), 6);
  EXPECT_THAT(run({"duplicates", "-c", "z", "--threshold", "-1"}), IsUsageError());
}

TEST_F(Evaluate, CopiesOfAnotherSizeAreDuplicatesUnlessSizesCount) {
  sample("large.obj", {"torus", "R=4", "r=2", "resolution=10"});
  EXPECT_THAT(run({"add", "-c", "z", "large.obj"}), Succeeds());
  const auto members = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"duplicates", "-c", "z"});
    return json(words)["clusters"].at(0)["names"].size();
  };
  EXPECT_EQ(members({}), 3);
  EXPECT_EQ(members({"--same-scale"}), 2);
}

TEST_F(Evaluate, ShapesAreEditedInPlace) {
  const Json shape = json({"edit", "-c", "z", "c1", "--rename", "rod", "--label", "ball", "--tag",
                           "made=today", "--tag", "by=hand"});
  EXPECT_EQ(shape["label"].string(), "ball");
  EXPECT_EQ(shape["tags"]["by"].string(), "hand");
  const Json later = json({"edit", "-c", "z", "rod", "--untag", "made"});
  EXPECT_FALSE(later["tags"].has("made"));
  EXPECT_EQ(later["tags"]["by"].string(), "hand");
  EXPECT_EQ(json({"evaluate", "-c", "z"})["queries"].number(), 6);
  expectRefusal({"edit", "-c", "z", "rod", "--rename", "t1"}, "already");
  expectRefusal({"edit", "-c", "z", "gone", "--label", "x"}, "gone");
  EXPECT_THAT(run({"edit", "-c", "z", "rod"}), IsUsageError());
}

TEST_F(Evaluate, AFilterRemovesManyAndSaysWhichBefore) {
  const std::vector<std::string> words = {"remove", "-c", "z", "--filter", "label = \"ring\""};
  std::vector<std::string> dry = words;
  dry.emplace_back("--dry-run");
  EXPECT_EQ(json(dry)["deleted_shapes"].number(), 3);
  EXPECT_EQ(json({"list", "-c", "z"})["shapes"].size(), 6);
  const Json removed = json(words);
  EXPECT_EQ(removed["deleted_shapes"].number(), 3);
  EXPECT_EQ(removed["names"].at(0).string(), "copy");
  EXPECT_EQ(json({"list", "-c", "z"})["shapes"].size(), 3);
  EXPECT_EQ(json({"search", "-c", "z", "t1.obj"})["hits"].size(), 3);
  EXPECT_THAT(run({"remove", "-c", "z"}), IsUsageError());
  EXPECT_THAT(run({"remove", "-c", "z", "s1", "--dry-run"}), IsUsageError());
  expectRefusal({"remove", "-c", "z", "--filter", " "}, "which shapes are meant");
}

TEST_F(Evaluate, ASearchTellsWhichPartsAgree) {
  const Json hits = json({"search", "-c", "z", "t1.obj", "--explain"})["hits"];
  ASSERT_EQ(hits.size(), 6);
  for (int n = 0; n < hits.size(); ++n) {
    const Json parts = hits.at(n)["parts"];
    ASSERT_EQ(parts.size(), 6);
    double sum = 0;
    for (int i = 0; i < 6; ++i) sum += std::pow(parts.at(i)["distance"].number(), 2);
    EXPECT_NEAR(std::sqrt(sum), hits.at(n)["distance"].number(), 1e-9);
  }
  EXPECT_EQ(hits.at(0)["parts"].at(0)["name"].string(), "spectrum");
  EXPECT_THAT(run({"search", "-c", "z", "t1.obj", "--explain"}).out, HasSubstr("solid"));
  EXPECT_EQ(json({"search", "-c", "z", "t1.obj"})["hits"].at(0)["parts"].size(), 0);
}

}  // namespace
}  // namespace moduli
