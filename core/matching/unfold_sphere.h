#pragma once

#include "core/base/context.h"
#include "core/mesh/triangle_mesh.h"
#include "core/spherical/mobius.h"

namespace moduli {

/// Moves the few vertices of folded faces of a map to the sphere until no face is folded: takes
/// them out, and puts each back into the kernel of its ring, as near to where it was as that
/// allows. All other vertices stay. points: per vertex, unit vectors that cover the sphere once.
/// pole: of a disk with a cap (DiskRim), whose boundary stays on the equator.
/// Fails with kFoldedMap where too little is left, kUnsupportedTopology as RingMesh::make. O(V).
Result<Points3> unfoldSphere(Context& context, const TriangleMesh& mesh, Points3 points,
                             Index pole = kNone);

}  // namespace moduli
