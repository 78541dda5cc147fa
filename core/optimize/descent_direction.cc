#include "core/optimize/descent_direction.h"

#include <algorithm>
#include <utility>

namespace moduli {
namespace {

/// Up to here a dense form may stand in for a Hessian that is not positive definite.
constexpr Eigen::Index kDense = 400;
/// An affine normal further than this many Newton steps from the Newton step is not trusted.
constexpr double kFarFromNewton = 10;

}  // namespace

Result<Descent> DescentDirections::at(Context& context, Objective& objective,
                                      const Eigen::VectorXd& x) {
  switch (options_.method) {
    case MinimizeMethod::kAffineNormal:
    case MinimizeMethod::kNewton:
      return byFactor(context, objective, x);
    default:
      return byGradients(objective);
  }
}

void DescentDirections::taken(double step, const Eigen::VectorXd& moved,
                              const Eigen::VectorXd& gradient_change) {
  last_step_ = step;
  if (options_.method == MinimizeMethod::kLbfgs) memory_.add(moved, gradient_change);
}

Descent DescentDirections::byGradients(const Objective& objective) {
  const Eigen::VectorXd& gradient = objective.gradient();
  Descent descent;
  descent.direction = memory_.apply(gradient);
  descent.decrease = gradient.dot(descent.direction);
  if (!(descent.decrease > 0)) {
    memory_.clear();
    descent.direction = gradient;
    descent.decrease = gradient.squaredNorm();
  }
  descent.lengthen = true;
  if (!memory_.empty()) return descent;
  const bool first = last_step_ == 0 || options_.method == MinimizeMethod::kLbfgs;
  descent.first_step = first ? std::min(1.0, 1 / gradient.norm()) : 2 * last_step_;
  return descent;
}

/// As the options have it.
Status DescentDirections::factorize(Context& context, Objective& objective) {
  return factor_.factorize(context, objective,
                           options_.shift_indefinite ? HessianFactor::Indefinite::kShift
                                                     : HessianFactor::Indefinite::kFail);
}

Result<Descent> DescentDirections::byFactor(Context& context, Objective& objective,
                                            const Eigen::VectorXd& x) {
  const bool affine_normal = options_.method == MinimizeMethod::kAffineNormal;
  if (affine_normal && objective.dimension() <= kDense) {
    const Status status = factor_.factorize(context, objective, HessianFactor::Indefinite::kFail);
    if (status.reason() == Reason::kNotPositiveDefinite) {
      Descent descent;
      ASSIGN_OR_RETURN(const bool convex, bordered(context, objective, x, descent));
      if (convex) return descent;
      RETURN_IF_ERROR(factorize(context, objective));
    } else {
      RETURN_IF_ERROR(status);
    }
  } else {
    RETURN_IF_ERROR(factorize(context, objective));
  }
  ASSIGN_OR_RETURN(Eigen::VectorXd newton, factor_.solve(context, objective.gradient()));
  if (affine_normal) return affine(context, objective, x, newton);
  Descent descent;
  descent.decrease = objective.gradient().dot(newton);
  if (factor_.fixed() >= 0) newton.array() -= newton.mean();
  descent.direction = std::move(newton);
  descent.lengthen = factor_.shift() > 0;
  return descent;
}

Result<Descent> DescentDirections::affine(Context& context, Objective& objective,
                                          const Eigen::VectorXd& x, const Eigen::VectorXd& newton) {
  Descent descent;
  descent.lengthen = factor_.shift() > 0;
  Result<AffineNormal> normal =
      affineNormalOf(context, objective, x, factor_, newton, options_.affine);
  const bool usable = normal.ok() || normal.status().reason() == Reason::kNoConvergence ||
                      normal.status().reason() == Reason::kNotPositiveDefinite;
  if (!usable) return normal.status();
  RETURN_IF_ERROR(objective.moveTo(context, x));
  Eigen::VectorXd step = newton;
  if (factor_.fixed() >= 0) step.array() -= step.mean();
  if (normal.ok() && normal->direction.allFinite() &&
      (normal->direction - step).norm() <= kFarFromNewton * step.norm()) {
    step = std::move(normal->direction);
  }
  descent.decrease = objective.gradient().dot(step);
  descent.direction = std::move(step);
  return descent;
}

/// Whether the level set is strictly convex although the Hessian is not positive definite; then its
/// affine normal, as long as a cautious step along the gradient.
Result<bool> DescentDirections::bordered(Context& context, Objective& objective,
                                         const Eigen::VectorXd& x, Descent& descent) {
  AffineNormalOptions options = options_.affine;
  options.form = AffineForm::kBordered;
  Result<AffineNormal> normal = affineNormal(context, objective, x, options);
  RETURN_IF_ERROR(objective.moveTo(context, x));
  if (!normal.ok()) {
    const Reason reason = normal.status().reason();
    if (reason == Reason::kNotPositiveDefinite || reason == Reason::kNoConvergence) return false;
    return normal.status();
  }
  if (!normal->convex || !normal->direction.allFinite()) return false;
  const double length = objective.gradient().norm() / factor_.norm();
  descent.direction = length * normal->direction;
  descent.decrease = objective.gradient().dot(descent.direction);
  descent.lengthen = true;
  return descent.decrease > 0;
}

}  // namespace moduli
