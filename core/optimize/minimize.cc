#include "core/optimize/minimize.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "core/base/text.h"
#include "core/optimize/counted_objective.h"
#include "core/optimize/descent_direction.h"

namespace moduli {
namespace {

constexpr double kRounding = std::numeric_limits<double>::epsilon();
/// In units of rounding of the Hessian's norm times the point: what a gradient is off by when the
/// point is the best that a double can name, and when it is a few steps of rounding away.
constexpr double kNamedBest = 4;
constexpr double kGradientNoise = 64;
/// Of the norm of the Hessian: negative eigenvalues above it are rounding.
constexpr double kSemidefinite = 1e-10;
/// Of 1 + |value|: a Newton step that gains more than this does not start at a minimum.
constexpr double kStillGaining = 1e-6;
/// Of the value: what a Newton step gains where only rounding of the gradient is left, and where
/// rounding of the value has stopped a search.
constexpr double kNothingToGain = 1e-20;
constexpr double kBlurred = 1e-13;
/// Steps without progress after which rounding is suspected, with and without the Hessian.
constexpr int kStalls = 5;
constexpr int kSlowStalls = 50;
constexpr double kProgress = 0.9;
constexpr double kFar = 1e100;

struct MethodName {
  MinimizeMethod method;
  std::string_view name;
};
constexpr std::array<MethodName, 4> kMethods{{{MinimizeMethod::kAffineNormal, "affine-normal"},
                                              {MinimizeMethod::kNewton, "newton"},
                                              {MinimizeMethod::kLbfgs, "lbfgs"},
                                              {MinimizeMethod::kGradient, "gradient"}}};

Status atLeastZero(const char* name, double value) {
  if (value >= 0 && std::isfinite(value)) return {};
  return {Reason::kInvalidOption,
          std::string(name) + " is " + shortestDouble(value) + ", a number of at least 0 is needed",
          "1e-10 serves most"};
}

Status checkOptions(const Objective& objective, const MinimizeOptions& options) {
  RETURN_IF_ERROR(atLeastZero("gradient_tolerance", options.gradient_tolerance));
  RETURN_IF_ERROR(atLeastZero("relative_tolerance", options.relative_tolerance));
  if (!(options.slope_tolerance > 0 && options.slope_tolerance < 1)) {
    return {Reason::kInvalidOption, "slope_tolerance is " +
                                        shortestDouble(options.slope_tolerance) +
                                        ", a number between 0 and 1 is needed"};
  }
  if (options.max_iterations < 0) {
    return {Reason::kInvalidOption,
            "max_iterations is " + std::to_string(options.max_iterations) + ", below 0"};
  }
  if (options.memory < 1) {
    return {Reason::kInvalidOption,
            "memory is " + std::to_string(options.memory) + ", at least 1 pair is needed"};
  }
  if (options.method != MinimizeMethod::kAffineNormal) return {};
  return checkOptions(objective, options.affine);
}

Status checkStart(const Objective& objective, const Eigen::VectorXd& start) {
  if (start.size() != objective.dimension()) {
    return {Reason::kInvalidOption,
            "the start has " + std::to_string(start.size()) + " entries, " + objective.name() +
                " has " + std::to_string(objective.dimension()) + " unknowns",
            "give one entry for each unknown"};
  }
  for (Eigen::Index i = 0; i < start.size(); ++i) {
    if (std::isfinite(start[i])) continue;
    return {Reason::kInvalidOption,
            "entry " + std::to_string(i) + " of the start is " + shortestDouble(start[i]),
            "give finite numbers"};
  }
  return {};
}

class Minimizer {
 public:
  Minimizer(Context& context, Objective& objective, const MinimizeOptions& options)
      : context_(context),
        objective_(objective),
        options_(options),
        directions_(options, factor_) {}

  Result<Minimum> run(const Eigen::VectorXd& start) {
    RETURN_IF_ERROR(begin(start));
    while (true) {
      RETURN_IF_ERROR(context_.check());
      ASSIGN_OR_RETURN(const bool stop, stops());
      if (stop) break;
      ASSIGN_OR_RETURN(const bool moved, step());
      if (!moved) break;
      report();
    }
    RETURN_IF_ERROR(objective_.moveTo(context_, result_.x));
    result_.converged = result_.reason == StopReason::kConverged;
    result_.evaluations = objective_.evaluations();
    result_.factorizations = factor_.factorizations();
    return std::move(result_);
  }

