#pragma once

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "core/matching/match_surfaces.h"
#include "tests/core/matching/renumbered.h"
#include "tests/core/testing.h"

/// Matches of surfaces and how far they are from what is known.
namespace moduli {

inline SurfaceMatch match(const TriangleMesh& a, const TriangleMesh& b,
                          const MatchOptions& options = {}) {
  Context context;
  auto found = matchSurfaces(context, a, b, options);
  EXPECT_OK(found);
  return found.ok() ? *std::move(found) : SurfaceMatch();
}

inline MatchOptions surfacesAlone() {
  MatchOptions options;
  options.same_triangulation = false;
  return options;
}

/// Straight distances of images from where they should be over the root of the area, ascending.
inline std::vector<double> errors(const SurfaceMatch& found, const TriangleMesh& b,
                                  const std::vector<Eigen::Vector3d>& truth) {
  std::vector<double> result;
  for (std::size_t v = 0; v < truth.size(); ++v) {
    const Eigen::Vector3d place = spacePoint(b.connectivity(), b.positions(), found.images.at(v));
    result.push_back((place - truth[v]).norm() / std::sqrt(b.area()));
  }
  std::sort(result.begin(), result.end());
  return result;
}

inline double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

inline std::vector<Eigen::Vector3d> carried(const Renumbered& other) {
  std::vector<Eigen::Vector3d> truth;
  for (const Index v : other.image) truth.push_back(other.soup.vertices[v]);
  return truth;
}

}  // namespace moduli
