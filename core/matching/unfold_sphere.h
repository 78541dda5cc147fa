#pragma once

#include "core/base/context.h"
#include "core/mesh/triangle_mesh.h"
#include "core/spherical/mobius.h"

namespace moduli {

/// Moves the vertices of folded faces of a map to the sphere until no face is folded: takes them
/// out, and puts each back to where it was, or where faces are least distorted (leastDistorted).
/// Others stay where they are as far as there is room; around them more and more are taken out, at
/// last all. Where anything folds, parts that are smaller on the sphere than kLeastScale are done
/// anew, too: limbs that are too long for the doubles of a conformal map keep that scale, and are
/// distorted instead.
///
/// points: per vertex, unit vectors that cover the sphere once; folded where they are no numbers.
/// pole: of a disk with a cap (DiskRim), whose boundary stays on the equator. The result is the
/// same points where nothing is folded. Fails with kFoldedMap where too little is left of a disk,
/// or where doubles have no room, and with kUnsupportedTopology as RingMesh::make. O(V) where few
/// are folded; where all are O(V log V). Stage: "unfold". Source: Praun and Hoppe 2003 (spheres
/// from progressive meshes).
Result<Points3> unfoldSphere(Context& context, const TriangleMesh& mesh, Points3 points,
                             Index pole = kNone);

}  // namespace moduli
