#pragma once

#include <complex>
#include <optional>
#include <string>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/mesh/connectivity.h"
#include "core/ricci/scheme.h"
#include "core/ricci/target_curvature.h"

/// Flat metrics with prescribed curvature, laid out in the plane.
namespace moduli {

struct FlatOptions {
  std::vector<Cone> cones;  ///< All other interior vertices are flat.
  BoundaryRule boundary = BoundaryRule::kFree;
  Scheme scheme = Scheme::kVertexScaling;
  RicciSolver solver = RicciSolver::kNewton;
  bool initial_delaunay = true;  ///< Isometric Delaunay flips first (vertex scaling only).
};

/// What judges a flat parameterization; computed from the final numbers.
struct FlatCertificate {
  double curvature_residual = 0;     ///< max |K - target|, radians, less its mean.
  double gauss_bonnet_residual = 0;  ///< |sum K + curvature * area - 2 pi chi|.
  double layout_closure = 0;         ///< Largest gap along an edge that is no seam, in its lengths.
  int flipped_faces = 0;
  double max_dilatation = 1;   ///< Per face, of the linear map to the plane; at least 1.
  double mean_dilatation = 1;  ///< Weighted by area.
  int newton_iterations = 0;
  int flips = 0;
  double smallest_angle = 0;  ///< Of the final metric's triangulation, radians.
  double mollification = 0;
  std::optional<double> clamped_fraction;  ///< Edges whose intersection angle was clamped.
  std::vector<std::string> warnings;
};

/// A map of the faces of a surface to the plane, continuous but for seams.
struct FlatParameterization {
  /// The images of corners, each as often as the seams cut it, scaled to the surface's area.
  std::vector<std::complex<double>> points;
  std::vector<Index> corner;  ///< Per halfedge h: the point of tail(h) in its face.
  FlatCertificate certificate;
};

/// Finds the discrete conformal metric that is flat but for the given cones and lays it out along a
/// cut graph through them. lengths: per edge, positive up to rounding (mollified if need be).
///
/// Fails with kInvalidOption (a cone's vertex does not exist or is named twice; a curvature of 2 pi
/// or more inside, of pi or more on the boundary; a sum that breaks Gauss and Bonnet: the message
/// says by how much), kNoConvergence where a scheme with fixed triangles has no such metric (the
/// hint names vertex scaling, which has), kFoldedMap naming how many faces fold, and as the solvers
/// do. About 8 F. Stages "delaunay", "analyse", "factorize", "solve", "metric", "layout".
Result<FlatParameterization> parameterizeFlat(Context& context, const Connectivity& surface,
                                              const std::vector<double>& lengths,
                                              const FlatOptions& options);

}  // namespace moduli
