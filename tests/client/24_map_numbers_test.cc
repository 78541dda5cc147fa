#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numeric>
#include <random>
#include <set>

#include "client/cli/map_heat.h"
#include "client/cli/map_measure.h"
#include "client/cli/seam_chains.h"
#include "tests/client/shown_panel.h"
#include "tests/client/small_maps.h"
#include "tests/core/testing.h"

/// Numbers of maps and their pictures: dilatation, scale, islands and seams.
namespace moduli::cli {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using Complex = std::complex<double>;
using Options = v1::ParameterizationOptions;

// The unit square, flat, its image moved by a rule.
template <typename Rule>
ParameterizedMesh gridBy(int n, Rule rule) {
  ParameterizedMesh map = gridMap(n, false);
  for (std::size_t i = 2; i < map.positions.size(); i += 3) map.positions[i] = 0;
  for (std::size_t i = 0; i < map.points.size(); i += 2) {
    const Complex image = rule(Complex(map.points[i], map.points[i + 1]));
    map.points[i] = image.real();
    map.points[i + 1] = image.imag();
  }
  return map;
}

Complex stretched(const Complex& z, double x, double y) {
  return {x * z.real(), y * z.imag()};
}

TEST(MeasureFaces, AStretchHasItsRatioAndItsMeanScale) {
  const Complex turn = std::polar(1.0, 0.7);
  for (const bool mirrored : {false, true}) {
    const MapDrawing drawing = makeDrawing(gridBy(3,
                                                  [&](Complex z) {
                                                    z = turn * stretched(z, 6, 1.5);
                                                    return mirrored ? std::conj(z) : z;
                                                  }),
                                           {});
    const FaceMeasures measures = measureFaces(drawing, false);
    ASSERT_EQ(measures.dilatation.size(), 18U);
    EXPECT_THAT(measures.dilatation, Each(testing::DoubleNear(4, 1e-12)));
    EXPECT_THAT(measures.log_scale, Each(testing::DoubleNear(std::log(3), 1e-12)));
    EXPECT_THAT(measures.area, Each(testing::DoubleNear(1.0 / 18, 1e-15)));
  }
}

TEST(MeasureFaces, ASimilarityHasNoDilatation) {
  const auto measures = measureFaces(
      makeDrawing(gridBy(4, [](Complex z) { return Complex(0, 1e6) * z + 1e3; }), {}), false);
  // K - 1 is the root of twice the rounding of its cosh: some 1e-16 of coordinates that are 1e-3
  // of the offset gives 1e-13, the root of which is 3e-7.
  EXPECT_THAT(measures.dilatation, Each(testing::DoubleNear(1, 1e-6)));
}

TEST(MeasureFaces, WhatIsNotMappedOrFlatHasNone) {
  ParameterizedMesh map = gridMap(2, false);
  for (std::size_t k = 0; k < 3; ++k) map.corners[k] = -1;
  map.corners[4] = map.corners[3];
  const auto measures = measureFaces(makeDrawing(map, {}), false);
  EXPECT_TRUE(std::isnan(measures.dilatation[0]));
  EXPECT_TRUE(std::isnan(measures.dilatation[1]));
  EXPECT_TRUE(std::isfinite(measures.dilatation[2]));
  EXPECT_GT(measures.area[0], 0);
}

TEST(MeasureFaces, IsometriesOfTheHyperbolicDiskChangeNoScale) {
  // Faces of 1e-4 / 3: the metric varies by as much over them, times 2 r / (1 - r^2) < 5.
  const auto small = [](Complex z) { return 1e-4 * z; };
  const auto scaleBy = [&](Complex a) {
    const auto moved = [&](Complex z) { return (small(z) + a) / (1.0 + std::conj(a) * small(z)); };
    return measureFaces(makeDrawing(gridBy(3, moved), {}), true).log_scale;
  };
  const double at_centre = std::log(2e-4);
  EXPECT_THAT(scaleBy(0), Each(testing::DoubleNear(at_centre, 1e-7)));
  EXPECT_THAT(scaleBy({0.5, 0.6}), Each(testing::DoubleNear(at_centre, 1e-3)));
}

TEST(MeasureFaces, LargeFacesOfTheDiskAreMeasuredInItsMiddle) {
  // A face of side 0.3, moved by an isometry, has the K that it has around 0.
  const auto dilatationBy = [](Complex a) {
    ParameterizedMesh map = gridBy(1, [&](Complex z) {
      const Complex small = 0.3 * stretched(z, 1, 0.5);
      return (small + a) / (1.0 + std::conj(a) * small);
    });
    return measureFaces(makeDrawing(map, {}), true).dilatation[0];
  };
  // The mean of three points is moved to the mean up to the third power of the size.
  EXPECT_NEAR(dilatationBy({0.6, 0.3}), dilatationBy(0), 0.05);
}

TEST(AreaQuantile, IsTheOneFoundByCounting) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<double> values(200), areas(200);
  std::generate(values.begin(), values.end(), [&] { return uniform(random); });
  std::generate(areas.begin(), areas.end(), [&] { return uniform(random); });
  const double total = std::accumulate(areas.begin(), areas.end(), 0.0);
  const auto notAbove = [&](double limit) {
    double sum = 0;
    for (std::size_t i = 0; i < values.size(); ++i) sum += values[i] <= limit ? areas[i] : 0;
    return sum / total;
  };
  for (const double share : {0.1, 0.5, 0.95}) {
    const double found = areaQuantile(values, areas, share);
    EXPECT_GE(notAbove(found), share);
    EXPECT_LT(notAbove(found - 1e-12), share);
  }
  values.push_back(std::numeric_limits<double>::quiet_NaN());
  areas.push_back(1e9);
  EXPECT_LE(areaQuantile(values, areas, 1), 1);
  EXPECT_EQ(areaQuantile({}, {}, 0.5), 0);
}

