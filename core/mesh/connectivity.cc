#include "core/mesh/connectivity.h"

#include <limits>
#include <string>
#include <utility>

#include "core/base/text.h"
#include "core/mesh/edge_groups.h"

namespace moduli {
namespace {

constexpr const char* kInspectHint = "`moduli inspect` lists every defect";
constexpr const char* kRepairHint = "--repair may mend it";

std::string edgeName(const std::vector<Triangle>& faces, Index h) {
  return "edge (" + std::to_string(faces[h / 3][h % 3]) + ", " +
         std::to_string(faces[h / 3][(h % 3 + 1) % 3]) + ")";
}

Status checkFaces(Index vertex_count, const std::vector<Triangle>& faces) {
  if (faces.empty()) return {Reason::kEmpty, "the surface has no faces"};
  if (faces.size() > std::numeric_limits<Index>::max() / 3) {
    return {Reason::kMeshTooLarge, std::to_string(faces.size()) + " faces exceed 32-bit halfedges"};
  }
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (const Index v : faces[f]) {
      if (v >= 0 && v < vertex_count) continue;
      return {Reason::kIndexOutOfRange, "face " + std::to_string(f) + " uses vertex " +
                                            std::to_string(v) + " of " +
                                            std::to_string(vertex_count)};
    }
  }
  return {};
}

Status checkNoRepeatedVertex(const std::vector<Triangle>& faces) {
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (!repeatsVertex(faces[f])) continue;
    return {Reason::kDegenerateFace, "face " + std::to_string(f) + " repeats a vertex",
            kRepairHint};
  }
  return {};
}

Status crowdedEdge(const std::vector<Triangle>& faces, std::span<const Index> halfedges) {
  std::vector<int> at;
  for (const Index h : halfedges) at.push_back(h / 3);
  return {Reason::kNonManifoldEdge,
          edgeName(faces, halfedges[0]) + " has " + std::to_string(at.size()) +
              " faces: " + listSome(at, at.size()),
          kInspectHint};
}

}  // namespace

Result<Connectivity> Connectivity::fromFaces(Index vertex_count, std::vector<Triangle> faces) {
  RETURN_IF_ERROR(checkFaces(vertex_count, faces));
  RETURN_IF_ERROR(checkNoRepeatedVertex(faces));
  const EdgeGroups edges = groupEdges(vertex_count, faces);
  for (std::size_t k = 0; k < edges.count(); ++k) {
    if (edges.group(k).size() > 2) return crowdedEdge(faces, edges.group(k));
  }
  Connectivity surface;
  surface.faces_ = std::move(faces);
  surface.twin_.assign(3 * surface.faces_.size(), kNone);
  for (std::size_t k = 0; k < edges.count(); ++k) {
    if (edges.group(k).size() < 2) continue;
    const Index a = edges.group(k)[0];
    const Index b = edges.group(k)[1];
    if (surface.tail(a) == surface.tail(b)) {
      return Status(Reason::kInconsistentOrientation,
                    "faces " + std::to_string(a / 3) + " and " + std::to_string(b / 3) +
                        " run through " + edgeName(surface.faces_, a) + " in the same direction",
                    kRepairHint);
    }
    surface.twin_[a] = b;
    surface.twin_[b] = a;
  }
  RETURN_IF_ERROR(surface.finish(vertex_count));
  return surface;
}

Result<Connectivity> Connectivity::fromGluing(Index vertex_count, std::vector<Triangle> faces,
                                              std::vector<Index> twin) {
  RETURN_IF_ERROR(checkFaces(vertex_count, faces));
  if (twin.size() != 3 * faces.size()) {
    return Status(Reason::kInvalidOption, "the gluing has " + std::to_string(twin.size()) +
                                              " entries for " + std::to_string(3 * faces.size()) +
                                              " halfedges");
  }
  Connectivity surface;
  surface.faces_ = std::move(faces);
  surface.twin_ = std::move(twin);
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    const Index t = surface.twin_[h];
    if (t == kNone) continue;
    const bool in_range = t >= 0 && t < surface.halfedgeCount();
    if (!in_range || t == h || surface.twin_[t] != h || surface.tail(t) != surface.head(h) ||
        surface.tail(h) != surface.head(t)) {
      return Status(
          Reason::kInvalidOption,
          "halfedge " + std::to_string(h) + " cannot be glued to halfedge " + std::to_string(t));
    }
  }
  RETURN_IF_ERROR(surface.finish(vertex_count));
  return surface;
}

// Numbers the edges, finds an outgoing halfedge per vertex and checks that one fan is all there is.
Status Connectivity::finish(Index vertex_count) {
  edge_.resize(twin_.size());
  edge_halfedge_.reserve(twin_.size() / 2 + 1);
  outgoing_.assign(vertex_count, kNone);
  std::vector<Index> degree(vertex_count, 0);
  for (Index h = 0; h < halfedgeCount(); ++h) {
    if (twin_[h] == kNone || twin_[h] > h) {
      edge_[h] = edgeCount();
      edge_halfedge_.push_back(h);
    } else {
      edge_[h] = edge_[twin_[h]];
    }
    const Index v = tail(h);
    ++degree[v];
    if (outgoing_[v] == kNone || (twin_[h] == kNone && !isBoundaryVertex(v))) outgoing_[v] = h;
  }
  edge_halfedge_.shrink_to_fit();

  for (Index v = 0; v < vertex_count; ++v) {
    if (outgoing_[v] == kNone) {
      return {Reason::kNonManifoldVertex, "vertex " + std::to_string(v) + " has no faces"};
    }
    Index fan = 1;
    for (Index h = rotate(outgoing_[v]); h != kNone && h != outgoing_[v]; h = rotate(h)) ++fan;
    if (fan == degree[v]) continue;
    return {
        Reason::kNonManifoldVertex,
        "vertex " + std::to_string(v) + " pinches the surface: several fans of faces meet there",
        kRepairHint};
  }
  return {};
}

}  // namespace moduli
