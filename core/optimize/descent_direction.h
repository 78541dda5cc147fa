#pragma once

#include <Eigen/Core>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/optimize/affine_normal.h"
#include "core/optimize/hessian_factor.h"
#include "core/optimize/lbfgs_memory.h"
#include "core/optimize/minimize.h"

namespace moduli {

/// A direction that a minimizer walks against.
struct Descent {
  Eigen::VectorXd direction;
  double decrease = 0;    ///< gradient . direction.
  double first_step = 1;  ///< What to try first.
  bool lengthen = false;  ///< The length of the direction means nothing.
};

/// The directions of one search, by its method. One thread at a time.
class DescentDirections {
 public:
  DescentDirections(const MinimizeOptions& options, HessianFactor& factor)
      : options_(options), factor_(factor), memory_(options.memory) {}

  /// At x, where the objective is and is left; its gradient is not 0. Fails with
  /// kNotPositiveDefinite (entries that are not finite; the Hessian itself without
  /// shift_indefinite), and as the objective does.
  Result<Descent> at(Context& context, Objective& objective, const Eigen::VectorXd& x);

  /// Tells of the step that was taken along the last direction.
  void taken(double step, const Eigen::VectorXd& moved, const Eigen::VectorXd& gradient_change);

 private:
  Status factorize(Context& context, Objective& objective);
  Result<Descent> byFactor(Context& context, Objective& objective, const Eigen::VectorXd& x);
  Result<Descent> affine(Context& context, Objective& objective, const Eigen::VectorXd& x,
                         const Eigen::VectorXd& newton);
  Result<bool> bordered(Context& context, Objective& objective, const Eigen::VectorXd& x,
                        Descent& descent);
  Descent byGradients(const Objective& objective);

  const MinimizeOptions& options_;
  HessianFactor& factor_;
  LbfgsMemory memory_;
  double last_step_ = 0;
};

}  // namespace moduli
