#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "client/cli/map_panels.h"
#include "client/cli/map_picture.h"
#include "tests/client/shown_panel.h"
#include "tests/client/small_maps.h"
#include "tests/client/xml_check.h"
#include "tests/core/testing.h"

/// Pictures of maps: what is drawn where, and that nothing breaks them. No server is needed.
namespace moduli::cli {
namespace {

using namespace vec3;
using testing::HasSubstr;
using Kind = MapEdge::Kind;
using Options = v1::ParameterizationOptions;

// Width and height as a PNG file tells them.
std::pair<int, int> sizeOfPng(const std::string& png) {
  const auto number = [&](std::size_t at) {
    int value = 0;
    for (std::size_t i = at; i < at + 4; ++i)
      value = 256 * value + static_cast<unsigned char>(png[i]);
    return value;
  };
  if (png.size() < 24 || !png.starts_with("\x89PNG\r\n\x1a\n")) return {0, 0};
  return {number(16), number(20)};
}

int countKind(const MapDrawing& drawing, Kind kind) {
  return static_cast<int>(std::count_if(drawing.edges.begin(), drawing.edges.end(),
                                        [=](const MapEdge& edge) { return edge.kind == kind; }));
}

TEST(MapDrawing, TellsCutsFromBoundaries) {
  const MapDrawing whole = makeDrawing(gridMap(1, false), {});
  EXPECT_EQ(countKind(whole, Kind::kInner), 1);
  EXPECT_EQ(countKind(whole, Kind::kBoundary), 4);
  EXPECT_EQ(countKind(whole, Kind::kSeam), 0);
  const MapDrawing torn = makeDrawing(gridMap(1, true), {});
  EXPECT_EQ(countKind(torn, Kind::kInner), 0);
  EXPECT_EQ(countKind(torn, Kind::kBoundary), 4);
  EXPECT_EQ(countKind(torn, Kind::kSeam), 2);
  EXPECT_DOUBLE_EQ(torn.image_area, 1);
  const MapDrawing ball = makeDrawing(ballMap(6), {});
  EXPECT_EQ(countKind(ball, Kind::kInner), static_cast<int>(ball.edges.size()));
  EXPECT_EQ(ball.edges.size(), 3 * ball.faces.size() / 2);
}

TEST(MapDrawing, FoldedFacesComeFirst) {
  ParameterizedMesh map = gridMap(4, false);
  std::swap(map.corners[60], map.corners[61]);
  const MapDrawing drawing = makeDrawing(map, {});
  EXPECT_EQ(std::count(drawing.folded.begin(), drawing.folded.end(), true), 1);
  EXPECT_EQ(drawing.mapped.front(), 20);
  EXPECT_EQ(drawing.mapped.size(), 32U);
}

TEST(MapDrawing, AddedVerticesGoBetweenTheirNeighbours) {
  // The last vertex of a fan around it; then two that only see each other and one that is known.
  const std::vector<double> square = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 6};
  const auto placed = extendToVertices(square, 3, 5, {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}});
  EXPECT_DOUBLE_EQ(placed[12], 0.5);
  EXPECT_DOUBLE_EQ(placed[13], 0.5);
  EXPECT_DOUBLE_EQ(placed[14], 1.5);
  const auto far = extendToVertices(std::vector<double>{7}, 1, 4, {{0, 1, 2}});
  EXPECT_DOUBLE_EQ(far[2], 7);
  EXPECT_TRUE(std::isnan(far[3]));
}

// Shoelace for the plane; on the sphere the outline's own area vector.
double areaOf(const std::vector<Vec3>& outline) {
  Vec3 sum{};
  for (std::size_t i = 0; i < outline.size(); ++i) {
    sum = sum + cross(outline[i], outline[(i + 1) % outline.size()]);
  }
  Vec3 middle{};
  for (const Vec3& p : outline) middle = middle + p;
  return dot(sum, middle[2] == 0 ? Vec3{0, 0, 1} : normalized(middle)) / 2;
}

