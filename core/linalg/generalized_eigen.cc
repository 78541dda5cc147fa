#include "core/linalg/generalized_eigen.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>

#include "core/base/text.h"
#include "core/linalg/dense_eigen.h"
#include "core/linalg/dense_product.h"

namespace moduli {
namespace {

/// Narrow ones need fewer vectors in all, wide ones find larger multiplets.
constexpr Eigen::Index kBlock = 16;
constexpr Eigen::Index kDenseSize = 400;
/// Blocks beyond twice the wanted number of pairs. Real surfaces need a dozen.
constexpr Eigen::Index kSpareBlocks = 50;
/// Digits that a block adds to the worst pair when it adds most.
constexpr double kDigitsPerBlock = 1;
/// The measured residuals may exceed the estimated ones by rounding.
constexpr double kSlack = 10;

/// Uniform in [-1, 1), the same on every machine (splitmix64).
double noise(std::uint64_t counter) {
  std::uint64_t z = (counter + 1) * 0x9e3779b97f4a7c15U;
  z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
  z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
  z ^= z >> 31U;
  return static_cast<double>(z >> 11U) * 0x1p-52 - 1;
}

/// Makes the columns of w orthonormal, w = q r, by two rounds of Cholesky QR. Returns r.
Result<Eigen::MatrixXd> orthonormalize(Eigen::MatrixXd& w) {
  Eigen::MatrixXd r = Eigen::MatrixXd::Identity(w.cols(), w.cols());
  for (int round = 0; round < 2; ++round) {
    const Eigen::LLT<Eigen::MatrixXd> factor(transposedProduct(w, w));
    if (factor.info() != Eigen::Success) {
      return Status{Reason::kNoConvergence, "the Krylov space is exhausted"};
    }
    const Eigen::MatrixXd upper = factor.matrixU();
    const Eigen::MatrixXd inverse =
        upper.triangularView<Eigen::Upper>().solve(Eigen::MatrixXd::Identity(w.cols(), w.cols()));
    Eigen::MatrixXd q = Eigen::MatrixXd::Zero(w.rows(), w.cols());
    addProduct(1, w, inverse, q);
    w = std::move(q);
    r = upper * r;
  }
  return r;
}

/// The symmetric operator C = S (stiffness + shift mass)^-1 S, S = mass^(1/2): C y = nu y where
/// y = S x. Its eigenvectors are orthonormal in the plain sense.
class ShiftedInverse {
 public:
  ShiftedInverse(Context& context, const SpdSolver& solver, const Eigen::VectorXd& mass)
      : context_(context), solver_(solver), root_(mass.cwiseSqrt()) {}

  Eigen::Index size() const { return root_.size(); }
  const Eigen::VectorXd& root() const { return root_; }

  Result<Eigen::MatrixXd> apply(const Eigen::MatrixXd& y) const {
    ASSIGN_OR_RETURN(Eigen::MatrixXd x, solver_.solve(context_, root_.asDiagonal() * y));
    x = root_.asDiagonal() * x;
    return x;
  }

  /// For the iteration, whose result is measured in the end.
  Result<Eigen::MatrixXd> applyUnjudged(const Eigen::MatrixXd& y) const {
    ASSIGN_OR_RETURN(Eigen::MatrixXd x, solver_.solveUnjudged(context_, root_.asDiagonal() * y));
    x = root_.asDiagonal() * x;
    return x;
  }

 private:
  Context& context_;
  const SpdSolver& solver_;
  Eigen::VectorXd root_;
};

class BlockLanczos {
 public:
  BlockLanczos(Context& context, const ShiftedInverse& inverse, const EigenOptions& options)
      : context_(context), operator_(inverse), options_(options) {}

