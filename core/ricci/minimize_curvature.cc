#include "core/ricci/minimize_curvature.h"

#include <cmath>
#include <cstddef>
#include <string>

#include "core/base/text.h"
#include "core/optimize/minimize.h"
#include "core/ricci/flow.h"
#include "core/ricci/ricci_objective.h"

namespace moduli {
namespace {

/// L-BFGS steps that cost about one of Newton's, and more.
constexpr int kCheapSteps = 100;
/// Where the value no longer changes, gradients of L-BFGS rise and fall for longer than a minimizer
/// waits: then it goes on from where it is.
constexpr int kMaxRounds = 50;

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

MinimizeOptions optionsFor(MinimizeMethod method, const NewtonOptions& options,
                           Eigen::Index dimension) {
  MinimizeOptions result;
  result.method = method;
  // Below it the root mean square of the residuals is below the tolerance of the largest.
  result.gradient_tolerance = options.tolerance * std::sqrt(static_cast<double>(dimension));
  result.max_iterations =
      options.max_iterations * (method == MinimizeMethod::kLbfgs ? kCheapSteps : 1);
  return result;
}

Result<RicciSolution> minimizeTo(Context& context, CurvatureModel& model,
                                 const Eigen::VectorXd& target, const Eigen::VectorXd& start,
                                 const NewtonOptions& options, MinimizeMethod method) {
  RicciObjective objective(model, target, start, options.fixed);
  if (objective.dimension() == 0) return RicciSolution{start, {0}};
  MinimizeOptions how = optionsFor(method, options, objective.dimension());
  RicciSolution solution;
  Minimum minimum;
  minimum.x = objective.start();
  for (int round = 0; round < kMaxRounds; ++round) {
    ASSIGN_OR_RETURN(minimum, minimize(context, objective, minimum.x, how));
    const std::size_t known = solution.residuals.empty() ? 0 : 1;
    for (std::size_t n = known; n < minimum.trace.size(); ++n) {
      solution.residuals.push_back(minimum.trace[n].gradient_norm);
    }
    how.max_iterations -= minimum.iterations;
    const bool small = objective.gradient().cwiseAbs().maxCoeff() <= options.acceptable;
    const bool stopped =
        minimum.reason == StopReason::kConverged || minimum.reason == StopReason::kLineSearchStuck;
    if (small || !stopped || minimum.iterations == 0) break;
  }
  solution.u = objective.unknowns(minimum.x);
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
