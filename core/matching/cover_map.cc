#include "core/matching/cover_map.h"

#include "core/base/parallel.h"
#include "core/spherical/exact_sign.h"

namespace moduli {
namespace {

using Eigen::Vector3d;

/// Edges that one thread takes before it asks for more.
constexpr std::size_t kTogether = 2048;

std::vector<Motion> framesOf(const CoverSurface& cover, const CoverMap& map) {
  const CoverPlane plane = cover.plane();
  std::vector<Motion> frames;
  for (const Vector3d& place : map.places) frames.push_back(plane.shift(plane.wayTo(place)));
  return frames;
}

}  // namespace

std::array<Vector3d, 3> cornersOf(const Connectivity& surface, const CoverMap& map, Index face) {
  const Index h = 3 * face, back = surface.twin(h + 2), last = surface.tail(h + 2);
  const Motion& to = map.transitions[h];
  const Vector3d third = back == kNone ? Vector3d(to * (map.transitions[h + 1] * map.places[last]))
                                       : Vector3d(map.transitions[back] * map.places[last]);
  return {map.places[surface.tail(h)], to * map.places[surface.head(h)], third};
}

VertexLinks linksOf(const Connectivity& surface, const CoverSurface& cover, const CoverMap& map) {
  const CoverPlane plane = cover.plane();
  const std::vector<Motion> frames = framesOf(cover, map);
  VertexLinks links(surface.halfedgeCount());
  const auto link = [&](Index e) {
    const Index h = surface.halfedge(e);
    links[h] = plane.normalized(Motion(plane.inverse(frames[surface.tail(h)]) * map.transitions[h] *
                                       frames[surface.head(h)]));
    if (surface.twin(h) != kNone) links[surface.twin(h)] = plane.inverse(links[h]);
  };
  parallelBlocks(surface.edgeCount(), kTogether, [&](std::size_t begin, std::size_t end) {
    for (std::size_t e = begin; e < end; ++e) link(static_cast<Index>(e));
  });
  return links;
}

CoverMap moved(const Connectivity& surface, const CoverSurface& cover, const CoverMap& map,
               const std::vector<Motion>& moves) {
  const CoverPlane plane = cover.plane();
  const std::vector<Motion> frames = framesOf(cover, map);
  CoverMap result;
  std::vector<Motion> way;
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    const Vector3d goal = plane.normalized(Vector3d(frames[v] * moves[v].col(2)));
    const CoverArrival end = walkStraight(cover, map.images[v].face, map.places[v], goal);
    result.images.push_back(cover.pointAt(end.face, end.place));
    result.places.push_back(end.place);
    way.push_back(end.motion);
  }
  result.transitions.resize(surface.halfedgeCount());
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    const Index h = surface.halfedge(e);
    result.transitions[h] = plane.normalized(
        Motion(plane.inverse(way[surface.tail(h)]) * map.transitions[h] * way[surface.head(h)]));
    if (surface.twin(h) == kNone) continue;
    result.transitions[surface.twin(h)] = plane.inverse(result.transitions[h]);
  }
  return result;
}

bool isFolded(const Connectivity& surface, const CoverMap& map, Index face) {
  const auto& [first, second, third] = cornersOf(surface, map, face);
  return spherical::orientationSign(first, second, third) <= 0;
}

Index countFolded(const Connectivity& surface, const CoverMap& map) {
  Index folded = 0;
  for (Index f = 0; f < surface.faceCount(); ++f) folded += isFolded(surface, map, f) ? 1 : 0;
  return folded;
}

}  // namespace moduli
