#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/context.h"
#include "core/mesh/inspect.h"
#include "core/mesh/triangle_soup.h"

namespace moduli {

struct RepairOptions {
  /// Weld exact duplicates, drop faces and vertices that carry nothing, re-orient, split pinches.
  bool repair = false;
  /// Close boundary loops shorter than this fraction of the square root of the area.
  std::optional<double> fill_holes;
};

struct RepairAction {
  std::string action;  ///< For instance "weld vertices", "drop duplicate faces", "fill holes".
  Index count = 0;
};

struct Repaired {
  TriangleSoup soup;
  /// For each vertex of soup the input's (the lowest of welded ones, the same for the copies of a
  /// split one), kNone for one that fills a hole.
  std::vector<Index> input_vertex;
  std::vector<Index> input_face;  ///< For each face of soup the input's, kNone for a new one.
  std::vector<RepairAction> actions;
};

/// Does what the options ask and says what it did; without options returns the soup as it is.
///
/// repair, in this order: weld vertices of exactly equal coordinates where that makes no edge with
/// more than two faces and nothing one-sided; drop faces that repeat a vertex; drop duplicate faces
/// (all but the first); re-orient components whose faces disagree to their lowest face (outwards
/// where they are closed and enclose a volume) if they are orientable; split pinched vertices; drop
/// isolated vertices. fill_holes then closes short loops (see fillHoles) if the soup is a surface.
/// A surface that cannot be repaired (non-manifold edges, non-orientable, non-finite) keeps that
/// defect: the result is never a different surface that merely looks valid. Fails only with
/// kCancelled, kDeadlineExceeded or kInvalidOption (fraction not in (0, inf)). O(n log n).
Result<Repaired> repairSoup(Context& context, const TriangleSoup& soup,
                            const RepairOptions& options);

/// What repairSoup with repair = true would do, without the soup.
Result<std::vector<RepairAction>> proposeRepair(Context& context, const TriangleSoup& soup);

}  // namespace moduli