// The left half keeps angles, the right half has K = 2, one face of it lies the other way round.
ParameterizedMesh halfStretched() {
  ParameterizedMesh map = gridBy(
      20, [](Complex z) { return Complex(z.real() + std::max(0.0, z.real() - 0.5), z.imag()); });
  // Cell (15, 4), its first face.
  const std::size_t face = 2 * (20 * 15 + 4);
  std::swap(map.corners[3 * face], map.corners[3 * face + 1]);
  return map;
}

TEST(MapHeat, ShowsDilatationOnBothSides) {
  const ParameterizedMesh map = halfStretched();
  MapPicture picture = pictureOf(map);
  picture.draw = PictureDraw::kDilatation;
  const MapPanels panels(picture);
  ASSERT_NE(panels.legend(), nullptr);
  const Legend& legend = *panels.legend();
  // K = 2 on half of the area: a bar from 1 to 2 in five parts. The face that was turned over is
  // sheared, too.
  std::vector<std::string> labels;
  for (const auto& tick : legend.ticks) labels.push_back(tick.label);
  EXPECT_THAT(labels, ElementsAre("1", "1.2", "1.4", "1.6", "1.8", "≥ 2"));
  ASSERT_EQ(legend.swatches.size(), 1U);
  EXPECT_EQ(legend.swatches[0].color, kFoldedInHeat);
  EXPECT_THAT(panels.panels()[0].subtitle, HasSubstr("mean 1.5"));
  const Shown image(panels, PanelKind::kPlane);
  // Within faces, away from their edges, which may be drawn.
  EXPECT_EQ(image.at({0.235, 0.215, 0}), heatColor(0));
  EXPECT_EQ(image.at({1.17, 0.615, 0}), heatColor(1));
  EXPECT_EQ(image.at({1.07, 0.213, 0}), kFoldedInHeat);
}

TEST(MapHeat, TheBarSaysWhereItIsExceeded) {
  const ParameterizedMesh map = gridBy(20, [](Complex z) {
    // The uppermost of twenty rows becomes three times as high: K = 3 on 5 % of the area.
    return Complex(z.real(), z.imag() * (z.imag() > 0.999 ? 1.1 : 1));
  });
  MapPicture picture = pictureOf(map);
  picture.draw = PictureDraw::kDilatation;
  const MapPanels panels(picture);
  ASSERT_NE(panels.legend(), nullptr);
  EXPECT_EQ(panels.legend()->ticks.back().label, "3");
  // One vertex in the corner moves: two of 800 faces.
  ParameterizedMesh spike = gridBy(20, [](Complex z) { return z; });
  spike.points[0] -= 0.5;
  MapPicture spiked = pictureOf(spike);
  spiked.draw = PictureDraw::kDilatation;
  const MapPanels other(spiked);
  EXPECT_EQ(other.legend()->ticks.back().label, "≥ 1.01");
}

