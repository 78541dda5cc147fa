#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/optimize/affine_normal.h"
#include "core/optimize/line_search.h"
#include "core/optimize/objective.h"

namespace moduli {

enum class MinimizeMethod : std::uint8_t { kAffineNormal, kNewton, kLbfgs, kGradient };

/// "affine-normal", "newton", "lbfgs", "gradient".
std::string_view methodName(MinimizeMethod method);
/// kInvalidOption naming the known ones for another name.
Result<MinimizeMethod> methodFromName(std::string_view name);

struct MinimizeOptions {
  MinimizeMethod method = MinimizeMethod::kAffineNormal;
  LineSearchKind line_search = LineSearchKind::kBacktracking;
  /// Of the exact line search: the slope at its end, in shares of that at its start.
  double slope_tolerance = 1e-6;
  /// Stops where the Euclidean norm of the gradient is at most
  /// gradient_tolerance + relative_tolerance * its norm at the start.
  double gradient_tolerance = 1e-10;
  double relative_tolerance = 0;
  int max_iterations = 1000;
  /// Of kAffineNormal; form is chosen by the minimizer.
  AffineNormalOptions affine;
  /// Of kLbfgs: pairs of steps and changes of the gradient kept.
  int memory = 10;
  /// Affine normal and Newton: go on where the Hessian is not positive definite, with a shift.
  bool shift_indefinite = true;
  /// Keeps the points of all iterations.
  bool keep_path = false;
};

/// Why a search ended.
enum class StopReason : std::uint8_t {
  kConverged,  ///< The gradient is below the tolerance, or below its own rounding.
  kMaxIterations,
  kUnboundedBelow,     ///< The value falls without end, or while the unknowns go to infinity.
  kNonFiniteValue,     ///< NaN, or an infinite derivative.
  kSaddle,             ///< The gradient vanishes where the Hessian has a negative eigenvalue.
  kIndefiniteHessian,  ///< Without shift_indefinite: the Hessian (affine normal: on the tangent
                       ///< space too) is not positive definite.
  kLineSearchStuck,    ///< No step along the direction is seen to go down.
};

/// "converged", "max_iterations", "unbounded_below", "non_finite_value", "saddle",
/// "indefinite_hessian", "line_search_stuck".
std::string_view stopReasonName(StopReason reason);

/// One row of the trace. Row 0 is the start; evaluations and factorizations count from there on.
struct MinimizeStep {
  int iteration = 0;
  double value = 0;
  double gradient_norm = 0;  ///< Euclidean.
  double step = 0;           ///< t of x - t d that led here; 0 in row 0.
  double decrease = 0;       ///< g.d of the direction that led here; 0 in row 0.
  int evaluations = 0;
  int factorizations = 0;
};

struct Minimum {
  Eigen::VectorXd x;
  double value = 0;
  double gradient_norm = 0;
  int iterations = 0;
  int evaluations = 0;     ///< Of value and gradient, those for third derivatives too.
  int factorizations = 0;  ///< The one that judges the Hessian at the end too.
  bool converged = false;
  StopReason reason = StopReason::kMaxIterations;
  std::vector<MinimizeStep> trace;
  std::vector<Eigen::VectorXd> path;  ///< With keep_path: of each row of the trace.
};

/// Walks down from `start` to a minimum. The objective is left at the result. start: dimension()
/// finite entries where the value is finite.
///
/// Affine normal and Newton take a Hessian that is not positive definite with a shift
/// (HessianFactor) in all of p, q and P; up to 400 unknowns the affine normal does without while
/// the Hessian is positive definite on the tangent space, so that it stays the same for phi(f).
/// Where the affine correction is not finite or more than ten times as long as the Newton step, the
/// Newton step stands in. A vanishing gradient is judged by the Hessian: a negative eigenvalue
/// makes a saddle; where a Newton step would still gain more than 1e-6 (1 + |f|) the search goes
/// on.
///
/// Whatever ends the search, the last point is kept, and `reason` tells; fails only with
/// kInvalidOption (size or entries of start, no finite value there, tolerances, counts), as the
/// objective does, with kCancelled and kDeadlineExceeded.
/// An iteration costs one to some evaluations; Newton a factorization and a solve more; the affine
/// normal besides the inverse on the pattern and another solve. Stage "minimize", whose fraction is
/// how far the logarithm of the gradient has come. Source: MATH 11.6.
Result<Minimum> minimize(Context& context, Objective& objective, const Eigen::VectorXd& start,
                         const MinimizeOptions& options = {});

}  // namespace moduli
