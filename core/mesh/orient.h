#pragma once

#include "core/mesh/soup_structure.h"
#include "core/mesh/triangle_soup.h"

namespace moduli {

/// Turns faces round until each orientable sheet whose faces disagree agrees with its lowest face,
/// or, where it is closed and encloses a volume, points outwards. Other sheets stay as they are:
/// one that is wholly inside out is a surface in its own right. A turned face keeps its first
/// corner. structure: of this soup. Returns how many faces were turned. O(F).
Index orientFaces(TriangleSoup& soup, const SoupStructure& structure);

}  // namespace moduli
