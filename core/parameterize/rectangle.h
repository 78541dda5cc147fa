#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/mesh/connectivity.h"
#include "core/parameterize/parameterization.h"

namespace moduli {

struct RectangleOptions {
  /// Boundary vertices in the order of the boundary, the surface on its left: they go to 0, M,
  /// M + i and i.
  std::array<Index, 4> corners = {kNone, kNone, kNone, kNone};
  bool initial_delaunay = true;  ///< As in PrescribeOptions; both are tried.
  bool refine = true;            ///< As in SphereOptions.
};

/// Fails with kUnsupportedTopology unless the surface can have a map to a rectangle. O(F).
Status checkRectangle(const Connectivity& surface);

/// Maps a connected surface of genus 0 with one boundary loop to the rectangle of height 1 and
/// width M, its modulus as a quadrilateral with these corners (the result's `modulus`).
///
/// The flat metric with right angles at the corners and straight sides, laid out: the identity on
/// flat rectangles. Where that folds faces, the disk's map (parameterizeDisk) goes on to the
/// rectangle instead (RectangleMap), with finer faces where needed. lengths, positions: as
/// parameterizeSphere's. Fails with kUnsupportedTopology, kInvalidOption (corners that are missing,
/// not on the boundary, equal or out of order), kFoldedMap, and as the solvers do. About 8 F.
/// Source: MATH 5.2, 5.7.
Result<Parameterization> parameterizeRectangle(Context& context, const Connectivity& surface,
                                               const std::vector<double>& lengths,
                                               const std::vector<Eigen::Vector3d>& positions,
                                               const RectangleOptions& options);

}  // namespace moduli
