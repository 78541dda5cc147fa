#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/linalg/spd_solver.h"

namespace moduli {

/// The linear systems of a Newton iteration whose matrices resemble one another.
///
/// One factorization per solve; the symbolic analysis stays while the pattern does, the
/// fill-reducing ordering for good. A matrix that rounding has robbed of its definiteness gets a
/// diagonal shift, which leaves a direction of descent.
class NewtonSystem {
 public:
  /// reach: where the energy is flat (an angle of almost 0) an unknown would go exponentially far;
  /// the diagonal above lets it go some `reach` without holding the others back, and vanishes with
  /// the gradient, fast enough for quadratic convergence.
  explicit NewtonSystem(double reach = std::numeric_limits<double>::infinity()) : reach_(reach) {}

  /// matrix: symmetric, positive semi-definite, lower triangle with all of its diagonal.
  /// pattern_version: equal for equal patterns. constants_in_kernel: the kernel are the constants,
  /// and `gradient` sums to 0; the solution is then fixed by one unknown. fixed: per unknown
  /// whether it stays (its gradient must be 0); empty: none. Returns d with
  /// (matrix + diag(|gradient|) / reach) * d = -gradient. Fails as SpdSolver does.
  Result<Eigen::VectorXd> direction(Context& context, const SparseMatrix& matrix,
                                    int pattern_version, bool constants_in_kernel,
                                    const std::vector<bool>& fixed,
                                    const Eigen::VectorXd& gradient);

 private:
  void isolate(const std::vector<bool>& fixed);
  Status factorize(Context& context, bool same_pattern);

  double reach_;
  std::optional<SpdSolver> solver_;
  SparseMatrix matrix_;
  int pattern_version_ = 0;
};

}  // namespace moduli
