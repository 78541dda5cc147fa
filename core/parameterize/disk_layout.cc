#include "core/parameterize/disk_layout.h"

#include <algorithm>
#include <cmath>

#include "core/mesh/disjoint_sets.h"

namespace moduli {
namespace {

constexpr double kSameElement = 1e-5;

/// Per edge whether the polygon has to be cut there: edges that the layout did not cross, less
/// those that stick out of the graph that they make.
std::vector<bool> cutEdges(const Connectivity& surface, const Development& development) {
  std::vector<bool> cut(surface.edgeCount(), true);
  for (const Index entry : development.entry) {
    if (entry != kNone) cut[surface.edge(entry)] = false;
  }
  std::vector<std::vector<Index>> edges(surface.vertexCount());
  std::vector<Index> degree(surface.vertexCount(), 0);
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    if (!cut[e]) continue;
    const Index h = surface.halfedge(e);
    for (const Index v : {surface.tail(h), surface.head(h)}) {
      edges[v].push_back(e);
      ++degree[v];
    }
  }
  std::vector<Index> ends;
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    if (degree[v] == 1) ends.push_back(v);
  }
  while (!ends.empty()) {
    const Index v = ends.back();
    ends.pop_back();
    for (const Index e : edges[v]) {
      if (!cut[e]) continue;
      cut[e] = false;
      const Index h = surface.halfedge(e);
      const Index other = surface.tail(h) == v ? surface.head(h) : surface.tail(h);
      --degree[v];
      if (--degree[other] == 1) ends.push_back(other);
    }
  }
  return cut;
}

class Sewing {
 public:
  Sewing(const HyperbolicTriangles& triangles, const Development& development)
      : triangles_(triangles),
        surface_(triangles.surface),
        development_(development),
        cut_(cutEdges(surface_, development)) {}

  DiskLayout run() {
    numberPoints();
    measureClosure();
    for (Index h = 0; h < surface_.halfedgeCount(); ++h) {
      if (surface_.twin(h) != kNone && cut_[surface_.edge(h)]) addNeighbour(h);
    }
    return std::move(layout_);
  }

 private:
  Complex place(Index h) const {
    return imageOf(development_.placed[Connectivity::faceOf(h)] * cornerFrame(triangles_, h), 0.0);
  }

  /// Corners that meet at an uncut edge are one point.
  void numberPoints() {
    DisjointSets one(surface_.halfedgeCount());
    for (Index h = 0; h < surface_.halfedgeCount(); ++h) {
      const Index twin = surface_.twin(h);
      if (twin == kNone || cut_[surface_.edge(h)]) continue;
      one.join(h, Connectivity::next(twin));
    }
    std::vector<Index> number(surface_.halfedgeCount(), kNone);
    layout_.corner.resize(surface_.halfedgeCount());
    for (Index h = 0; h < surface_.halfedgeCount(); ++h) {
      Index& point = number[one.root(h)];
      if (point == kNone) {
        point = static_cast<Index>(layout_.points.size());
        layout_.points.push_back(place(h));
        layout_.radius = std::max(layout_.radius, hyperbolicDistance(layout_.points.back(), 0.0));
      }
      layout_.corner[h] = point;
    }
  }

  void measureClosure() {
    for (Index h = 0; h < surface_.halfedgeCount(); ++h) {
      const double gap = hyperbolicDistance(place(h), layout_.points[layout_.corner[h]]);
      const double length = triangles_.lengths[h];
      layout_.closure = std::max(layout_.closure, gap / length);
    }
  }

  void addNeighbour(Index h) {
    const Su11& here = development_.placed[Connectivity::faceOf(h)];
    const Su11& beyond = development_.placed[Connectivity::faceOf(surface_.twin(h))];
    const Su11 g = renormalized(here * development_.crossing[h] * inverse(beyond));
    for (const Su11& known : layout_.neighbours) {
      if (displacement(inverse(known) * g) < kSameElement) return;
    }
    layout_.neighbours.push_back(g);
    layout_.neighbours.push_back(inverse(g));
  }

  const HyperbolicTriangles& triangles_;
  const Connectivity& surface_;
  const Development& development_;
  std::vector<bool> cut_;
  DiskLayout layout_;
};

}  // namespace

DiskLayout sewUp(const HyperbolicTriangles& triangles, const Development& development) {
  return Sewing(triangles, development).run();
}

}  // namespace moduli