 private:
  Status begin(const Eigen::VectorXd& start) {
    RETURN_IF_ERROR(objective_.moveTo(context_, start));
    if (!std::isfinite(objective_.value()) || !objective_.gradient().allFinite()) {
      return {Reason::kInvalidOption,
              objective_.name() + " has the value " + shortestDouble(objective_.value()) +
                  " at the start",
              "start where value and gradient are finite"};
    }
    result_.x = start;
    gradient_ = objective_.gradient();
    keep(objective_.value(), 0, 0);
    first_norm_ = best_norm_ = result_.gradient_norm;
    best_value_ = result_.value;
    tolerance_ = options_.gradient_tolerance + options_.relative_tolerance * first_norm_;
    return {};
  }

  void keep(double value, double step, double decrease) {
    result_.value = value;
    result_.gradient_norm = gradient_.norm();
    result_.trace.push_back({result_.iterations, value, result_.gradient_norm, step, decrease,
                             objective_.evaluations(), factor_.factorizations()});
    if (options_.keep_path) result_.path.push_back(result_.x);
  }

  bool end(StopReason reason) {
    result_.reason = reason;
    return true;
  }

  Result<bool> stops() {
    const bool small = result_.gradient_norm <= tolerance_ || isRounding(kNamedBest);
    if (small || stalls_ >= patience()) {
      ASSIGN_OR_RETURN(const Verdict verdict, judge(kNothingToGain));
      if (verdict == Verdict::kNotFinite) return end(StopReason::kNonFiniteValue);
      if (verdict == Verdict::kSaddle && small) return end(StopReason::kSaddle);
      if (verdict == Verdict::kMinimum || (small && verdict == Verdict::kSmall)) {
        return end(StopReason::kConverged);
      }
      if (result_.gradient_norm == 0) return end(StopReason::kSaddle);
      if (!small) return end(StopReason::kLineSearchStuck);
    }
    if (result_.iterations >= options_.max_iterations) return end(StopReason::kMaxIterations);
    if (result_.x.cwiseAbs().maxCoeff() > kFar) return end(StopReason::kUnboundedBelow);
    return false;
  }

  /// Whether the gradient is below its own rounding, by the Hessian last factorized.
  bool isRounding(double units) const {
    const double size = result_.x.cwiseAbs().maxCoeff();
    return result_.gradient_norm <= units * kRounding * factor_.norm() * size;
  }

  int patience() const {
    const bool second_order = options_.method == MinimizeMethod::kAffineNormal ||
                              options_.method == MinimizeMethod::kNewton;
    return second_order ? kStalls : kSlowStalls;
  }

  /// What the Hessian says of a point where the gradient is small.
  enum class Verdict {
    kMinimum,  ///< The gradient is rounding.
    kSmall,    ///< There is nothing worth going for.
    kGaining,  ///< A Newton step would still gain.
    kSaddle,   ///< There is a negative eigenvalue.
    kNotFinite,
  };

  Result<Verdict> judge(double nothing_to_gain) {
    RETURN_IF_ERROR(objective_.moveTo(context_, result_.x));
    const Status status =
        factor_.factorize(context_, objective_, HessianFactor::Indefinite::kShift);
    if (!std::isfinite(factor_.norm())) return Verdict::kNotFinite;
    RETURN_IF_ERROR(status);
    const double scale = factor_.norm() > 0 ? factor_.norm() : 1;
    if (factor_.shift() > kSemidefinite * scale) return Verdict::kSaddle;
    if (isRounding(kGradientNoise)) return Verdict::kMinimum;
    ASSIGN_OR_RETURN(const Eigen::VectorXd newton, factor_.solve(context_, gradient_));
    const double gain = 0.5 * gradient_.dot(newton);
    if (gain <= nothing_to_gain * std::abs(result_.value)) return Verdict::kMinimum;
    if (factor_.shift() > 0) return Verdict::kSmall;
    return gain <= kStillGaining * (1 + std::abs(result_.value)) ? Verdict::kSmall
                                                                 : Verdict::kGaining;
  }

