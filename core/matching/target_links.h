#pragma once

#include <vector>

#include "core/base/context.h"
#include "core/matching/boundary_map.h"
#include "core/matching/cover_map.h"

namespace moduli {

/// The homotopy class that places of vertices determine.
struct TargetLinks {
  CoverMap map;                ///< At the targets, or where a neighbour's was taken instead.
  std::vector<bool> replaced;  ///< Per vertex: whether its target contradicted its neighbours'.
  double closure = 0;          ///< Of the products around faces, from 1.
  double area = 0;             ///< That the targets cover.
  double degree = 0;           ///< That over the other surface's area: whole up to rounding.
  /// Of surfaces with boundary, per vertex: HarmonicOptions::slides for linksOf the map.
  std::vector<Eigen::Vector2d> slides = {};
};

/// Per edge where points within it go, from the tail of its halfedge (Connectivity::halfedge) on.
using EdgeWays = std::vector<std::vector<SurfacePoint>>;

/// Joins the targets of neighbouring vertices by short paths along edges of the other surface.
/// Where the paths around every face close, this is a homomorphism of the fundamental groups,
/// whatever the marking: its relation holds. Vertices at most of whose faces they do not close, and
/// those too far from their neighbours' targets for a search, get the target of the nearest vertex
/// that is not so; faces that are open after that are closed by closeLinks.
///
/// targets: per vertex of `surface`. Fails with kInvalidOption (a target not on the surface),
/// kUnsupportedTopology (a surface of another genus), with kNoConvergence where faces remain open
/// and where the degree is not 1, the message naming it: only degree 1 makes the homomorphism one
/// to one (-1: a mirror image), and as the context does. Some 50 steps of the search an edge. Stage
/// "homotopy". Source: MATH 9.4; Kneser 1930 (degree).
///
/// ways: of edges, through whose points paths go while both ends keep their targets: short steps do
/// not mistake one side of a thin limb for the other.
Result<TargetLinks> linkTargets(Context& context, const Connectivity& surface,
                                const CoverSurface& cover, std::vector<SurfacePoint> targets,
                                const EdgeWays& ways = {});

/// The same for surfaces with boundary, the other one being half of its double. Targets of the
/// boundary are those of `boundary`; they are not replaced.
///
/// cover: of the double of B, whose first copy is numbered as B. targets: per vertex of A, on B.
/// Fails as linkTargets does.
Result<TargetLinks> linkBordered(Context& context, const Connectivity& surface,
                                 const Connectivity& b, const CoverSurface& cover,
                                 const BoundaryMap& boundary, std::vector<SurfacePoint> targets);

}  // namespace moduli
