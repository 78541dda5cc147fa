#pragma once

#include <cstddef>

#include "core/base/status.h"
#include "core/mesh/sample_tools.h"
#include "core/mesh/triangle_soup.h"

/// Other triangulations of a surface. All take and give oriented manifolds, and keep the topology.
namespace moduli {

/// About `faces` faces: edges collapsed in the order of their quadric error (Garland and Heckbert,
/// 1997), never where that would change the topology or turn a face over. May stop early for these
/// reasons. Unchanged if there are no more faces to begin with. O(F log F).
TriangleSoup simplified(const TriangleSoup& soup, std::size_t faces);

/// Half as many faces again: the longest edges split at uneven places, all vertices moved within
/// their faces, and edges flipped where the surface is nearly flat and that makes angles larger.
/// soup: closed. O(F log F).
TriangleSoup refinedUnevenly(const TriangleSoup& soup, SampleRandom& random);

/// Without a disk of faces of about this share of the area. Fails with kInternal if the surface has
/// no such disk.
Result<TriangleSoup> punched(const TriangleSoup& soup, double share, SampleRandom& random);

}  // namespace moduli
