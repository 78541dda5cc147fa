#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/optimize/objective.h"

/// tau_c = sum over a, b of P_ab T_abc without third derivatives: by differences of gradients and
/// of Hessians. P is the inverse of a Hessian on the tangent space. These move the objective and
/// leave it anywhere.
namespace moduli {

/// Columns w_i and signs s_i with P = sum s_i w_i w_i^T: roots of eigenvalues times eigenvectors.
struct EigenColumns {
  Eigen::MatrixXd columns;  ///< n x n.
  Eigen::VectorXd signs;    ///< Each 1 or -1.
};
EigenColumns eigenColumns(const Eigen::MatrixXd& P);

/// sum over i of s_i T(w_i, w_i, .) at x by central second differences of the gradient, of step
/// `step` in units of w_i; halved up to 30 times while the value there is infinite. gradient: at x.
/// With the eigen-columns of P this is tau up to step^2. Fails with kNoConvergence where no step is
/// short enough, and as moveTo does. Two evaluations a column. Source: MATH 11.5.
Result<Eigen::VectorXd> tauAlong(Context& context, Objective& objective, const Eigen::VectorXd& x,
                                 const Eigen::VectorXd& gradient, const EigenColumns& along,
                                 double step);

/// What samples of N(0, P) are made of: w = L^{-T} z - p (g . L^{-T} z) / q, H = L L^T, z standard
/// normal.
struct SampleSpace {
  const SparseMatrix& hessian;      ///< Positive definite, lower triangle; row `fixed` isolated.
  const Eigen::VectorXd& gradient;  ///< 0 at the fixed unknown.
  const Eigen::VectorXd& newton;    ///< p = H^{-1} g.
  Eigen::Index fixed = -1;
};

/// `count` samples of N(0, P), n x count, the same for the same seed. Fails with
/// kNotPositiveDefinite. A sparse factorization and a half solve a sample.
Result<Eigen::MatrixXd> tangentSamples(const SampleSpace& space, int count, std::uint64_t seed);

/// The gradient by x of log |det [[H(x), g0], [g0^T, 0]]| with g0 = gradient kept, by central
/// differences of fourth order, of step step * (0.1 + |x_i|); fixed: the unknown that stays, -1 for
/// none. Fails with kNotPositiveDefinite (flat level set), kNoConvergence (an infinite value on the
/// way), as moveTo does. 4 n Hessians, O(n^4). Source: MATH 11.5.
Result<Eigen::VectorXd> tauByLogDeterminant(Context& context, Objective& objective,
                                            const Eigen::VectorXd& x,
                                            const Eigen::VectorXd& gradient, Eigen::Index fixed,
                                            double step);

/// The whole Hessian where the objective is, dense; row and column `fixed` isolated with `isolated`
/// on the diagonal.
Eigen::MatrixXd denseHessian(Objective& objective, Eigen::Index fixed, double isolated);

}  // namespace moduli
