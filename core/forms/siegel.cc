#include "core/forms/siegel.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/forms/lattice_reduction.h"
#include "core/forms/modular.h"

namespace moduli {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// How near to the border of the reduced domain a point counts as inside.
constexpr double kBorder = 1e-12;
constexpr double kSymplectic = 1e-8;
/// A step halves a large distance from the mean and squares a small one: enough for any doubles.
constexpr int kMaxMeanSteps = 1200;
/// After a relative change that small, the next one would be below rounding.
constexpr double kMeanReached = 1e-8;
/// Below this, a change that is not far smaller than the last is one of rounding.
constexpr double kMeanNear = 1e-3;
constexpr int kMaxRounds = 1000;
constexpr int kMaxTorusRounds = 16;

Status checkEnergy(const MatrixXd& energy) {
  if (energy.rows() == 0 || energy.rows() % 2 != 0 || energy.rows() != energy.cols()) {
    return {Reason::kInvalidOption, "an energy form needs 2 g rows and 2 g columns with g > 0"};
  }
  return gramSchmidt(energy).status();
}

MatrixXd symmetrized(const MatrixXd& matrix) {
  return (matrix + matrix.transpose()) / 2;
}

/// J^T matrix J for J = [[0, I], [-I, 0]].
MatrixXd turned(const MatrixXd& matrix) {
  const Index g = matrix.rows() / 2;
  MatrixXd result(2 * g, 2 * g);
  result << matrix.bottomRightCorner(g, g), -matrix.bottomLeftCorner(g, g),
      -matrix.topRightCorner(g, g), matrix.topLeftCorner(g, g);
  return result;
}

/// NaN where the matrix is not positive definite.
MatrixXd inverse(const MatrixXd& matrix) {
  const Eigen::LLT<MatrixXd> factor(matrix);
  if (factor.info() != Eigen::Success) {
    return MatrixXd::Constant(matrix.rows(), matrix.cols(),
                              std::numeric_limits<double>::quiet_NaN());
  }
  return factor.solve(MatrixXd::Identity(matrix.rows(), matrix.cols()));
}

/// Largest |change_ij| / sqrt(scale_ii scale_jj).
double relativeSize(const MatrixXd& change, const MatrixXd& scale) {
  const Eigen::VectorXd d = scale.diagonal().cwiseSqrt().cwiseInverse();
  return (d.asDiagonal() * change * d.asDiagonal()).cwiseAbs().maxCoeff();
}

/// Log of the largest eigenvalue of m^-1 energy, at least 0. NaN where m is not positive definite.
double logLargestRatio(const MatrixXd& m, const MatrixXd& energy) {
  const Eigen::LLT<MatrixXd> factor(m);
  if (factor.info() != Eigen::Success) return std::numeric_limits<double>::quiet_NaN();
  const MatrixXd half = factor.matrixL().solve(energy);
  const MatrixXd ratio = factor.matrixL().solve(MatrixXd(half.transpose()));
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(symmetrized(ratio), Eigen::EigenvaluesOnly);
  return std::max(0.0, std::log(solver.eigenvalues().maxCoeff()));
}

/// |E J E - J|, from the blocks of E J E = E (J E).
double symplecticDefect(const MatrixXd& energy) {
  const Index g = energy.rows() / 2;
  MatrixXd rotated(2 * g, 2 * g);
  rotated << energy.bottomRows(g), -energy.topRows(g);
  const MatrixXd defect = energy * rotated - standardSymplecticForm(g).cast<double>();
  return defect.cwiseAbs().maxCoeff();
}

/// A symplectic form on its way into the reduced domain, taken anew from the given one and the
/// exact change of basis after each step.
class Traveller {
 public:
  /// Whether a step changed anything.
  using Step = Result<bool>;

  explicit Traveller(const MatrixXd& given)
      : given_(given),
        g_(given.rows() / 2),
        at_{IntegerMatrix::Identity(given.rows(), given.rows()), given} {}

  const SiegelReduction& at() const { return at_; }

  /// alpha -> U alpha, beta -> U^-T beta with the U that reduces Y: Pi -> U Pi U^T.
  Step shorten() {
    ASSIGN_OR_RETURN(const PeriodPoint point, periodOfEnergy(at_.energy));
    ASSIGN_OR_RETURN(const ReducedLattice lattice, reduceLattice(point.period.imag()));
    if (lattice.transform == IntegerMatrix::Identity(g_, g_)) return false;
    IntegerMatrix step = IntegerMatrix::Zero(2 * g_, 2 * g_);
    step.topLeftCorner(g_, g_) = lattice.transform;
    step.bottomRightCorner(g_, g_) = lattice.dual;
    return apply(step);
  }

  /// alpha -> alpha + N beta with N = round(X): Pi -> Pi - N.
  Step translate() {
    ASSIGN_OR_RETURN(const PeriodPoint point, periodOfEnergy(at_.energy));
    IntegerMatrix step = IntegerMatrix::Identity(2 * g_, 2 * g_);
    bool moves = false;
    for (Index j = 0; j < g_; ++j) {
      for (Index k = 0; k < g_; ++k) {
        const double x = point.period(j, k).real();
        if (std::abs(x) <= 0.5 + kBorder) continue;
        if (!(std::abs(x) < 0x1p62)) return integerOverflow();
        step(j, g_ + k) = static_cast<Integer>(std::round(x));
        moves = true;
      }
    }
    if (!moves) return false;
    return apply(step);
  }