class PatternOf : public testing::TestWithParam<Options::Target> {};

TEST_P(PatternOf, CellsAreWhatPointsShow) {
  const ParameterizedMesh map = GetParam() == Options::SPHERE ? ballMap(12) : diskMap(12);
  const Pattern pattern(makeDrawing(map, map.positions), GetParam());
  const auto cells = pattern.darkCells();
  EXPECT_GT(cells.size(), 90U);
  for (const Pattern::Cell& cell : cells) {
    Vec3 middle{};
    for (const Vec3& p : cell.outline) middle = middle + (1.0 / double(cell.outline.size())) * p;
    EXPECT_EQ(pattern.at(middle), cell.color);
    // Across each side lies a light cell, as far as the pattern goes.
    const std::size_t side = cell.outline.size() / 4;
    for (std::size_t k = 0; k < 4; ++k) {
      const Vec3 edge = 0.5 * (cell.outline[k * side] + cell.outline[(k + 1) % 4 * side]);
      const Vec3 outside = edge + 0.25 * (edge - middle);
      if (GetParam() == Options::DISK && std::hypot(outside[0], outside[1]) > 1) continue;
      EXPECT_EQ(pattern.at(outside), kPatternLight);
    }
    EXPECT_GT(areaOf(cell.outline), 0);
  }
}

INSTANTIATE_TEST_SUITE_P(Targets, PatternOf,
                         testing::Values(Options::FLAT, Options::DISK, Options::SPHERE));

TEST(Pattern, CurvedCellsAreSquaresOfAConformalMap) {
  for (const ParameterizedMesh& map : {ballMap(12), diskMap(12)}) {
    for (const Pattern::Cell& cell :
         Pattern(makeDrawing(map, map.positions), map.result.target()).darkCells()) {
      // Cells of side s = pi / 12: the chords that join the middles of opposite sides have the
      // ratio sinh(s/2) / sin(s/2) = 1 + s^2 / 12 between circles, on the sphere 1 - s^2 / 24 (at
      // the equator) to 1 + s^2 / 12 (at the poles), up to s^4.
      const std::size_t side = cell.outline.size() / 4, half = side / 2;
      const auto distance = [&](std::size_t i, std::size_t j) {
        const Vec3 d = cell.outline[i] - cell.outline[j];
        return std::sqrt(vec3::dot(d, d));
      };
      const double ratio = distance(half, half + 2 * side) / distance(half + side, half + 3 * side);
      EXPECT_NEAR(ratio, 1, 1.1 * std::pow(std::numbers::pi / 12, 2) / 12);
    }
  }
}

TEST(Pattern, IsFinerWhereTheMapMakesTheSurfaceSmall) {
  // Three quarters of the surface's area are in a face of the image's hundredth.
  ParameterizedMesh map = gridMap(10, false);
  const Pattern even(makeDrawing(map, map.positions), Options::FLAT);
  std::vector<double> space = map.positions;
  for (std::size_t v = 0; v < space.size() / 3; ++v) space[3 * v + 2] = 0;
  space[3 * 60 + 2] = 50;
  const Pattern uneven(makeDrawing(map, space), Options::FLAT);
  EXPECT_GT(uneven.darkCells().size(), even.darkCells().size() + 4);
}

TEST(FieldColors, DivergeAroundZeroAndRunElsewhere) {
  const CornerIndices face = {0, 1, 2};
  const FieldColors both({-3, 0, 1});
  EXPECT_EQ(both.low(), -3);
  EXPECT_EQ(both.high(), 3);
  EXPECT_EQ(both.at(face, {1, 0, 0}), divergingColor(-1));
  EXPECT_EQ(both.at(face, {0, 1, 0}), divergingColor(0));
  const FieldColors one({2, 4, 6});
  EXPECT_EQ(one.at(face, {0, 1, 0}), sequentialColor(0.5));
  EXPECT_EQ(FieldColors({1, 1, std::nan("")}).at(face, {0, 0, 1}), kUnmappedColor);
  EXPECT_EQ(FieldColors({}).at(face, {0, 0, 1}), kUnmappedColor);
  EXPECT_EQ(FieldColors({5, 5, 5}).at(face, {1, 0, 0}), sequentialColor(0.5));
}

