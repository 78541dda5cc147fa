#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "client/cli/map_pattern.h"
#include "client/cli/torus_tiling.h"
#include "tests/client/shown_panel.h"
#include "tests/client/small_maps.h"
#include "tests/core/testing.h"

/// Pictures of maps to the plane: copies around a torus, cones and unit squares.
namespace moduli::cli {
namespace {

using Options = v1::ParameterizationOptions;

void setGenerator(v1::TorusDomain& torus, double re, double im) {
  v1::Complex& generator = *torus.add_generators();
  generator.set_re(re);
  generator.set_im(im);
}

/// The unit square as one cell of the lattice of 1 and shear + i.
ParameterizedMesh squareTorus(double shear) {
  ParameterizedMesh map = gridMap(8, false);
  for (std::size_t i = 0; i < map.points.size(); i += 2) map.points[i] += shear * map.points[i + 1];
  map.result.set_target(Options::TORUS);
  setGenerator(*map.result.mutable_torus(), 1, 0);
  setGenerator(*map.result.mutable_torus(), shear, 1);
  return map;
}

double areaOf(const TorusTiling& tiling) {
  double area = 0;
  for (const TorusTiling::Piece& piece : tiling.pieces()) {
    const auto& [i, j, k] = piece.corners;
    const Vec3 &a = tiling.points()[i], &b = tiling.points()[j], &c = tiling.points()[k];
    area += ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2;
  }
  return area;
}

TEST(TorusTiling, CopiesFillTheWindowAroundTheImageOnce) {
  for (const double shear : {0.0, 0.4, -0.5}) {
    const ParameterizedMesh map = squareTorus(shear);
    const MapDrawing drawing = makeDrawing(map, {});
    const TorusTiling tiling(drawing, map.result.torus());
    ASSERT_FALSE(tiling.empty()) << shear;
    const auto& [low, high] = tiling.window();
    EXPECT_LT(low[0], std::min(0.0, shear));
    EXPECT_GT(high[1], 1);
    EXPECT_NEAR(areaOf(tiling), (high[0] - low[0]) * (high[1] - low[1]) - 1, 1e-12) << shear;
    for (const Vec3& p : tiling.points()) {
      for (int axis = 0; axis < 2; ++axis) {
        EXPECT_GE(p[axis], low[axis] - 1e-12);
        EXPECT_LE(p[axis], high[axis] + 1e-12);
      }
    }
    EXPECT_FALSE(tiling.outlines().empty());
    EXPECT_EQ(tiling.parallelogram().size(), 4U);
  }
}

TEST(TorusTiling, WhatIsNoLatticeHasNoCopies) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const ParameterizedMesh map = squareTorus(0);
  const MapDrawing drawing = makeDrawing(map, {});
  for (const std::array<double, 4>& numbers : {std::array<double, 4>{1, 0, 2, 0},
                                               {0, 0, 0, 1},
                                               {1, 0, 0, -1},
                                               {nan, 0, 0, 1},
                                               {1e-9, 0, 0, 1},
                                               {1e-300, 0, 0, 1e-300}}) {
    v1::TorusDomain torus;
    setGenerator(torus, numbers[0], numbers[1]);
    setGenerator(torus, numbers[2], numbers[3]);
    EXPECT_TRUE(TorusTiling(drawing, torus).empty()) << numbers[0] << " " << numbers[3];
  }
  EXPECT_TRUE(TorusTiling(drawing, v1::TorusDomain()).empty());
}

TEST(TorusTiling, ACopyShowsThePatternOfTheImagePaler) {
  const ParameterizedMesh map = squareTorus(0);
  MapPicture picture = pictureOf(map);
  const MapPanels panels(picture);
  ASSERT_NE(panels.torus(), nullptr);
  const Shown shown(panels, PanelKind::kPlane);
  // Middles of cells, away from lines; the pattern has 16 x 16 cells.
  for (int n = 2; n < 12; ++n) {
    const Vec3 inside = {2.5 / 16, (n + 0.5) / 16, 0};
    const Vec3 copied = {inside[0] + 1, inside[1], 0};
    EXPECT_EQ(shown.at(copied), paleColor(panels.pattern().at(inside))) << n;
  }
  picture.draw = PictureDraw::kLayout;
  EXPECT_EQ(MapPanels(picture).torus(), nullptr);
}

TEST(ConeDots, StandAtTheImagesOfConesInTheColourOfTheirSign) {
  ParameterizedMesh map = gridMap(4, false);
  map.result.set_target(Options::FLAT);
  v1::ConeMetric& metric = *map.result.mutable_cone_metric();
  for (const auto& [vertex, curvature] : {std::pair{12, 1.0}, {6, -1.0}, {7, 0.0}, {-1, 2.0}}) {
    v1::Cone& cone = *metric.add_cones();
    cone.set_vertex(vertex);
    cone.set_curvature(curvature);
  }
  const MapPanels panels(pictureOf(map));
  ASSERT_EQ(panels.cones().size(), 2U);
  const Shown shown(panels, PanelKind::kPlane);
  for (const MapPanels::DrawnCone& cone : panels.cones()) {
    EXPECT_EQ(cone.color, cone.vertex == 12 ? kConvexColor : kConcaveColor);
    EXPECT_EQ(shown.at(panels.drawing().points[cone.point]), cone.color);
  }
}

TEST(UnitSquares, ChangeTheirColourAtWholeCoordinates) {
  ParameterizedMesh map = gridMap(2, false);
  for (double& x : map.points) x = 10 * x - 3.3;
  const Pattern pattern(makeDrawing(map, {}), Options::QUADS);
  for (int i = -3; i < 6; ++i) {
    for (int j = -3; j < 6; ++j) {
      const Color here = pattern.at({i + 0.01, j + 0.01, 0});
      EXPECT_EQ(here == kPatternLight, pattern.at({i + 0.99, j + 0.99, 0}) == kPatternLight);
      EXPECT_NE(here == kPatternLight, pattern.at({i - 0.01, j + 0.01, 0}) == kPatternLight);
      EXPECT_NE(here == kPatternLight, pattern.at({i + 0.01, j - 0.01, 0}) == kPatternLight);
    }
  }
}

}  // namespace
}  // namespace moduli::cli
