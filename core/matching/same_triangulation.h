#pragma once

#include <vector>

#include "core/base/context.h"
#include "core/mesh/connectivity.h"

namespace moduli {

/// The ways in which two connected triangulations differ by their numbering alone: per vertex of a
/// the one of b such that faces go to faces, turned alike (with `mirror`, turned over). Mostly none
/// or one; several where the triangulation has symmetries. That a mesh and another pose of it, or
/// two fits of one template, have the same triangulation is no accident beyond some dozen irregular
/// vertices.
///
/// Halfedges are told apart by what surrounds them, ring by ring; the rarest kind is tried on all
/// of its kind. None either where the rarest kind has more than 64 halfedges, as in regular grids.
/// Fails with kCancelled and kDeadlineExceeded. O(F log F), and O(F) a way.
Result<std::vector<std::vector<Index>>> sameTriangulations(Context& context, const Connectivity& a,
                                                           const Connectivity& b,
                                                           bool mirror = false);

}  // namespace moduli
