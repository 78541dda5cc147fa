#include "core/mesh/double_cover.h"

#include <limits>
#include <utility>

namespace moduli {
namespace {

// Face f + F holds the mirror images of the corners 0, 2, 1 of face f.
Index mirrorHalfedge(Index h, Index face_count) {
  return 3 * (h / 3 + face_count) + 2 - h % 3;
}

}  // namespace

Result<DoubleCover> doubleCover(const Connectivity& surface) {
  const Index faces = surface.faceCount();
  const Index vertices = surface.vertexCount();
  if (faces > std::numeric_limits<Index>::max() / 6) {
    return Status(Reason::kMeshTooLarge, "the double has too many faces for 32-bit halfedges");
  }
  std::vector<Index> mirror(vertices);
  Index next_vertex = vertices;
  for (Index v = 0; v < vertices; ++v) {
    mirror[v] = surface.isBoundaryVertex(v) ? v : next_vertex++;
  }
  std::vector<Triangle> doubled = surface.faces();
  doubled.reserve(2 * static_cast<std::size_t>(faces));
  for (const Triangle& face : surface.faces()) {
    doubled.push_back({mirror[face[0]], mirror[face[2]], mirror[face[1]]});
  }
  std::vector<Index> twin(6 * static_cast<std::size_t>(faces));
  bool bordered = false;
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    const Index image = mirrorHalfedge(h, faces);
    const Index t = surface.twin(h);
    if (t == kNone) bordered = true;
    twin[h] = t == kNone ? image : t;
    twin[image] = t == kNone ? h : mirrorHalfedge(t, faces);
  }
  if (!bordered) {
    return Status(Reason::kInvalidOption, "a surface without boundary has no double");
  }
  ASSIGN_OR_RETURN(Connectivity connectivity,
                   Connectivity::fromGluing(next_vertex, std::move(doubled), std::move(twin)));
  std::vector<Index> involution(next_vertex);
  for (Index v = 0; v < vertices; ++v) {
    involution[v] = mirror[v];
    involution[mirror[v]] = v;
  }
  std::vector<Index> edge(connectivity.edgeCount());
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    edge[connectivity.edge(h)] = surface.edge(h);
    edge[connectivity.edge(mirrorHalfedge(h, faces))] = surface.edge(h);
  }
  return DoubleCover{std::move(connectivity), std::move(involution), std::move(edge), faces};
}

}  // namespace moduli
