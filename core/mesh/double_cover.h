#pragma once

#include <vector>

#include "core/mesh/connectivity.h"

namespace moduli {

/// A closed surface made of two copies of a bordered one, glued along the boundary.
struct DoubleCover {
  Connectivity connectivity;  ///< A Δ-complex: an edge between boundary vertices may be doubled.
  std::vector<Index> involution;  ///< Per vertex its mirror image; itself on the boundary.
  std::vector<Index> edge;        ///< Per edge of the double the edge of the original.
  Index face_count = 0;  ///< Faces [0, face_count) are the original's, the rest their mirrors.
};

/// Doubles a surface. The first copy keeps its numbering; face f + face_count is face f mirrored,
/// its corners in the order 0, 2, 1. The double of genus g with b loops has genus 2 g + b - 1 (one
/// component per component). Fails with kInvalidOption if there is no boundary. O(V + F). Source:
/// MATH 1.
Result<DoubleCover> doubleCover(const Connectivity& surface);

}  // namespace moduli
