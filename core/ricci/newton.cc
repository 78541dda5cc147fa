#include "core/ricci/newton.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include "core/base/text.h"
#include "core/ricci/newton_system.h"

namespace moduli {
namespace {

/// The largest change of a logarithmic factor in one step: a factor of some 10^4.
constexpr double kMaxStep = 10;
/// How far the slope along a step may turn before it is shortened.
constexpr double kSlopeTurn = 0.1;
/// Below this residual Newton's method converges at once, or rounding is all there is.
constexpr double kRoundingRegion = 1e-9;
/// From here on changes of u are counted on their own.
constexpr double kFineRegion = 1e-4;
constexpr int kMaxRescues = 5;
/// A full turn at one vertex: no start for a Newton step.
constexpr double kWild = 2 * std::numbers::pi;
constexpr int kMaxShortenings = 40;
/// Of the norm of the gradient, where relaxation is in place of a short step.
constexpr double kProgress = 0.9;

class Newton {
 public:
  Newton(Context& context, CurvatureModel& model, const Eigen::VectorXd& target,
         const NewtonOptions& options)
      : context_(context), model_(model), target_(target), options_(options) {}

  Result<RicciSolution> run(const Eigen::VectorXd& start) {
    solution_.u = start;
    RETURN_IF_ERROR(model_.moveTo(context_, start));
    if (norm(gradientThere()) > kWild) {
      RETURN_IF_ERROR(model_.relax(context_, target_, options_.fixed, kWild, solution_.u).status());
    }
    keep();
    base_ = Eigen::VectorXd::Zero(start.size());
    while (solution_.residual() > options_.tolerance &&
           solution_.iterations() < options_.max_iterations) {
      if (!fine_ && solution_.residual() < kFineRegion) {
        fine_ = true;
        if (model_.setBase(solution_.u)) std::swap(base_, solution_.u);
      }
      ASSIGN_OR_RETURN(const bool moved, step());
      if (moved) continue;
      if (solution_.residual() <= options_.acceptable) break;
      // No step is short enough: vertices outside their windows, in a Hessian that rounding rules.
      ASSIGN_OR_RETURN(const bool changed,
                       model_.relax(context_, target_, options_.fixed, 1, solution_.u));
      if (!changed || ++rescues_ > kMaxRescues) break;
      keep();
    }
    solution_.u += base_;
    model_.setBase(Eigen::VectorXd::Zero(base_.size()));
    if (solution_.residual() <= options_.acceptable) return std::move(solution_);
    return Status{Reason::kNoConvergence,
                  "the curvature stays " + shortestDouble(solution_.residual()) +
                      " radians off its target after " + std::to_string(solution_.iterations()) +
                      " Newton steps"};
  }

 private:
  /// K - target at the model's metric.
  Eigen::VectorXd gradientThere() const {
    Eigen::VectorXd gradient = model_.curvature() - target_;
    if (scaleFree()) gradient.array() -= gradient.mean();
    for (std::size_t n = 0; n < options_.fixed.size(); ++n) {
      if (options_.fixed[n]) gradient[static_cast<Eigen::Index>(n)] = 0;
    }
    return gradient;
  }

  bool scaleFree() const {
    return model_.scaleFree() && model_.size() > 0 &&
           std::find(options_.fixed.begin(), options_.fixed.end(), true) == options_.fixed.end();
  }

  static double norm(const Eigen::VectorXd& gradient) {
    return gradient.size() == 0 ? 0 : gradient.cwiseAbs().maxCoeff();
  }

  void keep() {
    model_.accept();
    gradient_ = gradientThere();
    solution_.residuals.push_back(norm(gradient_));
  }

  /// One Newton step; false where rounding has the last word. Then the model is back at u.
  Result<bool> step() {
    const double before = solution_.residual();
    const SparseMatrix& hessian = model_.hessian();
    ASSIGN_OR_RETURN(Eigen::VectorXd direction,
                     system_.direction(context_, hessian, model_.patternVersion(), scaleFree(),
                                       options_.fixed, gradient_));
    if (scaleFree()) direction.array() -= direction.mean();
    const double length = norm(direction);
    const double slope = gradient_.dot(direction);
    double t = length > kMaxStep ? kMaxStep / length : 1;
    for (int n = 0; n < kMaxShortenings; ++n) {
      const Eigen::VectorXd there = solution_.u + t * direction;
      const Status moved = model_.moveTo(context_, there);
      double turned = std::numeric_limits<double>::infinity();
      if (moved.ok()) {
        const Eigen::VectorXd gradient = gradientThere();
        const double after = norm(gradient);
        turned = gradient.dot(direction);
        if (before < kRoundingRegion && after > before / 2) {
          if (after < before) return accept(there, false);
          break;
        }
        if (turned <= kSlopeTurn * std::abs(slope) || after < before / 2) {
          return accept(there, true);
        }
        if (n == 0) {
          ASSIGN_OR_RETURN(const bool relaxed, relax(there));
          if (relaxed) return true;
        }
      } else if (moved.reason() != Reason::kNoConvergence) {
        return moved;
      }
      t *= shortening(slope, turned);
    }
    RETURN_IF_ERROR(model_.moveTo(context_, solution_.u));
    return false;
  }

  /// Tries the end of a step that is too long with the worst vertices relaxed.
  Result<bool> relax(Eigen::VectorXd there) {
    ASSIGN_OR_RETURN(const bool changed, model_.relax(context_, target_, options_.fixed,
                                                      solution_.residual() / 2, there));
    if (!changed || gradientThere().norm() > kProgress * gradient_.norm()) return false;
    return accept(there, true);
  }

  /// The secant's guess of where the slope vanishes, kept between a tenth and a half.
  static double shortening(double slope, double turned) {
    if (!std::isfinite(turned)) return 0.5;
    return std::clamp(-slope / (turned - slope), 0.1, 0.5);
  }

  Result<bool> accept(const Eigen::VectorXd& there, bool go_on) {
    solution_.u = there;
    keep();
    return go_on;
  }

  Context& context_;
  CurvatureModel& model_;
  const Eigen::VectorXd& target_;
  const NewtonOptions& options_;
  NewtonSystem system_{kMaxStep};
  Eigen::VectorXd gradient_;
  Eigen::VectorXd base_;
  int rescues_ = 0;
  bool fine_ = false;  ///< u counts from base_.
  RicciSolution solution_;
};

}  // namespace

Result<RicciSolution> solveCurvature(Context& context, CurvatureModel& model,
                                     const Eigen::VectorXd& target, const Eigen::VectorXd& start,
                                     const NewtonOptions& options) {
  return Newton(context, model, target, options).run(start);
}

}  // namespace moduli
