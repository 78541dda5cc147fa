#pragma once

#include "core/base/context.h"
#include "core/matching/relaxation.h"

/// From the map of a coarse mesh to that of the whole.
namespace moduli {

/// A face with more than this many times the energy of an isometry is wild: it is stretched by 7 or
/// more.
inline constexpr double kWild = 25;

struct RefinementOptions {
  int sweeps = 12;          ///< Over all vertices, at most, whenever there are twice as many.
  double tolerance = 2e-3;  ///< As Relaxation::relaxAll's.
  double wildest = kWild;   ///< Faces beyond are taken out and put back (repairMap).
};

/// Whether positive faces cover the sphere once, and not several times. O(V).
bool coversOnce(const Relaxation& map);

/// Whether all faces are tame (Relaxation::isTame). O(V).
bool isAllTame(const Relaxation& map, double wildest);

/// Takes away vertices until all faces are tame and cover the sphere once. False where that does
/// not come about; the mesh is then of no use. As thinUntil.
bool thinUntilTame(Relaxation& map, double wildest = kWild);

/// Puts vertices back into the map's mesh until there are `wanted`, each where it costs least in
/// the kernel of its ring. Fails with kFoldedMap where a vertex finds no place among doubles, not
/// even when others are taken out again.
Status restoreVertices(Context& context, Relaxation& map, Index wanted);

/// The same, and relaxes all whenever there are twice as many.
Status restoreVertices(Context& context, Relaxation& map, Index wanted,
                       const RefinementOptions& options);

/// Takes out what is stuck in wild faces and puts it back where there is room; keeps what lowers
/// the energy.
Status repairMap(Context& context, Relaxation& map, const RefinementOptions& options);

}  // namespace moduli
