#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/intrinsic/chordal_metric.h"
#include "core/parameterize/hyperbolic.h"
#include "tests/core/hyperbolic/hexagon_pants.h"
#include "tests/core/hyperbolic/uniformized_samples.h"
#include "tests/core/parameterize/disk_checks.h"

/// Surfaces and their maps to the disk, for the tests of these.
namespace moduli {

/// The chords of a surface that is given hyperbolic.
inline MetricSurface chordsOf(const IntrinsicSurface& given) {
  const auto lengths = chordLengths(given);
  EXPECT_OK(lengths);
  return {given.connectivity, *lengths};
}

inline Result<Parameterization> mapped(const MetricSurface& given,
                                       const HyperbolicOptions& options = {}) {
  Context context;
  return parameterizeHyperbolic(context, given.surface, given.lengths, options);
}

/// The faces that a map is of.
inline Connectivity mappedFaces(const MetricSurface& given, const Parameterization& map) {
  if (!map.subdivision) return given.surface;
  const auto vertices =
      given.surface.vertexCount() + static_cast<Index>(map.subdivision->vertices.size());
  auto faces = Connectivity::fromFaces(vertices, map.subdivision->faces);
  EXPECT_OK(faces);
  return *std::move(faces);
}

inline std::vector<double> lengthsOf(const Parameterization& map) {
  std::vector<double> lengths;
  for (const GeodesicPath& path : map.hyperbolic->geodesics) lengths.push_back(path.length);
  return lengths;
}

inline void expectNear(const std::vector<double>& found, const std::vector<double>& expected,
                       double tolerance) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_NEAR(found[i], expected[i], tolerance) << "entry " << i;
  }
}

}  // namespace moduli
