#pragma once

#include <optional>
#include <queue>
#include <vector>

#include "core/matching/cover_surface.h"

namespace moduli {

/// Finds points of a cover from one outwards, in the order of the lengths of the ways there along
/// edges of the surface itself, and what these ways make of coordinates. Refers to the cover. Not
/// thread-safe.
class PathSearch {
 public:
  /// vertices: ways go through the first so many. Nothing farther than some hundred of them is
  /// found. O(F).
  PathSearch(const CoverSurface& cover, Index vertices);

  void start(const SurfacePoint& point);

  /// From here on nothing is far away.
  void searchAll() { most_ = vertices_; }

  /// From the coordinates of a point's face to those of the start, along the shortest way; nothing
  /// where it is far away. O(log V) for each vertex nearer than the point, once a start.
  std::optional<Motion> find(const SurfacePoint& point);

 private:
  struct State {
    int round = 0;
    double distance = 0;
    Motion motion;  ///< From the vertex' frame to the coordinates of the start.
  };
  struct Candidate {
    double distance = 0;
    Index vertex = kNone;
    Index halfedge = kNone;  ///< That leads there, or whose tail it is in the face of the start.
    bool is_first = false;
    bool operator<(const Candidate& other) const {
      return distance != other.distance ? distance > other.distance : halfedge > other.halfedge;
    }
  };

  double length(Index h) const { return cover_.lengths[cover_.surface.edge(h)]; }
  double toCorner(const SurfacePoint& point, int c) const;
  void takeNext();

  const CoverSurface& cover_;
  CoverPlane plane_;
  std::vector<Motion> frames_;
  VertexLinks links_;
  Index vertices_;
  std::vector<State> state_;  ///< Per vertex.
  std::priority_queue<Candidate> queue_;
  Index face_ = kNone;
  int now_ = 0;
  Index taken_ = 0, most_ = 0;
};

}  // namespace moduli
