#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/mesh/connectivity.h"

namespace moduli {

/// A triangulation of a Euclidean surface, whose faces may share several edges.
struct RefinedSurface {
  Connectivity surface;         ///< The given vertices first, under their numbers.
  std::vector<double> lengths;  ///< Per edge, proper triangles.
};

struct RefineOptions {
  double longest = 0;      ///< Edges longer than this are cut; > 0.
  Index most_added = 1e5;  ///< Faces: cutting ends before it makes more.
};

/// The same polyhedral surface in an intrinsic Delaunay triangulation with short edges:
///
///   ASSIGN_OR_RETURN(const RefinedSurface finer,
///                    refineDelaunay(context, surface, lengths, {.longest = 0.1}));
///
/// All edges over a limit are halved at once, the limit itself from the longest edge down to
/// `longest`, and made Delaunay by flips in between; a face with two of them has its third one
/// halved too, so that nothing is a matter of numbering but the diagonals of cocircular points.
/// Edges along which many needles lie side by side are all cut, wherefore the number of added faces
/// is limited. lengths: per edge, proper triangles. O(F log(longest edge / longest)) for the faces
/// of the result. Fails with kInvalidOption, kNoConvergence (rounding keeps flips from ending),
/// kCancelled and kDeadlineExceeded.
Result<RefinedSurface> refineDelaunay(Context& context, const Connectivity& surface,
                                      const std::vector<double>& lengths,
                                      const RefineOptions& options);

/// The same polyhedral surface in space with short edges: as above, but in its own faces, without
/// flips.
struct RefinedMesh {
  Connectivity surface;
  std::vector<double> lengths;             ///< Per edge, proper triangles.
  std::vector<Eigen::Vector3d> positions;  ///< Per vertex.
};
Result<RefinedMesh> refineInSpace(Context& context, RefinedMesh mesh, const RefineOptions& options);

}  // namespace moduli