  /// Vectors are those of C.
  Result<EigenPairs> run() {
    const Eigen::Index n = operator_.size();
    const Eigen::Index most =
        std::min(n / kBlock, 2 * options_.count / kBlock + kSpareBlocks) * kBlock;
    RETURN_IF_ERROR(start());
    Eigen::Index next_look = 3 * options_.count;
    for (Eigen::Index size = kBlock;; size += kBlock) {
      RETURN_IF_ERROR(extend());
      const bool last = size + kBlock > most;
      if (last || size >= next_look) {
        const Context::Stage stage(context_, "eigen");
        ASSIGN_OR_RETURN(const DenseEigenPairs ritz, denseEigenpairs(projected_));
        const double excess = worstResidual(ritz) / options_.tolerance;
        if (excess <= 1) return collect(ritz);
        next_look = size + blocksToGo(excess) * kBlock;
      }
      if (last) break;
    }
    return Status{Reason::kNoConvergence, "the eigenvalues do not converge within a space of " +
                                              std::to_string(projected_.rows()) + " dimensions"};
  }

 private:
  Columns basis() const { return basis_.leftCols(projected_.rows()); }

  Status start() {
    basis_.resize(operator_.size(), std::min(operator_.size(), 6 * options_.count));
    Eigen::MatrixXd random(operator_.size(), kBlock);
    for (Eigen::Index i = 0; i < random.size(); ++i) {
      random.data()[i] = noise(static_cast<std::uint64_t>(i));
    }
    // One application damps what is far above the wanted values.
    ASSIGN_OR_RETURN(next_, operator_.applyUnjudged(random));
    return orthonormalize(next_).status();
  }

  /// Takes in the next block q and finds the one after it: C q less its part in the space.
  Status extend() {
    ASSIGN_OR_RETURN(Eigen::MatrixXd image, operator_.applyUnjudged(next_));
    const Context::Stage stage(context_, "eigen");
    RETURN_IF_ERROR(context_.check());
    const Eigen::Index before = projected_.rows();
    const Eigen::Index size = before + kBlock;
    if (basis_.cols() < size) basis_.conservativeResize(Eigen::NoChange, size + 2 * kBlock);
    basis_.middleCols(before, kBlock) = next_;

    Eigen::MatrixXd grown = Eigen::MatrixXd::Zero(size, size);
    grown.topLeftCorner(before, before) = projected_;
    projected_ = std::move(grown);
    const Eigen::MatrixXd part = transposedProduct(basis(), image);
    addProduct(-1, basis(), part, image);
    // What rounding left, which matters most against the latest blocks.
    const Eigen::Index recent = std::min(size, 2 * kBlock);
    const Columns latest = basis_.middleCols(size - recent, recent);
    addProduct(-1, latest, transposedProduct(latest, image), image);

    const Eigen::MatrixXd diagonal = part.bottomRows(kBlock);
    projected_.bottomRightCorner(kBlock, kBlock) = (diagonal + diagonal.transpose()) / 2;
    if (before > 0) {
      projected_.block(before, before - kBlock, kBlock, kBlock) = coupling_;
      projected_.block(before - kBlock, before, kBlock, kBlock) = coupling_.transpose();
    }
    ASSIGN_OR_RETURN(coupling_, orthonormalize(image));
    next_ = std::move(image);
    return {};
  }

  /// The residual of a Ritz vector is the coupling times its part in the last block.
  double worstResidual(const DenseEigenPairs& ritz) const {
    const Eigen::Index size = projected_.rows();
    double worst = size < options_.count ? std::numeric_limits<double>::infinity() : 0;
    for (Eigen::Index k = 0; k < std::min(size, options_.count); ++k) {
      const Eigen::Index column = size - 1 - k;
      const double residual = (coupling_ * ritz.vectors.col(column).tail(kBlock)).norm();
      const double relative = residual / ritz.values[column];
      // Not a number is worse than all.
      worst = std::isfinite(relative) ? std::max(worst, relative)
                                      : std::numeric_limits<double>::infinity();
    }
    return worst;
  }

  /// How many there are at least, as looking costs as much as a block.
  static Eigen::Index blocksToGo(double excess) {
    if (!std::isfinite(excess)) return 1;
    return std::max<Eigen::Index>(1,
                                  static_cast<Eigen::Index>(std::log10(excess) / kDigitsPerBlock));
  }

  EigenPairs collect(const DenseEigenPairs& ritz) {
    EigenPairs pairs;
    pairs.dimension = projected_.rows();
    const Eigen::MatrixXd wanted = ritz.vectors.rightCols(options_.count).rowwise().reverse();
    const Eigen::VectorXd inverse = ritz.values.tail(options_.count).reverse();
    pairs.values = (inverse.cwiseInverse().array() - options_.shift).matrix();
    pairs.vectors = Eigen::MatrixXd::Zero(operator_.size(), options_.count);
    addProduct(1, basis(), wanted, pairs.vectors);
    return pairs;
  }

