#include "core/parameterize/components.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "core/parameterize/layout.h"
#include "core/parameterize/overlaps.h"
#include "core/parameterize/packing.h"

namespace moduli {
namespace {

Index halfedgeInWhole(const SurfaceComponent& component, Index h) {
  return 3 * component.faces[Connectivity::faceOf(h)] + h % 3;
}

Result<SurfaceComponent> extract(const Connectivity& surface, const std::vector<double>& lengths,
                                 std::vector<Index> faces, std::vector<Index>& number) {
  std::vector<Index> vertices;
  for (const Index f : faces) {
    vertices.insert(vertices.end(), surface.face(f).begin(), surface.face(f).end());
  }
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  for (std::size_t v = 0; v < vertices.size(); ++v) number[vertices[v]] = static_cast<Index>(v);
  std::vector<Triangle> triangles;
  std::vector<Index> twin;
  for (const Index f : faces) {
    const Triangle& face = surface.face(f);
    triangles.push_back({number[face[0]], number[face[1]], number[face[2]]});
    for (Index h = 3 * f; h < 3 * f + 3; ++h) {
      const Index other = surface.twin(h);
      if (other == kNone) {
        twin.push_back(kNone);
        continue;
      }
      const auto place = std::lower_bound(faces.begin(), faces.end(), Connectivity::faceOf(other));
      twin.push_back(3 * static_cast<Index>(place - faces.begin()) + other % 3);
    }
  }
  ASSIGN_OR_RETURN(Connectivity part, Connectivity::fromGluing(static_cast<Index>(vertices.size()),
                                                               std::move(triangles), twin));
  SurfaceComponent component{std::move(part), {}, std::move(vertices), std::move(faces), {}};
  for (Index e = 0; e < component.surface.edgeCount(); ++e) {
    const Index h = halfedgeInWhole(component, component.surface.halfedge(e));
    component.edges.push_back(surface.edge(h));
    component.lengths.push_back(lengths[surface.edge(h)]);
  }
  return component;
}

/// What of the options is in the component.
FlatOptions optionsWithin(const FlatOptions& options, const SurfaceComponent& component) {
  FlatOptions own = options;
  own.cones.clear();
  for (const Cone& cone : options.cones) {
    const auto place =
        std::lower_bound(component.vertices.begin(), component.vertices.end(), cone.vertex);
    if (place == component.vertices.end() || *place != cone.vertex) continue;
    own.cones.push_back({static_cast<Index>(place - component.vertices.begin()), cone.curvature});
  }
  own.seams.clear();
  if (options.seams.empty()) return own;
  for (const Index e : component.edges) own.seams.push_back(options.seams[e]);
  return own;
}

/// Puts the maps of components together.
class Assembly {
 public:
  Assembly(const Connectivity& surface, const std::vector<SurfaceComponent>& components,
           std::vector<Parameterization> maps)
      : surface_(surface), components_(components), maps_(std::move(maps)) {}

  Parameterization run() {
    gatherFaces();
    gatherVertices();
    gatherCones();
    gatherCertificate();
    return std::move(whole_);
  }

 private:
  struct Piece {
    Index parent;  ///< Of the whole.
    std::size_t component;
    Index face;  ///< Of the component's map.
  };

  /// Faces in the order of the whole, with their points.
  void gatherFaces() {
    std::vector<Piece> pieces;
    std::vector<Index> first_point;
    for (std::size_t n = 0; n < maps_.size(); ++n) {
      const Parameterization& map = maps_[n];
      refined_ = refined_ || map.subdivision;
      const auto count = static_cast<Index>(map.corner.size() / 3);
      for (Index f = 0; f < count; ++f) {
        const Index parent = map.subdivision ? map.subdivision->parent[f] : f;
        pieces.push_back({components_[n].faces[parent], n, f});
      }
      first_point.push_back(static_cast<Index>(whole_.points.size()));
      whole_.points.insert(whole_.points.end(), map.points.begin(), map.points.end());
    }
    std::stable_sort(pieces.begin(), pieces.end(),
                     [](const Piece& a, const Piece& b) { return a.parent < b.parent; });
    for (const Piece& piece : pieces) {
      for (int c = 0; c < 3; ++c) {
        whole_.corner.push_back(first_point[piece.component] +
                                maps_[piece.component].corner[3 * piece.face + c]);
      }
    }
    pieces_ = std::move(pieces);
  }

