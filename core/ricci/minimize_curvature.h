#pragma once

#include <Eigen/Core>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/ricci/curvature_model.h"
#include "core/ricci/newton.h"
#include "core/ricci/scheme.h"

namespace moduli {

/// Finds the u where the curvature is the target, by any of the methods of RicciSolver; arguments
/// and the solution are those of solveCurvature.
///
/// kNewton is solveCurvature itself, kFlow the semi-implicit flow to a residual of 1e-11.
/// kAffineNormal and kLbfgs minimize the Ricci energy
/// (ricci_objective.h, core/optimize/minimize.h), the former with third derivatives and a selected
/// inversion of the Hessian in each step; their residuals are Euclidean norms of K - target up to
/// the last one, which is the largest entry as everywhere, and options.tolerance is of the root
/// mean square. They relax no vertices, and count u from 0 to the end: where faces degenerate on
/// the way, Newton's method goes further.
///
/// Fails as these do, with kNoConvergence where the residual stays above options.acceptable; that
/// L-BFGS takes some hundred steps on a mesh of thousands of faces is to be expected: it is given
/// a hundred times options.max_iterations.
Result<RicciSolution> findCurvature(Context& context, CurvatureModel& model,
                                    const Eigen::VectorXd& target, const Eigen::VectorXd& start,
                                    const NewtonOptions& options, RicciSolver solver);

}  // namespace moduli
