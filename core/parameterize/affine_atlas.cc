#include "core/parameterize/affine_atlas.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/base/text.h"

namespace moduli {
namespace {

using Complex = std::complex<double>;

/// Unfolds the stars of all vertices that have charts.
void unfoldStars(AffineAtlas& atlas, const FlatCharts& charts) {
  const Connectivity& surface = atlas.surface;
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    if (!atlas.has_chart[v]) continue;
    const Index first = surface.outgoing(v);
    double direction = 0;
    Index h = first;
    do {
      // Both faces beside an edge make the same of its length.
      const Index own = surface.halfedge(surface.edge(h));
      atlas.spoke[h] = std::polar(std::abs(charts[own]), direction);
      direction += std::arg(-charts[Connectivity::previous(h)] / charts[h]);
      h = surface.rotate(h);
    } while (h != first);
  }
}

void findTransitions(AffineAtlas& atlas) {
  const Connectivity& surface = atlas.surface;
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    if (!atlas.has_chart[surface.tail(h)] || !atlas.has_chart[surface.head(h)]) continue;
    const Complex back = atlas.spoke[surface.twin(h)];
    const Complex turn = -back / atlas.spoke[h];
    atlas.transition[h] = {turn / std::abs(turn), back};
  }
}

/// Of the longest edge of the face of a halfedge.
double faceSize(const AffineAtlas& atlas, Index h) {
  return std::max({std::abs(atlas.spoke[h]), std::abs(atlas.spoke[atlas.surface.rotate(h)]),
                   std::abs(atlas.spoke[h] - atlas.spoke[atlas.surface.rotate(h)])});
}

void judge(AffineAtlas& atlas) {
  const Connectivity& surface = atlas.surface;
  const auto charted = [&](Index h) {
    return atlas.has_chart[surface.tail(h)] && atlas.has_chart[surface.head(h)];
  };
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    if (!charted(h)) continue;
    // The corner to the left of h, seen from both ends, and that to the right.
    const Index twin = surface.twin(h);
    const double left = std::abs(atlas.transition[h](atlas.spoke[surface.rotate(h)]) -
                                 atlas.spoke[Connectivity::next(h)]);
    const double right = std::abs(atlas.transition[h](atlas.spoke[Connectivity::next(twin)]) -
                                  atlas.spoke[surface.rotate(twin)]);
    atlas.overlap_residual = std::max({atlas.overlap_residual, left / faceSize(atlas, h),
                                       right / std::abs(faceSize(atlas, twin))});
  }
  for (Index f = 0; f < surface.faceCount(); ++f) {
    const Index h = 3 * f;
    if (!charted(h) || !charted(h + 1) || !charted(h + 2)) continue;
    const PlaneMotion around =
        atlas.transition[h + 2] * atlas.transition[h + 1] * atlas.transition[h];
    atlas.cocycle_residual = std::max({atlas.cocycle_residual, std::abs(around.turn - 1.0),
                                       std::abs(around.shift) / faceSize(atlas, h)});
  }
}

std::string pairOf(Complex z) {
  return "[" + shortestDouble(z.real()) + ", " + shortestDouble(z.imag()) + "]";
}

/// "key": [ with a line for each of the items that `item` does not leave empty.
template <typename Item>
void writeList(std::string& text, const char* key, Index count, const Item& item) {
  text.append("  \"").append(key).append("\": [");
  const char* separator = "\n    ";
  for (Index n = 0; n < count; ++n) {
    const std::string line = item(n);
    if (line.empty()) continue;
    text.append(separator).append(line);
    separator = ",\n    ";
  }
  text.append("],\n");
}

std::string chartText(const AffineAtlas& atlas, const std::vector<Index>& number, Index v) {
  if (!atlas.has_chart[v]) return {};
  std::string neighbours, places;
  const Index first = atlas.surface.outgoing(v);
  Index h = first;
  do {
    const char* separator = h == first ? "" : ", ";
    neighbours.append(separator).append(std::to_string(number[atlas.surface.head(h)]));
    places.append(separator).append(pairOf(atlas.spoke[h]));
    h = atlas.surface.rotate(h);
  } while (h != first);
  return "{\"vertex\": " + std::to_string(number[v]) + ", \"neighbours\": [" + neighbours +
         "], \"points\": [" + places + "]}";
}

std::string transitionText(const AffineAtlas& atlas, const std::vector<Index>& number, Index e) {
  const Index h = atlas.surface.halfedge(e);
  const Index from = atlas.surface.tail(h), to = atlas.surface.head(h);
  if (!atlas.has_chart[from] || !atlas.has_chart[to]) return {};
  return "{\"from\": " + std::to_string(number[from]) + ", \"to\": " + std::to_string(number[to]) +
         ", \"angle\": " + shortestDouble(std::arg(atlas.transition[h].turn)) +
         ", \"translation\": " + pairOf(atlas.transition[h].shift) + "}";
}

}  // namespace

AffineAtlas atlasOfCharts(const Connectivity& surface, const FlatCharts& charts,
                          const std::vector<Cone>& cones) {
  AffineAtlas atlas{surface, cones, std::vector<bool>(surface.vertexCount(), true),
                    std::vector<Complex>(surface.halfedgeCount()),
                    std::vector<PlaneMotion>(surface.halfedgeCount())};
  for (const Cone& cone : cones) atlas.has_chart[cone.vertex] = cone.curvature == 0;
  unfoldStars(atlas, charts);
  findTransitions(atlas);
  judge(atlas);
  return atlas;
}

std::string writeAtlasJson(const AffineAtlas& atlas) {
  std::vector<Index> number(atlas.surface.vertexCount());
  std::iota(number.begin(), number.end(), 0);
  return writeAtlasJson(atlas, number, atlas.surface.vertexCount());
}

std::string writeAtlasJson(const AffineAtlas& atlas, const std::vector<Index>& number,
                           Index vertices) {
  const Connectivity& surface = atlas.surface;
  std::string text = "{\n  \"format\": \"moduli-affine-atlas\",\n  \"version\": 1,\n";
  text.append("  \"vertices\": ").append(std::to_string(vertices)).append(",\n");
  writeList(text, "faces", surface.faceCount(), [&](Index f) {
    const auto& [a, b, c] = surface.face(f);
    return "[" + std::to_string(number[a]) + ", " + std::to_string(number[b]) + ", " +
           std::to_string(number[c]) + "]";
  });
  writeList(text, "extraordinary", static_cast<Index>(atlas.cones.size()), [&](Index n) {
    return "{\"vertex\": " + std::to_string(number[atlas.cones[n].vertex]) +
           ", \"curvature\": " + shortestDouble(atlas.cones[n].curvature) + "}";
  });
  writeList(text, "charts", surface.vertexCount(),
            [&](Index v) { return chartText(atlas, number, v); });
  writeList(text, "transitions", surface.edgeCount(),
            [&](Index e) { return transitionText(atlas, number, e); });
  text.append("  \"overlap_residual\": ").append(shortestDouble(atlas.overlap_residual));
  text.append(",\n  \"cocycle_residual\": ").append(shortestDouble(atlas.cocycle_residual));
  text.append("\n}\n");
  return text;
}

}  // namespace moduli