TEST(MapPanels, FoldedFacesAreRedInTheImage) {
  ParameterizedMesh map = gridMap(4, false);
  std::swap(map.corners[60], map.corners[61]);
  const MapPicture picture = pictureOf(map);
  const MapPanels panels(picture);
  const auto middle = [&](std::size_t f) {
    Vec3 sum{};
    for (std::size_t k = 3 * f; k < 3 * f + 3; ++k) {
      sum =
          sum + Vec3{map.points[2 * map.corners[k]] / 3, map.points[2 * map.corners[k] + 1] / 3, 0};
    }
    return sum;
  };
  const Shown image(panels, PanelKind::kPlane);
  EXPECT_EQ(image.at(middle(20)), kFoldedColor);
  EXPECT_NE(image.at(middle(22)), kFoldedColor);
}

TEST(MapPanels, SurfaceAndImageShowTheSamePatternAtTheSamePoint) {
  // The surface is the image, tilted: light makes all of it darker by one factor.
  const ParameterizedMesh map = gridMap(8, false);
  const MapPicture picture = pictureOf(map);
  const MapPanels panels(picture);
  const Shown image(panels, PanelKind::kPlane), surface(panels, PanelKind::kSurface);
  const Color light = surface.at({0.03, 0.03, 0.015});
  int dark_places = 0;
  for (const double x : {0.1, 0.3, 0.55, 0.8}) {
    for (const double y : {0.16, 0.28, 0.46, 0.84}) {
      const Color color = panels.pattern().at({x, y, 0});
      EXPECT_EQ(image.at({x, y, 0}), color) << x << ' ' << y;
      const bool dark = color != kPatternLight;
      dark_places += dark ? 1 : 0;
      EXPECT_EQ(surface.at({x, y, x / 2}) != light, dark) << x << ' ' << y;
    }
  }
  EXPECT_GT(dark_places, 4);
  EXPECT_LT(dark_places, 12);
}

TEST(MapPanels, TheSphereIsSeenFromBothSides) {
  const ParameterizedMesh map = ballMap(24);
  const MapPicture picture = pictureOf(map);
  const MapPanels panels(picture);
  ASSERT_EQ(panels.panels().size(), 3U);
  const RenderOptions front = panels.look(PanelKind::kFront, 100, 100);
  const RenderOptions back = panels.look(PanelKind::kBack, 100, 100);
  const Projection seen(panels.scene(PanelKind::kFront, front, 1), front);
  const Projection behind(panels.scene(PanelKind::kBack, back, 1), back);
  // From the positive x axis y points to the right, from the other side to the left; z up.
  EXPECT_GT(seen({0, 1, 0})[0], 90);
  EXPECT_LT(behind({0, 1, 0})[0], 10);
  EXPECT_LT(seen({0, 0, 1})[1], 10);
  EXPECT_GT(seen({1, 0, 0})[2], seen({-1, 0, 0})[2]);
}

constexpr PictureDraw kDraws[] = {PictureDraw::kChecker, PictureDraw::kDilatation,
                                  PictureDraw::kScale, PictureDraw::kLayout};

bool hasNoLayout(const MapPicture& picture) {
  return picture.draw == PictureDraw::kLayout && picture.map->result.target() == Options::SPHERE;
}

