#pragma once

#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/mesh/connectivity.h"
#include "core/ricci/discrete_metric.h"
#include "core/ricci/vertex_scaling.h"

/// Prescribing curvature on closed surfaces by vertex scaling with flips.
namespace moduli {

struct PrescribeOptions {
  Geometry geometry = Geometry::kEuclidean;  ///< E2 or H2.
  /// Isometric Delaunay flips of the polyhedral metric first; otherwise Ptolemy flips only, from
  /// the surface's own edges.
  bool initial_delaunay = true;
};

/// The metric in the discrete conformal class of a closed polyhedral surface whose curvature is
/// `target`. lengths: per edge, proper Euclidean triangles. target: per vertex, radians, admissible
/// (admissible.h). unknowns: vertices of one orbit must have equal targets and be exchanged by a
/// symmetry of the surface; those of kNone keep their scale and may end at any curvature.
///
/// H2 begins with half chords c * l: a constant c shifts u alone, so that the unit of length plays
/// no role. In E2 u is fixed by a mean of 0 over unknowns where nothing keeps its scale.
/// Fails with kNoConvergence and as the solvers do. About one factorization per Newton step, 4 to 9
/// of them on real surfaces. Source: MATH 6.4 to 6.7.
Result<DiscreteMetric> prescribeCurvature(Context& context, const Connectivity& surface,
                                          const std::vector<double>& lengths,
                                          const std::vector<double>& target,
                                          const Unknowns& unknowns,
                                          const PrescribeOptions& options = {});

}  // namespace moduli
