#include "server/service/seams.h"

#include <string>

#include "server/service/named_vertex.h"

namespace moduli {
namespace {

/// Marks the edges that join two vertices; returns whether there is one.
bool markEdges(const Connectivity& surface, Index from, Index to, std::vector<bool>& marked) {
  bool any = false;
  const Index first = surface.outgoing(from);
  for (Index h = first; h != kNone;) {
    // The halfedge, and the one that comes in before it: on a boundary that one has no twin.
    const Index side = Connectivity::previous(h);
    if (surface.head(h) == to) any = marked[surface.edge(h)] = true;
    if (surface.tail(side) == to) any = marked[surface.edge(side)] = true;
    h = surface.rotate(h);
    if (h == first) break;
  }
  return any;
}

}  // namespace

Result<std::vector<bool>> seamsOnSurface(
    const google::protobuf::RepeatedPtrField<v1::SeamPath>& seams, const Connectivity& surface,
    const VertexPlaces& places) {
  if (seams.empty()) return std::vector<bool>();
  std::vector<bool> marked(surface.edgeCount(), false);
  for (const v1::SeamPath& seam : seams) {
    Index from = kNone;
    for (int n = 0; n < seam.vertices_size(); ++n) {
      ASSIGN_OR_RETURN(const Index to, namedVertex("a seam", seam.vertices(n), places));
      if (n > 0 && !markEdges(surface, from, to, marked)) {
        return Status(Reason::kInvalidOption,
                      "a seam from vertex " + std::to_string(seam.vertices(n - 1)) + " to vertex " +
                          std::to_string(seam.vertices(n)) + ", which no edge joins",
                      "name all vertices along the way");
      }
      from = to;
    }
  }
  return marked;
}

}  // namespace moduli
