#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/picture/image.h"
#include "core/picture/render.h"
#include "core/picture/sheet.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

struct Surface {
  std::vector<Vec3> points;
  std::vector<CornerIndices> faces;
};

Surface ball(int n) {
  Surface surface;
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j < 2 * n; ++j) {
      const double theta = std::numbers::pi * i / n, phi = std::numbers::pi * j / n;
      surface.points.push_back(
          {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)});
    }
  }
  const auto id = [n](int i, int j) { return i * 2 * n + j % (2 * n); };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < 2 * n; ++j) {
      surface.faces.push_back({id(i, j), id(i + 1, j), id(i + 1, j + 1)});
      surface.faces.push_back({id(i, j), id(i + 1, j + 1), id(i, j + 1)});
    }
  }
  return surface;
}

int covered(const Image& image, Color background) {
  return static_cast<int>(std::count_if(image.pixels.begin(), image.pixels.end(),
                                        [&](const Color& c) { return c != background; }));
}

TEST(Render, ABallFillsADiskOfTheFittedSize) {
  const Surface surface = ball(48);
  RenderOptions options;
  options.width = options.height = 200;
  const Image image = renderSurface(surface.points, surface.faces, {}, options);
  // Radius 0.92 * 100 pixels; the polygonal outline and the rim's pixels move the count by less
  // than two pixels of the radius.
  const double radius = std::sqrt(covered(image, options.background) / std::numbers::pi);
  EXPECT_NEAR(radius, 92, 2);
  EXPECT_EQ(image.at(0, 0), options.background);
  EXPECT_NE(image.at(100, 100), options.background);
}

TEST(Render, TheNearerSurfaceHidesTheOther) {
  // Two triangles across the view axis; the red one is nearer to the eye at -y.
  const std::vector<Vec3> points = {{-1, 0, -1},  {1, 0, -1},  {0, 0, 1},
                                    {-1, -1, -1}, {1, -1, -1}, {0, -1, 1}};
  const std::vector<Color> colors = {{0, 0, 255}, {0, 0, 255}, {0, 0, 255},
                                     {255, 0, 0}, {255, 0, 0}, {255, 0, 0}};
  RenderOptions options;
  options.width = options.height = 64;
  options.view_from = {0, -1, 0};
  for (const std::vector<CornerIndices>& faces :
       {std::vector<CornerIndices>{{0, 1, 2}, {3, 4, 5}},
        std::vector<CornerIndices>{{3, 4, 5}, {0, 1, 2}}}) {
    const Color seen = renderSurface(points, faces, colors, options).at(32, 32);
    EXPECT_GT(seen.red, 60);
    EXPECT_EQ(seen.blue, 0);
  }
}

TEST(Render, UpIsUpAndRightIsRight) {
  // A small triangle to the right (+x) and above (+z) of a large invisible frame of two points.
  const std::vector<Vec3> points = {{0.8, 0, 0.8}, {1, 0, 0.8}, {1, 0, 1}, {-1, 0, -1}};
  RenderOptions options;
  options.width = options.height = 100;
  options.view_from = {0, -1, 0};
  const std::vector<CornerIndices> faces = {{0, 1, 2}, {3, 3, 3}};
  const Image image = renderSurface(points, faces, {}, options);
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 100; ++x) {
      if (image.at(x, y) == options.background) continue;
      EXPECT_GT(x, 50);
      EXPECT_LT(y, 50);
    }
  }
  EXPECT_GT(covered(image, options.background), 10);
}

TEST(Render, LeavesOutWhatCannotBeDrawn) {
  Surface surface = ball(8);
  surface.points.push_back({std::numeric_limits<double>::quiet_NaN(), 0, 0});
  surface.faces.push_back({0, 1, static_cast<int>(surface.points.size()) - 1});
  surface.faces.push_back({-1, 2, 99999});
  const Image image = renderSurface(surface.points, surface.faces, {});
  EXPECT_GT(covered(image, {255, 255, 255}), 1000);
  EXPECT_EQ(covered(renderSurface({}, {}, {}), {255, 255, 255}), 0);
}

TEST(Colors, RunFromDarkToLightAndFromBlueToRed) {
  int before = 0;
  for (int i = 0; i <= 20; ++i) {
    const Color c = sequentialColor(i / 20.0);
    const int light = 2126 * c.red + 7152 * c.green + 722 * c.blue;
    EXPECT_GT(light, before);
    before = light;
  }
  EXPECT_GT(divergingColor(-1).blue, divergingColor(-1).red);
  EXPECT_GT(divergingColor(1).red, divergingColor(1).blue);
  EXPECT_EQ(divergingColor(5), divergingColor(1));
  EXPECT_EQ(sequentialColor(std::numeric_limits<double>::quiet_NaN()), sequentialColor(0));
}

TEST(Sheet, HoldsEveryPictureAndTheFrameOfTheHighlightedOne) {
  const Image green(80, 60, {0, 128, 0});
  const auto sheet = composeSheet("Heading with Ümlaut",
                                  {{green, "query", "tau = i", true},
                                   {green, std::string(200, 'W'), "", false},
                                   {green, "third", "0.5", false}},
                                  2);
  ASSERT_OK(sheet);
  const auto greens = std::count(sheet->pixels.begin(), sheet->pixels.end(), Color{0, 128, 0});
  // One frame of 3 pixels takes 3 * (2 * 80 + 2 * 60 - 12) = 804 pixels away.
  EXPECT_EQ(greens, 3 * 80 * 60 - 804);
  EXPECT_THAT(composeSheet("", {}, 2), FailsWith(Reason::kInvalidOption));
  const auto png = encodePng(*sheet);
  ASSERT_OK(png);
  EXPECT_TRUE(png->starts_with("\x89PNG"));
  EXPECT_FALSE(encodePng(Image(70000, 1, {})).ok());
}

}  // namespace
}  // namespace moduli
