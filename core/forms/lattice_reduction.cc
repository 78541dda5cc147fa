#include "core/forms/lattice_reduction.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace moduli {
namespace {

constexpr double kDelta = 0.99;
/// Beyond 1/2 by more than rounding, so that a coefficient of 1/2 is not sent to and fro.
constexpr double kSizeReduced = 0.5 + 1e-9;
constexpr double kAsymmetry = 1e-10;
/// A round leaves the relative error of rounding times the condition number of its basis, so two or
/// three are the rule.
constexpr int kMaxRounds = 50;

Status notPositiveDefinite() {
  return {Reason::kNotPositiveDefinite, "the energy form is not symmetric positive definite",
          "the surface is too thin for double precision, or its metric is not valid"};
}

bool isSymmetric(const Eigen::MatrixXd& gram) {
  if (gram.rows() == 0 || gram.rows() != gram.cols() || !gram.allFinite()) return false;
  const double largest = gram.cwiseAbs().maxCoeff();
  return (gram - gram.transpose()).cwiseAbs().maxCoeff() <= kAsymmetry * largest;
}

/// LLL with floating-point coefficients; the changes of basis are exact.
class Reduction {
 public:
  Reduction(GramSchmidt steps, ReducedLattice& lattice)
      : mu_(std::move(steps.mu)), squares_(std::move(steps.squares)), lattice_(lattice) {}

  /// Stops early, with changed() true, where rounding seems to lead it in a circle.
  Status run() {
    const Eigen::Index n = squares_.size();
    const Eigen::Index limit = 100 * n * n + 1000;
    Eigen::Index swaps = 0;
    for (Eigen::Index k = 1; k < n && swaps < limit;) {
      RETURN_IF_ERROR(shorten(k, k - 1));
      const double m = mu_(k, k - 1);
      if (squares_(k) < (kDelta - m * m) * squares_(k - 1)) {
        swap(k);
        ++swaps;
        k = std::max<Eigen::Index>(1, k - 1);
        continue;
      }
      for (Eigen::Index l = k - 2; l >= 0; --l) RETURN_IF_ERROR(shorten(k, l));
      ++k;
    }
    return {};
  }

  bool changed() const { return changed_; }

 private:
  /// b_k -= round(mu(k, l)) b_l.
  Status shorten(Eigen::Index k, Eigen::Index l) {
    if (!(std::abs(mu_(k, l)) > kSizeReduced)) return {};
    const double q = std::round(mu_(k, l));
    if (!(std::abs(q) < 0x1p62)) return integerOverflow();
    mu_.row(k).head(l + 1) -= q * mu_.row(l).head(l + 1);
    changed_ = true;
    RETURN_IF_ERROR(addRow(lattice_.transform, k, -static_cast<Integer>(q), l));
    return addRow(lattice_.dual, l, static_cast<Integer>(q), k);
  }

  /// Exchanges b_k and b_{k-1}.
  void swap(Eigen::Index k) {
    const double m = mu_(k, k - 1);
    const double square = squares_(k) + m * m * squares_(k - 1);
    const double back = m * squares_(k - 1) / square;
    squares_(k) *= squares_(k - 1) / square;
    squares_(k - 1) = square;
    mu_(k, k - 1) = back;
    mu_.row(k).head(k - 1).swap(mu_.row(k - 1).head(k - 1));
    for (Eigen::Index i = k + 1; i < squares_.size(); ++i) {
      const double old = mu_(i, k);
      mu_(i, k) = mu_(i, k - 1) - m * old;
      mu_(i, k - 1) = old + back * mu_(i, k);
    }
    lattice_.transform.row(k).swap(lattice_.transform.row(k - 1));
    lattice_.dual.row(k).swap(lattice_.dual.row(k - 1));
    changed_ = true;
  }

  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> mu_;
  Eigen::VectorXd squares_;
  ReducedLattice& lattice_;
  bool changed_ = false;
};

}  // namespace

Result<GramSchmidt> gramSchmidt(const Eigen::MatrixXd& gram) {
  if (!isSymmetric(gram)) return notPositiveDefinite();
  const Eigen::Index n = gram.rows();
  const double rounding = static_cast<double>(n) * std::numeric_limits<double>::epsilon();
  GramSchmidt steps{Eigen::MatrixXd::Identity(n, n), Eigen::VectorXd::Zero(n)};
  // Row i of `products` holds the inner products of b_i with b*_j.
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> products(n, n), mu(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) {
      products(i, j) = gram(i, j) - mu.row(j).head(j).dot(products.row(i).head(j));
      if (j < i) mu(i, j) = products(i, j) / steps.squares(j);
    }
    steps.squares(i) = products(i, i);
    steps.mu.row(i).head(i) = mu.row(i).head(i);
    if (!(steps.squares(i) > rounding * gram(i, i))) return notPositiveDefinite();
  }
  return steps;
}

Result<ReducedLattice> reduceLattice(const Eigen::MatrixXd& gram) {
  const Eigen::Index n = gram.rows();
  ReducedLattice lattice{gram, IntegerMatrix::Identity(n, n), IntegerMatrix::Identity(n, n)};
  for (int round = 0; round < kMaxRounds; ++round) {
    ASSIGN_OR_RETURN(GramSchmidt steps, gramSchmidt(lattice.gram));
    Reduction reduction(std::move(steps), lattice);
    RETURN_IF_ERROR(reduction.run());
    if (!reduction.changed()) return lattice;
    lattice.gram = congruence(lattice.transform, gram);
  }
  return Status{Reason::kNoConvergence, "the basis of a lattice cannot be reduced",
                "the surface is too long and thin for its periods to be found"};
}

Eigen::MatrixXd congruence(const IntegerMatrix& r, const Eigen::MatrixXd& gram) {
  using Wide = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  const Wide given = gram.cast<long double>();
  const Wide rows = r.transpose().cast<long double>();  // Row j of r is column j.
  Eigen::MatrixXd result(r.rows(), r.rows());
  Wide image(gram.rows(), 1);
  for (Eigen::Index j = 0; j < r.rows(); ++j) {
    image.setZero();
    for (Eigen::Index k = 0; k < r.cols(); ++k) {
      if (rows(k, j) != 0) image += rows(k, j) * given.col(k);
    }
    for (Eigen::Index i = j; i < r.rows(); ++i) {
      result(i, j) = result(j, i) = static_cast<double>(rows.col(i).cwiseProduct(image).sum());
    }
  }
  return result;
}

}  // namespace moduli
