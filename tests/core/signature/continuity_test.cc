#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <string>
#include <vector>

#include "core/signature/compute.h"
#include "core/signature/distance.h"
#include "tests/core/signature/stretched_surfaces.h"
#include "tests/core/spherical/surfaces.h"

/// Vectors have no jumps along paths of surfaces, not even where eigenvalues or classes cross.
namespace moduli {
namespace {

struct Path {
  const char* name;
  std::function<TriangleSoup(double)> at;  ///< For t in [0, 1].
};

/// One handle grows and the other shrinks; at t = 1/2 they are alike, so that there the shortest
/// closed geodesics and the smallest energies of both change places.
TriangleSoup unequalHandles(double t) {
  TriangleSoup soup = surfaces::sample("genus", {{"genus", 2}, {"resolution", 4}});
  double low = soup.vertices[0].x(), high = low;
  for (const Eigen::Vector3d& p : soup.vertices) {
    low = std::min(low, p.x());
    high = std::max(high, p.x());
  }
  for (Eigen::Vector3d& p : soup.vertices) {
    const double place = (2 * p.x() - low - high) / (high - low);
    p.y() *= std::exp(0.6 * (t - 0.5) * place);
    p.z() *= std::exp(0.4 * (t - 0.5) * place);
  }
  return soup;
}

/// A surface of genus 2 that is bent.
TriangleSoup bentPretzel(double t) {
  TriangleSoup soup = surfaces::sample("genus", {{"genus", 2}, {"resolution", 4}});
  for (Eigen::Vector3d& p : soup.vertices) p.z() += 0.05 * (t - 0.5) * p.x() * p.x();
  return soup;
}

/// Each goes through what is special at its middle.
std::vector<Path> paths() {
  return {
      {"ellipsoids through the sphere",
       [](double t) {
         return surfaces::sample(
             "ellipsoid",
             {{"a", 1}, {"b", 1 + 0.1 * (t - 0.5)}, {"c", 1 - 0.1 * (t - 0.5)}, {"resolution", 6}});
       }},
      // tau = i sqrt((R / r)^2 - 1).
      {"tori through tau = i",
       [](double t) {
         return surfaces::sample(
             "torus",
             {{"R", std::sqrt(2.0) * (1 + 0.1 * (t - 0.5))}, {"r", 1}, {"resolution", 12}});
       }},
      {"rods",
       [](double t) {
         return surfaces::sample("capped-cylinder",
                                 {{"half_length", 1 + 0.1 * t}, {"resolution", 6}});
       }},
      {"rings",
       [](double t) {
         return surfaces::sample("annulus", {{"r", 1}, {"R", 2 + 0.1 * t}, {"resolution", 6}});
       }},
      {"genus 2 with handles that change places", unequalHandles},
      {"genus 2 that is bent", bentPretzel}};
}

SearchVectors vectorsAt(const Path& path, double t) {
  Context context;
  const auto prepared = prepareMesh(context, path.at(t), {});
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

double largestStep(const std::vector<SearchVectors>& vectors, VectorOf space, std::size_t stride,
                   std::size_t coordinate) {
  double largest = 0;
  for (std::size_t i = 0; i + stride < vectors.size(); i += stride) {
    const double difference = static_cast<double>((vectors[i].*space)[coordinate]) -
                              static_cast<double>((vectors[i + stride].*space)[coordinate]);
    largest = std::max(largest, std::abs(difference));
  }
  return largest;
}

/// The largest of steps half as long is about half as large; a jump would stay what it is. Where
/// eigenvalues cross, steps are Lipschitz but no more: up to 0.75 is let pass. Triangulations of
/// one kind keep their numbering along a path, rings and rods where the number of rows stays the
/// same.
///
/// In every coordinate as well; one that stands still but for a short way may take all of its way
/// in one step, and so a tenth of the largest step of all coordinates is let pass.
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
      const std::size_t count = (vectors.front().*space).size();
      double most = 0;
      for (std::size_t i = 0; i < count; ++i) {
        most = std::max(most, largestStep(vectors, space, 4, i));
      }
      for (std::size_t i = 0; i < count; ++i) {
        EXPECT_LT(largestStep(vectors, space, 1, i),
                  0.75 * 0.75 * largestStep(vectors, space, 4, i) + 0.1 * most + 1e-6)
            << "coordinate " << i;
      }
    }
  }
}

/// Flat tori, whose tau is exact, through the corners and the sides of the fundamental domain.
TEST(Continuity, ToriPassTheBordersOfTheFundamentalDomain) {
  using Complex = std::complex<double>;
  struct Line {
    const char* name;
    Complex middle, direction;
  };
  const std::vector<Line> lines = {
      {"up through i", {0, 1}, {0, 1}},
      {"across i", {0, 1}, {1, 0}},
      {"up through rho", {0.5, std::sqrt(0.75)}, {0, 1}},
      {"across rho", {0.5, std::sqrt(0.75)}, {1, 0}},
      {"along the circle at rho", {0.5, std::sqrt(0.75)}, {std::sqrt(0.75), -0.5}},
      {"across Re tau = 1/2", {0.5, 1.4}, {1, 0}},
      {"across Re tau = -3/2, far from the domain", {-1.5, 1.1}, {1, 0.3}}};
  for (const Line& line : lines) {
    SCOPED_TRACE(line.name);
    constexpr int kSteps = 32;
    std::vector<SearchVectors> vectors;
    for (int i = 0; i <= kSteps; ++i) {
      const Complex tau = line.middle + 0.1 * (1.0 * i / kSteps - 0.5) * line.direction;
      const Signature torus = signatureOf(flatTorus(tau, 6, 6, 0, 1));
      vectors.push_back(torus.vectors);
    }
    const VectorOf conformal = &SearchVectors::conformal;
    const double coarse = largestStep(vectors, conformal, 8);
    EXPECT_LT(largestStep(vectors, conformal, 4), 0.75 * coarse);
    EXPECT_LT(largestStep(vectors, conformal, 2), 0.75 * 0.75 * coarse);
    EXPECT_LT(largestStep(vectors, conformal, 1), 0.75 * 0.75 * 0.75 * coarse);
    EXPECT_GT(coarse, 1e-4);
  }
}

}  // namespace
}  // namespace moduli
