#pragma once

#include <complex>
#include <vector>

#include "core/intrinsic/flat_charts.h"

namespace moduli {

/// The faces of a flat surface side by side in one plane, each where a tree of faces puts it.
struct Unfolding {
  std::vector<std::complex<double>> placed;  ///< Per halfedge the position of its tail.
  /// Per halfedge: whether the tree crosses it, so that its two faces fit along it.
  std::vector<bool> crossed;
};

/// Unfolds charts face by face across the longest edges first (Prim's tree): short ones pass a
/// direction on badly. twin: per halfedge, kNone on the boundary. skip: per face, faces to be left
/// out; empty: none. The other faces are to be connected. The longest edge lies on the real axis
/// from 0. O(F log F).
Unfolding unfold(const FlatCharts& charts, const std::vector<Index>& twin,
                 const std::vector<bool>& skip = {});

/// The largest distance of what two faces make of an end of an edge between them, for edges where
/// `fits` holds, in units of the edge's length (of the mean length, where it is shorter than a
/// millionth of that). fits: per halfedge. O(F).
double unfoldingGap(const Unfolding& unfolding, const FlatCharts& charts,
                    const std::vector<Index>& twin, const std::vector<bool>& fits);

}  // namespace moduli
