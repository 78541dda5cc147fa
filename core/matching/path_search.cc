#include "core/matching/path_search.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace moduli {

PathSearch::PathSearch(const CoverSurface& cover, Index vertices)
    : cover_(cover),
      plane_(cover.geometry),
      frames_(vertexFrames(cover)),
      links_(ownLinks(cover, frames_)),
      vertices_(vertices),
      state_(vertices),
      most_(300 + vertices / 100) {}

void PathSearch::start(const SurfacePoint& point) {
  ++now_;
  taken_ = 0;
  queue_ = {};
  face_ = point.face;
  for (int c = 0; c < 3; ++c) {
    const Index h = 3 * point.face + c;
    queue_.push({toCorner(point, c), cover_.surface.tail(h), h, true});
  }
}

std::optional<Motion> PathSearch::find(const SurfacePoint& point) {
  if (point.face == face_) return Motion::Identity();
  std::array<double, 3> rest;
  for (int c = 0; c < 3; ++c) rest[c] = toCorner(point, c);
  while (true) {
    int nearest = -1;
    double least = 0;
    for (int c = 0; c < 3; ++c) {
      const State& corner = state_[cover_.surface.tail(3 * point.face + c)];
      if (corner.round != now_) continue;
      const double distance = corner.distance + rest[c];
      if (nearest >= 0 && distance >= least) continue;
      least = distance;
      nearest = c;
    }
    if (nearest >= 0 && (queue_.empty() || queue_.top().distance >= least)) {
      const Index h = 3 * point.face + nearest;
      return plane_.normalized(
          Motion(state_[cover_.surface.tail(h)].motion * plane_.inverse(frames_[h])));
    }
    if (queue_.empty() || taken_ >= most_) return std::nullopt;
    takeNext();
  }
}

/// Within the face as the surface has it.
double PathSearch::toCorner(const SurfacePoint& point, int c) const {
  const Index h = 3 * point.face + c;
  const double p = point.barycentric[(c + 1) % 3], q = point.barycentric[(c + 2) % 3];
  const double a = length(h), b = length(Connectivity::previous(h));
  const double opposite = length(Connectivity::next(h));
  const double square =
      p * p * a * a + q * q * b * b + p * q * (a * a + b * b - opposite * opposite);
  return std::sqrt(std::max(0.0, square));
}

void PathSearch::takeNext() {
  const Candidate next = queue_.top();
  queue_.pop();
  State& state = state_[next.vertex];
  if (state.round == now_) return;
  ++taken_;
  state.round = now_;
  state.distance = next.distance;
  const Connectivity& surface = cover_.surface;
  const Index from = next.halfedge;
  state.motion = next.is_first
                     ? frames_[from]
                     : plane_.normalized(Motion(state_[surface.tail(from)].motion * links_[from]));
  const Index first = surface.outgoing(next.vertex);
  Index h = first;
  do {
    const Index beyond = surface.head(h);
    if (beyond < vertices_ && state_[beyond].round != now_) {
      queue_.push({next.distance + length(h), beyond, h, false});
    }
    h = surface.rotate(h);
  } while (h != first);
}

}  // namespace moduli
