#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/picture/render.h"
#include "tests/core/testing.h"

/// Painted surfaces and lines, by what single pixels show.
namespace moduli {
namespace {

constexpr Color kWhite = {255, 255, 255};
constexpr Color kInk = {10, 20, 30};

// The unit square in the plane: 100 x 100 pixels show it at 92 pixels per unit from pixel 4 on.
const std::vector<Vec3> kSquare = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
const std::vector<CornerIndices> kHalves = {{0, 1, 2}, {0, 2, 3}};

Scene squareScene() {
  Scene scene;
  scene.points = kSquare;
  scene.faces = kHalves;
  return scene;
}

int count(const Image& image, Color color) {
  return static_cast<int>(std::count(image.pixels.begin(), image.pixels.end(), color));
}

TEST(RenderScene, PaintIsAskedWhereThePixelLies) {
  Scene scene = squareScene();
  scene.paint = [](int face, const Vec3& weights) {
    double x = 0, y = 0;
    for (int k = 0; k < 3; ++k) {
      x += weights[k] * kSquare[kHalves[face][k]][0];
      y += weights[k] * kSquare[kHalves[face][k]][1];
    }
    const auto channel = [](double t) { return static_cast<std::uint8_t>(std::lround(250 * t)); };
    return Color{channel(x), channel(y), static_cast<std::uint8_t>(face)};
  };
  const Image image = renderScene(scene, planeView(100, 100));
  for (int y = 5; y < 95; y += 3) {
    for (int x = 5; x < 95; x += 3) {
      const Color seen = image.at(x, y);
      // Samples lie evenly around the pixel's middle. They are rounded to 1/2 and their mean down
      // to whole numbers: off by 1/2 above and 3/2 below.
      EXPECT_NEAR(seen.red, 250 * (x + 0.5 - 4) / 92 - 0.5, 1.01);
      EXPECT_NEAR(seen.green, 250 * (96 - (y + 0.5)) / 92 - 0.5, 1.01);
      if (std::abs(x + y - 99) > 1) {
        EXPECT_EQ(seen.blue, x + y > 99 ? 0 : 1) << x << ' ' << y;
      }
    }
  }
  EXPECT_EQ(image.at(3, 50), kWhite);
  EXPECT_EQ(image.at(96, 50), kWhite);
}

TEST(RenderScene, NeighboursLeaveNoCrackBetweenThem) {
  // A fan of slivers around a point that is on no sample: each pixel inside is covered entirely.
  constexpr int kSpokes = 997;
  std::vector<Vec3> points = {{0.1, 0.2, 0}};
  std::vector<CornerIndices> faces;
  for (int i = 0; i < kSpokes; ++i) {
    const double angle = 2 * std::numbers::pi * i / kSpokes;
    points.push_back({std::cos(angle), std::sin(angle), 0});
    faces.push_back({0, 1 + i, 1 + (i + 1) % kSpokes});
  }
  // A grid whose edges run through samples.
  for (int i = 0; i <= 92; ++i) {
    for (int j = 0; j <= 92; ++j) points.push_back({i / 92.0 - 0.5, j / 92.0 - 0.5, 0});
  }
  std::vector<CornerIndices> grid;
  for (int i = 0; i < 92; ++i) {
    for (int j = 0; j < 92; ++j) {
      const int a = 1 + kSpokes + 93 * i + j;
      grid.push_back({a, a + 93, a + 94});
      grid.push_back({a, a + 94, a + 1});
    }
  }
  Scene scene;
  scene.points = points;
  for (const std::vector<CornerIndices>& mesh : {faces, grid}) {
    scene.faces = mesh;
    const RenderOptions look = planeView(100, 100);
    const Image image = renderScene(scene, look);
    for (int y = 20; y < 80; ++y) {
      for (int x = 20; x < 80; ++x) ASSERT_EQ(image.at(x, y), look.surface) << x << ' ' << y;
    }
  }
}

TEST(RenderScene, LinesHaveTheirWidthAndSmoothRims) {
  Scene scene = squareScene();
  const Segment across = {Vec3{0, 0.503, 0}, Vec3{1, 0.503, 0}};
  scene.lines.push_back({{across}, {0, 0, 0}, 3.3});
  RenderOptions look = planeView(100, 100);
  look.surface = {200, 200, 200};
  look.supersampling = 4;
  const Image image = renderScene(scene, look);
  double covered = 0;
  int between = 0;
  for (int y = 0; y < 100; ++y) {
    const int value = image.at(50, y).red;
    if (value > 200) continue;
    covered += 1 - value / 200.0;
    between += value > 0 && value < 200 ? 1 : 0;
  }
  // Of 13.2 samples across, 13 or 14 lie in the line: it is 3.25 or 3.5 pixels wide. Means are
  // rounded down to whole numbers.
  EXPECT_NEAR(covered, 3.375, 0.125 + 0.02);
  EXPECT_GE(between, 1);
}

TEST(RenderScene, ALineIsSeenOnItsSurfaceAndNotBehindIt) {
  Scene scene = squareScene();
  RenderOptions look = planeView(100, 100);
  const auto middle = [&](double height) {
    scene.lines = {{{{Vec3{0.2, 0.5, height}, Vec3{0.8, 0.5, height}}}, kInk, 5}};
    return renderScene(scene, look).at(50, 50);
  };
  EXPECT_EQ(middle(0), kInk);
  EXPECT_EQ(middle(0.1), kInk);
  EXPECT_EQ(middle(-0.1), look.surface);
}

TEST(RenderScene, ALineOnASlopeIsSeenOnBothOfItsSides) {
  std::vector<Vec3> slope = kSquare;
  for (Vec3& p : slope) p[2] = p[0] / 2;
  Scene scene = squareScene();
  scene.points = slope;
  scene.lines = {{{{Vec3{0.5, 0.1, 0.25}, Vec3{0.5, 0.9, 0.25}}}, kInk, 4}};
  const RenderOptions look = planeView(100, 100);
  const Image image = renderScene(scene, look);
  for (int x = 40; x < 60; ++x) {
    EXPECT_EQ(image.at(x, 50), x >= 48 && x < 52 ? kInk : look.surface) << x;
  }
}

TEST(RenderScene, TheFirstFaceAndTheLastLineAreSeenAtOneDepth) {
  Scene scene;
  const std::vector<CornerIndices> twice = {{0, 1, 2}, {0, 1, 2}};
  scene.points = kSquare;
  scene.faces = twice;
  scene.paint = [](int face, const Vec3&) { return face == 0 ? kInk : kWhite; };
  EXPECT_EQ(renderScene(scene, planeView(50, 50)).at(35, 30), kInk);
  const Segment line = {Vec3{0, 0.5, 0}, Vec3{1, 0.5, 0}};
  scene.lines = {{{line}, {1, 1, 1}, 6}, {{line}, {2, 2, 2}, 6}};
  EXPECT_EQ(renderScene(scene, planeView(50, 50)).at(25, 25), (Color{2, 2, 2}));
}

TEST(RenderScene, BandsOfALargePictureFitTogether) {
  Scene scene = squareScene();
  RenderOptions look = planeView(1500, 1000);
  look.supersampling = 4;  // 24 million samples: 6 bands.
  const Image image = renderScene(scene, look);
  // 920 pixels high, from 290 to 1210 and from 40 to 960, to a sample.
  EXPECT_EQ(count(image, look.surface), 920 * 920);
  EXPECT_EQ(count(image, kWhite), 1500 * 1000 - 920 * 920);
}

TEST(RenderScene, TheSameSceneGivesTheSamePixels) {
  Scene scene = squareScene();
  scene.lines.push_back({{{Vec3{0, 0, 0}, Vec3{1, 1, 0}}}, kInk, 1.5});
  RenderOptions look;
  look.width = 77;
  look.height = 31;
  EXPECT_EQ(renderScene(scene, look).pixels, renderScene(scene, look).pixels);
}

TEST(RenderScene, NothingThatCannotBeDrawnDoesHarm) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kHuge = std::numeric_limits<double>::max();
  const std::vector<std::vector<Vec3>> worlds = {
      {},
      {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}},
      {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}},
      {{kNan, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}},
      {{kHuge, 0, 0}, {-kHuge, 0, 0}, {0, kHuge, kHuge}, {0, 0, -kHuge}},
      {{1e300, 0, 0}, {-1e300, 0, 0}, {0, 1e300, 1e300}, {0, 0, -1e300}},
      {{0, 0, 0}, {1e-320, 0, 0}, {0, 1e-320, 0}, {1e-320, 1e-320, 0}}};
  for (const std::vector<Vec3>& points : worlds) {
    Scene scene;
    scene.points = points;
    scene.faces = kHalves;
    scene.paint = [](int, const Vec3&) { return kInk; };
    if (!points.empty())
      scene.lines = {{{{points[0], points[3]}, {points[1], points[1]}}, kInk, 2}};
    for (const bool shaded : {true, false}) {
      RenderOptions look = planeView(20, 10);
      look.shaded = shaded;
      EXPECT_EQ(renderScene(scene, look).pixels.size(), 200U);
    }
  }
  RenderOptions look = planeView(0, -3);
  look.supersampling = 0;
  EXPECT_EQ(renderScene(squareScene(), look).pixels.size(), 1U);
}

TEST(Projection, FitsTheSceneWithAMarginAndKeepsItsShape) {
  Scene scene = squareScene();
  const Projection projection(scene, planeView(200, 100));
  ASSERT_TRUE(projection.valid());
  EXPECT_DOUBLE_EQ(projection.scale(), 92);
  const Vec3 corner = projection({1, 1, 0});
  EXPECT_NEAR(corner[0], 146, 1e-12);
  EXPECT_NEAR(corner[1], 4, 1e-12);
  EXPECT_FALSE(Projection(Scene(), planeView(200, 100)).valid());
  // Lines count as well.
  scene.lines.push_back({{{Vec3{-1, 0, 0}, Vec3{3, 0, 0}}}, kInk, 1});
  EXPECT_DOUBLE_EQ(Projection(scene, planeView(200, 100)).scale(), 46);
}

}  // namespace
}  // namespace moduli
