#pragma once

#include <vector>

#include "core/base/context.h"
#include "core/matching/plane_motion.h"
#include "core/mesh/connectivity.h"

/// Maps of a triangulated surface to another one by lifts to the plane that covers the latter.
///
/// A map is kept by what each vertex sees from its image: per halfedge a motion, from a frame at
/// the image of its head to one at that of its tail (both 0), the lifts being those that the edge
/// joins. Inverse for twins; their product around a face is 1. Nothing depends on where in the
/// plane the lifts are. Surfaces with boundary are mapped to halves of doubles, and the boundary to
/// geodesics, on which its vertices slide: the map is then half of one of their doubles.
namespace moduli {

using VertexLinks = std::vector<Motion>;

struct HarmonicMap {
  VertexLinks links;
  std::vector<Motion> moves;  ///< Per vertex: from its final frame to that at the start.
  /// 1/2 sum of w d^2; without the pulls. For cotan weights at least the area covered.
  double energy = 0;
  double last_step = 0;  ///< Of a vertex, relative to the longest edge there.
  int iterations = 0;
  Index folded_faces = 0;
};

struct HarmonicOptions {
  /// Per vertex: weight of the square of the distance from the start. Empty: none.
  std::vector<double> pulls = {};
  /// Per vertex of a boundary the direction, of length 1, from its frame in which the line runs
  /// that it stays on; 0 inside. Empty: no vertex is bound.
  std::vector<Eigen::Vector2d> slides = {};
  /// Per vertex where the search begins, as HarmonicMap::moves; the links are those there. Empty:
  /// at the start.
  std::vector<Motion> moves = {};
  double tolerance = 1e-7;  ///< The last step, of the longest edge at its vertex.
  int most_iterations = 60;
};

/// The map of least energy 1/2 sum of w_e d_e^2 in the homotopy class of the start. weights: per
/// edge. With weights > 0 and without pulls there is one (of tori up to a shift: vertex 0 stays, or
/// the first that is bound), and where the start is homotopic to a homeomorphism that keeps
/// orientation no face of it folds.
///
/// Newton's method with the exact Hessian, which is positive semidefinite for weights >= 0. Fails
/// with kInvalidOption (sizes), kNoConvergence, and as SpdSolver does. One factorization of 2 V
/// unknowns a step, 5 to 10 of these. Stages: "harmonic" and SpdSolver's.
/// Source: MATH 9.4; Colin de Verdière 1991; Luo, Wu and Zhu 2021.
Result<HarmonicMap> harmonicMap(Context& context, Geometry geometry, const Connectivity& surface,
                                const std::vector<double>& weights, VertexLinks start,
                                const HarmonicOptions& options = {});

/// Cotan weights, kept between a hundredth of the median of their absolute values and a hundred
/// times that. lengths: per edge. O(F).
std::vector<double> positiveWeights(const Connectivity& surface,
                                    const std::vector<double>& lengths);

/// Per face whether the map turns it over or lays it flat. O(F).
std::vector<bool> foldedFaces(const Connectivity& surface, const VertexLinks& links);
/// How many these are. O(F).
Index countFolded(const Connectivity& surface, const VertexLinks& links);

/// The signed area that the map covers: a whole multiple of the other surface's. O(F).
double coveredArea(Geometry geometry, const Connectivity& surface, const VertexLinks& links);

/// The largest distance of the product around a face from 1, entry by entry. O(F).
double closureResidual(const Connectivity& surface, const VertexLinks& links);

}  // namespace moduli
