#include "core/matching/target_links.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "core/base/parallel.h"
#include "core/matching/boundary_links.h"
#include "core/matching/close_links.h"
#include "core/matching/path_search.h"

namespace moduli {
namespace {

using Eigen::Vector3d;

constexpr double kClosed = 1e-6;
constexpr int kMostRounds = 12;
/// Vertices that one thread links before it asks for more; a search of its own costs something,
/// too.
constexpr std::size_t kTogether = 512, kMostBlocks = 32;

class Linking {
 public:
  /// vertices: the first ones of the cover, through which paths go.
  Linking(Context& context, const Connectivity& surface, const CoverSurface& cover,
          std::vector<SurfacePoint> targets, Index vertices)
      : context_(context),
        surface_(surface),
        cover_(cover),
        plane_(cover.geometry),
        search_(cover, vertices),
        transitions_(surface.halfedgeCount()),
        known_(surface.edgeCount(), 0),
        replaced_(surface.vertexCount(), false) {
    map_.images = std::move(targets);
  }

  /// What the edges of the boundary are, known beforehand. Per halfedge.
  void setBoundary(const std::vector<Motion>& transitions) {
    for (Index e = 0; e < surface_.edgeCount(); ++e) {
      if (!surface_.isBoundaryEdge(e)) continue;
      known_[e] = 1;
      transitions_[surface_.halfedge(e)] = transitions[surface_.halfedge(e)];
    }
  }

  /// Per edge. Outlives this.
  void setWays(const EdgeWays& ways) { ways_ = &ways; }

  /// All but what linksOf the map tell.
  Result<TargetLinks> run() {
    const Context::Stage stage(context_, "homotopy");
    RETURN_IF_ERROR(linkAround(std::vector<bool>(surface_.vertexCount(), true)));
    for (int round = 0; round < kMostRounds; ++round) {
      const std::vector<bool> wrong = wrongVertices(round);
      if (wrong == replaced_) break;
      if (std::count(wrong.begin(), wrong.end(), false) == 0)
        return undetermined(surface_.faceCount());
      replace(wrong);
      RETURN_IF_ERROR(linkAround(wrong));
    }
    return finish();
  }

 private:
  Status undetermined(std::ptrdiff_t count) const {
    return {Reason::kNoConvergence,
            "the places of vertices on the other surface contradict each other around " +
                std::to_string(count) + " faces",
            "they do not tell which handle goes to which"};
  }

  /// Short paths along all edges at these vertices.
  Status linkAround(const std::vector<bool>& at) {
    const std::size_t count = at.size();
    parallelBlocks(count, std::max(kTogether, count / kMostBlocks),
                   [&](std::size_t v, std::size_t end) {
                     Searches own{search_, search_};
                     for (; v < end; ++v) {
                       if (v % 1024 == 0 && !context_.check().ok()) return;
                       linkFrom(static_cast<Index>(v), at, own);
                     }
                   });
    return context_.check();
  }

  struct Searches {
    PathSearch whole, step;
  };

  /// Each edge from its own tail, so that both ways are one.
  void linkFrom(Index v, const std::vector<bool>& at, Searches& searches) {
    bool started = false;
    const Index first = surface_.outgoing(v);
    Index h = first;
    do {
      if (surface_.sign(h) > 0 && (at[v] || at[surface_.head(h)])) {
        if (!started) searches.whole.start(map_.images[v]);
        started = true;
        link(h, searches);
      }
      h = surface_.rotate(h);
    } while (h != first && h != kNone);
  }

  const SurfacePoint& headOf(Index h) const { return map_.images[surface_.head(h)]; }

  bool isWayKnown(Index h) const {
    return ways_ != nullptr && !replaced_[surface_.tail(h)] && !replaced_[surface_.head(h)];
  }

  /// The same as find(headOf(h)), by points between.
  std::optional<Motion> alongWay(Index h, PathSearch& search) const {
    Motion way = Motion::Identity();
    const SurfacePoint* from = &map_.images[surface_.tail(h)];
    const auto step = [&](const SurfacePoint& to) {
      search.start(*from);
      const std::optional<Motion> found = search.find(to);
      if (found) way = plane_.normalized(Motion(way * *found));
      from = &to;
      return found.has_value();
    };
    for (const SurfacePoint& to : (*ways_)[surface_.edge(h)]) {
      if (!step(to)) return std::nullopt;
    }
    return step(headOf(h)) ? std::optional(way) : std::nullopt;
  }

  void link(Index h, Searches& searches) {
    if (surface_.twin(h) == kNone) return;
    const std::optional<Motion> found =
        isWayKnown(h) ? alongWay(h, searches.step) : searches.whole.find(headOf(h));
    known_[surface_.edge(h)] = found.has_value() ? 1 : 0;
    if (!found) return;
    transitions_[h] = *found;
    transitions_[surface_.twin(h)] = plane_.inverse(*found);
  }

  /// Vertices that were replaced, those at most of whose faces paths do not close, and from the
  /// second round on those at faces with an edge whose ends are too far from each other, and from
  /// the third on their neighbours.
  std::vector<bool> wrongVertices(int round) const {
    std::vector<int> degree(surface_.vertexCount(), 0), open(surface_.vertexCount(), 0);
    std::vector<bool> wrong = replaced_;
    for (Index f = 0; f < surface_.faceCount(); ++f) {
      bool known = true;
      for (Index h = 3 * f; h < 3 * f + 3; ++h) known = known && known_[surface_.edge(h)] != 0;
      const bool closed = known && distanceToUnit(transitions_[3 * f] * transitions_[3 * f + 1] *
                                                  transitions_[3 * f + 2]) < kClosed;
      for (const Index v : surface_.face(f)) {
        ++degree[v];
        open[v] += !closed;
        if (!known && round > 0) wrong[v] = true;
      }
    }
    for (Index v = 0; v < surface_.vertexCount(); ++v) {
      if (2 * open[v] > degree[v] && !replaced_[v]) wrong[v] = true;
    }
    if (round > 1 && wrong != replaced_) wrong = widened(wrong);
    for (Index v = 0; v < surface_.vertexCount(); ++v) {
      if (surface_.isBoundaryVertex(v)) wrong[v] = false;
    }
    return wrong;
  }

