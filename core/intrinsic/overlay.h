#pragma once

#include <vector>

#include "core/base/context.h"
#include "core/intrinsic/intrinsic_triangulation.h"
#include "core/mesh/connectivity.h"

namespace moduli {

/// Where an edge of the given triangulation crosses one of the final triangulation.
///
/// Weights are projective: the point of the final edge is (weight_tail * tail + weight_head *
/// head), divided by the sum of the weights, in the metric before scaling. Where half chords are
/// multiplied by e^{(u_i + u_j) / 2}, the weight of vertex i is multiplied by e^{-u_i}; then the
/// same formula holds in the scaled metric.
struct Crossing {
  Index halfedge = 0;   ///< Of the final triangulation; the given edge goes from its left to right.
  double fraction = 0;  ///< Of the given edge, from its tail: within (0, 1).
  double weight_tail = 0;
  double weight_head = 0;
};

/// The common refinement of a triangulation and what flips have made of it.
///
/// Both triangulations are geodesic ones of the same ideal hyperbolic surface, decorated with the
/// half chords, and their edges cross as its geodesics do. In every face of either, points are told
/// by projective (circumcircle-preserving) coordinates, under which these are straight lines: a map
/// that is projective on the faces of the overlay is continuous, whatever the factors u. Crossings
/// are found from the flips alone, without a decision on rounded numbers, and their places from
/// products and sums of positive numbers.
/// Where flips of another kind (isometric ones) are among them, given edges stand for the geodesics
/// of the final metric between the same vertices and past the same others: what crosses what, and
/// in which order, is the same, so that it is an overlay all the same, but its map is projective on
/// the final faces alone. Source: Fisher, Springborn, Bobenko and Schroeder 2006 (the overlay under
/// flips); Penner 1987 (lengths); Springborn, Schroeder and Pinkall 2008, section 3.4 (projective
/// interpolation).
class Overlay {
 public:
  /// final_triangulation: with its history. Fails with kCancelled and kDeadlineExceeded. O(flips +
  /// crossings).
  static Result<Overlay> make(Context& context, const IntrinsicTriangulation& final_triangulation);

  /// The triangulation before all flips.
  const Connectivity& given() const { return given_; }

  /// The crossings of a given edge, from the tail of given().halfedge(edge) to its head.
  const std::vector<Crossing>& crossings(Index edge) const { return crossings_[edge]; }

  /// Chords of a given face: the final edges within it.
  struct Chord {
    Index from = 0, to = 0;  ///< Places on the boundary of the face; see boundary().
  };

  /// A point on the boundary of a given face.
  struct BoundaryPoint {
    Index halfedge = 0;  ///< Of the given face, the side on which it is.
    Index crossing = 0;  ///< Number of the crossing along that halfedge; kNone for its tail.
  };
  /// The corners of a face and the crossings on its sides, counter-clockwise from corner 0.
  std::vector<BoundaryPoint> boundary(Index face) const;
  /// The pieces of final edges within a face, as pairs of places in boundary(face). They do not
  /// cross each other.
  std::vector<Chord> chords(Index face) const;

  /// The crossing of a boundary point that is one.
  const Crossing& crossing(const BoundaryPoint& point) const;

 private:
  explicit Overlay(Connectivity given) : given_(std::move(given)) {}
  Index count(Index halfedge) const {
    return static_cast<Index>(crossings_[given_.edge(halfedge)].size());
  }

  Connectivity given_;
  std::vector<std::vector<Crossing>> crossings_;  ///< Per given edge.
};

/// How arcs that cross the sides of a triangle run within it, told from their numbers alone: each
/// cuts off a corner or ends in the corner opposite. count: of the arcs through side 0, 1, 2, side
/// c from corner c to the next. Source: the theory of normal curves.
struct NormalArcs {
  explicit NormalArcs(Index count0, Index count1, Index count2);

  /// Arcs around the corner at the tail of side c.
  Index corner[3];
  /// Arcs that end in the corner opposite side c, through its middle.
  Index ending[3];
};

}  // namespace moduli
