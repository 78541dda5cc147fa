#include "core/matching/cover_inverse.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/parallel.h"

namespace moduli {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Vertices that one thread finds before it asks for more.
constexpr std::size_t kTogether = 512;

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

/// Finds the first vertices of B in the triangulation that A is of B.
class Inversion {
 public:
  Inversion(Context& context, const Connectivity& surface, const CoverSurface& cover,
            const CoverMap& map, Index vertices)
      : context_(context),
        surface_(surface),
        cover_(cover),
        map_(map),
        plane_(cover.geometry),
        links_(linksOf(surface, cover, map)),
        image_(coverOfLinks(cover.geometry, surface, links_,
                            std::vector<double>(surface.edgeCount(), 1.0))),
        frames_(vertexFrames(cover)),
        result_(vertices),
        seen_(vertices),
        near_(vertices, kNone) {}

  Result<std::vector<SurfacePoint>> run() {
    findNear();
    parallelBlocks(near_.size(), kTogether, [this](std::size_t u, std::size_t end) {
      if (!context_.check().ok()) return;
      for (; u < end; ++u) {
        if (near_[u] != kNone) putFromNear(static_cast<Index>(u));
      }
    });
    RETURN_IF_ERROR(putOthers());
    return std::move(result_);
  }

 private:
  /// Per vertex of B one of A whose image is in a face around it.
  void findNear() {
    for (Index v = 0; v < surface_.vertexCount(); ++v) {
      const Triangle& corners = cover_.surface.face(map_.images[v].face);
      // Rounding may have put vertices of a boundary beyond it, where corners do not count.
      const auto counts = [&](Index u) { return u < static_cast<Index>(near_.size()); };
      if (!std::all_of(corners.begin(), corners.end(), counts)) continue;
      for (const Index u : corners) near_[u] = v;
    }
  }

  void put(Index u, Index face, const Vector3d& from, const Motion& frame) {
    const CoverArrival end =
        walkStraight(image_, face, from, plane_.normalized(Vector3d(frame.col(2))));
    seen_[u] = plane_.normalized(Motion(plane_.inverse(end.motion) * frame));
    result_[u] = image_.pointAt(end.face, end.place);
  }

  /// From a vertex of A to a corner of the face that it is mapped to.
  void putFromNear(Index u) {
    const Index v = near_[u], h = surface_.outgoing(v);
    Index corner = 3 * map_.images[v].face;
    while (cover_.surface.tail(corner) != u) ++corner;
    const Motion at_vertex = plane_.inverse(plane_.shift(plane_.wayTo(map_.places[v])));
    put(u, Connectivity::faceOf(h), image_.corners[h],
        intoFace(image_, links_, h) * at_vertex * frames_[corner]);
  }

  /// From neighbours, where no vertex of A is near.
  Status putOthers() {
    std::vector<Index> queue;
    for (std::size_t u = 0; u < near_.size(); ++u) {
      if (near_[u] != kNone) queue.push_back(static_cast<Index>(u));
    }
    if (queue.empty()) {
      return {Reason::kFoldedMap, "the map leaves the surface across its boundary"};
    }
    for (std::size_t n = 0; n < queue.size() && queue.size() < near_.size(); ++n) {
      if (n % 4096 == 0) RETURN_IF_ERROR(context_.check());
      const Index v = queue[n], first = cover_.surface.outgoing(v);
      Index out = first;
      do {
        const Index u = cover_.surface.head(out);
        if (u < static_cast<Index>(near_.size()) && near_[u] == kNone) {
          const Motion link = plane_.inverse(frames_[out]) * frames_[Connectivity::next(out)];
          put(u, result_[v].face, plane_.normalized(Vector3d(seen_[v].col(2))), seen_[v] * link);
          near_[u] = near_[v];
          queue.push_back(u);
        }
        out = cover_.surface.rotate(out);
      } while (out != first);
    }
    return context_.check();
  }

  Context& context_;
  const Connectivity& surface_;
  const CoverSurface& cover_;
  const CoverMap& map_;
  CoverPlane plane_;
  VertexLinks links_;
  CoverSurface image_;
  std::vector<Motion> frames_;
  std::vector<SurfacePoint> result_;
  /// Per vertex of B, from its frame to the coordinates of the face of A that it lies in.
  std::vector<Motion> seen_;
  std::vector<Index> near_;
};

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
  return Inversion(context, surface, cover, map, vertices).run();
}

}  // namespace moduli
