#include "core/intrinsic/assemble_surface.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include "core/base/text.h"
#include "core/mesh/disjoint_sets.h"
#include "core/mesh/soup_structure.h"
#include "core/topology/surface_topology.h"

namespace moduli {
namespace {

/// How far two statements of one length may differ, as a fraction of it.
constexpr double kSameLength = 1e-12;
/// Faces after which the context is asked.
constexpr Index kCheckInterval = Index{1} << 16;

constexpr const char* kGluingHint =
    "entry c of face f is the halfedge opposite to halfedge 3 f + c, which runs from corner c to "
    "the next one; -1 is the boundary";

std::string halfedgeName(Index h) {
  return "halfedge " + std::to_string(h) + " (face " + std::to_string(h / 3) + ", corner " +
         std::to_string(h % 3) + ")";
}

std::string endsName(Index from, Index to) {
  return "from vertex " + std::to_string(from) + " to vertex " + std::to_string(to);
}

Index tailOf(const SurfaceTables& tables, Index h) {
  return tables.faces[h / 3][h % 3];
}

Index headOf(const SurfaceTables& tables, Index h) {
  return tailOf(tables, Connectivity::next(h));
}

Status checkCounts(const SurfaceTables& tables) {
  constexpr std::size_t kMostFaces = std::numeric_limits<Index>::max() / 3;
  const std::size_t count = tables.faces.size();
  if (count == 0) {
    return {Reason::kEmpty, "the surface has no faces", "give at least one triangle"};
  }
  if (count > kMostFaces) {
    return {Reason::kMeshTooLarge, std::to_string(count) + " faces exceed 32-bit halfedges",
            "simplify the surface"};
  }
  if (tables.vertex_count > static_cast<std::int64_t>(3 * count)) {
    return {Reason::kCountTooLarge,
            "there are " + std::to_string(tables.vertex_count) + " vertices, but the " +
                std::to_string(count) + " faces have " + std::to_string(3 * count) + " corners",
            "count the vertices that faces use"};
  }
  for (std::size_t f = 0; f < count; ++f) {
    for (std::size_t c = 0; c < 3; ++c) {
      const Index v = tables.faces[f][c];
      if (v >= 0 && v < tables.vertex_count) continue;
      return {Reason::kIndexOutOfRange,
              "corner " + std::to_string(c) + " of face " + std::to_string(f) + " is vertex " +
                  std::to_string(v) + ", but there are " + std::to_string(tables.vertex_count) +
                  " vertices",
              "vertices are counted from 0"};
    }
  }
  return {};
}

/// The faces' sides are 2 f (as stated) and 2 f + 1 (turned over). Gluing joins sides; a face whose
/// two sides come together lies on a one-sided surface.
Index faceOnOneSidedSurface(const SurfaceTables& tables, const std::vector<Index>& twin) {
  const auto count = static_cast<Index>(tables.faces.size());
  DisjointSets sides(2 * count);
  for (Index h = 0; h < 3 * count; ++h) {
    const Index t = twin[h];
    if (t < h) continue;
    const Index turned = tailOf(tables, t) == headOf(tables, h) ? 0 : 1;
    sides.join(2 * (h / 3), 2 * (t / 3) + turned);
    sides.join(2 * (h / 3) + 1, 2 * (t / 3) + 1 - turned);
  }
  for (Index f = 0; f < count; ++f) {
    if (sides.root(2 * f) == sides.root(2 * f + 1)) return f;
  }
  return kNone;
}

Status oneSided(Index face) {
  return {Reason::kNonOrientable,
          "the surface is one-sided: it holds face " + std::to_string(face) +
              ", and no choice of directions makes all faces agree",
          "cut it open along a loop, or give its double cover"};
}

Status sameDirection(Index h, Index t) {
  return {Reason::kInconsistentOrientation,
          halfedgeName(h) + " and " + halfedgeName(t) + " are glued in the same direction",
          "list the vertices of one of the two faces the other way round, with its gluing and "
          "lengths"};
}

/// An opposite halfedge must point back. Both ends may fit in the same direction instead: then the
/// faces disagree, which is judged when all the rest is sound.
Status checkTwin(const SurfaceTables& tables, Index h) {
  const std::vector<Index>& twin = *tables.twin;
  const Index t = twin[h];
  if (t == kNone) return {};
  if (t < 0 || t >= static_cast<Index>(twin.size())) {
    return {Reason::kIndexOutOfRange,
            halfedgeName(h) + " is glued to halfedge " + std::to_string(t) + " of " +
                std::to_string(twin.size()),
            kGluingHint};
  }
  if (t == h) return {Reason::kInvalidGluing, halfedgeName(h) + " is glued to itself", kGluingHint};
  if (twin[t] != h) {
    return {Reason::kInvalidGluing,
            halfedgeName(h) + " is glued to " + halfedgeName(t) + ", but that one to " +
                (twin[t] == kNone ? "none" : "halfedge " + std::to_string(twin[t])),
            kGluingHint};
  }
  const Index from = tailOf(tables, h), to = headOf(tables, h);
  const Index twin_from = tailOf(tables, t), twin_to = headOf(tables, t);
  if ((twin_from == to && twin_to == from) || (twin_from == from && twin_to == to)) return {};
  return {Reason::kInvalidGluing,
          halfedgeName(h) + " runs " + endsName(from, to) + ", but " + halfedgeName(t) +
              " to which it is glued " + endsName(twin_from, twin_to),
          "glued halfedges join the same two vertices in opposite directions"};
}

Status checkGluing(const SurfaceTables& tables) {
  const std::vector<Index>& twin = *tables.twin;
  Index disagreeing = kNone;
  for (Index h = 0; h < static_cast<Index>(twin.size()); ++h) {
    RETURN_IF_ERROR(checkTwin(tables, h));
    if (twin[h] == kNone || tailOf(tables, twin[h]) == headOf(tables, h)) continue;
    if (disagreeing == kNone) disagreeing = h;
  }
  if (disagreeing == kNone) return {};
  const Index face = faceOnOneSidedSurface(tables, twin);
  return face == kNone ? sameDirection(disagreeing, twin[disagreeing]) : oneSided(face);
}

/// What the faces alone do not tell, in the words of who states a gluing.
Status explainConnectivity(const Status& status) {
  switch (status.reason()) {
    case Reason::kDegenerateFace:
      return {status.reason(), status.message(),
              "loops need a gluing that says which halfedges are opposite"};
    case Reason::kNonManifoldEdge:
      return {status.reason(), status.message(),
              "state the gluing: double edges need it, and an edge has two faces at most"};
    case Reason::kInconsistentOrientation:
      return {status.reason(), status.message(),
              "list the vertices of one of the two faces the other way round, with its lengths"};
    case Reason::kNonManifoldVertex:
      return {status.reason(), status.message(),
              "number the vertices 0, 1, 2 ... without gaps, one for each fan of faces"};
    default:
      return status;
  }
}

Result<Connectivity> connect(SurfaceTables& tables) {
  if (tables.twin) {
    RETURN_IF_ERROR(checkGluing(tables));
    auto surface = Connectivity::fromGluing(tables.vertex_count, std::move(tables.faces),
                                            *std::move(tables.twin));
    if (!surface.ok()) return explainConnectivity(surface.status());
    return surface;
  }
  auto surface = Connectivity::fromFaces(tables.vertex_count, tables.faces);
  if (surface.status().reason() == Reason::kInconsistentOrientation) {
    const SoupStructure structure = analyseSoup(tables.vertex_count, tables.faces);
    for (Index f = 0; f < static_cast<Index>(tables.faces.size()); ++f) {
      if (structure.one_sided[structure.sheet[f]]) return oneSided(f);
    }
  }
  if (!surface.ok()) return explainConnectivity(surface.status());
  return surface;
}

Status checkConnected(const Connectivity& surface) {
  const SurfaceTopology topology = computeTopology(surface);
  if (topology.components == 1) return {};
  const auto other = std::ranges::find(topology.component, 1);
  return {Reason::kMultipleComponents,
          "the surface has " + std::to_string(topology.components) + " components: face " +
              std::to_string(other - topology.component.begin()) + " is not connected with face 0",
          "write a file for each component"};
}

/// The length of every edge from those of its halfedges.
Result<std::vector<double>> mergeLengths(const Connectivity& surface,
                                         const std::vector<double>& stated) {
  std::vector<double> lengths(surface.edgeCount());
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    if (!(stated[h] > 0) || !std::isfinite(stated[h])) {
      return Status(Reason::kInvalidMetric,
                    halfedgeName(h) + " has the length " + shortestDouble(stated[h]),
                    "lengths are positive and finite");
    }
    const Index first = surface.halfedge(surface.edge(h));
    if (h == first) {
      lengths[surface.edge(h)] = stated[h];
      continue;
    }
    const double difference = std::abs(stated[h] - stated[first]);
    if (difference <= kSameLength * std::max(stated[h], stated[first])) continue;
    return Status(Reason::kInvalidMetric,
                  halfedgeName(first) + " and " + halfedgeName(h) +
                      " are one edge, but have the lengths " + shortestDouble(stated[first]) +
                      " and " + shortestDouble(stated[h]),
                  "give both the same length");
  }
  return lengths;
}

std::string sidesName(Index f, const TriangleValues& sides) {
  return "face " + std::to_string(f) + " has the sides " + shortestDouble(sides[0]) + ", " +
         shortestDouble(sides[1]) + " and " + shortestDouble(sides[2]);
}

Status checkTriangle(Geometry geometry, Index f, const TriangleValues& sides) {
  TriangleValues sorted = sides;
  std::ranges::sort(sorted);
  // The difference of the longer two first: it is exact where it matters.
  if (!(sorted[2] - sorted[1] < sorted[0])) {
    return {Reason::kInvalidMetric, sidesName(f, sides) + ", which make no triangle",
            "the longest side must be shorter than the two others together"};
  }
  if (geometry == Geometry::kSpherical &&
      !(sides[0] + sides[1] + sides[2] < 2 * std::numbers::pi)) {
    return {Reason::kInvalidMetric, sidesName(f, sides) + ", which go all round the unit sphere",
            "their sum must be less than 2 pi; cut the face into smaller ones"};
  }
  return {};
}

}  // namespace

Result<IntrinsicSurface> assembleSurface(Context& context, SurfaceTables tables) {
  RETURN_IF_ERROR(checkCounts(tables));
  RETURN_IF_ERROR(context.check());
  ASSIGN_OR_RETURN(Connectivity connectivity, connect(tables));
  RETURN_IF_ERROR(context.check());
  RETURN_IF_ERROR(checkConnected(connectivity));
  ASSIGN_OR_RETURN(std::vector<double> lengths, mergeLengths(connectivity, tables.lengths));
  IntrinsicSurface surface{std::move(connectivity), std::move(lengths), tables.geometry};
  for (Index f = 0; f < surface.connectivity.faceCount(); ++f) {
    if (f % kCheckInterval == 0) RETURN_IF_ERROR(context.check());
    RETURN_IF_ERROR(checkTriangle(tables.geometry, f, surface.sides(f)));
  }
  return surface;
}

}  // namespace moduli