TEST(MapPicture, HasTheSizeThatWasAskedFor) {
  const ParameterizedMesh plane = gridMap(3, true), ball = ballMap(5);
  for (int n = 0; n < 8; ++n) {
    const ParameterizedMesh* map = n % 2 == 0 ? &plane : &ball;
    for (const PictureSize size : {PictureSize{16, 16},
                                   {17, 333},
                                   {333, 17},
                                   {1024, 101},
                                   {641, 479},
                                   {16384, 16},
                                   {16, 16384},
                                   {250, 900}}) {
      MapPicture picture = pictureOf(*map);
      picture.size = size;
      picture.draw = kDraws[n / 2];
      const bool large = size.width > 2000 || size.height > 2000;
      if (hasNoLayout(picture) || (n > 1 && large)) continue;
      const auto png = drawMap(picture);
      ASSERT_OK(png);
      EXPECT_EQ(sizeOfPng(*png), std::pair(size.width, size.height));
      picture.format = PictureFormat::kSvg;
      const auto svg = drawMap(picture);
      ASSERT_OK(svg);
      EXPECT_THAT(*svg, HasSubstr(" width=\"" + std::to_string(size.width) + "\" height=\"" +
                                  std::to_string(size.height) + "\""));
      EXPECT_EQ(xmlFault(*svg), "");
    }
  }
}

TEST(MapPicture, TheSameMapGivesTheSameBytes) {
  const ParameterizedMesh ball = ballMap(8), disk = diskMap(8);
  for (const ParameterizedMesh* map : {&ball, &disk}) {
    MapPicture picture = pictureOf(*map);
    for (int n = 0; n < 8; ++n) {
      picture.format = n % 2 == 0 ? PictureFormat::kPng : PictureFormat::kSvg;
      picture.draw = kDraws[n / 2];
      if (hasNoLayout(picture)) continue;
      const auto first = drawMap(picture), second = drawMap(picture);
      ASSERT_OK(first);
      EXPECT_EQ(*first, *second);
    }
  }
}

TEST(MapPicture, SvgDrawsTheImageInOutlinesAndNamesTheMap) {
  ParameterizedMesh map = diskMap(6);
  map.result.mutable_certificate()->set_mean_dilatation(1.25);
  map.result.mutable_certificate()->set_flipped_faces(2);
  MapPicture picture = pictureOf(map);
  picture.size = {900, 420};
  picture.format = PictureFormat::kSvg;
  const auto svg = drawMap(picture);
  ASSERT_OK(svg);
  EXPECT_EQ(xmlFault(*svg), "");
  EXPECT_THAT(*svg, HasSubstr("a&lt;mesh&gt;&amp;?.obj, mapped to the disk"));
  EXPECT_THAT(*svg, HasSubstr("mean K 1.25, 2 flipped faces"));
  EXPECT_THAT(*svg, HasSubstr("data:image/png;base64,"));
  EXPECT_THAT(*svg, HasSubstr("<circle"));
  EXPECT_THAT(*svg, HasSubstr("<clipPath"));
}

TEST(MapPicture, SvgOfALargeMapStaysSmall) {
  const ParameterizedMesh map = gridMap(230, false);  // 105800 faces.
  MapPicture picture = pictureOf(map);
  picture.size = {1600, 900};
  picture.format = PictureFormat::kSvg;
  std::vector<double> field;
  for (std::size_t v = 0; v < map.positions.size() / 3; ++v) field.push_back(map.positions[3 * v]);
  for (const bool with_field : {false, true}) {
    if (with_field) picture.field = field;
    const auto svg = drawMap(picture);
    ASSERT_OK(svg);
    EXPECT_LT(svg->size(), 4U << 20);
    EXPECT_EQ(xmlFault(*svg), "");
  }
}

