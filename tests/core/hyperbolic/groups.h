#pragma once

#include <cmath>
#include <cstdlib>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "core/hyperbolic/developing.h"
#include "core/intrinsic/assemble_surface.h"
#include "core/intrinsic/intrinsic_samples.h"

/// Hyperbolic surfaces and groups that are known exactly.
namespace moduli {

inline HyperbolicTriangles regularSample(const std::string& kind) {
  return *hyperbolicTriangles(*makeIntrinsicSample(kind));
}

/// The circumradius of the regular 4 g-gon with angles 2 pi / 4 g: cosh R = cot(pi / 4 g)^2.
inline double polygonRadius(int g) {
  const double t = std::tan(std::numbers::pi / (4 * g));
  return std::acosh(1 / (t * t));
}

/// The side pairings A_1, B_1, .. of that polygon with the sides a_1 b_1 a_1^-1 b_1^-1 ..
inline std::vector<Su11> polygonGroup(int g) {
  const int n = 4 * g;
  const auto corner = [&](int k) {
    return std::polar(std::tanh(polygonRadius(g) / 2), 2 * std::numbers::pi * (k % n) / n);
  };
  // From side i to side j, backwards.
  const auto pairing = [&](int i, int j) {
    return edgeFrame(corner(j + 1), corner(j)) * inverse(edgeFrame(corner(i), corner(i + 1)));
  };
  std::vector<Su11> group;
  for (int k = 0; k < n; k += 4) {
    group.push_back(pairing(k + 2, k));
    group.push_back(pairing(k + 3, k + 1));
  }
  return group;
}

/// The same polygon as a surface: 4 g triangles around its middle.
inline IntrinsicSurface polygonSurface(int g) {
  const int n = 4 * g;
  const double side =
      hyperbolicDistance(std::tanh(polygonRadius(g) / 2),
                         std::polar(std::tanh(polygonRadius(g) / 2), 2 * std::numbers::pi / n));
  SurfaceTables tables;
  tables.geometry = Geometry::kHyperbolic;
  tables.vertex_count = 2;
  tables.twin.emplace();
  for (int k = 0; k < n; ++k) {
    // Side 0 is the polygon's; sides 1 and 2 lead to the middle and back.
    tables.faces.push_back({0, 0, 1});
    tables.twin->insert(tables.twin->end(), {3 * (k % 4 < 2 ? k + 2 : k - 2), 3 * ((k + 1) % n) + 2,
                                             3 * ((k + n - 1) % n) + 1});
    tables.lengths.insert(tables.lengths.end(), {side, polygonRadius(g), polygonRadius(g)});
  }
  Context context;
  return *assembleSurface(context, std::move(tables));
}

inline Su11 evaluateWord(const std::vector<Su11>& letters, const std::vector<int>& word) {
  Su11 product;
  for (const int x : word) {
    const Su11& g = letters[std::abs(x) - 1];
    product = product * (x > 0 ? g : inverse(g));
  }
  return product;
}

}  // namespace moduli
