#pragma once

#include <Eigen/Core>
#include <string>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/linalg/spd_solver.h"

namespace moduli {

/// A smooth function of n real numbers that a minimizer walks down.
///
/// All questions are about the point that moveTo() last reached, so that an objective on a mesh
/// computes its metric once a step. Values outside the domain (the logarithm of a negative number)
/// are +infinity, which line searches step back from; NaN anywhere ends a search with an error.
class Objective {
 public:
  virtual ~Objective() = default;

  /// The number of unknowns, at least 1.
  virtual Eigen::Index dimension() const = 0;

  /// What errors, traces and tables call it: "rosenbrock".
  virtual std::string name() const = 0;

  /// Whether adding a constant to all unknowns changes nothing: the Hessian's kernel are the
  /// constants, and a minimizer works with one unknown fixed.
  virtual bool constantsInKernel() const { return false; }

  /// Moves to x, dimension() finite entries. Fails as an objective's own work does, with kCancelled
  /// and kDeadlineExceeded; then it has to be moved elsewhere before it answers again.
  virtual Status moveTo(Context& context, const Eigen::VectorXd& x) = 0;

  virtual double value() const = 0;

  /// dimension() entries.
  virtual const Eigen::VectorXd& gradient() const = 0;

  /// Second derivatives: symmetric, the lower triangle with all of its diagonal; valid until the
  /// next call of moveTo or hessian.
  virtual const SparseMatrix& hessian() = 0;

  /// Counts changes of the pattern of hessian(): equal numbers mean one pattern.
  virtual int patternVersion() const { return 0; }

  /// Whether thirdContraction() is there; otherwise methods that want third derivatives use
  /// differences of gradients.
  virtual bool hasThirdDerivatives() const { return false; }

  /// tau_c = sum over a, b of P_ab T_abc, T the third derivatives. weights: the symmetric matrix P
  /// on the pattern of hessian(), lower triangle, from the point of the last hessian(). Only called
  /// where hasThirdDerivatives().
  virtual Eigen::VectorXd thirdContraction(const SparseMatrix& weights) const = 0;
};

}  // namespace moduli
