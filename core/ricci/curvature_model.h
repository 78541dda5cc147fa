#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/intrinsic/geometry.h"
#include "core/linalg/spd_solver.h"

namespace moduli {

/// A family of discrete metrics on one surface, one real unknown per vertex (or per orbit of
/// vertices), whose curvatures are the gradient of a convex energy.
///
/// What a solver of the Ricci flow knows of a scheme. A model is moved to one u at a time; all
/// questions are about the metric there.
class CurvatureModel {
 public:
  virtual ~CurvatureModel() = default;

  virtual Geometry geometry() const = 0;

  /// The number of unknowns.
  virtual Eigen::Index size() const = 0;

  /// Whether adding a constant to u changes no angle; then the Hessian's kernel are the constants.
  virtual bool scaleFree() const { return geometry() == Geometry::kEuclidean; }

  /// Moves to the metric of u; may change the connectivity (flips), from the one last accepted.
  /// Fails with kNoConvergence where u is not finite or too far for a double, kCancelled,
  /// kDeadlineExceeded; then the model has to be moved to another u before it answers again.
  virtual Status moveTo(Context& context, const Eigen::VectorXd& u) = 0;

  /// Changes single unknowns of u, where the model is, whose curvatures are off their targets by
  /// more than min(1, residual) radians, until a third of that is left, as far as that can be done
  /// one by one; moves there. fixed: as in NewtonOptions. Returns whether anything changed. A model
  /// may have no such method.
  virtual Result<bool> relax(Context& /*context*/, const Eigen::VectorXd& /*target*/,
                             const std::vector<bool>& /*fixed*/, double /*residual*/,
                             Eigen::VectorXd& /*u*/) {
    return false;
  }

  /// Makes all u that follow count from `base`, so that changes far below the rounding of base + u
  /// are felt; zeros at first. Moves nothing. Returns false where the model cannot.
  virtual bool setBase(const Eigen::VectorXd& /*base*/) { return false; }

  /// Keeps the present connectivity as the one from which the next moves start.
  virtual void accept() {}

  /// Per unknown the curvature at u: 2 pi (interior) or pi (boundary) less the angles around the
  /// vertex, summed over the vertices of the unknown.
  virtual const Eigen::VectorXd& curvature() const = 0;

  /// The derivative of curvature() by u: symmetric, positive semi-definite; lower triangle. Valid
  /// until the next moveTo or hessian.
  virtual const SparseMatrix& hessian() = 0;

  /// Counts changes of the pattern of hessian(): equal numbers mean one pattern.
  virtual int patternVersion() const = 0;

  /// Whether energy() is there.
  virtual bool hasEnergy() const { return false; }

  /// The energy whose gradient is curvature(), up to a constant of the surface that flips do not
  /// change. Only called where hasEnergy().
  virtual double energy() const { return 0; }

  /// Whether thirdContraction() is there.
  virtual bool hasThirdDerivatives() const { return false; }

  /// Per unknown c the sum over a, b of P_ab times the derivative of hessian()_ab by u_c, in the
  /// present triangulation. weights: the symmetric matrix P; the lower triangle, with the places of
  /// hessian(), which has been called here. Only called where hasThirdDerivatives().
  virtual Eigen::VectorXd thirdContraction(const SparseMatrix& /*weights*/) const {
    return Eigen::VectorXd::Zero(size());
  }
};

}  // namespace moduli
