#pragma once

#include <Eigen/Core>

/// Products of tall dense matrices, the bulk of an eigen-solver's work: by the BLAS that CHOLMOD is
/// linked with, which knows the processor, or by Eigen without it. One thread; the same bytes for
/// the same input on one machine.
namespace moduli {

/// A view of consecutive columns of a matrix.
using Columns = Eigen::Ref<const Eigen::MatrixXd>;

/// a^T b. a: n x p, b: n x q. 2 n p q operations.
Eigen::MatrixXd transposedProduct(const Columns& a, const Columns& b);

/// The same of floats: half the time where the result is only compared.
Eigen::MatrixXf transposedProduct(const Eigen::Ref<const Eigen::MatrixXf>& a,
                                  const Eigen::Ref<const Eigen::MatrixXf>& b);

/// c + scale a b. a: n x p, b: p x q, c: n x q. 2 n p q operations.
void addProduct(double scale, const Columns& a, const Columns& b, Eigen::MatrixXd& c);

}  // namespace moduli
