#include "core/matching/doubled_map.h"

#include <Eigen/LU>
#include <cmath>
#include <utility>

namespace moduli {
namespace {

using Eigen::Vector3d;

double angleOf(const Vector3d& point) {
  return std::atan2(point[1], point[0]);
}

/// From the coordinates of a face of the first copy to those of its mirror.
Motion reflectionOf(const CoverSurface& cover, Index face) {
  const Index mirror = face + cover.surface.faceCount() / 2;
  const double turn = angleOf(cover.corners[3 * face + 1]) + angleOf(cover.corners[3 * mirror + 2]);
  Motion result = Motion::Identity();
  result.topLeftCorner<2, 2>() << std::cos(turn), std::sin(turn), std::sin(turn), -std::cos(turn);
  return result;
}

SurfacePoint mirrored(const SurfacePoint& point, Index faces) {
  const auto& [a, b, c] = point.barycentric;
  return {point.face + faces, {a, c, b}};
}

/// As doubleCover has them.
Index mirrorHalfedge(Index h, Index faces) {
  return 3 * (h / 3 + faces) + 2 - h % 3;
}

}  // namespace

std::vector<Motion> boundaryTransitions(const Connectivity& surface, const Connectivity& b,
                                        const CoverSurface& cover, const BoundaryMap& boundary) {
  const CoverPlane plane = cover.plane();
  std::vector<Motion> transitions(surface.halfedgeCount(), Motion::Identity());
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    if (surface.twin(h) != kNone) continue;
    Index at = boundary.edges[surface.tail(h)];
    for (Index n = 0; n < boundary.steps[h]; ++n) {
      // Around the head to the next edge of the boundary.
      at = Connectivity::next(at);
      while (b.twin(at) != kNone) {
        transitions[h] = plane.normalized(Motion(transitions[h] * cover.across[at]));
        at = Connectivity::next(b.twin(at));
      }
    }
  }
  return transitions;
}

CoverMap doubledMap(const Connectivity& surface, const DoubleCover& surface_double,
                    const CoverSurface& cover, const BoundaryMap& boundary, const CoverMap& half) {
  const Connectivity& doubled = surface_double.connectivity;
  const CoverPlane plane = cover.plane();
  const Index faces = surface.faceCount(), cover_faces = cover.surface.faceCount() / 2;
  CoverMap result = half;
  result.images.resize(doubled.vertexCount());
  result.places.resize(doubled.vertexCount());
  result.transitions.resize(doubled.halfedgeCount());
  // Per vertex of A: from the coordinates of its image's face to those where its mirror is.
  std::vector<Motion> reflections;
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    reflections.push_back(reflectionOf(cover, half.images[v].face));
    if (surface.isBoundaryVertex(v)) {
      reflections[v] = cover.across[boundary.edges[v]] * reflections[v];
      continue;
    }
    const Index mirror = surface_double.involution[v];
    result.images[mirror] = mirrored(half.images[v], cover_faces);
    result.places[mirror] = cover.place(result.images[mirror]);
  }
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    const Motion back = plane.inverse(half.transitions[h]);
    result.transitions[mirrorHalfedge(h, faces)] =
        surface.twin(h) == kNone ? back
                                 : plane.normalized(Motion(reflections[surface.head(h)] * back *
                                                           reflections[surface.tail(h)].inverse()));
  }
  return result;
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