  /// New vertices after the whole's, component by component.
  void gatherVertices() {
    if (!refined_) return;
    Subdivision& whole = whole_.subdivision.emplace();
    std::vector<Index> first_new;
    for (std::size_t n = 0; n < maps_.size(); ++n) {
      first_new.push_back(surface_.vertexCount() + static_cast<Index>(whole.vertices.size()));
      if (!maps_[n].subdivision) continue;
      for (Subdivision::Vertex vertex : maps_[n].subdivision->vertices) {
        vertex.halfedge = halfedgeInWhole(components_[n], vertex.halfedge);
        whole.vertices.push_back(vertex);
      }
    }
    for (const Piece& piece : pieces_) {
      const SurfaceComponent& component = components_[piece.component];
      const std::optional<Subdivision>& own = maps_[piece.component].subdivision;
      Triangle face = own ? own->faces[piece.face] : component.surface.face(piece.face);
      for (Index& v : face) {
        const Index beyond = v - component.surface.vertexCount();
        v = beyond < 0 ? component.vertices[v] : first_new[piece.component] + beyond;
      }
      whole.faces.push_back(face);
      whole.parent.push_back(piece.parent);
    }
  }

  void gatherCones() {
    ConeDomain& whole = whole_.cones.emplace();
    for (std::size_t n = 0; n < maps_.size(); ++n) {
      if (!maps_[n].cones) continue;
      const ConeDomain& own = *maps_[n].cones;
      for (const Cone& cone : own.cones) {
        whole.cones.push_back({components_[n].vertices[cone.vertex], cone.curvature});
      }
      whole.handle_turns.insert(whole.handle_turns.end(), own.handle_turns.begin(),
                                own.handle_turns.end());
      whole.spread = larger(whole.spread, own.spread);
      whole.spread_before = larger(whole.spread_before, own.spread_before);
    }
  }

  template <typename Number>
  static std::optional<Number> larger(std::optional<Number> a, std::optional<Number> b) {
    return !a ? b : !b ? a : std::max(*a, *b);
  }
  template <typename Number>
  static std::optional<Number> sum(std::optional<Number> a, std::optional<Number> b) {
    return !a ? b : !b ? a : *a + *b;
  }

  void gatherCertificate() {
    MapCertificate& whole = whole_.certificate;
    for (const Parameterization& map : maps_) {
      const MapCertificate& own = map.certificate;
      whole.curvature_residual = larger(whole.curvature_residual, own.curvature_residual);
      whole.gauss_bonnet_residual = larger(whole.gauss_bonnet_residual, own.gauss_bonnet_residual);
      whole.layout_closure = larger(whole.layout_closure, own.layout_closure);
      whole.clamped_fraction = larger(whole.clamped_fraction, own.clamped_fraction);
      whole.holonomy_residual = larger(whole.holonomy_residual, own.holonomy_residual);
      whole.newton_iterations = sum(whole.newton_iterations, own.newton_iterations);
      whole.flips = sum(whole.flips, own.flips);
      if (own.smallest_angle) {
        whole.smallest_angle =
            std::min(whole.smallest_angle.value_or(*own.smallest_angle), *own.smallest_angle);
      }
      whole.mollification = std::max(whole.mollification, own.mollification);
      for (const std::string& warning : own.warnings) {
        if (std::find(whole.warnings.begin(), whole.warnings.end(), warning) ==
            whole.warnings.end()) {
          whole.warnings.push_back(warning);
        }
      }
    }
  }

