#include "server/store/filter.h"

#include "tests/server/store/store_testing.h"

namespace moduli {
namespace {

bool matches(std::string_view text, const ShapeRecord& shape) {
  const Result<Filter> filter = Filter::parse(text);
  EXPECT_OK(filter) << text;
  return filter.ok() && filter->matches(shape);
}

ShapeRecord cup() {
  ShapeRecord shape = sampleShape("c", "cup-1");
  shape.label = "cup";
  shape.tags = {{"year", "2020"}, {"two words", "a \"b\" \\c"}, {"a.b-c_d", "x"}};
  shape.topology = {"TORUS", 1, 0, 1000, 2000, 1.5};
  return shape;
}

TEST(Filter, EmptyTextLetsEverythingThrough) {
  EXPECT_TRUE(matches("", cup()));
  EXPECT_TRUE(matches(" \t\n", cup()));
  EXPECT_TRUE(Filter().matchesAll());
}

TEST(Filter, EveryOperatorComparesNumbers) {
  for (const char* yes : {"genus = 1", "genus!=2", "genus < 2", "genus<=1", "genus > 0", "genus>=1",
                          "area = 1.5", "area = 15e-1", "vertices > 999.5", "faces <= 2e3",
                          "boundary_loops = -0", "area > -1", "genus = +1"}) {
    EXPECT_TRUE(matches(yes, cup())) << yes;
  }
  for (const char* no : {"genus = 2", "genus != 1", "genus < 1", "genus <= 0", "genus > 1",
                         "genus >= 2", "area < 1.5", "boundary_loops > 0"}) {
    EXPECT_FALSE(matches(no, cup())) << no;
  }
}

TEST(Filter, StringsCompareByteByByte) {
  EXPECT_TRUE(matches("label = \"cup\"", cup()));
  EXPECT_FALSE(matches("label = \"Cup\"", cup()));
  EXPECT_TRUE(matches("name > \"cup\" AND name < \"cup-2\"", cup()));
  EXPECT_TRUE(matches("name < \"\xC3\xA9\"", cup()));  // Beyond ASCII sorts behind.
  EXPECT_TRUE(matches("type = \"TORUS\" AND type != \"SPHERE\"", cup()));
}

TEST(Filter, TagsCompareAsTextOrAsNumbers) {
  EXPECT_TRUE(matches("tags.year = \"2020\"", cup()));
  EXPECT_TRUE(matches("tags.year >= 2019.5 AND tags.year < 2021", cup()));
  EXPECT_TRUE(matches("tags.a.b-c_d = \"x\"", cup()));
  EXPECT_TRUE(matches("tags.\"two words\" = \"a \\\"b\\\" \\\\c\"", cup()));
  EXPECT_TRUE(matches("tags.missing = \"\"", cup()));
  EXPECT_TRUE(matches("tags.missing != \"2020\"", cup()));
  // What spells no number is neither below nor above one.
  EXPECT_FALSE(matches("tags.a.b-c_d < 5", cup()));
  EXPECT_FALSE(matches("tags.a.b-c_d >= 5", cup()));
  EXPECT_TRUE(matches("tags.a.b-c_d != 5", cup()));
}

TEST(Filter, AllComparisonsMustHold) {
  EXPECT_TRUE(matches("label = \"cup\" AND genus >= 1 AND tags.year != \"2021\"", cup()));
  EXPECT_FALSE(matches("label = \"cup\" AND genus >= 2 AND tags.year != \"2021\"", cup()));
  EXPECT_FALSE(matches("label = \"mug\" AND genus >= 1", cup()));
}

TEST(Filter, OnlyTagsNeedTags) {
  EXPECT_TRUE(Filter::parse("genus = 1 AND tags.x = \"y\"")->usesTags());
  EXPECT_FALSE(Filter::parse("genus = 1")->usesTags());
}

TEST(Filter, ErrorsNameTheColumn) {
  const std::pair<const char*, int> cases[] = {
      {"colour = 1", 1},               // No such field.
      {"  colour = 1", 3},             //
      {"genus ~ 1", 7},                // No operator.
      {"genus", 6},                    //
      {"genus = ", 9},                 // No value.
      {"genus = one", 9},              //
      {"genus = nan", 9},              //
      {"genus = inf", 9},              //
      {"genus = 1e999", 9},            //
      {"genus = \"1\"", 9},            // Wrong kind of value.
      {"label = 5", 9},                //
      {"label = cup", 9},              //
      {"label = \"cup", 9},            // Open string.
      {"label = \"a\\n\"", 11},        // Unknown escape.
      {"genus = 1 OR genus = 2", 11},  // Neither AND nor the end.
      {"genus = 1 and genus = 2", 11},
      {"genus = 1 AND", 14},  // Nothing behind AND.
      {"genus = 1 AND colour = 2", 15},
      {"label = \"\xC3\xA9\xC3\xA9\" & genus = 1", 14},  // Columns count characters, not bytes.
      {"type < \"TORUS\"", 6},
      {"type = \"torus\"", 8},
      {"tags. = \"x\"", 6},
      {"tags = \"x\"", 1},
      {"(genus = 1)", 1},
  };
  for (const auto& [text, column] : cases) {
    const Status status = Filter::parse(text).status();
    EXPECT_THAT(status, FailsWith(Reason::kInvalidFilter)) << text;
    const std::string prefix = "column " + std::to_string(column) + ":";
    EXPECT_TRUE(status.message().starts_with(prefix)) << text << " -> " << status.message();
  }
}

TEST(Filter, RefusesEndlessText) {
  EXPECT_THAT(Filter::parse(std::string(5000, ' ')), FailsWith(Reason::kInvalidFilter));
  std::string many = "genus = 1";
  for (int i = 0; i < 64; ++i) many += " AND genus = 1";
  EXPECT_THAT(Filter::parse(many), FailsWith(Reason::kInvalidFilter));
}

TEST(Filter, SurvivesEveryCutAndEveryChangedByte) {
  const std::string good = "label = \"c\\\"up\" AND genus >= 1 AND tags.\"k\" != 2e3";
  ASSERT_OK(Filter::parse(good));
  for (std::size_t at = 0; at < good.size(); ++at) {
    for (const char byte : {'\0', '"', '\\', ' ', '.', '=', '\xFF', 'A', '1'}) {
      std::string bent = good;
      bent[at] = byte;
      const Result<Filter> filter = Filter::parse(bent);
      if (filter.ok()) filter->matches(cup());
    }
    const Result<Filter> cut = Filter::parse(good.substr(0, at));
    if (cut.ok()) cut->matches(cup());
  }
}

}  // namespace
}  // namespace moduli
