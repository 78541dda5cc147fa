#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/mesh/connectivity.h"
#include "core/ricci/discrete_metric.h"
#include "core/ricci/newton.h"
#include "core/ricci/scheme.h"
#include "core/ricci/vertex_scaling.h"

/// Prescribing curvature on closed surfaces by vertex scaling with flips.
namespace moduli {

struct PrescribeOptions {
  Geometry geometry = Geometry::kEuclidean;  ///< E2 or H2.
  /// Isometric Delaunay flips of the polyhedral metric first; otherwise Ptolemy flips only, from
  /// the surface's own edges.
  bool initial_delaunay = true;
  /// Per unknown: keep the given scale, whatever the curvature there. Empty: none. E2 only.
  std::vector<bool> fixed;
  RicciSolver solver = RicciSolver::kNewton;
};

/// The metrics in the discrete conformal class of a closed polyhedral surface.
///
///   PrescribedCurvature problem(surface, unknowns, options);
///   RETURN_IF_ERROR(problem.start(context, lengths));
///   ASSIGN_OR_RETURN(const DiscreteMetric metric, problem.solve(context, target));
///
/// H2 begins with half chords c * l: a constant c shifts u alone, so that the unit of length plays
/// no role. In E2, where nothing is fixed, only differences of u mean anything.
/// Source: MATH 6.4 to 6.7.
class PrescribedCurvature {
 public:
  /// unknowns: vertices of one orbit are exchanged by a symmetry of the surface.
  PrescribedCurvature(const Connectivity& surface, Unknowns unknowns, PrescribeOptions options);

  /// lengths: per edge, proper Euclidean triangles. Fails as flipToDelaunayIsometric does.
  Status start(Context& context, const std::vector<double>& lengths);

  /// The metric whose curvature is `target`: per vertex, radians, admissible (target_curvature.h),
  /// equal within orbits. Starts from the last solution, if there is one. Fails with kNoConvergence
  /// and as the solvers do. About one factorization per Newton step, 3 to 10 of them on real
  /// surfaces.
  Result<DiscreteMetric> solve(Context& context, const std::vector<double>& target);

  /// Only to a residual of `tolerance`: a step on the way to a target that still moves.
  Result<DiscreteMetric> approach(Context& context, const std::vector<double>& target,
                                  double tolerance);

  /// What a minimizer of the Ricci energy needs to know: per unknown the curvature wanted, and
  /// where solve() would start. Lives as long as the problem.
  struct Search {
    VertexScalingModel& model;
    Eigen::VectorXd target;
    Eigen::VectorXd start;
  };
  /// target: as in solve(). Fails as moves of the model do. O(F) for each of some scalings in H2.
  Result<Search> search(Context& context, const std::vector<double>& target);

 private:
  Result<DiscreteMetric> find(Context& context, const std::vector<double>& target,
                              NewtonOptions options);
  Eigen::VectorXd perUnknown(const std::vector<double>& target) const;
  Status fitScale(Context& context, const Eigen::VectorXd& target);

  Index euler_characteristic_;
  const Connectivity& surface_;
  Unknowns unknowns_;
  PrescribeOptions options_;
  std::optional<VertexScalingModel> model_;
  Eigen::VectorXd u_;
  bool scaled_ = false;
};

/// All of it at once.
Result<DiscreteMetric> prescribeCurvature(Context& context, const Connectivity& surface,
                                          const std::vector<double>& lengths,
                                          const std::vector<double>& target,
                                          const Unknowns& unknowns,
                                          const PrescribeOptions& options = {});

}  // namespace moduli
