#pragma once

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "core/forms/cotan.h"
#include "core/intrinsic/mollify.h"
#include "core/mesh/triangle_mesh.h"
#include "core/signature/surface_modes.h"
#include "tests/core/testing.h"

namespace moduli::surfaces {

/// Proper lengths of moderate size, as descriptors want them.
inline std::vector<double> properLengths(const TriangleMesh& mesh) {
  auto metric = mollify(mesh.connectivity(), mesh.edgeLengths());
  EXPECT_OK(metric);
  return unitLengths(metric->lengths);
}

inline SurfaceModes modesOf(const TriangleMesh& mesh, double edges_per_wave = kEdgesPerWave) {
  Context context;
  auto modes = surfaceModes(context, mesh.connectivity(), properLengths(mesh), edges_per_wave);
  EXPECT_OK(modes);
  return *std::move(modes);
}

}  // namespace moduli::surfaces
