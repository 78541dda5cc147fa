#include "core/parameterize/layout.h"

#include <algorithm>

#include "core/intrinsic/unfold.h"

namespace moduli {

PlanarLayout layOut(const Connectivity& surface, const FlatCharts& charts,
                    const std::vector<bool>& seam) {
  std::vector<Index> twin(surface.halfedgeCount());
  std::vector<bool> sewn(surface.halfedgeCount());
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    sewn[h] = !seam[surface.edge(h)];
    twin[h] = sewn[h] ? surface.twin(h) : kNone;
  }
  const std::vector<Index> piece = piecesOf(twin);
  const Index pieces = piece.empty() ? 0 : 1 + *std::max_element(piece.begin(), piece.end());
  Unfolding whole{std::vector<std::complex<double>>(surface.halfedgeCount()), {}};
  for (Index n = 0; n < pieces; ++n) {
    std::vector<bool> others(surface.faceCount());
    for (Index f = 0; f < surface.faceCount(); ++f) others[f] = piece[f] != n;
    const Unfolding one = unfold(charts, twin, others);
    for (Index h = 0; h < surface.halfedgeCount(); ++h) {
      if (!others[Connectivity::faceOf(h)]) whole.placed[h] = one.placed[h];
    }
  }
  PlanarLayout layout = sewCorners(surface, seam, whole.placed);
  layout.closure = unfoldingGap(whole, charts, twin, sewn);
  return layout;
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

std::vector<Index> piecesOf(const std::vector<Index>& twin) {
  std::vector<Index> piece(twin.size() / 3, kNone);
  Index count = 0;
  std::vector<Index> open;
  for (Index start = 0; start < static_cast<Index>(piece.size()); ++start) {
    if (piece[start] != kNone) continue;
    piece[start] = count;
    open = {start};
    while (!open.empty()) {
      const Index f = open.back();
      open.pop_back();
      for (Index h = 3 * f; h < 3 * f + 3; ++h) {
        if (twin[h] == kNone || piece[Connectivity::faceOf(twin[h])] != kNone) continue;
        piece[Connectivity::faceOf(twin[h])] = count;
        open.push_back(Connectivity::faceOf(twin[h]));
      }
    }
    ++count;
  }
  return piece;
}

bool isSewn(const Connectivity& surface, const std::vector<Index>& corner, Index h) {
  const Index twin = surface.twin(h);
  return twin != kNone && corner[h] == corner[Connectivity::next(twin)] &&
         corner[Connectivity::next(h)] == corner[twin];
}

}  // namespace moduli
