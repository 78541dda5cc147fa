#include "core/parameterize/layout_measures.h"

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "core/mesh/samples.h"
#include "core/parameterize/flat.h"
#include "tests/core/forms/glued_surfaces.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

MetricSurface sample(const std::string& kind, const std::map<std::string, double>& parameters) {
  const auto soup = makeSample(kind, parameters);
  EXPECT_OK(soup);
  return fromPositions(soup->vertices, soup->faces);
}

// The unit square in two faces, which share the diagonal 0-2; points as given.
MetricSurface square() {
  return fromPositions({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}});
}

TEST(LayoutMeasures, ACutDiagonalIsASeamOfItsLength) {
  const MetricSurface metric = square();
  Parameterization map;
  map.points = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  map.corner = {0, 1, 2, 0, 2, 3};
  const auto whole = measureLayout(metric.surface, metric.lengths, map);
  ASSERT_OK(whole);
  EXPECT_EQ(whole->islands, 1);
  EXPECT_EQ(whole->seam_length, 0);
  EXPECT_EQ(whole->mapped_faces, 2);
  map.points.insert(map.points.end(), {{2, 0}, {3, 1}});
  // Both ends of the diagonal are doubled, then one of them: a seam either way.
  map.corner = {0, 1, 2, 4, 5, 3};
  const auto cut = measureLayout(metric.surface, metric.lengths, map);
  ASSERT_OK(cut);
  EXPECT_EQ(cut->islands, 2);
  EXPECT_DOUBLE_EQ(cut->seam_length, std::sqrt(2));
  map.corner = {0, 1, 2, 0, 5, 3};
  const auto slit = measureLayout(metric.surface, metric.lengths, map);
  ASSERT_OK(slit);
  EXPECT_EQ(slit->islands, 1);
  EXPECT_DOUBLE_EQ(slit->seam_length, std::sqrt(2));
}

TEST(LayoutMeasures, WhatFillsHolesIsNoneOfIt) {
  const MetricSurface metric = square();
  Parameterization map;
  map.points = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {2, 0}, {3, 1}};
  map.corner = {0, 1, 2, 4, 5, 3};
  const auto half = measureLayout(metric.surface, metric.lengths, map, {false, true});
  ASSERT_OK(half);
  EXPECT_EQ(half->mapped_faces, 1);
  EXPECT_EQ(half->islands, 1);
  EXPECT_EQ(half->seam_length, 0) << "its edge is a boundary for the user";
}

TEST(LayoutMeasures, ATorusIsCutAlongTwoCyclesAtAnyScale) {
  const MetricSurface metric = sample("torus", {{"resolution", 12}});
  Context context;
  const auto flat = parameterizeFlat(context, metric.surface, metric.lengths, {});
  ASSERT_OK(flat);
  const auto measures = measureLayout(metric.surface, metric.lengths, *flat);
  ASSERT_OK(measures);
  EXPECT_EQ(measures->islands, 1);
  EXPECT_EQ(measures->mapped_faces, metric.surface.faceCount());
  // The cuts hold a meridian and a longitude, no shorter than 0.95 of the smooth ones of length 2
  // pi each; the area is no larger than the smooth one, 8 pi^2.
  EXPECT_GT(measures->seam_length, 0.95 * 4 / std::sqrt(8));
  std::vector<double> larger = metric.lengths;
  for (double& length : larger) length *= 1000;
  const auto scaled = measureLayout(metric.surface, larger, *flat);
  ASSERT_OK(scaled);
  EXPECT_NEAR(scaled->seam_length / measures->seam_length, 1, 1e-12);
}

TEST(LayoutMeasures, PiecesOfCutFacesAreMeasured) {
  const MetricSurface metric = square();
  Parameterization map;
  // The first face is cut from vertex 1 to the middle of the diagonal, and so is the second.
  const Index diagonal = metric.surface.edge(2);
  map.subdivision.emplace();
  map.subdivision->vertices = {{metric.surface.halfedge(diagonal), 0.5, {}}};
  map.subdivision->faces = {{0, 1, 4}, {1, 2, 4}, {0, 4, 3}, {4, 2, 3}};
  map.subdivision->parent = {0, 0, 1, 1};
  map.points = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0.5, 0.5}, {0.6, 0.4}, {1.1, 0.9}};
  // Torn along the upper half of the diagonal alone.
  map.corner = {0, 1, 4, 1, 6, 4, 0, 4, 3, 4, 2, 3};
  const auto measures = measureLayout(metric.surface, metric.lengths, map);
  ASSERT_OK(measures);
  EXPECT_EQ(measures->mapped_faces, 4);
  EXPECT_EQ(measures->islands, 1);
  EXPECT_NEAR(measures->seam_length, std::sqrt(2) / 2, 1e-15);
}

TEST(LayoutMeasures, ASphereHasOneIslandAndNoSeams) {
  const MetricSurface ball = sample("sphere", {{"resolution", 3}});
  Parameterization round;
  round.sphere.resize(ball.surface.vertexCount(), Eigen::Vector3d::UnitX());
  const auto sphere = measureLayout(ball.surface, ball.lengths, round);
  ASSERT_OK(sphere);
  EXPECT_EQ(sphere->islands, 1);
  EXPECT_EQ(sphere->seam_length, 0);
}

}  // namespace
}  // namespace moduli
