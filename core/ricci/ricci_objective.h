#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/optimize/objective.h"
#include "core/ricci/curvature_model.h"

namespace moduli {

/// The Ricci energy of a model less target . u, for minimizers: its gradient is K - target.
///
///   RicciObjective objective(model, target, start);
///   ASSIGN_OR_RETURN(const Minimum minimum,
///                    minimize(context, objective, objective.start(), options));
///   use(objective.unknowns(minimum.x));
///
/// Convex where the model's energy is; in the Euclidean plane, where no unknown is fixed, constants
/// are in the kernel of the Hessian. With flips the energy is analytic within each cell of u that
/// share a Delaunay triangulation and twice continuously differentiable across; third derivatives
/// are those of the present triangulation, one of two at a border. An affine normal is then that of
/// the present cell: still a direction of descent, as with any third derivatives.
///
/// The value is the model's energy() where there is a formula, good to rounding of the sum over
/// faces. Otherwise (circle packings) it is the line integral of the gradient along the segments
/// between the points moved to, counted from the first one: Clenshaw and Curtis' rule, of 2, 4, ...
/// 64 pieces until it stands to 1e-9 of itself, a move of the model for each point. Moving through
/// other points gives the same value up to that.
///
/// Works on the model it is given, which must live longer. One thread at a time.
/// Source: MATH 6.5, 6.6, 11.9.
class RicciObjective final : public Objective {
 public:
  /// target, start: model.size() entries. fixed: per unknown whether it stays at its start, without
  /// being a variable; empty: none.
  RicciObjective(CurvatureModel& model, Eigen::VectorXd target, Eigen::VectorXd start,
                 const std::vector<bool>& fixed = {});

  Eigen::Index dimension() const override { return static_cast<Eigen::Index>(free_.size()); }
  std::string name() const override { return "ricci"; }
  bool constantsInKernel() const override {
    return model_.scaleFree() && dimension() == model_.size();
  }

  /// Fails as the model's moveTo. The triangulation from which moves start is that of the point
  /// with the smallest gradient so far.
  Status moveTo(Context& context, const Eigen::VectorXd& x) override;
  double value() const override;
  /// Where constants are in the kernel less its mean, which is rounding and the target's own error.
  const Eigen::VectorXd& gradient() const override { return gradient_; }
  const SparseMatrix& hessian() override;
  int patternVersion() const override { return model_.patternVersion(); }
  bool hasThirdDerivatives() const override { return model_.hasThirdDerivatives(); }
  Eigen::VectorXd thirdContraction(const SparseMatrix& weights) const override;

  /// The variables at the start.
  Eigen::VectorXd start() const { return variables(start_); }
  /// All unknowns of the model, and back.
  Eigen::VectorXd unknowns(const Eigen::VectorXd& x) const;
  Eigen::VectorXd variables(const Eigen::VectorXd& u) const;

 private:
  Eigen::VectorXd gradientThere() const;
  Result<double> integral(Context& context, const Eigen::VectorXd& from, const Eigen::VectorXd& to,
                          double first_slope, double last_slope);
  void selectFree(const SparseMatrix& whole);

  CurvatureModel& model_;
  Eigen::VectorXd target_;
  Eigen::VectorXd start_;
  std::vector<Eigen::Index> free_;  ///< Per variable its unknown.

  Eigen::VectorXd x_;  ///< Where the model is; empty after a failure.
  Eigen::VectorXd gradient_;
  double least_gradient_;
  /// The last point that had a value by a line integral.
  Eigen::VectorXd anchor_, anchor_gradient_;
  double anchor_value_ = 0;
  mutable double value_ = 0;
  mutable bool valued_ = false;

  // With fixed unknowns: the Hessian of the variables, and where its entries stand in the model's.
  SparseMatrix hessian_, whole_pattern_;
  std::vector<Eigen::Index> place_;
  int selected_version_ = -1;
};

}  // namespace moduli
