#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/ricci/curvature_model.h"

namespace moduli {

struct NewtonOptions {
  /// Stops where the largest |K - target| is below it. Otherwise the search goes on to where
  /// rounding stops it.
  double tolerance = 1e-13;
  /// A residual above this is not a solution.
  double acceptable = 1e-10;
  int max_iterations = 100;
  /// Per unknown: keep u as it is at the start, and ask for no curvature. Empty: none.
  std::vector<bool> fixed;
};

struct RicciSolution {
  Eigen::VectorXd u;
  /// Before each step and at the end; without their mean where the model is free of scale, for
  /// rounding alone decides about that.
  std::vector<double> residuals;

  double residual() const { return residuals.back(); }
  int iterations() const { return static_cast<int>(residuals.size()) - 1; }
};

/// Finds the u where the curvature is the target: the minimum of the convex Ricci energy, by
/// Newton's method. A step is shortened while the slope of the energy along it has turned by more
/// than a tenth, which needs no value of the energy. The model is left at the solution. target,
/// start: one entry per unknown; target must be admissible.
///
/// Fails with kNoConvergence naming the residual reached, or as the model and SpdSolver do. One
/// factorization and a few moves of the model per step; symbolic work only where the pattern
/// changes. Stages "metric", "analyse", "factorize", "solve". Source: MATH 6.6.
Result<RicciSolution> solveCurvature(Context& context, CurvatureModel& model,
                                     const Eigen::VectorXd& target, const Eigen::VectorXd& start,
                                     const NewtonOptions& options = {});

}  // namespace moduli
