#include "core/ricci/flow.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/base/text.h"
#include "core/ricci/newton_system.h"

namespace moduli {
namespace {

/// A step this small, in units of the stable explicit one, has failed for other reasons.
constexpr double kSmallestStep = 1e-9;
/// 1 / dt stays this far above the rounding of H, so that 1 / dt + H is positive definite.
constexpr double kLargestStep = 1e10;
constexpr double kGrowth = 4;
/// The norm may grow by its rounding: this, times the square root of the number of unknowns.
constexpr double kRounding = 1e-14;

class Flow {
 public:
  Flow(Context& context, CurvatureModel& model, const Eigen::VectorXd& target,
       const FlowOptions& options)
      : context_(context), model_(model), target_(target), options_(options) {}

  Result<FlowResult> run(const Eigen::VectorXd& start) {
    result_.u = start;
    RETURN_IF_ERROR(model_.moveTo(context_, start));
    arrive(missing(), 0);
    for (int step = 0; result_.residual > options_.tolerance; ++step) {
      if (step == options_.max_steps) return stalled("after " + std::to_string(step) + " steps");
      RETURN_IF_ERROR(context_.check());
      RETURN_IF_ERROR(tryStep());
      if (reach_ < kSmallestStep) return stalled("where no step made it smaller");
    }
    return std::move(result_);
  }

 private:
  /// target - K: less its mean where the model is free of scale, 0 where u is fixed.
  Eigen::VectorXd missing() const {
    Eigen::VectorXd rest = target_ - model_.curvature();
    if (scaleFree()) rest.array() -= rest.mean();
    for (std::size_t n = 0; n < options_.fixed.size(); ++n) {
      if (options_.fixed[n]) rest[static_cast<Eigen::Index>(n)] = 0;
    }
    return rest;
  }

  bool scaleFree() const {
    return model_.scaleFree() && model_.size() > 0 &&
           std::find(options_.fixed.begin(), options_.fixed.end(), true) == options_.fixed.end();
  }

  /// The model is at result_.u.
  void arrive(Eigen::VectorXd rest, double time) {
    model_.accept();
    rest_ = std::move(rest);
    result_.residual = rest_.size() == 0 ? 0 : rest_.cwiseAbs().maxCoeff();
    result_.history.push_back({time, result_.residual});
    const double first = result_.history.front().residual;
    if (result_.residual > 0 && first > options_.tolerance) {
      const double done = std::log(first / result_.residual) / std::log(first / options_.tolerance);
      context_.report("flow", std::clamp(done, 0.0, 1.0));
    }
    if (result_.residual <= options_.tolerance) return;
    hessian_ = model_.hessian();
    pattern_ = model_.patternVersion();
    // Without any proper face there is no stiffness, and any step is stable.
    const double sum = maximumNorm(hessian_);
    unit_step_ = sum > 0 ? 1 / sum : 1;
  }

  /// One attempt; reach_ says how long the next one is.
  Status tryStep() {
    const double dt = reach_ * unit_step_;
    Eigen::VectorXd change = dt * rest_;
    if (options_.steps == FlowSteps::kSemiImplicit) {
      ASSIGN_OR_RETURN(change, implicitChange(dt));
    }
    if (scaleFree()) change.array() -= change.mean();
    const Eigen::VectorXd there = result_.u + change;
    const Status moved = model_.moveTo(context_, there);
    if (!moved.ok() && moved.reason() != Reason::kNoConvergence) return moved;
    if (moved.ok()) {
      Eigen::VectorXd rest = missing();
      const double allowed = rest_.norm() + kRounding * std::sqrt(static_cast<double>(rest.size()));
      if (rest.norm() <= allowed) {
        result_.u = there;
        result_.last_change = change.cwiseAbs().maxCoeff();
        arrive(std::move(rest), result_.history.back().time + dt);
        if (!shortened_) lengthen();
        shortened_ = false;
        return {};
      }
    }
    ++result_.rejected_steps;
    shortened_ = true;
    reach_ /= options_.steps == FlowSteps::kExplicit ? 2 : kGrowth;
    return {};
  }

  void lengthen() {
    reach_ = options_.steps == FlowSteps::kExplicit ? std::min(1.0, 2 * reach_)
                                                    : std::min(kLargestStep, kGrowth * reach_);
  }

  /// Solves (1 / dt + H) change = target - K.
  Result<Eigen::VectorXd> implicitChange(double dt) {
    SparseMatrix matrix = hessian_;
    for (Eigen::Index k = 0; k < matrix.outerSize(); ++k) matrix.coeffRef(k, k) += 1 / dt;
    return system_.direction(context_, matrix, pattern_, false, options_.fixed, -rest_);
  }

  Status stalled(const std::string& where) const {
    return {Reason::kNoConvergence,
            "the Ricci flow left a curvature residual of " + shortestDouble(result_.residual) +
                " " + where + "; " + shortestDouble(options_.tolerance) + " is wanted",
            "fixed triangles may have no such metric: try vertex scaling, which flips edges, or "
            "allow more steps"};
  }

  Context& context_;
  CurvatureModel& model_;
  const Eigen::VectorXd& target_;
  const FlowOptions& options_;
  FlowResult result_;
  Eigen::VectorXd rest_;  ///< missing() at result_.u.
  SparseMatrix hessian_;  ///< At result_.u, with the version of its pattern.
  int pattern_ = 0;
  double unit_step_ = 1;    ///< The stable explicit step at result_.u.
  double reach_ = 1;        ///< The next step, in units of unit_step_.
  bool shortened_ = false;  ///< The last attempt was too long.
  NewtonSystem system_;
};

}  // namespace

Result<FlowResult> ricciFlow(Context& context, CurvatureModel& model, const Eigen::VectorXd& target,
                             const Eigen::VectorXd& start, const FlowOptions& options) {
  if (target.size() != model.size() || start.size() != model.size()) {
    return Status{Reason::kInvalidOption, std::to_string(target.size()) + " targets and " +
                                              std::to_string(start.size()) + " values for " +
                                              std::to_string(model.size()) + " unknowns"};
  }
  if (!(options.tolerance > 0) || options.max_steps < 0) {
    return Status{Reason::kInvalidOption,
                  "a flow needs a tolerance above 0 and no negative number "
                  "of steps"};
  }
  if (!target.allFinite()) {
    return Status{Reason::kInvalidOption, "a target curvature is not finite"};
  }
  return Flow(context, model, target, options).run(start);
}

}  // namespace moduli
