#pragma once

#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>
#include <vector>

#include "core/intrinsic/intrinsic_surface.h"
#include "core/signature/compute.h"
#include "tests/core/forms/glued_surfaces.h"
#include "tests/core/testing.h"

/// Translation surfaces of genus 2 that diag(e^t, e^-t) stretches. The stretching is Teichmüller's
/// map, of dilatation e^{2 |t|}: for small t the distance of two of them is the difference of t.
namespace moduli {

inline std::complex<double> stretched(std::complex<double> point, double t) {
  return {std::exp(t) * point.real(), std::exp(-t) * point.imag()};
}

/// Three unit squares in an L, stretched.
inline MetricSurface stretchedL(double t) {
  const std::array<std::complex<double>, 3> corner{0, 1, {0, 1}};
  const std::array<Index, 3> right{1, 0, 2}, above{2, 1, 0};
  std::vector<std::array<std::complex<double>, 3>> triangles;
  std::vector<std::pair<GluedSide, GluedSide>> gluing;
  for (Index s = 0; s < 3; ++s) {
    const auto at = [&](double x, double y) {
      return stretched(corner[s] + std::complex<double>(x, y), t);
    };
    triangles.push_back({at(0, 0), at(1, 0), at(1, 1)});
    triangles.push_back({at(0, 0), at(1, 1), at(0, 1)});
    gluing.push_back({{2 * s, 2}, {2 * s + 1, 0}});
    gluing.push_back({{2 * s, 1}, {2 * right[s] + 1, 2}});
    gluing.push_back({{2 * s + 1, 1}, {2 * above[s], 0}});
  }
  return glueTriangles(triangles, gluing);
}

/// A regular polygon with opposite sides glued, turned by `turn`, then stretched.
inline MetricSurface stretchedPolygon(int sides, double turn, double t) {
  const auto corner = [&](Index k) {
    return stretched(std::polar(1.0, 2 * std::numbers::pi * k / sides + turn), t);
  };
  std::vector<std::array<std::complex<double>, 3>> triangles;
  std::vector<std::pair<GluedSide, GluedSide>> gluing;
  for (Index k = 0; k < sides; ++k) {
    triangles.push_back({0, corner(k), corner(k + 1)});
    gluing.push_back({{k, 2}, {(k + 1) % sides, 0}});
    if (2 * k < sides) gluing.push_back({{k, 1}, {k + sides / 2, 1}});
  }
  return glueTriangles(triangles, gluing);
}

inline Signature signatureOf(const MetricSurface& surface, bool initial_delaunay = true) {
  Context context;
  SignatureOptions options;
  options.space = Space::kConformal;
  options.initial_delaunay = initial_delaunay;
  auto signature = computeIntrinsicSignature(
      context, {surface.surface, surface.lengths, Geometry::kEuclidean}, options);
  EXPECT_OK(signature);
  return *std::move(signature);
}

}  // namespace moduli