TEST(MapHeat, ScaleIsAgainstTheMean) {
  // Twice as long on the right half, whatever the whole: logarithms -log(2)/2 and log(2)/2.
  const ParameterizedMesh map =
      gridBy(20, [](Complex z) { return 7.0 * (z.real() > 0.5 ? 2.0 * z - Complex(0.5, 0) : z); });
  MapPicture picture = pictureOf(map);
  picture.draw = PictureDraw::kScale;
  const MapPanels panels(picture);
  const Legend& legend = *panels.legend();
  EXPECT_EQ(legend.ticks.front().place, 0);
  EXPECT_EQ(legend.ticks[2].label, "1");
  // Far from the middle line, where vertices mix both.
  const Color left = panels.colorAt(4, {0.4, 0.3, 0.3});
  const Color right = panels.colorAt(2 * 400 - 5, {0.4, 0.3, 0.3});
  EXPECT_GT(left.blue, left.red);
  EXPECT_GT(right.red, right.blue);
  EXPECT_EQ(divergingColor(0), (Color{245, 245, 245}));
}

// Cut open along x = 1/2.
ParameterizedMesh halvedGrid(int n) {
  ParameterizedMesh map = gridMap(n, false);
  const auto vertices = static_cast<std::int32_t>(map.points.size() / 2);
  for (int j = 0; j <= n; ++j) {
    const std::size_t v = static_cast<std::size_t>(n / 2 * (n + 1) + j);
    map.points.insert(map.points.end(), {map.points[2 * v] + 1, map.points[2 * v + 1]});
  }
  for (std::size_t k = map.corners.size() / 2; k < map.corners.size(); ++k) {
    std::int32_t& corner = map.corners[k];
    if (corner / (n + 1) == n / 2) corner = vertices + corner % (n + 1);
  }
  std::set<std::int32_t> right(map.corners.begin() + map.corners.size() / 2, map.corners.end());
  for (const std::int32_t corner : right) {
    if (corner < vertices) map.points[2 * static_cast<std::size_t>(corner)] += 1;
  }
  return map;
}

TEST(SeamChains, ACutIsOneChainWithBothItsSides) {
  const MapDrawing drawing = makeDrawing(halvedGrid(4), {});
  const auto groups = seamChains(drawing);
  std::size_t used = 0, edges = 0;
  for (const EdgeGroup& group : groups) {
    used += group.edges.empty() ? 0 : 1;
    edges += group.edges.size();
  }
  EXPECT_EQ(used, 1U);
  EXPECT_EQ(edges, 8U);
  const std::vector<int> islands = findIslands(drawing);
  for (std::size_t f = 0; f < islands.size(); ++f) EXPECT_EQ(islands[f], f < 16 ? 0 : 1);
}

TEST(SeamChains, EndWhereTheyBranch) {
  // A square of four faces around its middle, each with points of its own: four cuts meet there.
  ParameterizedMesh map;
  map.result.set_target(Options::FLAT);
  map.positions = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0.5, 0.5, 0};
  for (int k = 0; k < 4; ++k) {
    for (const int v : {k, (k + 1) % 4, 4}) {
      map.faces.push_back(v);
      map.corners.push_back(static_cast<std::int32_t>(map.points.size() / 2));
      map.points.push_back(map.positions[3 * static_cast<std::size_t>(v)]);
      map.points.push_back(map.positions[3 * static_cast<std::size_t>(v) + 1]);
    }
  }
  const MapDrawing drawing = makeDrawing(map, {});
  const auto groups = seamChains(drawing);
  ASSERT_EQ(groups.size(), 4U);
  std::set<std::array<std::uint8_t, 3>> colors;
  for (const EdgeGroup& group : groups) {
    ASSERT_EQ(group.edges.size(), 2U);
    const auto& a = drawing.edges[static_cast<std::size_t>(group.edges[0])].vertices;
    const auto& b = drawing.edges[static_cast<std::size_t>(group.edges[1])].vertices;
    EXPECT_EQ(a[0] + a[1], b[0] + b[1]) << "two sides of one edge";
    colors.insert({group.color.red, group.color.green, group.color.blue});
  }
  EXPECT_EQ(colors.size(), 4U);
  EXPECT_THAT(findIslands(drawing), ElementsAre(0, 1, 2, 3));
}