  /// False where the search ends.
  Result<bool> step() {
    RETURN_IF_ERROR(objective_.moveTo(context_, result_.x));
    Result<Descent> descent = directions_.at(context_, objective_, result_.x);
    if (descent.status().reason() == Reason::kNotPositiveDefinite) {
      end(std::isfinite(factor_.norm()) ? StopReason::kIndefiniteHessian
                                        : StopReason::kNonFiniteValue);
      return false;
    }
    RETURN_IF_ERROR(descent.status());
    if (!descent->direction.allFinite() || !(descent->decrease > 0)) {
      return stuck();
    }
    LineSearchOptions line;
    line.kind = options_.line_search;
    line.first_step = descent->first_step;
    line.lengthen = descent->lengthen;
    line.slope_tolerance = options_.slope_tolerance;
    ASSIGN_OR_RETURN(LineStep found,
                     searchLine(context_, objective_, result_.x, descent->direction, line));
    return take(*descent, std::move(found));
  }

  Result<bool> take(const Descent& descent, LineStep found) {
    switch (found.end) {
      case LineSearchEnd::kUnbounded:
        end(StopReason::kUnboundedBelow);
        return false;
      case LineSearchEnd::kNotANumber:
        end(StopReason::kNonFiniteValue);
        return false;
      case LineSearchEnd::kStuck:
        return stuck();
      case LineSearchEnd::kFound:
        break;
    }
    directions_.taken(found.step, found.x - result_.x, found.gradient - gradient_);
    ++result_.iterations;
    const bool same = found.x == result_.x;
    result_.x = std::move(found.x);
    gradient_ = std::move(found.gradient);
    keep(found.value, found.step, descent.decrease);
    const bool better =
        result_.value < best_value_ || result_.gradient_norm < kProgress * best_norm_;
    stalls_ = better ? 0 : stalls_ + 1;
    if (same) stalls_ = kSlowStalls;
    if (better) best_norm_ = std::min(best_norm_, result_.gradient_norm);
    best_value_ = std::min(best_value_, result_.value);
    return true;
  }

  /// No step goes down: at a minimum that rounding has blurred, that is all one can ask.
  Result<bool> stuck() {
    ASSIGN_OR_RETURN(const Verdict verdict, judge(kBlurred));
    end(verdict == Verdict::kMinimum ? StopReason::kConverged : StopReason::kLineSearchStuck);
    return false;
  }

  void report() {
    const double all = std::log(first_norm_ / std::max(tolerance_, kRounding * first_norm_));
    const double done = std::log(first_norm_ / result_.gradient_norm);
    context_.report("minimize", all > 0 ? std::clamp(done / all, 0.0, 1.0) : 1.0);
  }

  Context& context_;
  CountedObjective objective_;
  const MinimizeOptions& options_;
  HessianFactor factor_;
  DescentDirections directions_;
  Eigen::VectorXd gradient_;
  Minimum result_;
  double first_norm_ = 0;
  double tolerance_ = 0;
  double best_value_ = 0;
  double best_norm_ = 0;
  int stalls_ = 0;
};

}  // namespace

std::string_view methodName(MinimizeMethod method) {
  for (const MethodName& known : kMethods) {
    if (known.method == method) return known.name;
  }
  return "";
}

Result<MinimizeMethod> methodFromName(std::string_view name) {
  for (const MethodName& known : kMethods) {
    if (known.name == name) return known.method;
  }
  return Status{Reason::kInvalidOption, "there is no method '" + std::string(name) + "'",
                "the methods are affine-normal, newton, lbfgs, gradient"};
}

std::string_view stopReasonName(StopReason reason) {
  switch (reason) {
    case StopReason::kConverged:
      return "converged";
    case StopReason::kMaxIterations:
      return "max_iterations";
    case StopReason::kUnboundedBelow:
      return "unbounded_below";
    case StopReason::kNonFiniteValue:
      return "non_finite_value";
    case StopReason::kSaddle:
      return "saddle";
    case StopReason::kIndefiniteHessian:
      return "indefinite_hessian";
    case StopReason::kLineSearchStuck:
      return "line_search_stuck";
  }
  return "";
}

Result<Minimum> minimize(Context& context, Objective& objective, const Eigen::VectorXd& start,
                         const MinimizeOptions& options) {
  const Context::Stage stage(context, "minimize");
  RETURN_IF_ERROR(checkOptions(objective, options));
  RETURN_IF_ERROR(checkStart(objective, start));
  RETURN_IF_ERROR(context.check());
  return Minimizer(context, objective, options).run(start);
}

}  // namespace moduli
