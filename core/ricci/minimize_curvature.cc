#include "core/ricci/minimize_curvature.h"

#include <string>

#include "core/base/text.h"
#include "core/optimize/minimize.h"
#include "core/ricci/flow.h"
#include "core/ricci/ricci_objective.h"

namespace moduli {
namespace {

/// L-BFGS steps that cost about one of Newton's, and more.
constexpr int kCheapSteps = 100;

Result<RicciSolution> flowTo(Context& context, CurvatureModel& model, const Eigen::VectorXd& target,
                             const Eigen::VectorXd& start, const NewtonOptions& options) {
  FlowOptions flow_options;
  flow_options.fixed = options.fixed;
  ASSIGN_OR_RETURN(const FlowResult flow, ricciFlow(context, model, target, start, flow_options));
  RicciSolution solution;
  solution.u = flow.u;
  for (const FlowPoint& point : flow.history) solution.residuals.push_back(point.residual);
  return solution;
}

Result<RicciSolution> minimizeTo(Context& context, CurvatureModel& model,
                                 const Eigen::VectorXd& target, const Eigen::VectorXd& start,
                                 const NewtonOptions& options, MinimizeMethod method) {
  RicciObjective objective(model, target, start, options.fixed);
  if (objective.dimension() == 0) return RicciSolution{start, {0}};
  MinimizeOptions how;
  how.method = method;
  // Of the largest entry, and so of the norm.
  how.gradient_tolerance = options.tolerance;
  how.max_iterations =
      options.max_iterations * (method == MinimizeMethod::kLbfgs ? kCheapSteps : 1);
  how.affine.inverse = [](Context& inner, SpdSolver& solver, const SparseMatrix& pattern) {
    return solver.inverseOnPattern(inner, pattern);
  };
  ASSIGN_OR_RETURN(const Minimum minimum, minimize(context, objective, objective.start(), how));
  RicciSolution solution;
  solution.u = objective.unknowns(minimum.x);
  for (const MinimizeStep& step : minimum.trace) solution.residuals.push_back(step.gradient_norm);
  solution.residuals.back() = objective.gradient().cwiseAbs().maxCoeff();
  if (solution.residual() <= options.acceptable) return solution;
  return Status{Reason::kNoConvergence,
                "the curvature stays " + shortestDouble(solution.residual()) +
                    " radians off its target after " + std::to_string(solution.iterations()) +
                    " steps of " + std::string(methodName(method)) + " (" +
                    std::string(stopReasonName(minimum.reason)) + ")",
                "use Newton's method"};
}

}  // namespace

Result<RicciSolution> findCurvature(Context& context, CurvatureModel& model,
                                    const Eigen::VectorXd& target, const Eigen::VectorXd& start,
                                    const NewtonOptions& options, RicciSolver solver) {
  switch (solver) {
    case RicciSolver::kFlow:
      return flowTo(context, model, target, start, options);
    case RicciSolver::kAffineNormal:
      return minimizeTo(context, model, target, start, options, MinimizeMethod::kAffineNormal);
    case RicciSolver::kLbfgs:
      return minimizeTo(context, model, target, start, options, MinimizeMethod::kLbfgs);
    default:
      return solveCurvature(context, model, target, start, options);
  }
}

}  // namespace moduli
