#include "core/intrinsic/chordal_metric.h"

#include <cmath>
#include <string>

#include "core/base/text.h"

namespace moduli {

Result<std::vector<double>> chordLengths(const IntrinsicSurface& surface) {
  if (surface.geometry == Geometry::kEuclidean) return surface.lengths;
  std::vector<double> chords;
  chords.reserve(surface.lengths.size());
  for (const double length : surface.lengths) {
    chords.push_back(2 * halfChord(surface.geometry, length));
    if (std::isfinite(chords.back())) continue;
    return Status(Reason::kOverflow,
                  "edge " + std::to_string(chords.size() - 1) + " of length " +
                      shortestDouble(length) + " has a chord too long for a double",
                  "cut the faces into smaller ones");
  }
  const Connectivity& c = surface.connectivity;
  for (Index f = 0; f < c.faceCount(); ++f) {
    const TriangleValues sides = {chords[c.edge(3 * f)], chords[c.edge(3 * f + 1)],
                                  chords[c.edge(3 * f + 2)]};
    if (!isBrokenTriangle(sides)) continue;
    return Status(Reason::kUnsupportedContent,
                  "face " + std::to_string(f) +
                      " has no circumscribed circle, and its chords make no triangle",
                  "flip edges until the triangulation is Delaunay: its faces have such circles");
  }
  return chords;
}

}  // namespace moduli
