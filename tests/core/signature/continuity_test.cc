#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "core/signature/compute.h"
#include "core/signature/distance.h"
#include "tests/core/spherical/surfaces.h"

/// Vectors have no jumps along paths of surfaces, not even where eigenvalues or classes cross.
namespace moduli {
namespace {

using Parameters = std::map<std::string, double>;

struct Path {
  const char* name;
  const char* kind;
  std::function<Parameters(double)> at;  ///< For t in [0, 1].
};

/// Each goes through what is special at its middle.
std::vector<Path> paths() {
  return {
      {"ellipsoids through the sphere", "ellipsoid",
       [](double t) {
         return Parameters{
             {"a", 1}, {"b", 1 + 0.1 * (t - 0.5)}, {"c", 1 - 0.1 * (t - 0.5)}, {"resolution", 6}};
       }},
      // tau = i sqrt((R / r)^2 - 1).
      {"tori through tau = i", "torus",
       [](double t) {
         return Parameters{
             {"R", std::sqrt(2.0) * (1 + 0.1 * (t - 0.5))}, {"r", 1}, {"resolution", 12}};
       }},
      {"rods", "capped-cylinder",
       [](double t) {
         return Parameters{{"half_length", 1 + 0.1 * t}, {"resolution", 6}};
       }},
      {"rings", "annulus", [](double t) {
         return Parameters{{"r", 1}, {"R", 2 + 0.1 * t}, {"resolution", 6}};
       }}};
}

SearchVectors vectorsAt(const Path& path, double t) {
  Context context;
  const auto prepared = prepareMesh(context, surfaces::sample(path.kind, path.at(t)), {});
  EXPECT_OK(prepared);
  const auto signature = computeSignature(context, *prepared);
  EXPECT_OK(signature);
  return signature.ok() ? signature->vectors : SearchVectors();
}

double difference(const std::vector<float>& a, const std::vector<float>& b) {
  EXPECT_EQ(a.size(), b.size());
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    sum += std::pow(static_cast<double>(a[i]) - static_cast<double>(b[i]), 2);
  }
  return std::sqrt(sum);
}

using VectorOf = std::vector<float> SearchVectors::*;

double largestStep(const std::vector<SearchVectors>& vectors, VectorOf space, std::size_t stride) {
  double largest = 0;
  for (std::size_t i = 0; i + stride < vectors.size(); i += stride) {
    largest = std::max(largest, difference(vectors[i].*space, vectors[i + stride].*space));
  }
  return largest;
}

/// The largest of steps half as long is about half as large; a jump would stay what it is. Where
/// eigenvalues cross, steps are Lipschitz but no more: up to 0.75 is let pass. Triangulations of
/// one kind keep their numbering along a path, rings and rods where the number of rows stays the
/// same.
TEST(Continuity, StepsShrinkWithTheWayAlongPathsOfSurfaces) {
  constexpr int kSteps = 16;
  for (const Path& path : paths()) {
    std::vector<SearchVectors> vectors;
    for (int i = 0; i <= kSteps; ++i) {
      vectors.push_back(vectorsAt(path, static_cast<double>(i) / kSteps));
    }
    const std::vector<std::pair<const char*, VectorOf>> spaces = {
        {"conformal", &SearchVectors::conformal},
        {"metric", &SearchVectors::metric},
        {"shape", &SearchVectors::shape}};
    for (const auto& [name, space] : spaces) {
      SCOPED_TRACE(std::string(path.name) + ", " + name);
      const double coarse = largestStep(vectors, space, 4), fine = largestStep(vectors, space, 1);
      if ((vectors.front().*space).empty() || coarse == 0) continue;  // Spheres are all one.
      // Two halvings.
      EXPECT_LT(fine, 0.75 * 0.75 * coarse);
      EXPECT_GT(coarse, 1e-4);
    }
  }
}

}  // namespace
}  // namespace moduli
