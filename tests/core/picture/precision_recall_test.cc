#include "core/picture/precision_recall.h"

#include "tests/core/testing.h"

namespace moduli {
namespace {

using testing::HasSubstr;
using testing::Not;

using Curves = std::vector<PrecisionRecallCurve>;

TEST(DrawPrecisionRecall, PointsStandWhereTheAxesSay) {
  // The plot spans x from 56 to 640 - 168 and y from 64 to 440 - 52.
  const auto svg = drawPrecisionRecall(Curves{{"shape", {1, 0.5, 0}}});
  ASSERT_OK(svg);
  EXPECT_THAT(*svg, HasSubstr("d=\"M56 64L264 226L472 388\""));
  EXPECT_THAT(*svg, HasSubstr("<circle cx=\"264\" cy=\"226\""));
}

TEST(DrawPrecisionRecall, SaysWhatIsDrawn) {
  const auto svg = drawPrecisionRecall(Curves{{"shape", {1, 0}}, {"D2 & <others>", {0.5, 0.25}}},
                                       {.title = "Quality"});
  ASSERT_OK(svg);
  for (const char* text : {">Recall<", ">Precision<", ">Quality<", ">0.2<", ">1<", ">shape<",
                           ">D2 &amp; &lt;others&gt;<"}) {
    EXPECT_THAT(*svg, HasSubstr(text));
  }
  EXPECT_LT(svg->find(">shape<"), svg->find(">D2 "));
}

TEST(DrawPrecisionRecall, ManyCurvesKeepColourAndMarkApart) {
  // 7 colours and 4 marks repeat together after 28 curves only.
  Curves curves;
  for (int i = 0; i < 8; ++i) curves.push_back({"c" + std::to_string(i), {1, 0}});
  const auto svg = drawPrecisionRecall(curves);
  ASSERT_OK(svg);
  // Curves 0 and 7 share their colour: a disk the one, a triangle the other.
  EXPECT_THAT(*svg, HasSubstr("r=\"3.6\" fill=\"#0072b2\""));
  EXPECT_THAT(*svg, HasSubstr("fill=\"#0072b2\" d=\"M56 59.32"));
}

TEST(DrawPrecisionRecall, CurvesOfManyPointsHaveAFewMarks) {
  const auto svg = drawPrecisionRecall(Curves{{"fine", std::vector<double>(1001, 0.5)}});
  ASSERT_OK(svg);
  std::size_t marks = 0;
  for (std::size_t at = svg->find("<circle"); at != std::string::npos;
       at = svg->find("<circle", at + 1)) {
    ++marks;
  }
  EXPECT_EQ(marks, 12U);  // 11 on the curve, one in the legend.
}

TEST(DrawPrecisionRecall, RefusesWhatCannotBeDrawn) {
  const auto drawn = [](PrecisionRecallCurve curve) { return drawPrecisionRecall(Curves{curve}); };
  EXPECT_THAT(drawPrecisionRecall({}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(drawn({"short", {1}}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(drawn({"high", {1.01, 0}}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(drawn({"nan", {std::nan(""), 0}}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(drawn({"a\nb", {1, 0}}), FailsWith(Reason::kInvalidOption));
  const Curves one = {{"a", {1, 0}}};
  EXPECT_THAT(drawPrecisionRecall(one, {.title = "\x01"}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(drawPrecisionRecall(one, {.width = 319}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(drawPrecisionRecall(one, {.height = 239}), FailsWith(Reason::kInvalidOption));
  const Curves many(18, one.front());
  EXPECT_THAT(drawPrecisionRecall(many, {.height = 449}), FailsWith(Reason::kInvalidOption));
  EXPECT_OK(drawPrecisionRecall(many, {.height = 450}));
}

}  // namespace
}  // namespace moduli