  const Connectivity& surface_;
  const std::vector<SurfaceComponent>& components_;
  std::vector<Parameterization> maps_;
  std::vector<Piece> pieces_;
  bool refined_ = false;
  Parameterization whole_;
};

/// Side by side: components that may lie on themselves are moved as one.
void pack(const Connectivity& faces, const FlatOptions& options, Parameterization& map) {
  std::vector<Index> twin;
  for (Index h = 0; h < faces.halfedgeCount(); ++h) twin.push_back(faces.twin(h));
  const std::vector<Index> island =
      options.cut_overlaps ? islandsOf(faces, map.corner) : piecesOf(twin);
  packIslands(faces, island, options.margin, map.points, map.corner);
  map.certificate.islands = options.cut_overlaps
                                ? cutOverlaps(faces, map.points, map.corner, options.margin)
                                : 1 + *std::max_element(island.begin(), island.end());
}

}  // namespace

Result<std::vector<SurfaceComponent>> componentsOf(const Connectivity& surface,
                                                   const std::vector<double>& lengths) {
  std::vector<Index> twin;
  for (Index h = 0; h < surface.halfedgeCount(); ++h) twin.push_back(surface.twin(h));
  const std::vector<Index> piece = piecesOf(twin);
  std::vector<std::vector<Index>> faces;
  for (Index f = 0; f < surface.faceCount(); ++f) {
    if (piece[f] == static_cast<Index>(faces.size())) faces.emplace_back();
    faces[piece[f]].push_back(f);
  }
  std::vector<SurfaceComponent> components;
  std::vector<Index> number(surface.vertexCount(), kNone);
  for (std::vector<Index>& own : faces) {
    ASSIGN_OR_RETURN(SurfaceComponent component, extract(surface, lengths, std::move(own), number));
    components.push_back(std::move(component));
  }
  return components;
}

Result<Parameterization> flattenComponents(Context& context, const Connectivity& surface,
                                           const std::vector<double>& lengths,
                                           const FlatOptions& options,
                                           const FlattenComponent& flatten) {
  for (const Cone& cone : options.cones) {
    if (cone.vertex >= 0 && cone.vertex < surface.vertexCount()) continue;
    return Status(Reason::kInvalidOption, "a cone at vertex " + std::to_string(cone.vertex) +
                                              ", and the surface has " +
                                              std::to_string(surface.vertexCount()) + " vertices");
  }
  ASSIGN_OR_RETURN(const std::vector<SurfaceComponent> components, componentsOf(surface, lengths));
  std::vector<Parameterization> maps;
  for (std::size_t n = 0; n < components.size(); ++n) {
    RETURN_IF_ERROR(context.check());
    Result<Parameterization> map =
        flatten(context, components[n], optionsWithin(options, components[n]));
    if (!map.ok() && components.size() > 1) {
      return map.status().withContext("component " + std::to_string(n));
    }
    RETURN_IF_ERROR(map.status());
    maps.push_back(*std::move(map));
  }
  if (maps.size() == 1) return std::move(maps[0]);
  Parameterization whole = Assembly(surface, components, std::move(maps)).run();
  const auto finish = [&](const Connectivity& faces, const std::vector<double>& own_lengths) {
    pack(faces, options, whole);
    whole.certificate.quality = measurePlaneMap(faces, own_lengths, whole.points, whole.corner);
  };
  if (!whole.subdivision) {
    finish(surface, lengths);
    return whole;
  }
  ASSIGN_OR_RETURN(
      const Connectivity faces,
      Connectivity::fromFaces(
          surface.vertexCount() + static_cast<Index>(whole.subdivision->vertices.size()),
          whole.subdivision->faces));
  finish(faces, subdividedLengths(surface, lengths, *whole.subdivision, faces));
  return whole;
}

}  // namespace moduli
