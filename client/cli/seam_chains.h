#pragma once

#include <vector>

#include "client/cli/map_drawing.h"
#include "core/picture/image.h"

/// The layout of a map to the plane: its islands and its seams.
namespace moduli::cli {

/// Edges that are drawn in one colour.
struct EdgeGroup {
  Color color;
  std::vector<int> edges;  ///< Of the drawing.
};

/// Seams as chains between the points where they meet, branch or end; both sides of a chain have
/// one colour, that of the surface's edges. Few enough colours to tell apart: they come again.
/// O(E log E).
std::vector<EdgeGroup> seamChains(const MapDrawing& drawing);

/// For every face the number of its island: faces that hang together by points of the image; -1
/// where it is not mapped. They are counted by their first faces. O(F).
std::vector<int> findIslands(const MapDrawing& drawing);

/// A light colour for an island.
Color islandColor(int island);

}  // namespace moduli::cli
