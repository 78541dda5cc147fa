#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "core/matching/cover_surface.h"

namespace moduli {

/// Finds points of a cover from one outwards, in the order of the lengths of the ways there along
/// edges of the surface itself, and what these ways make of coordinates. Refers to the cover. Not
/// thread-safe, but a copy searches by itself and shares what does not change.
class PathSearch {
 public:
  /// vertices: ways go through the first so many. Nothing farther than some hundred of them is
  /// found. O(F); a copy O(V).
  PathSearch(const CoverSurface& cover, Index vertices);

  void start(const SurfacePoint& point);

  /// From here on nothing is far away.
  void searchAll() { most_ = std::numeric_limits<std::size_t>::max(); }

  /// From the coordinates of a point's face to those of the start, along the shortest way; nothing
  /// where it is far away. O(log V) for each vertex nearer than the point, once a start.
  std::optional<Motion> find(const SurfacePoint& point);

 private:
  struct Frames {
    std::vector<Motion> corners;  ///< vertexFrames.
    VertexLinks links;            ///< ownLinks.
  };
  /// A vertex that the search has come to.
  struct Reached {
    double distance = 0;
    Index vertex = kNone;
    Index halfedge = kNone;  ///< That leads there, or whose tail it is in the face of the start.
    bool is_first = false;
    bool is_moved = false;  ///< Whether motions_ has it.
  };
  struct Candidate {
    double distance = 0;
    Index vertex = kNone;
    Index halfedge = kNone;
    bool is_first = false;
    bool operator<(const Candidate& other) const {
      return distance != other.distance ? distance > other.distance : halfedge > other.halfedge;
    }
  };

  double length(Index h) const { return cover_->lengths[cover_->surface.edge(h)]; }
  double toCorner(const SurfacePoint& point, int c) const;
  Reached* at(Index v);
  const Motion& motionTo(Index v);
  void push(const Candidate& candidate);
  void takeNext();

  const CoverSurface* cover_;
  CoverPlane plane_;
  std::shared_ptr<const Frames> frames_;
  Index vertices_;
  std::vector<Index> slots_;  ///< Per vertex its place in reached_, of use if that says so, too.
  std::vector<Reached> reached_;
  /// Per place in reached_, where that was asked for: from the vertex' frame to the coordinates of
  /// the start.
  std::vector<Motion> motions_;
  std::vector<Candidate> queue_;  ///< A heap.
  std::vector<Index> way_;        ///< For motionTo.
  Index face_ = kNone;
  std::size_t most_ = 0;
};

}  // namespace moduli
