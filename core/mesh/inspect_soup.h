#pragma once

#include <vector>

#include "core/mesh/inspect.h"
#include "core/mesh/soup_structure.h"

namespace moduli {

/// inspectSoup with the structure of the soup at hand.
Result<Inspection> inspectStructure(Context& context, const TriangleSoup& soup,
                                    const SoupStructure& structure);

/// Per face: has the same three vertices as an earlier face, in any order. Faces that repeat a
/// vertex are not looked at. O(F), but O(d log d) at an edge with d faces.
std::vector<bool> findDuplicateFaces(const std::vector<Triangle>& faces,
                                     const SoupStructure& structure);

}  // namespace moduli
