#pragma once

#include "core/mesh/sample_tools.h"
#include "core/mesh/triangle_soup.h"

/// Deformations of space or of surfaces, as a place in shape retrieval has them. Connectivity and
/// numbering stay. Lengths are in model units.
namespace moduli {

/// Diagonal of the bounding box.
double boundingDiagonal(const TriangleSoup& soup);

/// Turned, scaled by 1/4 to 4 and moved at random, with vertices and faces in another order and
/// faces starting at other corners.
TriangleSoup movedAndRenumbered(const TriangleSoup& soup, SampleRandom& random);

/// Every coordinate of every vertex with a Gaussian error of this standard deviation.
TriangleSoup withNoise(const TriangleSoup& soup, double deviation, SampleRandom& random);

/// Bent around a cylinder along its longest principal axis, by up to `angle` radians in all; no
/// length changes by more than the share `strain`.
TriangleSoup bent(const TriangleSoup& soup, double angle, double strain, SampleRandom& random);

/// With a Gaussian bump of this height and deviation at a random vertex, along its normal.
TriangleSoup bulged(const TriangleSoup& soup, double height, double deviation,
                    SampleRandom& random);

/// Inverted in a sphere whose centre stands `gap` radii of the bounding sphere away from that, then
/// mirrored in a plane, so that orientation stays.
TriangleSoup inverted(const TriangleSoup& soup, double gap, SampleRandom& random);

/// Three or four limbs turned about their joints by 25 to 40 degrees: a limb is what lies within
/// some distance, along the surface, of a tip far from the other tips, its joint the centre of its
/// end. The turn sets in smoothly. Where it would stretch or shrink one edge in fifty by more than
/// half, all turns are made smaller until they do not. O(F log F).
TriangleSoup articulated(const TriangleSoup& soup, SampleRandom& random);

}  // namespace moduli
