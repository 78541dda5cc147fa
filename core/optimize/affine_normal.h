#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string_view>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/optimize/hessian_factor.h"
#include "core/optimize/objective.h"

/// The affine normal of a level hypersurface: the direction that f's level set through x has for
/// itself, whatever the coordinates (affine maps carry it along) and whatever the values that the
/// level sets are labelled with (f and phi(f) have the same). On quadratics it leads to the
/// minimizer.
///
///   ASSIGN_OR_RETURN(const AffineNormal normal, affineNormal(context, *objective, x, {}));
///   x -= step * normal.direction;
///
/// Legend: N unknowns, g gradient, H Hessian, T third derivatives, p = H^{-1} g, q = g.p,
/// P = H^{-1} - p p^T / q (the inverse of H on the tangent space), tau_c = P_ab T_abc.
namespace moduli {

/// How the direction is put together; the forms agree, and are twins of one another in tests.
enum class AffineForm : std::uint8_t {
  kInverse,   ///< d = p + q / (N + 1) P tau: sparse, H positive definite. g.d = q whatever tau is.
  kBordered,  ///< P from the inverse of [[H, g], [g^T, 0]]: H may be singular or indefinite. Dense.
  kTangent,   ///< P = U (U^T H U)^{-1} U^T by an orthonormal tangent basis U. Dense.
};

/// Where tau comes from.
enum class ThirdSource : std::uint8_t {
  kAutomatic,       ///< Analytic if the objective has it, else eigen-columns up to 400 unknowns,
                    ///< else Gaussian samples.
  kAnalytic,        ///< Objective::thirdContraction, with P on the pattern of H.
  kLogDeterminant,  ///< Differences of log det [[H, g0], [g0^T, 0]] with g0 kept: 2 N Hessians.
  kEigenColumns,    ///< Second differences of the gradient along the N eigen-columns of P.
  kGaussian,        ///< The mean of second differences along samples of N(0, P).
};

struct AffineNormalOptions {
  AffineForm form = AffineForm::kInverse;
  ThirdSource third = ThirdSource::kAutomatic;
  /// Of kGaussian: the relative error of tau falls with its square root; the seed of the samples,
  /// which are the same on every machine.
  int samples = 64;
  std::uint64_t seed = 1;
  /// Of second differences: in units of the columns of P, whose natural length is 1.
  /// kLogDeterminant moves unknowns by a hundredth of it, relative to their size.
  double difference_step = 1e-3;
};

struct AffineNormal {
  /// N entries, towards larger values: a minimizer walks against it. With constantsInKernel() of
  /// mean 0. kInverse: of the length that makes x - direction the natural step; the other forms:
  /// with gradient . direction = |gradient|.
  Eigen::VectorXd direction;
  /// gradient . direction, positive: the rate of decrease against the direction.
  double decrease = 0;
  /// The contraction used; 0 at the fixed unknown of constantsInKernel().
  Eigen::VectorXd tau;
  /// Whether P is positive semi-definite: the level set is strictly convex at x.
  bool convex = true;
};

/// The affine normal at x. x: dimension() finite entries where the value is finite and the gradient
/// not 0. The objective is left at x.
///
/// Fails with kInvalidOption (size or entries of x, no value there, a vanishing gradient, samples
/// or step not positive, analytic third derivatives that there are none of), kNotPositiveDefinite
/// (kInverse: H is not positive definite; others: the level set is flat in a direction, H singular
/// on the tangent space), as moveTo does, with kCancelled and kDeadlineExceeded.
/// kInverse: a factorization, the inverse on the pattern and two solves; dense forms: O(N^3).
/// Source: MATH 11.2, 11.3, 11.5.
Result<AffineNormal> affineNormal(Context& context, Objective& objective, const Eigen::VectorXd& x,
                                  const AffineNormalOptions& options = {});

/// The same by kInverse, for the point where the objective is and the factor of its Hessian there.
/// A shift in the factor counts as part of H. newton: p = factor.solve(gradient()). The objective
/// is moved for differences, and moved back. Fails and costs as affineNormal, less the
/// factorization and one solve.
Result<AffineNormal> affineNormalOf(Context& context, Objective& objective,
                                    const Eigen::VectorXd& x, HessianFactor& factor,
                                    const Eigen::VectorXd& newton,
                                    const AffineNormalOptions& options);

/// Whether options can be used with the objective: kInvalidOption otherwise.
Status checkOptions(const Objective& objective, const AffineNormalOptions& options);

}  // namespace moduli