  std::vector<bool> widened(const std::vector<bool>& set) const {
    std::vector<bool> result = set;
    for (Index h = 0; h < surface_.halfedgeCount(); ++h) {
      if (set[surface_.tail(h)]) result[surface_.head(h)] = true;
    }
    return result;
  }

  /// The targets of the nearest vertices that are not wrong, by the number of edges.
  void replace(const std::vector<bool>& wrong) {
    std::vector<Index> queue;
    std::vector<bool> done(surface_.vertexCount());
    for (Index v = 0; v < surface_.vertexCount(); ++v) {
      done[v] = !wrong[v];
      if (done[v]) queue.push_back(v);
    }
    for (std::size_t n = 0; n < queue.size(); ++n) {
      const Index first = surface_.outgoing(queue[n]);
      Index h = first;
      do {
        const Index next = surface_.head(h);
        if (!done[next]) {
          done[next] = true;
          replaced_[next] = true;
          map_.images[next] = map_.images[queue[n]];
          queue.push_back(next);
        }
        h = surface_.rotate(h);
      } while (h != first && h != kNone);
    }
  }

  Result<TargetLinks> finish() {
    TargetLinks result;
    Searches searches{search_, search_};
    searches.whole.searchAll();
    for (Index e = 0; e < surface_.edgeCount(); ++e) {
      if (known_[e] != 0) continue;
      RETURN_IF_ERROR(context_.check());
      searches.whole.start(map_.images[surface_.tail(surface_.halfedge(e))]);
      link(surface_.halfedge(e), searches);
    }
    for (const SurfacePoint& image : map_.images) map_.places.push_back(cover_.place(image));
    ASSIGN_OR_RETURN(map_.transitions,
                     closeLinks(context_, surface_, plane_, map_.places, std::move(transitions_)));
    if (const auto open = openFaces(surface_, map_.transitions); !open.empty()) {
      return undetermined(static_cast<std::ptrdiff_t>(open.size()));
    }
    result.replaced = std::move(replaced_);
    result.map = std::move(map_);
    return result;
  }

  Context& context_;
  const Connectivity& surface_;
  const CoverSurface& cover_;
  CoverPlane plane_;
  PathSearch search_;  ///< To be copied.
  const EdgeWays* ways_ = nullptr;
  std::vector<Motion> transitions_;
  std::vector<char> known_;     ///< Per edge.
  std::vector<bool> replaced_;  ///< Per vertex.
  CoverMap map_;
};

/// Fails unless the targets cover the other surface, of this area, once.
Result<TargetLinks> checked(const Connectivity& surface, const CoverSurface& cover, double area,
                            TargetLinks found) {
  const VertexLinks links = linksOf(surface, cover, found.map);
  found.closure = closureResidual(surface, links);
  found.area = coveredArea(cover.geometry, surface, links);
  found.degree = found.area / area;
  if (std::lround(found.degree) == 1) return found;
  return Status(Reason::kNoConvergence,
                "the places of vertices on the other surface cover it " +
                    std::to_string(std::lround(found.degree)) + " times, not once",
                "they do not tell which handle goes to which");
}

Status checkTargets(const Connectivity& surface, const CoverSurface& cover,
                    const std::vector<SurfacePoint>& targets) {
  if (targets.size() != static_cast<std::size_t>(surface.vertexCount())) {
    return Status(Reason::kInvalidOption, std::to_string(targets.size()) + " targets for " +
                                              std::to_string(surface.vertexCount()) + " vertices");
  }
  for (std::size_t v = 0; v < targets.size(); ++v) {
    RETURN_IF_ERROR(
        checkSurfacePoint(cover.surface, targets[v], "the target of vertex " + std::to_string(v)));
  }
  return {};
}

}  // namespace

Result<TargetLinks> linkTargets(Context& context, const Connectivity& surface,
                                const CoverSurface& cover, std::vector<SurfacePoint> targets,
                                const EdgeWays& ways) {
  RETURN_IF_ERROR(checkTargets(surface, cover, targets));
  if (surface.eulerCharacteristic() != cover.surface.eulerCharacteristic()) {
    return Status(Reason::kUnsupportedTopology, "the surfaces have different numbers of handles");
  }
  Linking linking(context, surface, cover, std::move(targets), cover.surface.vertexCount());
  if (!ways.empty()) linking.setWays(ways);
  ASSIGN_OR_RETURN(TargetLinks found, linking.run());
  return checked(surface, cover, cover.area, std::move(found));
}

Result<TargetLinks> linkBordered(Context& context, const Connectivity& surface,
                                 const Connectivity& b, const CoverSurface& cover,
                                 const BoundaryMap& boundary, std::vector<SurfacePoint> targets) {
  RETURN_IF_ERROR(checkTargets(surface, cover, targets));
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    if (surface.isBoundaryVertex(v)) targets[v] = boundary.points[v];
  }
  Linking linking(context, surface, cover, std::move(targets), b.vertexCount());
  linking.setBoundary(boundaryTransitions(surface, b, cover, boundary));
  ASSIGN_OR_RETURN(TargetLinks found, linking.run());
  found.slides = boundaryDirections(cover, boundary, found.map);
  return checked(surface, cover, cover.area / 2, std::move(found));
}

}  // namespace moduli
