#include "core/picture/svg.h"

#include <limits>

#include "tests/core/testing.h"

namespace moduli {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(Base64, IsThatOfTheStandardsExamples) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foob"), "Zm9vYg==");
  EXPECT_EQ(base64("fooba"), "Zm9vYmE=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64(std::string("\xFF\xFE\x00", 3)), "//4A");
}

TEST(SvgPath, RoundsToHundredthsWithoutSpareDigits) {
  SvgPath path;
  path.moveTo(1.234567, -0.001).lineTo(10, 2.5).lineTo(100.999, -3.1).close();
  EXPECT_EQ(path.data(), "M1.23 0L10 2.5L101 -3.1Z");
}

TEST(SvgPath, HoldsNumbersThatNoPictureHas) {
  SvgPath path;
  path.moveTo(std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity());
  EXPECT_EQ(path.data(), "M0 0");
  path.lineTo(-std::numeric_limits<double>::max(), 0);
  EXPECT_GT(path.data().size(), 309U);
}

TEST(Svg, WritesWhatItWasTold) {
  Svg svg(20, 10);
  SvgPath path;
  path.moveTo(0, 0).lineTo(1, 0);
  svg.path(path, {.stroke = Color{255, 0, 171}, .stroke_width = 0.5});
  svg.path(SvgPath(), {.fill = Color{1, 2, 3}});
  svg.circle(1, 2, 3, {.fill = Color{1, 2, 3}});
  const std::string file = std::move(svg).finish();
  EXPECT_THAT(file, HasSubstr("viewBox=\"0 0 20 10\""));
  EXPECT_THAT(file, HasSubstr("stroke=\"#ff00ab\""));
  EXPECT_THAT(file, HasSubstr("d=\"M0 0L1 0\""));
  EXPECT_THAT(file, HasSubstr("<circle cx=\"1\" cy=\"2\" r=\"3\" fill=\"#010203\"/>"));
  EXPECT_THAT(file, Not(HasSubstr("d=\"\"")));  // An empty path is left out.
  EXPECT_TRUE(file.ends_with("</svg>\n"));
}

TEST(Svg, EscapesTextAndCutsWholeLetters) {
  Svg svg(20, 10);
  svg.text("a<b>&\"c\"", 0, 0, 10, {}, false, 1000);
  svg.text("ÄÖÜäöü", 0, 0, 10, {}, true, 3 * 5.8 + 0.1);
  const std::string file = std::move(svg).finish();
  EXPECT_THAT(file, HasSubstr(">a&lt;b&gt;&amp;\"c\"</text>"));
  EXPECT_THAT(file, HasSubstr(">ÄÖÜ…</text>"));
}

}  // namespace
}  // namespace moduli
