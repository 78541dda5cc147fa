#include "core/matching/boundary_links.h"

namespace moduli {

using Eigen::Vector2d;

BorderStep nextOnBorder(const Connectivity& b, const CoverSurface& cover, Index halfedge) {
  const CoverPlane plane = cover.plane();
  // Around the head.
  BorderStep step{Connectivity::next(halfedge), Motion::Identity()};
  while (b.twin(step.halfedge) != kNone) {
    step.motion = plane.normalized(Motion(step.motion * cover.across[step.halfedge]));
    step.halfedge = Connectivity::next(b.twin(step.halfedge));
  }
  return step;
}

std::vector<Motion> boundaryTransitions(const Connectivity& surface, const Connectivity& b,
                                        const CoverSurface& cover, const BoundaryMap& boundary) {
  const CoverPlane plane = cover.plane();
  std::vector<Motion> transitions(surface.halfedgeCount(), Motion::Identity());
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    if (surface.twin(h) != kNone) continue;
    Index at = boundary.edges[surface.tail(h)];
    for (Index n = 0; n < boundary.steps[h]; ++n) {
      const BorderStep step = nextOnBorder(b, cover, at);
      transitions[h] = plane.normalized(Motion(transitions[h] * step.motion));
      at = step.halfedge;
    }
  }
  return transitions;
}

std::vector<Vector2d> boundaryDirections(const CoverSurface& cover, const BoundaryMap& boundary,
                                         const CoverMap& map) {
  const CoverPlane plane = cover.plane();
  std::vector<Vector2d> directions(map.places.size(), Vector2d::Zero());
  for (std::size_t v = 0; v < map.places.size(); ++v) {
    const Index h = boundary.edges[v];
    if (h == kNone) continue;
    const Motion there = plane.inverse(plane.shift(plane.wayTo(map.places[v])));
    const Vector2d back = plane.wayTo(there * cover.corners[h]);
    const Vector2d on = plane.wayTo(there * cover.corners[Connectivity::next(h)]);
    // The end that is farther away tells better.
    directions[v] = (on.norm() > back.norm() ? on : Vector2d(-back)).normalized();
  }
  return directions;
}

std::vector<Vector2d> boundaryDirections(const Connectivity& surface, const CoverPlane& plane,
                                         const VertexLinks& links) {
  std::vector<Vector2d> directions(surface.vertexCount(), Vector2d::Zero());
  std::vector<double> lengths(surface.vertexCount(), 0.0);
  const auto offer = [&](Index v, const Vector2d& way) {
    if (!(way.norm() > lengths[v])) return;
    lengths[v] = way.norm();
    directions[v] = way / way.norm();
  };
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    if (surface.twin(h) != kNone) continue;
    offer(surface.tail(h), plane.wayTo(links[h].col(2)));
    offer(surface.head(h), -plane.wayTo(plane.inverse(links[h]).col(2)));
  }
  return directions;
}

SurfacePoint foldedBack(const SurfacePoint& point, Index faces) {
  if (point.face < faces) return point;
  const auto& [a, b, c] = point.barycentric;
  return {point.face - faces, {a, c, b}};
}

SurfacePoint ontoBoundary(const Connectivity& surface, const SurfacePoint& point) {
  SurfacePoint nearest = point;
  double least = 2;
  for (int c = 0; c < 3; ++c) {
    const int next = (c + 1) % 3, last = (c + 2) % 3;
    const double off = point.barycentric[last];
    if (surface.twin(3 * point.face + c) == kNone && off < least) {
      least = off;
      nearest.barycentric = point.barycentric;
      nearest.barycentric[last] = 0;
    }
    const double rest = point.barycentric[next] + point.barycentric[last];
    if (surface.isBoundaryVertex(surface.face(point.face)[c]) && rest < least) {
      least = rest;
      nearest.barycentric = {0, 0, 0};
      nearest.barycentric[c] = 1;
    }
  }
  const double sum = nearest.barycentric[0] + nearest.barycentric[1] + nearest.barycentric[2];
  for (double& weight : nearest.barycentric) weight /= sum;
  return nearest;
}

}  // namespace moduli