TEST(MapPicture, NothingBreaksIt) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  std::vector<ParameterizedMesh> maps = {{}, gridMap(2, false), ballMap(3), diskMap(3)};
  const std::size_t whole = maps.size();
  for (std::size_t i = 1; i < whole; ++i) {
    for (const double value : {0.0, kNan, 1e308, -1e300, 1e-320}) {
      ParameterizedMesh map = maps[i];
      std::fill(map.points.begin(), map.points.end(), value);
      std::fill(map.positions.begin(), map.positions.end(), value);
      maps.push_back(map);
      map = maps[i];
      map.points.resize(map.points.size() / 2, value);
      map.positions[4] = value;
      if (!map.points.empty()) map.points[3] = value;
      maps.push_back(map);
    }
    ParameterizedMesh map = maps[i];
    map.faces[2] = -1;
    map.faces[4] = 1 << 30;
    map.corners[7] = 1 << 30;
    map.corners[9] = -5;
    maps.push_back(map);
    map.corners.resize(3);
    map.faces.push_back(0);
    maps.push_back(map);
    map.positions.clear();
    maps.push_back(map);
  }
  const std::vector<double> odd = {kNan, 1, 2, 3, 1e308, -1e308, 0};
  for (ParameterizedMesh& map : maps) {
    for (const auto target : {Options::TARGET_UNSPECIFIED, Options::FLAT, Options::SPHERE,
                              Options::DISK, Options::RECTANGLE, Options::CIRCLE_DOMAIN}) {
      map.result.set_target(target);
      auto& circle = *map.result.add_circles();
      circle.set_radius(target == Options::DISK ? kNan : 1);
      MapPicture picture = pictureOf(map);
      picture.size = {120, 90};
      for (const PictureFormat format : {PictureFormat::kPng, PictureFormat::kSvg}) {
        picture.format = format;
        picture.field = {};
        picture.space = map.positions;
        picture.in_space = true;
        EXPECT_OK(drawMap(picture));
        picture.field = picture.space = odd;
        for (const PictureDraw draw : kDraws) {
          picture.draw = draw;
          if (hasNoLayout(picture)) continue;
          EXPECT_OK(drawMap(picture));
        }
        picture.draw = PictureDraw::kChecker;
        picture.in_space = false;
        EXPECT_OK(drawMap(picture));
      }
    }
  }
}

TEST(PictureOptions, ReadSizes) {
  const auto size = parsePictureSize("800x600");
  ASSERT_OK(size);
  EXPECT_EQ(size->width, 800);
  EXPECT_EQ(size->height, 600);
  EXPECT_OK(parsePictureSize("16x16384"));
  for (const char* text : {"", "x", "800", "800x", "x600", "15x100", "100x16385", "800X600",
                           "800x600x3", " 800x600", "8e2x600", "-800x600", "800.5x600"}) {
    EXPECT_THAT(parsePictureSize(text), FailsWith(Reason::kInvalidOption)) << text;
  }
}

TEST(PictureOptions, ReadViews) {
  const auto top = parsePictureView("top");
  ASSERT_OK(top);
  EXPECT_EQ(top->towards_eye, (Vec3{0, 1, 0}));
  EXPECT_EQ(top->up, (Vec3{0, 0, -1}));
  const auto view = parsePictureView("1e300,-5e299,0");
  ASSERT_OK(view);
  EXPECT_EQ(view->towards_eye, (Vec3{1, -0.5, 0}));
  EXPECT_EQ(view->up, (Vec3{0, 1, 0}));
  EXPECT_EQ(parsePictureView("0,-2,0")->up, (Vec3{0, 0, 1}));
  for (const char* text :
       {"", "Front", "1,2", "1,2,3,4", "0,0,0", "nan,0,1", "inf,0,0", "1, 2,3", "a,b,c", "1,2,"}) {
    EXPECT_THAT(parsePictureView(text), FailsWith(Reason::kInvalidOption)) << text;
  }
}

TEST(PictureOptions, TellTheFormatByTheName) {
  EXPECT_EQ(*parsePictureFormat("a.b/c.PNG"), PictureFormat::kPng);
  EXPECT_EQ(*parsePictureFormat("x.Svg"), PictureFormat::kSvg);
  for (const char* path : {"", "png", "x.jpg", "x.png/y"}) {
    EXPECT_THAT(parsePictureFormat(path), FailsWith(Reason::kInvalidOption)) << path;
  }
}

}  // namespace
}  // namespace moduli::cli
