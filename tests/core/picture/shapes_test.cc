#include "core/picture/shapes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "tests/core/testing.h"

namespace moduli {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr Color kWhite{255, 255, 255}, kRed{200, 10, 20}, kBlue{0, 40, 220};
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Outline rectangle(double left, double top, double right, double bottom) {
  return {{left, top}, {right, top}, {right, bottom}, {left, bottom}};
}

Shape filled(std::vector<Outline> outlines, Color color) {
  Shape shape;
  shape.outlines = std::move(outlines);
  shape.style.fill = color;
  return shape;
}

Shape stroked(std::vector<Outline> outlines, double width, bool closed) {
  Shape shape;
  shape.outlines = std::move(outlines);
  shape.style.stroke = kBlue;
  shape.style.stroke_width = width;
  shape.closed = closed;
  return shape;
}

Image drawn(const std::vector<Shape>& shapes, int width = 40, int height = 30) {
  const auto image = drawShapes(shapes, width, height);
  EXPECT_OK(image);
  EXPECT_EQ(image->width, width);
  EXPECT_EQ(image->height, height);
  return *image;
}

int count(const Image& image, const Color& color) {
  int found = 0;
  for (const Color& pixel : image.pixels) found += pixel == color ? 1 : 0;
  return found;
}

/// The darkness of a picture in pixels that are quite black.
double inkOf(const Image& image) {
  double ink = 0;
  for (const Color& pixel : image.pixels) ink += 1 - pixel.green / 255.0;
  return ink;
}

TEST(DrawShapes, LeavesAnEmptyPictureWhite) {
  EXPECT_EQ(count(drawn({}), kWhite), 40 * 30);
  EXPECT_EQ(count(drawn({filled({}, kRed), filled({{}}, kRed), stroked({{}}, 3, true)}), kWhite),
            40 * 30);
}

TEST(DrawShapes, FillsThePixelsOfARectangle) {
  const Image image = drawn({filled({rectangle(5, 3, 15, 9)}, kRed)});
  EXPECT_EQ(count(image, kRed), 10 * 6);
  EXPECT_EQ(count(image, kWhite), 40 * 30 - 10 * 6);
  // x to the right, y down.
  EXPECT_EQ(image.at(5, 3), kRed);
  EXPECT_EQ(image.at(14, 8), kRed);
  EXPECT_EQ(image.at(15, 8), kWhite);
  EXPECT_EQ(image.at(14, 9), kWhite);
  EXPECT_EQ(image.at(4, 3), kWhite);
}

TEST(DrawShapes, CoversPixelsByTheirShare) {
  const Image image = drawn({filled({rectangle(5.25, 3, 15, 9)}, Color{0, 0, 0})});
  EXPECT_NEAR(image.at(5, 5).green, 0.25 * 255, 2);
  EXPECT_EQ(image.at(6, 5), (Color{0, 0, 0}));
}

TEST(DrawShapes, PaintsLaterShapesOverEarlierOnes) {
  const Image image =
      drawn({filled({rectangle(0, 0, 20, 20)}, kRed), filled({rectangle(10, 10, 30, 30)}, kBlue)});
  EXPECT_EQ(image.at(5, 5), kRed);
  EXPECT_EQ(image.at(15, 15), kBlue);
  EXPECT_EQ(image.at(25, 25), kBlue);
}

TEST(DrawShapes, FillsByTheNonzeroRule) {
  // Both the same way around: no hole. One reversed: a hole.
  Outline inner = rectangle(10, 10, 20, 20);
  EXPECT_EQ(drawn({filled({rectangle(5, 5, 25, 25), inner}, kRed)}).at(15, 15), kRed);
  std::reverse(inner.begin(), inner.end());
  EXPECT_EQ(drawn({filled({rectangle(5, 5, 25, 25), inner}, kRed)}).at(15, 15), kWhite);
}

TEST(DrawShapes, StrokesClosedAndOpenOutlines) {
  const Outline corner{{5, 5}, {25, 5}, {25, 25}};
  const Image closed = drawn({stroked({corner}, 2, true)});
  const Image open = drawn({stroked({corner}, 2, false)});
  for (const Image& image : {closed, open}) {
    EXPECT_EQ(image.at(15, 4), kBlue);
    EXPECT_EQ(image.at(15, 5), kBlue);
    EXPECT_EQ(image.at(15, 7), kWhite);
    EXPECT_EQ(image.at(24, 15), kBlue);
    EXPECT_EQ(image.at(20, 10), kWhite);  // Not filled.
  }
  EXPECT_EQ(closed.at(15, 15), kBlue);
  EXPECT_EQ(open.at(15, 15), kWhite);
}

TEST(DrawShapes, RoundsEndsAndJoins) {
  // A line of width 8 has half a disk at either end.
  const Image line = drawn({stroked({{{10, 15}, {30, 15}}}, 8, false)});
  EXPECT_EQ(line.at(7, 14), kBlue);
  EXPECT_EQ(line.at(5, 14), kWhite);
  EXPECT_EQ(line.at(6, 18), kWhite);
  // A square corner reaches (6, 6), a round one does not.
  EXPECT_EQ(drawn({stroked({rectangle(10, 10, 30, 25)}, 8, true)}).at(6, 6), kWhite);
}

TEST(DrawShapes, MixesInOpacity) {
  Shape shape = filled({rectangle(5, 5, 25, 25)}, Color{0, 0, 0});
  shape.style.opacity = 0.5;
  EXPECT_NEAR(drawn({shape}).at(15, 15).green, 127.5, 1);
}

TEST(DrawShapes, EndsAnOutlineAtAPointThatIsNotFinite) {
  for (const double bad : {kNan, kInfinity, -kInfinity}) {
    for (const std::array<double, 2>& point : {std::array{bad, 5.0}, std::array{5.0, bad}}) {
      // What is before it stands, what is behind it does not, and other outlines do.
      const Shape cut =
          stroked({{{5, 5}, {25, 5}, point, {35, 28}}, {{5, 20}, {25, 20}}}, 2, false);
      const Image image = drawn({cut});
      EXPECT_EQ(image.at(15, 5), kBlue);
      EXPECT_EQ(image.at(15, 20), kBlue);
      EXPECT_EQ(image.pixels,
                drawn({stroked({{{5, 5}, {25, 5}}, {{5, 20}, {25, 20}}}, 2, false)}).pixels);
      EXPECT_EQ(count(drawn({filled({{point, {5, 5}, {25, 5}, {25, 25}}}, kRed)}), kWhite),
                40 * 30);
    }
  }
}

TEST(DrawShapes, ClosesAnOutlineThatEndsAtSuchAPointToo) {
  const Image image = drawn({filled({{{5, 5}, {25, 5}, {25, 25}, {kNan, 0}, {0, 29}}}, kRed)});
  EXPECT_EQ(image.pixels, drawn({filled({{{5, 5}, {25, 5}, {25, 25}}}, kRed)}).pixels);
}

TEST(DrawShapes, RefusesSizesThatNoPictureHas) {
  EXPECT_THAT(drawShapes({}, 40'000, 10), FailsWith(Reason::kInternal));
  EXPECT_THAT(drawShapes({}, -1, 10), FailsWith(Reason::kInternal));
}

TEST(CircleOutline, IsACircle) {
  const Outline outline = circleOutline(20, 15, 10);
  for (const auto& [x, y] : outline) EXPECT_NEAR(std::hypot(x - 20, y - 15), 10, 1e-13);
  EXPECT_EQ(drawn({filled({outline}, kRed)}).at(20, 15), kRed);
  // A polygon of 360 corners has an area smaller by 2 pi^2 / 3 / 360^2 = 5e-5; pixels have 255
  // levels, and about 80 are cut.
  EXPECT_NEAR(inkOf(drawn({filled({outline}, Color{0, 0, 0})})), M_PI * 100, 0.5);
}

std::string svgOf(const std::vector<Shape>& shapes, double x, double y) {
  Svg svg(40, 30);
  addShapes(svg, shapes, x, y);
  return std::move(svg).finish();
}

TEST(AddShapes, WritesTheSameShapesMoved) {
  Shape shape = filled({rectangle(5, 3, 15, 9), {{1, 2}, {3, 4}}}, kRed);
  EXPECT_THAT(svgOf({shape}, 0, 0), HasSubstr("d=\"M5 3L15 3L15 9L5 9ZM1 2L3 4Z\""));
  EXPECT_THAT(svgOf({shape}, 100, 0.5),
              HasSubstr("d=\"M105 3.5L115 3.5L115 9.5L105 9.5ZM101 2.5L103 4.5Z\""));
  EXPECT_THAT(svgOf({shape}, 0, 0), HasSubstr("fill=\"#c80a14\""));
  shape.closed = false;
  EXPECT_THAT(svgOf({shape}, 0, 0), HasSubstr("d=\"M5 3L15 3L15 9L5 9M1 2L3 4\""));
  const std::string line = svgOf({stroked({{{1, 2}, {3, 4}}}, 2.5, false)}, 0, 0);
  EXPECT_THAT(line, HasSubstr("stroke=\"#0028dc\""));
  EXPECT_THAT(line, HasSubstr("stroke-width=\"2.5\""));
  EXPECT_THAT(line, HasSubstr("fill=\"none\""));
}

TEST(AddShapes, KeepsTheOrder) {
  const std::string file =
      svgOf({filled({rectangle(0, 0, 1, 1)}, kRed), filled({rectangle(0, 0, 1, 1)}, kBlue)}, 0, 0);
  EXPECT_LT(file.find("#c80a14"), file.find("#0028dc"));
}

TEST(AddShapes, EndsAnOutlineAtAPointThatIsNotFinite) {
  EXPECT_THAT(
      svgOf({stroked({{{5, 5}, {25, 5}, {kNan, 1}, {9, 9}}, {{1, 2}, {3, 4}}}, 2, true)}, 0, 0),
      HasSubstr("d=\"M5 5L25 5ZM1 2L3 4Z\""));
  EXPECT_EQ(svgOf({filled({{{kInfinity, 0}, {1, 1}}}, kRed), filled({}, kRed)}, 0, 0),
            svgOf({}, 0, 0));
}

}  // namespace
}  // namespace moduli
