#include "core/parameterize/layout.h"

#include "core/intrinsic/unfold.h"

namespace moduli {
namespace {

class Layout {
 public:
  Layout(const Connectivity& surface, const FlatCharts& charts)
      : surface_(surface), charts_(charts), twin_(surface.halfedgeCount()) {
    for (Index h = 0; h < surface.halfedgeCount(); ++h) twin_[h] = surface.twin(h);
  }

  PlanarLayout run(const std::vector<bool>& is_cone) {
    if (surface_.faceCount() == 0) return {};
    unfolding_ = unfold(charts_, twin_);
    seam_.resize(surface_.edgeCount());
    for (Index e = 0; e < surface_.edgeCount(); ++e) {
      seam_[e] = !unfolding_.crossed[surface_.halfedge(e)];
    }
    prune(is_cone);
    std::vector<bool> sewn(surface_.halfedgeCount());
    for (Index h = 0; h < surface_.halfedgeCount(); ++h) sewn[h] = !seam_[surface_.edge(h)];
    PlanarLayout layout = sewCorners(surface_, seam_, unfolding_.placed);
    layout.closure = unfoldingGap(unfolding_, charts_, twin_, sewn);
    return layout;
  }

 private:
  /// Takes seams away that end at a flat inner vertex.
  void prune(const std::vector<bool>& is_cone) {
    std::vector<Index> degree(surface_.vertexCount(), 0);
    for (Index e = 0; e < surface_.edgeCount(); ++e) {
      if (!seam_[e]) continue;
      ++degree[surface_.tail(surface_.halfedge(e))];
      ++degree[surface_.head(surface_.halfedge(e))];
    }
    std::vector<Index> ends;
    const auto consider = [&](Index v) {
      if (degree[v] == 1 && !is_cone[v] && !surface_.isBoundaryVertex(v)) ends.push_back(v);
    };
    for (Index v = 0; v < surface_.vertexCount(); ++v) consider(v);
    while (!ends.empty()) {
      const Index v = ends.back();
      ends.pop_back();
      Index h = surface_.outgoing(v);
      const Index first = h;
      while (!seam_[surface_.edge(h)]) {
        h = surface_.rotate(h);
        if (h == first) break;
      }
      if (!seam_[surface_.edge(h)]) continue;
      seam_[surface_.edge(h)] = false;
      --degree[v];
      const Index other = surface_.head(h);
      --degree[other];
      consider(other);
    }
  }

  const Connectivity& surface_;
  const FlatCharts& charts_;
  std::vector<Index> twin_;
  Unfolding unfolding_;
  std::vector<bool> seam_;  ///< Per edge; boundary edges too.
};

}  // namespace

PlanarLayout layOut(const Connectivity& surface, const FlatCharts& charts,
                    const std::vector<bool>& is_cone) {
  return Layout(surface, charts).run(is_cone);
}

PlanarLayout sewCorners(const Connectivity& surface, const std::vector<bool>& seam,
                        const std::vector<std::complex<double>>& placed) {
  PlanarLayout layout;
  layout.corner.assign(surface.halfedgeCount(), kNone);
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    if (layout.corner[h] != kNone) continue;
    const auto point = static_cast<Index>(layout.points.size());
    layout.points.push_back(placed[h]);
    // Counter-clockwise up to a seam, then clockwise from the start.
    for (Index g = h; g != kNone && layout.corner[g] == kNone;) {
      layout.corner[g] = point;
      const Index side = Connectivity::previous(g);
      g = seam[surface.edge(side)] ? kNone : surface.twin(side);
    }
    for (Index g = h; !seam[surface.edge(g)] && surface.twin(g) != kNone;) {
      g = Connectivity::next(surface.twin(g));
      if (layout.corner[g] != kNone) break;
      layout.corner[g] = point;
    }
  }
  return layout;
}

}  // namespace moduli