  /// alpha_1 -> beta_1, beta_1 -> -alpha_1, which divides det Y by |Pi_11|^2.
  Step invert() {
    ASSIGN_OR_RETURN(const PeriodPoint point, periodOfEnergy(at_.energy));
    if (std::abs(point.period(0, 0)) >= 1 - kBorder) return false;
    IntegerMatrix step = IntegerMatrix::Identity(2 * g_, 2 * g_);
    step(0, 0) = step(g_, g_) = 0;
    step(0, g_) = 1;
    step(g_, 0) = -1;
    return apply(step);
  }

  /// g = 1: tau -> (a tau + b) / (c tau + d) by R = [[a, -b], [-c, d]], for
  /// omega = alpha + tau beta.
  Step enterDomain() {
    ASSIGN_OR_RETURN(const PeriodPoint point, periodOfEnergy(at_.energy));
    ASSIGN_OR_RETURN(const ReducedTau reduced, reduceToFundamentalDomain(point.period(0, 0)));
    const ModularMatrix& m = reduced.transform;
    if (m.b == 0 && m.c == 0) return false;
    IntegerMatrix step(2, 2);
    step << m.a, -m.b, -m.c, m.d;
    return apply(step);
  }

 private:
  Step apply(const IntegerMatrix& step) {
    ASSIGN_OR_RETURN(at_.transform, multiply(step, at_.transform));
    at_.energy = congruence(at_.transform, given_);
    return true;
  }

  const MatrixXd& given_;
  Index g_;
  SiegelReduction at_;
};

/// A point within rounding of the tolerance at the border may go to and fro; either side will do.
Result<SiegelReduction> reduceTorus(Traveller& traveller) {
  for (int round = 0; round < kMaxTorusRounds; ++round) {
    ASSIGN_OR_RETURN(const bool moved, traveller.enterDomain());
    if (!moved) break;
  }
  return traveller.at();
}

}  // namespace

Result<PeriodPoint> periodOfEnergy(const MatrixXd& energy) {
  RETURN_IF_ERROR(checkEnergy(energy));
  const Index g = energy.rows() / 2;
  const MatrixXd y = inverse(energy.bottomRightCorner(g, g));
  const MatrixXd x = -energy.topRightCorner(g, g) * y;
  const double asymmetry = std::max((x - x.transpose()).cwiseAbs().maxCoeff(),
                                    (y - y.transpose()).cwiseAbs().maxCoeff());
  const double largest = std::max(x.cwiseAbs().maxCoeff(), y.cwiseAbs().maxCoeff());
  PeriodPoint point{Eigen::MatrixXcd(g, g), asymmetry / largest};
  point.period.real() = symmetrized(x);
  point.period.imag() = symmetrized(y);
  return point;
}

MatrixXd energyOfPeriod(const Eigen::MatrixXcd& period) {
  const Index g = period.rows();
  const MatrixXd x = period.real();
  const MatrixXd y = period.imag();
  const MatrixXd beta = inverse(y);
  const MatrixXd mixed = -x * beta;
  MatrixXd energy(2 * g, 2 * g);
  energy << y - mixed * x, mixed, mixed.transpose(), beta;
  return symmetrized(energy);
}

// The step A -> (A + J^T A^-1 J) / 2 is that of the arithmetic-harmonic mean of A and J^T A^-1 J,
// for their harmonic mean is J^T ((A + J^T A^-1 J) / 2)^-1 J. So it keeps their geometric mean and
// tends to it: in the basis where A = diag(d) and J^T A^-1 J = diag(1 / d), d -> (d + 1 / d) / 2.
// No eigenvectors are needed, which for the eigenvalue 1 of a nearly symplectic form would mix
// what ought to stay apart, and what vanishes stays 0.
Result<SymplecticProjection> projectSymplectic(const MatrixXd& energy_h) {
  RETURN_IF_ERROR(checkEnergy(energy_h));
  SymplecticProjection projection{symmetrized(energy_h), 0};
  double last = std::numeric_limits<double>::infinity();
  for (int step = 0; step < kMaxMeanSteps; ++step) {
    const MatrixXd& before = projection.energy;
    const MatrixXd mean = symmetrized(before + turned(inverse(before))) / 2;
    const double change = relativeSize(mean - before, before);
    projection.energy = mean;
    if (!std::isfinite(change)) break;
    const bool stuck = change < kMeanNear && change > last / 2;
    last = change;
    if (change > kMeanReached && !stuck) continue;
    projection.spread = logLargestRatio(projection.energy, symmetrized(energy_h));
    if (!std::isfinite(projection.spread)) break;
    return projection;
  }
  return Status{Reason::kNoConvergence, "the energy form cannot be projected",
                "the surface is too thin for double precision"};
}

Result<SiegelReduction> siegelReduce(Context& context, const MatrixXd& energy) {
  RETURN_IF_ERROR(checkEnergy(energy));
  const double largest = energy.cwiseAbs().maxCoeff();
  if (!(symplecticDefect(energy) <= kSymplectic * (1 + largest * largest))) {
    return Status{Reason::kInvalidOption, "the energy form is not symplectic"};
  }
  Traveller traveller(energy);
  if (energy.rows() == 2) return reduceTorus(traveller);
  for (int round = 0; round < kMaxRounds; ++round) {
    RETURN_IF_ERROR(context.check());
    ASSIGN_OR_RETURN(const bool shortened, traveller.shorten());
    ASSIGN_OR_RETURN(const bool translated, traveller.translate());
    ASSIGN_OR_RETURN(const bool inverted, traveller.invert());
    if (!shortened && !translated && !inverted) return traveller.at();
  }
  return Status{Reason::kNoConvergence, "the period matrix cannot be reduced"};
}

}  // namespace moduli
