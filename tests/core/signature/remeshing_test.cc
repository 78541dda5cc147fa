#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "core/intrinsic/refine.h"
#include "core/signature/descriptor.h"
#include "tests/core/signature/modes.h"
#include "tests/core/spherical/surfaces.h"

/// Vectors belong to surfaces and not to their triangulations: remeshing to a quarter up to four
/// times of the faces moves them by less than a tenth of what lies between different surfaces.
namespace moduli {
namespace {

using surfaces::mesh;
using surfaces::sample;

struct Vectors {
  std::vector<double> metric, shape;
};

Vectors vectorsOf(const TriangleMesh& surface) {
  Context context;
  const SurfaceModes modes = surfaces::modesOf(surface);
  const auto parts = shapeParts(context, surface, surfaces::properLengths(surface), modes);
  EXPECT_OK(parts);
  return {weighParts(metricParts(modes)), weighParts(*parts)};
}

double distance(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum);
}

struct Shape {
  std::string kind;
  std::map<std::string, double> parameters;
  double resolution;  ///< Of some 2000 faces.
};

const std::vector<Shape>& shapes() {
  static const std::vector<Shape> all = {{"ellipsoid", {{"b", 0.7}, {"c", 0.4}}, 10},
                                         {"spheroid", {{"c", 0.3}}, 10},
                                         {"capped-cylinder", {{"half_length", 3}}, 8},
                                         {"torus", {{"R", 3}, {"r", 0.6}}, 24},
                                         {"torus", {{"R", 1.5}, {"r", 1}}, 22},
                                         {"genus", {{"genus", 2}}, 4},
                                         {"disk", {}, 18},
                                         {"annulus", {}, 14}};
  return all;
}

/// With another irregular triangulation for every seed.
TriangleMesh meshOf(const Shape& shape, double share_of_faces, double seed) {
  std::map<std::string, double> parameters = shape.parameters;
  parameters["resolution"] = std::round(shape.resolution * std::sqrt(share_of_faces));
  parameters["seed"] = seed;
  return mesh(sample(shape.kind, parameters));
}

double medianDistance(const std::vector<std::vector<double>>& all) {
  std::vector<double> distances;
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) distances.push_back(distance(all[i], all[j]));
  }
  std::nth_element(distances.begin(), distances.begin() + distances.size() / 2, distances.end());
  return distances[distances.size() / 2];
}

TEST(Remeshing, MovesVectorsByLessThanATenthOfWhatLiesBetweenShapes) {
  std::vector<std::vector<double>> metric, shape;
  for (const Shape& each : shapes()) {
    const Vectors vectors = vectorsOf(meshOf(each, 1, 1));
    metric.push_back(vectors.metric);
    shape.push_back(vectors.shape);
  }
  const double metric_unit = medianDistance(metric), shape_unit = medianDistance(shape);
  double largest_metric = 0, largest_shape = 0;
  for (std::size_t i = 0; i < shapes().size(); ++i) {
    double seed = 2;
    for (const double share : {0.25, 0.5, 2.0, 4.0}) {
      const Vectors vectors = vectorsOf(meshOf(shapes()[i], share, seed++));
      const double metric_change = distance(vectors.metric, metric[i]) / metric_unit;
      const double shape_change = distance(vectors.shape, shape[i]) / shape_unit;
      EXPECT_LT(metric_change, 0.1) << shapes()[i].kind << " " << share;
      EXPECT_LT(shape_change, 0.1) << shapes()[i].kind << " " << share;
      largest_metric = std::max(largest_metric, metric_change);
      largest_shape = std::max(largest_shape, shape_change);
    }
  }
  RecordProperty("largest_metric_change", std::to_string(largest_metric));
  RecordProperty("largest_shape_change", std::to_string(largest_shape));
}

/// With long edges halved: the very same polyhedral surface.
TriangleMesh refined(const TriangleMesh& coarse, double longest) {
  Context context;
  RefineOptions options;
  options.longest = longest;
  auto fine = refineInSpace(
      context, {coarse.connectivity(), coarse.edgeLengths(), coarse.positions()}, options);
  EXPECT_OK(fine);
  return mesh({std::move(fine->positions), fine->surface.faces()});
}

TEST(Remeshing, OfAPolyhedronWithinItsFacesIsNoOtherSurface) {
  const TriangleMesh ring = mesh(sample("torus", {{"resolution", 3}}));
  const TriangleMesh icosahedron = mesh(sample("sphere", {{"resolution", 1}}));
  const double apart = distance(vectorsOf(ring).metric, vectorsOf(icosahedron).metric);
  for (const TriangleMesh& coarse : {ring, icosahedron}) {
    const Vectors few = vectorsOf(coarse);
    for (const double share : {0.5, 0.12, 0.05}) {
      const std::vector<double> lengths = coarse.edgeLengths();
      const Vectors many =
          vectorsOf(refined(coarse, share * *std::max_element(lengths.begin(), lengths.end())));
      EXPECT_LT(distance(few.metric, many.metric), 0.1 * apart) << share;
    }
  }
}

}  // namespace
}  // namespace moduli
