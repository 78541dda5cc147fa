#pragma once

#include "core/base/context.h"
#include "core/matching/cover_map.h"
#include "core/matching/homeomorphism.h"
#include "core/matching/thinned_surface.h"

namespace moduli {

/// Of Newton's step, in sweeps over all vertices. Between 1, which is best for errors from vertex
/// to vertex, and 2, which is best for smooth ones (Young 1954).
inline constexpr double kOverRelaxation = 1.8;

/// From the map of a thinned sphere to that of the whole: its vertices come back in reverse order,
/// each where it costs least in the kernel of its ring, and all relax whenever there are about
/// twice as many. No face folds. What is smooth has been settled before, on few vertices; what
/// comes back is near its ring, which few sweeps even out.
///
/// thinned: of a. points: per vertex of thinned.mesh on the sphere
/// of b, none of its faces folded. Returns points per vertex of the whole. Fails with kFoldedMap
/// (a vertex finds no place among doubles), kCancelled and kDeadlineExceeded. O(V). Stage: "whole".
Result<Points3> mapWhole(Context& context, const ThinnedSurface& thinned, const TriangleMesh& a,
                         const SphericalTarget& b, const Points3& points);

/// The same for surfaces with handles. a: the whole. map: of thinned.mesh to the cover of b; the
/// result is in its homotopy class.
Result<CoverMap> mapWhole(Context& context, const ThinnedSurface& thinned, const TriangleMesh& a,
                          const TriangleMesh& b, const CoverSurface& cover, const CoverMap& map);

}  // namespace moduli