TEST(MapPicture, TheLayoutHasItsSeamsInColorOnBothPanels) {
  const ParameterizedMesh map = halvedGrid(4);
  MapPicture picture = pictureOf(map);
  picture.draw = PictureDraw::kLayout;
  const MapPanels panels(picture);
  EXPECT_EQ(panels.legend(), nullptr);
  EXPECT_THAT(panels.panels()[0].subtitle, HasSubstr("2 islands, seams along 4 edges"));
  const Color seam = panels.seams()[0].color;
  const Shown image(panels, PanelKind::kPlane), surface(panels, PanelKind::kSurface);
  EXPECT_EQ(image.at({0.5, 0.4, 0}), seam);
  EXPECT_EQ(image.at({1.5, 0.6, 0}), seam);
  EXPECT_EQ(surface.at({0.5, 0.4, 0.25}), seam);
  EXPECT_EQ(image.at({0.16, 0.07, 0}), islandColor(0));
  EXPECT_EQ(image.at({1.91, 0.07, 0}), islandColor(1));
}

TEST(MapPicture, WhatCannotBeDrawnIsRefused) {
  const ParameterizedMesh grid = gridMap(2, false), ball = ballMap(4);
  MapPicture flat = pictureOf(grid), round = pictureOf(ball);
  flat.in_space = false;
  flat.draw = PictureDraw::kDilatation;
  EXPECT_THAT(drawMap(flat), FailsWith(Reason::kInvalidOption));
  flat.draw = PictureDraw::kLayout;
  EXPECT_OK(drawMap(flat));
  round.draw = PictureDraw::kLayout;
  EXPECT_THAT(drawMap(round), FailsWith(Reason::kInvalidOption));
  round.draw = PictureDraw::kScale;
  EXPECT_OK(drawMap(round));
  round.space = {};
  EXPECT_THAT(drawMap(round), FailsWith(Reason::kInvalidOption));
}

TEST(MapPicture, ALegendStandsBesideThePanels) {
  const ParameterizedMesh map = halfStretched();
  MapPicture picture = pictureOf(map);
  picture.draw = PictureDraw::kDilatation;
  const MapPanels panels(picture);
  const SheetPlan wide = planSheet(panels, {1000, 400});
  EXPECT_GT(wide.legend_width, 0);
  EXPECT_EQ(wide.panels.height, 400);
  EXPECT_LT(wide.panels.width + wide.legend_width, 1000);
  EXPECT_EQ(planSheet(panels, {100, 60}).legend_width, 0) << "no room for words";
  picture.format = PictureFormat::kSvg;
  picture.size = {1000, 400};
  const auto svg = drawMap(picture);
  ASSERT_OK(svg);
  EXPECT_THAT(*svg, HasSubstr(">1.2</text>"));
  EXPECT_THAT(*svg, HasSubstr(">folded</text>"));
}

TEST(Legend, HasItsColorsFromTheLowerEndUp) {
  Legend legend;
  legend.title = "K";
  legend.color = heatColor;
  legend.ticks = {{0, "1"}, {1, "2"}};
  const LegendDrawing drawing = makeLegend(legend, 70, 300);
  const auto image = drawShapes(drawing.shapes, 70, 300, drawing.words);
  ASSERT_OK(image);
  // A strip is two pixels high; colours of the bar change by up to three steps over it.
  const auto near = [](const Color& a, const Color& b) {
    return std::abs(a.red - b.red) + std::abs(a.green - b.green) + std::abs(a.blue - b.blue) <= 9;
  };
  EXPECT_TRUE(near(image->at(8, 292), heatColor(0)));
  EXPECT_TRUE(near(image->at(8, 158), heatColor(0.5)));
  EXPECT_TRUE(near(image->at(8, 24), heatColor(1)));
  EXPECT_EQ(image->at(60, 290), (Color{255, 255, 255})) << "right of the labels";
  bool written = false;
  for (int x = 24; x < 34; ++x) written |= image->at(x, 292) != Color{255, 255, 255};
  EXPECT_TRUE(written);
}

TEST(NiceSpan, IsRoundAndNoSmaller) {
  const auto spans = [](double least) {
    const NiceSpan span = niceSpan(least);
    return std::pair(span.span, span.parts);
  };
  EXPECT_EQ(spans(1), std::pair(1.0, 5));
  EXPECT_EQ(spans(1.01), std::pair(2.0, 4));
  EXPECT_EQ(spans(0.3), std::pair(0.5, 5));
  EXPECT_NEAR(spans(0.07).first, 0.1, 1e-15);
  EXPECT_EQ(spans(600), std::pair(1000.0, 5));
  EXPECT_EQ(spans(std::numeric_limits<double>::infinity()), std::pair(1.0, 5));
  EXPECT_EQ(spans(-1), std::pair(1.0, 5));
}

}  // namespace
}  // namespace moduli::cli
