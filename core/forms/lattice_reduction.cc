#include "core/forms/lattice_reduction.h"

#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <limits>

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

template <typename T>
using RowMajor = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// addRow for rows that lie in one piece.
Status addRow(RowMajor<Integer>& matrix, Eigen::Index to, Integer times, Eigen::Index from) {
  const Integer* source = matrix.data() + from * matrix.cols();
  Integer* target = matrix.data() + to * matrix.cols();
  bool overflow = false;
  for (Eigen::Index c = 0; c < matrix.cols(); ++c) {
    Integer product = 0;
    overflow |= __builtin_mul_overflow(times, source[c], &product);
    overflow |= __builtin_add_overflow(target[c], product, &target[c]);
  }
  return overflow ? integerOverflow() : Status();
}

/// LLL with floating-point coefficients and exact changes of basis.
class Reduction {
 public:
  explicit Reduction(Eigen::Index n)
      : transform_(RowMajor<Integer>::Identity(n, n)), dual_(transform_) {}

  /// Reduces the present basis, whose Gram-Schmidt steps are given. Returns whether it changed.
  /// Stops early where rounding seems to lead it in a circle.
  Result<bool> run(const GramSchmidt& steps) {
    mu_ = steps.mu;
    squares_ = steps.squares;
    changed_ = false;
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
    return changed_;
  }

  IntegerMatrix transform() const { return transform_; }
  IntegerMatrix dual() const { return dual_; }

 private:
  /// b_k -= round(mu(k, l)) b_l.
  Status shorten(Eigen::Index k, Eigen::Index l) {
    if (!(std::abs(mu_(k, l)) > kSizeReduced)) return {};
    const double q = std::round(mu_(k, l));
    if (!(std::abs(q) < 0x1p62)) return integerOverflow();
    mu_.row(k).head(l + 1) -= q * mu_.row(l).head(l + 1);
    changed_ = true;
    RETURN_IF_ERROR(addRow(transform_, k, -static_cast<Integer>(q), l));
    return addRow(dual_, l, static_cast<Integer>(q), k);
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
    transform_.row(k).swap(transform_.row(k - 1));
    dual_.row(k).swap(dual_.row(k - 1));
    changed_ = true;
  }

  RowMajor<double> mu_;
  Eigen::VectorXd squares_;
  RowMajor<Integer> transform_, dual_;
  bool changed_ = false;
};

}  // namespace

Result<GramSchmidt> gramSchmidt(const Eigen::MatrixXd& gram) {
  if (!isSymmetric(gram)) return notPositiveDefinite();
  const Eigen::Index n = gram.rows();
  const double rounding = static_cast<double>(n) * std::numeric_limits<double>::epsilon();
  GramSchmidt steps{Eigen::MatrixXd::Identity(n, n), Eigen::VectorXd::Zero(n)};
  // Row i of `products` holds the inner products of b_i with b*_j.
  RowMajor<double> products(n, n), mu(n, n);
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
  Reduction reduction(gram.rows());
  Eigen::MatrixXd current = gram;
  for (int round = 0; round < kMaxRounds; ++round) {
    ASSIGN_OR_RETURN(const GramSchmidt steps, gramSchmidt(current));
    ASSIGN_OR_RETURN(const bool changed, reduction.run(steps));
    if (!changed) return ReducedLattice{current, reduction.transform(), reduction.dual()};
    current = congruence(reduction.transform(), gram);
  }
  return Status{Reason::kNoConvergence, "the basis of a lattice cannot be reduced",
                "the surface is too long and thin for its periods to be found"};
}

Eigen::MatrixXd congruence(const IntegerMatrix& r, const Eigen::MatrixXd& gram) {
  using Wide = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  using Rows = Eigen::SparseMatrix<long double>;  // Row j in column j.
  const Wide given = gram.cast<long double>();
  const Rows rows = Wide(r.transpose().cast<long double>()).sparseView();
  Eigen::MatrixXd result(r.rows(), r.rows());
  Eigen::Matrix<long double, Eigen::Dynamic, 1> image(gram.rows());
  for (Eigen::Index j = 0; j < r.rows(); ++j) {
    image.setZero();
    for (Rows::InnerIterator entry(rows, j); entry; ++entry) {
      image += entry.value() * given.col(entry.row());
    }
    for (Eigen::Index i = j; i < r.rows(); ++i) {
      result(i, j) = result(j, i) = static_cast<double>(rows.col(i).dot(image));
    }
  }
  return result;
}

}  // namespace moduli