  Context& context_;
  const ShiftedInverse& operator_;
  const EigenOptions& options_;
  Eigen::MatrixXd basis_;      ///< Columns in use: as many as projected_ has.
  Eigen::MatrixXd projected_;  ///< basis^T C basis, block tridiagonal.
  Eigen::MatrixXd next_;       ///< The block that follows.
  Eigen::MatrixXd coupling_;   ///< next^T C (last block).
};

/// Vectors are those of S^-1 stiffness S^-1, as of C.
Result<EigenPairs> solveDensely(const SparseMatrix& stiffness, const Eigen::VectorXd& mass,
                                const EigenOptions& options) {
  const Eigen::VectorXd inverse = mass.cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd whole = stiffness.selfadjointView<Eigen::Lower>() *
                                Eigen::MatrixXd::Identity(stiffness.rows(), stiffness.rows());
  ASSIGN_OR_RETURN(const DenseEigenPairs all,
                   denseEigenpairs(inverse.asDiagonal() * whole * inverse.asDiagonal()));
  EigenPairs pairs;
  pairs.values = all.values.head(options.count);
  pairs.vectors = all.vectors.leftCols(options.count);
  pairs.dimension = stiffness.rows();
  return pairs;
}

/// Measures |C y - y / (value + shift)| (value + shift) of the final vectors.
Status certify(const ShiftedInverse& inverse, const EigenOptions& options, EigenPairs& pairs) {
  for (Eigen::Index first = 0; first < pairs.values.size(); first += kBlock) {
    const Eigen::Index width = std::min(kBlock, pairs.values.size() - first);
    const Eigen::MatrixXd y = pairs.vectors.middleCols(first, width);
    ASSIGN_OR_RETURN(Eigen::MatrixXd residual, inverse.apply(y));
    const Eigen::VectorXd shifted = pairs.values.segment(first, width).array() + options.shift;
    residual = residual * shifted.asDiagonal() - y;
    pairs.largest_residual = std::max(pairs.largest_residual, residual.colwise().norm().maxCoeff());
  }
  if (pairs.largest_residual <= kSlack * options.tolerance) return {};
  return {Reason::kResidualTooLarge,
          "an eigenpair leaves a relative residual of " + shortestDouble(pairs.largest_residual) +
              " where " + shortestDouble(kSlack * options.tolerance) + " is allowed"};
}

}  // namespace

Result<EigenPairs> smallestEigenpairs(Context& context, const SparseMatrix& stiffness,
                                      const Eigen::VectorXd& mass, const EigenOptions& options) {
  const Eigen::Index n = stiffness.rows();
  if (mass.size() != n || stiffness.cols() != n || options.count < 0 || options.count > n ||
      !(options.shift > 0) || !(options.tolerance > 0) || (n > 0 && !(mass.minCoeff() > 0))) {
    return Status{Reason::kInvalidOption,
                  "the matrices, the number of eigenpairs or the shift do "
                  "not fit together"};
  }
  if (options.count == 0) return EigenPairs{Eigen::VectorXd(), Eigen::MatrixXd(n, 0)};
  SparseMatrix shifted = stiffness;
  for (Eigen::Index i = 0; i < n; ++i) shifted.coeffRef(i, i) += options.shift * mass[i];
  shifted.makeCompressed();
  ASSIGN_OR_RETURN(const SpdSolver solver, SpdSolver::make(context, shifted));
  const ShiftedInverse inverse(context, solver, mass);
  EigenPairs pairs;
  if (n <= kDenseSize) {
    ASSIGN_OR_RETURN(pairs, solveDensely(stiffness, mass, options));
  } else {
    ASSIGN_OR_RETURN(pairs, BlockLanczos(context, inverse, options).run());
  }
  RETURN_IF_ERROR(certify(inverse, options, pairs));
  pairs.vectors = inverse.root().cwiseInverse().asDiagonal() * pairs.vectors;
  return pairs;
}

}  // namespace moduli
