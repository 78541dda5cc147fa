#include "core/matching/cover_inverse.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace moduli {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

double angleOf(const Vector2d& way) {
  return std::atan2(way[1], way[0]);
}

/// From the frame that linksOf has at a vertex of A to the coordinates of a face around it in the
/// triangulation that A is of B.
Motion intoFace(const CoverSurface& image, const VertexLinks& links, Index h) {
  const CoverPlane plane = image.plane();
  const Motion corner = plane.shift(plane.wayTo(image.corners[h]));
  const Vector3d head = plane.inverse(corner) * image.corners[Connectivity::next(h)];
  const double there = angleOf(head.head<2>()), here = angleOf(links[h].col(2).head<2>());
  return corner * CoverPlane::turn(there - here);
}

}  // namespace

SurfacePoint imageOf(const Connectivity& surface, const CoverSurface& cover, const CoverMap& map,
                     const SurfacePoint& point) {
  const CoverPlane plane = cover.plane();
  const Index first = surface.tail(3 * point.face);
  const std::array<Vector3d, 3> corners = cornersOf(surface, map, point.face);
  const Vector3d sum = point.barycentric[0] * corners[0] + point.barycentric[1] * corners[1] +
                       point.barycentric[2] * corners[2];
  const CoverArrival end =
      walkStraight(cover, map.images[first].face, map.places[first], plane.normalized(sum));
  return cover.pointAt(end.face, end.place);
}

Result<std::vector<SurfacePoint>> invertCoverMap(Context& context, const Connectivity& surface,
                                                 const CoverSurface& cover, const CoverMap& map,
                                                 Index vertices) {
  if (vertices == kNone) vertices = cover.surface.vertexCount();
  const CoverPlane plane = cover.plane();
  const VertexLinks links = linksOf(surface, cover, map);
  const CoverSurface image =
      coverOfLinks(cover.geometry, surface, links, std::vector<double>(surface.edgeCount(), 1.0));
  const std::vector<Motion> frames = vertexFrames(cover);
  const VertexLinks own = ownLinks(cover, frames);
  std::vector<SurfacePoint> result(vertices);
  // Per vertex of B, from its frame to the coordinates of the face of A that it lies in.
  std::vector<Motion> seen(vertices);
  std::vector<bool> done(vertices, false);
  std::vector<Index> queue;
  const auto put = [&](Index v, Index face, const Vector3d& from, const Motion& frame) {
    const CoverArrival end =
        walkStraight(image, face, from, plane.normalized(Vector3d(frame.col(2))));
    seen[v] = plane.normalized(Motion(plane.inverse(end.motion) * frame));
    result[v] = image.pointAt(end.face, end.place);
    done[v] = true;
    queue.push_back(v);
  };
  // From a vertex of A to a corner of the face that it is mapped to. Rounding may have put vertices
  // of a boundary beyond it, where corners do not count.
  const auto counts = [&](Index face) {
    const Triangle& corners = cover.surface.face(face);
    return std::all_of(corners.begin(), corners.end(), [&](Index v) { return v < vertices; });
  };
  Index start = 0;
  while (start + 1 < surface.vertexCount() && !counts(map.images[start].face)) ++start;
  if (!counts(map.images[start].face)) {
    return Status(Reason::kFoldedMap, "the map leaves the surface across its boundary");
  }
  const Index h = surface.outgoing(start), corner = 3 * map.images[start].face;
  const Motion at_vertex = plane.inverse(plane.shift(plane.wayTo(map.places[start])));
  put(cover.surface.tail(corner), Connectivity::faceOf(h), image.corners[h],
      intoFace(image, links, h) * at_vertex * frames[corner]);
  for (std::size_t n = 0; n < queue.size(); ++n) {
    if (n % 4096 == 0) RETURN_IF_ERROR(context.check());
    const Index v = queue[n], first = cover.surface.outgoing(v);
    Index out = first;
    do {
      const Index u = cover.surface.head(out);
      if (u < vertices && !done[u]) {
        put(u, result[v].face, plane.normalized(Vector3d(seen[v].col(2))), seen[v] * own[out]);
      }
      out = cover.surface.rotate(out);
    } while (out != first);
  }
  return result;
}

}  // namespace moduli
