#pragma once

#include "core/base/context.h"
#include "core/mesh/triangle_mesh.h"
#include "core/spherical/mobius.h"

namespace moduli {

/// A disk closed by a cap: a last vertex, the pole, in space at the mean of the boundary, and a
/// face from each edge of the boundary to it, behind all others. Fails as TriangleMesh::fromSoup
/// does. disk: with one boundary loop. O(F).
Result<TriangleMesh> cappedDisk(const TriangleMesh& disk);

/// A conformal map of a disk to the northern half of the sphere without folded faces: the robust
/// map to the disk, and the few vertices at faces that it folds moved. Where that fails, the same
/// from the other starting triangulation; the linear map; at last Tutte's, which is not conformal.
/// Per vertex of cappedDisk(disk), whose pole is at the south pole: as DiskRim asks for.
/// disk: no edge inside joins two vertices of the boundary, and every face has a corner inside.
/// capped: cappedDisk of it. Fails with kFoldedMap, and as mapToIdealDisk and mollify do.
Result<Points3> conformalHemisphere(Context& context, const TriangleMesh& disk,
                                    const TriangleMesh& capped, bool initial_delaunay);

/// Puts the boundary on the equator, to the last bit, and the pole where it belongs; and moves the
/// vertices of faces that fold. Fails with kFoldedMap.
Result<Points3> unfoldHemisphere(Context& context, const TriangleMesh& capped, Points3 points);

}  // namespace moduli
