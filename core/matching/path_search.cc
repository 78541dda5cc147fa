#include "core/matching/path_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace moduli {

PathSearch::PathSearch(const CoverSurface& cover, Index vertices)
    : cover_(&cover),
      plane_(cover.geometry),
      vertices_(vertices),
      slots_(vertices, 0),
      most_(300 + static_cast<std::size_t>(vertices) / 100) {
  Frames frames;
  frames.corners = vertexFrames(cover);
  frames.links = ownLinks(cover, frames.corners);
  frames_ = std::make_shared<const Frames>(std::move(frames));
}

void PathSearch::start(const SurfacePoint& point) {
  reached_.clear();
  queue_.clear();
  face_ = point.face;
  for (int c = 0; c < 3; ++c) {
    const Index h = 3 * point.face + c;
    const Index v = cover_->surface.tail(h);
    if (v < vertices_) push({toCorner(point, c), v, h, true});
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
      const Reached* corner = at(cover_->surface.tail(3 * point.face + c));
      if (corner == nullptr) continue;
      const double distance = corner->distance + rest[c];
      if (nearest >= 0 && distance >= least) continue;
      least = distance;
      nearest = c;
    }
    if (nearest >= 0 && (queue_.empty() || queue_.front().distance >= least)) {
      const Index h = 3 * point.face + nearest;
      return plane_.normalized(
          Motion(motionTo(cover_->surface.tail(h)) * plane_.inverse(frames_->corners[h])));
    }
    if (queue_.empty() || reached_.size() >= most_) return std::nullopt;
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

/// Nothing where the search has not come yet, or does not go.
PathSearch::Reached* PathSearch::at(Index v) {
  if (v >= vertices_) return nullptr;
  const auto slot = static_cast<std::size_t>(slots_[v]);
  return slot < reached_.size() && reached_[slot].vertex == v ? &reached_[slot] : nullptr;
}

/// Few of the vertices reached are asked for it.
const Motion& PathSearch::motionTo(Index v) {
  const Connectivity& surface = cover_->surface;
  way_.clear();
  for (Index w = v; !at(w)->is_moved; w = surface.tail(at(w)->halfedge)) {
    way_.push_back(w);
    if (at(w)->is_first) break;
  }
  motions_.resize(reached_.size());
  for (; !way_.empty(); way_.pop_back()) {
    Reached& reached = *at(way_.back());
    const Index from = reached.halfedge;
    motions_[slots_[way_.back()]] =
        reached.is_first ? frames_->corners[from]
                         : plane_.normalized(
                               Motion(motions_[slots_[surface.tail(from)]] * frames_->links[from]));
    reached.is_moved = true;
  }
  return motions_[slots_[v]];
}

void PathSearch::push(const Candidate& candidate) {
  queue_.push_back(candidate);
  std::push_heap(queue_.begin(), queue_.end());
}

void PathSearch::takeNext() {
  std::pop_heap(queue_.begin(), queue_.end());
  const Candidate next = queue_.back();
  queue_.pop_back();
  if (at(next.vertex) != nullptr) return;
  slots_[next.vertex] = static_cast<Index>(reached_.size());
  reached_.push_back({next.distance, next.vertex, next.halfedge, next.is_first});
  const Connectivity& surface = cover_->surface;
  const Index first = surface.outgoing(next.vertex);
  Index h = first;
  do {
    const Index beyond = surface.head(h);
    if (beyond < vertices_ && at(beyond) == nullptr) {
      push({next.distance + length(h), beyond, h, false});
    }
    h = surface.rotate(h);
  } while (h != first);
}

}  // namespace moduli
