#include "core/forms/siegel.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "core/forms/lattice_reduction.h"
#include "core/forms/modular.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

Result<SiegelReduction> reduce(const Eigen::MatrixXd& energy) {
  Context context;
  return siegelReduce(context, energy);
}

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

const Complex kI(0, 1);

double uniform(std::mt19937& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
}

MatrixXd randomMatrix(std::mt19937& random, Index rows, Index cols) {
  MatrixXd matrix(rows, cols);
  for (double& entry : matrix.reshaped()) entry = uniform(random, -1, 1);
  return matrix;
}

/// Y = `height` (1 + A A^T) with small A, X in [-1/2, 1/2].
MatrixXcd randomPeriod(std::mt19937& random, Index g, double height) {
  const MatrixXd a = 0.5 * randomMatrix(random, g, g);
  const MatrixXd x = 0.5 * randomMatrix(random, g, g);
  MatrixXcd period(g, g);
  period.real() = x.selfadjointView<Eigen::Lower>();
  period.imag() = height * (MatrixXd::Identity(g, g) + a * a.transpose());
  return period;
}

/// A product of `letters` generators of Sp(2 g, Z).
IntegerMatrix randomWord(std::mt19937& random, Index g, int letters) {
  IntegerMatrix word = IntegerMatrix::Identity(2 * g, 2 * g);
  for (int k = 0; k < letters; ++k) {
    IntegerMatrix step = IntegerMatrix::Identity(2 * g, 2 * g);
    const auto i = static_cast<Index>(random() % g);
    const auto j = static_cast<Index>(random() % g);
    const Integer n = random() % 2 == 0 ? 1 : -1;
    switch (random() % 3) {
      case 0:
        step(i, g + j) = step(j, g + i) = n;
        break;
      case 1:
        step(i, i) = step(g + i, g + i) = 0;
        step(i, g + i) = 1;
        step(g + i, i) = -1;
        break;
      default:
        if (i == j) break;
        step(i, j) = n;
        step(g + j, g + i) = -n;
    }
    word = *multiply(step, word);
  }
  return word;
}

MatrixXd form(Index g) {
  return standardSymplecticForm(g).cast<double>();
}

double largest(const MatrixXd& matrix) {
  return matrix.cwiseAbs().maxCoeff();
}

double largest(const MatrixXcd& matrix) {
  return matrix.cwiseAbs().maxCoeff();
}

double smallestEigenvalue(const MatrixXd& matrix) {
  return Eigen::SelfAdjointEigenSolver<MatrixXd>(matrix, Eigen::EigenvaluesOnly)
      .eigenvalues()
      .minCoeff();
}

MatrixXcd periodOf(const MatrixXd& energy) {
  const auto point = periodOfEnergy(energy);
  EXPECT_OK(point);
  return point->period;
}

/// omega' = K omega in the new basis: Pi' = (R_aa Pi - R_ab) (R_bb - R_ba Pi)^-1.
MatrixXcd moved(const IntegerMatrix& r, const MatrixXcd& period) {
  const Index g = period.rows();
  const MatrixXcd c = r.cast<Complex>();
  return (c.topLeftCorner(g, g) * period - c.topRightCorner(g, g)) *
         (c.bottomRightCorner(g, g) - c.bottomLeftCorner(g, g) * period).inverse();
}

/// MATH 12.6: Bolza's curve, Lawson's, Klein's, and the surface of three squares.
std::vector<MatrixXcd> knownPeriods() {
  const double r2 = std::sqrt(2.0);
  const Complex s(0, std::sqrt(7.0));
  MatrixXcd bolza(2, 2), lawson(2, 2), klein(3, 3), squares(2, 2);
  bolza << Complex(-2, 2 * r2), Complex(1, -r2), Complex(1, -r2), Complex(-2, 2 * r2);
  lawson << 2.0 * kI, kI, kI, 2.0 * kI;
  squares << 5.0 * kI, 4.0 * kI, 4.0 * kI, 5.0 * kI;
  klein << -1.0 + 3.0 * s, -2.0 - 2.0 * s, -3.0 + s,  //
      -2.0 - 2.0 * s, 4.0 + 4.0 * s, -2.0 - 2.0 * s,  //
      -3.0 + s, -2.0 - 2.0 * s, 7.0 + 3.0 * s;
  return {bolza / 3.0, lawson / std::sqrt(3.0), klein / 8.0, squares / 3.0};
}

TEST(Period, EnergyOfAPeriodIsSymplecticAndGivesItBack) {
  std::mt19937 random(1);
  for (const Index g : {1, 2, 3, 5, 20}) {
    for (int trial = 0; trial < 10; ++trial) {
      const MatrixXcd period = randomPeriod(random, g, 0.7);
      const MatrixXd energy = energyOfPeriod(period);
      EXPECT_LT(largest(MatrixXd(energy * form(g) * energy - form(g))), 1e-12);
      EXPECT_EQ(energy, energy.transpose());
      const auto point = periodOfEnergy(energy);
      ASSERT_OK(point);
      EXPECT_LT(largest(MatrixXcd(point->period - period)), 1e-13);
      EXPECT_EQ(point->period, point->period.transpose());
      EXPECT_LT(point->symmetry_residual, 1e-13);
    }
  }
}

TEST(Period, IsTauOfTheTorus) {
  const MatrixXcd tau = MatrixXcd::Constant(1, 1, Complex(0.3, 2));
  const Eigen::Matrix2d expected{{(4 + 0.09) / 2, -0.15}, {-0.15, 0.5}};
  EXPECT_LT(largest(MatrixXd(energyOfPeriod(tau) - expected)), 1e-15);
}

TEST(Period, MovesByFractionalMapsUnderChangesOfBasis) {
  std::mt19937 random(2);
  for (const Index g : {1, 2, 3}) {
    for (int trial = 0; trial < 20; ++trial) {
      const MatrixXcd period = randomPeriod(random, g, 1);
      const IntegerMatrix word = randomWord(random, g, 5);
      ASSERT_TRUE(isSymplectic(word));
      const MatrixXcd image = periodOf(congruence(word, energyOfPeriod(period)));
      EXPECT_LT(largest(MatrixXcd(image - moved(word, period))), 1e-10);
    }
  }
}

TEST(Period, TellsTheAsymmetryOfAFormThatIsNotSymplectic) {
  std::mt19937 random(3);
  MatrixXd energy = energyOfPeriod(randomPeriod(random, 2, 1));
  energy(0, 3) += 0.01;
  energy(3, 0) += 0.01;
  EXPECT_GT(periodOfEnergy(energy)->symmetry_residual, 1e-3);
}

/// A # B by square roots.
MatrixXd geometricMean(const MatrixXd& a, const MatrixXd& b) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> outer(a);
  const MatrixXd root = outer.operatorSqrt();
  const MatrixXd inverse_root = outer.operatorInverseSqrt();
  const MatrixXd inner = inverse_root * b * inverse_root;
  return root * Eigen::SelfAdjointEigenSolver<MatrixXd>(inner).operatorSqrt() * root;
}

/// E + a positive semidefinite perturbation of rank g.
MatrixXd raised(std::mt19937& random, const MatrixXd& energy, double amount) {
  const MatrixXd a = randomMatrix(random, energy.rows(), energy.rows() / 2);
  return energy + amount * a * a.transpose();
}

TEST(Projection, IsTheGeometricMeanOfTheBounds) {
  std::mt19937 random(4);
  for (const Index g : {1, 2, 3, 6}) {
    for (const double amount : {1e-6, 0.01, 1.0, 100.0}) {
      const MatrixXd energy_h = raised(random, energyOfPeriod(randomPeriod(random, g, 1)), amount);
      const MatrixXd lower = form(g).transpose() * energy_h.inverse() * form(g);
      const auto projection = projectSymplectic(energy_h);
      ASSERT_OK(projection);
      const MatrixXd twin = geometricMean(energy_h, lower);
      EXPECT_LT(largest(MatrixXd(projection->energy - twin)), 1e-11 * largest(energy_h));
    }
  }
}

TEST(Projection, IsSymplecticWithAComplexStructure) {
  std::mt19937 random(5);
  for (const Index g : {1, 2, 3, 8, 26}) {
    const MatrixXd energy_h = raised(random, energyOfPeriod(randomPeriod(random, g, 1)), 0.05);
    const auto projection = projectSymplectic(energy_h);
    ASSERT_OK(projection);
    const MatrixXd& m = projection->energy;
    EXPECT_EQ(m, m.transpose());
    EXPECT_LT(largest(MatrixXd(m * form(g) * m - form(g))), 1e-12);
    const MatrixXd star = form(g).inverse() * m;
    EXPECT_LT(largest(MatrixXd(star * star + MatrixXd::Identity(2 * g, 2 * g))), 1e-12);
    EXPECT_LT(periodOfEnergy(m)->symmetry_residual, 1e-12);
    EXPECT_GT(projection->spread, 1e-3);
  }
}

TEST(Projection, KeepsSymplecticForms) {
  std::mt19937 random(6);
  for (const Index g : {1, 2, 5, 26}) {
    const MatrixXd energy = energyOfPeriod(randomPeriod(random, g, 0.8));
    const auto projection = projectSymplectic(energy);
    ASSERT_OK(projection);
    EXPECT_LT(largest(MatrixXd(projection->energy - energy)), 1e-13 * largest(energy));
    EXPECT_LT(projection->spread, 1e-13);
    EXPECT_GE(projection->spread, 0);
  }
}

TEST(Projection, IsEquivariant) {
  std::mt19937 random(7);
  for (const Index g : {1, 2, 4}) {
    const MatrixXd energy_h = raised(random, energyOfPeriod(randomPeriod(random, g, 1)), 0.1);
    const IntegerMatrix word = randomWord(random, g, 8);
    const auto projection = projectSymplectic(energy_h);
    const auto image = projectSymplectic(congruence(word, energy_h));
    ASSERT_OK(projection);
    ASSERT_OK(image);
    const MatrixXd expected = congruence(word, projection->energy);
    EXPECT_LT(largest(MatrixXd(image->energy - expected)), 1e-11 * largest(expected));
    EXPECT_NEAR(image->spread, projection->spread, 1e-10);
  }
}

TEST(Projection, KeepsVanishingBlocks) {
  std::mt19937 random(8);
  const Index g = 26;
  const MatrixXd y = randomPeriod(random, g, 1).imag();
  MatrixXd energy_h = MatrixXd::Zero(2 * g, 2 * g);
  energy_h.topLeftCorner(g, g) = 1.1 * y;
  energy_h.bottomRightCorner(g, g) = y.inverse();
  const auto projection = projectSymplectic(energy_h);
  ASSERT_OK(projection);
  EXPECT_TRUE(projection->energy.topRightCorner(g, g).isZero(0));
  const MatrixXcd period = periodOf(projection->energy);
  EXPECT_TRUE(period.real().isZero(0));
  EXPECT_LT(largest(MatrixXd(period.imag() - std::sqrt(1.1) * y)), 1e-13);
}

TEST(Projection, IsExactForScaledFormsAndForTheTorus) {
  std::mt19937 random(9);
  const MatrixXd energy = energyOfPeriod(randomPeriod(random, 3, 1));
  for (const double scale : {1.0 + 1e-9, 2.0, 1e6}) {
    const auto projection = projectSymplectic(scale * energy);
    ASSERT_OK(projection);
    EXPECT_LT(largest(MatrixXd(projection->energy - energy)), 1e-13);
    EXPECT_NEAR(projection->spread, std::log(scale), 1e-13);
  }
  const Eigen::Matrix2d torus{{3, 0.4}, {0.4, 0.9}};
  EXPECT_LT(
      largest(MatrixXd(projectSymplectic(torus)->energy - torus / std::sqrt(torus.determinant()))),
      1e-15 * 10);
}

TEST(Projection, SpreadBoundsTheExactForm) {
  std::mt19937 random(10);
  for (const Index g : {1, 2, 3, 7}) {
    for (const double amount : {1e-4, 0.03, 1.0}) {
      const MatrixXd energy = energyOfPeriod(randomPeriod(random, g, 1));
      const MatrixXd energy_h = raised(random, energy, amount);
      const auto projection = projectSymplectic(energy_h);
      ASSERT_OK(projection);
      const MatrixXd& m = projection->energy;
      const double e = std::exp(projection->spread);
      EXPECT_GT(smallestEigenvalue(e * m - energy), -1e-12);
      EXPECT_GT(smallestEigenvalue(energy - m / e), -1e-12);
      // E_h <= ratio E, so that the upper bound is at most ratio^2 times the lower one.
      const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> ratios(energy_h, energy);
      EXPECT_LE(e, ratios.eigenvalues().maxCoeff() + 1e-12);
    }
  }
}

TEST(Projection, SpreadBoundsThePeriod) {
  std::mt19937 random(11);
  double closest = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const Index g = 1 + trial % 3;
    const MatrixXcd period = randomPeriod(random, g, std::exp(uniform(random, -1, 1)));
    const double amount = std::exp(uniform(random, -8, 1));
    const auto projection = projectSymplectic(raised(random, energyOfPeriod(period), amount));
    ASSERT_OK(projection);
    const MatrixXcd found = periodOf(projection->energy);
    const Eigen::VectorXd scale = found.imag().diagonal().cwiseSqrt();
    const double factor = std::exp(projection->spread) - 1;
    for (Index j = 0; j < g; ++j) {
      for (Index k = 0; k < g; ++k) {
        const double bound = scale(j) * scale(k) * factor;
        EXPECT_LE(std::abs(found(j, k) - period(j, k)), bound + 1e-12);
        closest = std::max(closest, std::abs(found(j, k) - period(j, k)) / bound);
      }
    }
  }
  EXPECT_GT(closest, 0.2) << "the bound is never near";
}

/// E_h = e^delta E' for an exact E' would be extreme, but is not: the exact form at the end of the
/// interval, E = diag(e^delta, e^-delta) with M = 1, meets the bound with equality.
TEST(Projection, BoundOfThePeriodIsSharp) {
  const double delta = 0.3;
  const Eigen::Matrix2d energy_h = std::exp(delta) * Eigen::Matrix2d::Identity();
  const auto projection = projectSymplectic(energy_h);
  ASSERT_OK(projection);
  const Complex exact(0, std::exp(delta));
  const MatrixXd energy = energyOfPeriod(MatrixXcd::Constant(1, 1, exact));
  EXPECT_GT(smallestEigenvalue(energy_h - energy), -1e-15);
  EXPECT_NEAR(std::abs(periodOf(projection->energy)(0, 0) - exact),
              std::exp(projection->spread) - 1, 1e-14);
}

void expectReduced(const SiegelReduction& reduced, const MatrixXd& given) {
  ASSERT_TRUE(isSymplectic(reduced.transform));
  EXPECT_EQ(reduced.energy, congruence(reduced.transform, given));
  const MatrixXcd period = periodOf(reduced.energy);
  EXPECT_LE(largest(MatrixXd(period.real())), 0.5 + 1e-11);
  EXPECT_GE(std::abs(period(0, 0)), 1 - 1e-11);
  const auto lattice = reduceLattice(period.imag());
  ASSERT_OK(lattice);
  EXPECT_EQ(lattice->transform, IntegerMatrix::Identity(period.rows(), period.rows()));
}

TEST(SiegelReduction, IsThatOfTheModularGroupForTheTorus) {
  std::mt19937 random(12);
  std::vector<Complex> taus = {kI,          {0.5, 2},    {-0.5, 2},    {-0.5, std::sqrt(0.75)},
                               {0.5, 0.01}, {7.5, 0.75}, {0.25, 1e-4}, std::polar(1.0, 1.8)};
  for (int trial = 0; trial < 300; ++trial) {
    taus.emplace_back(uniform(random, -5, 5), std::exp(uniform(random, -5, 3)));
    taus.push_back(std::polar(1.0, uniform(random, 0.2, 3.0)));
  }
  for (const Complex tau : taus) {
    const MatrixXd energy = energyOfPeriod(MatrixXcd::Constant(1, 1, tau));
    const auto reduced = reduce(energy);
    ASSERT_OK(reduced);
    ASSERT_TRUE(isSymplectic(reduced->transform));
    const Complex found = periodOf(reduced->energy)(0, 0);
    const auto expected = reduceToFundamentalDomain(tau);
    // The rounding of `energy` grows by its condition number, |E|^2.
    const double rounding = 1e-15 * (1 + std::pow(largest(energy), 2));
    EXPECT_LT(std::abs(found - expected->tau), rounding * expected->tau.imag()) << tau;
  }
}

/// High above the border, where no element of Sp but translations and changes of basis keeps the
/// height, a random image comes back to the same height.
TEST(SiegelReduction, UndoesRandomWords) {
  std::mt19937 random(13);
  for (const Index g : {2, 3, 5}) {
    for (int trial = 0; trial < 40; ++trial) {
      const MatrixXcd period = randomPeriod(random, g, 2);
      const MatrixXd given = congruence(randomWord(random, g, 12), energyOfPeriod(period));
      const auto reduced = reduce(given);
      ASSERT_OK(reduced);
      expectReduced(*reduced, given);
      const MatrixXcd found = periodOf(reduced->energy);
      EXPECT_NEAR(found.imag().determinant() / period.imag().determinant(), 1, 1e-9);
    }
  }
}

/// As the comment of projectSymplectic advises.
TEST(SiegelReduction, ProjectingAnewAfterItRestoresTheDigits) {
  std::mt19937 random(17);
  double skewest = 0;
  for (int trial = 0; trial < 20; ++trial) {
    const Index g = 2 + trial % 2;
    const MatrixXd energy_h = raised(random, energyOfPeriod(randomPeriod(random, g, 2)), 0.01);
    const MatrixXd given = congruence(randomWord(random, g, 60), energy_h);
    skewest = std::max(skewest, largest(given));
    const auto rough = projectSymplectic(given);
    ASSERT_OK(rough);
    const auto reduced = reduce(rough->energy);
    ASSERT_OK(reduced);
    const auto anew = projectSymplectic(congruence(reduced->transform, given));
    const auto expected = projectSymplectic(energy_h);
    ASSERT_OK(anew);
    const double rounding = 1e-15 * (1 + std::pow(largest(given), 2));
    EXPECT_NEAR(anew->spread, expected->spread, rounding);
    const MatrixXd& m = anew->energy;
    EXPECT_LT(largest(MatrixXd(m * form(g) * m - form(g))), 1e-12);
    EXPECT_NEAR(periodOf(m).imag().determinant() / periodOf(expected->energy).imag().determinant(),
                1, rounding);
  }
  EXPECT_GT(skewest, 1e4);
}

TEST(SiegelReduction, KeepsReducedPoints) {
  std::mt19937 random(14);
  for (int trial = 0; trial < 20; ++trial) {
    const auto once = reduce(energyOfPeriod(randomPeriod(random, 3, 0.4)));
    ASSERT_OK(once);
    const auto twice = reduce(once->energy);
    ASSERT_OK(twice);
    EXPECT_EQ(twice->transform, IntegerMatrix::Identity(6, 6));
    EXPECT_EQ(twice->energy, once->energy);
  }
}

/// These lie on the border, where rounding must not send the reduction to and fro.
TEST(SiegelReduction, EndsOnSymmetricPeriods) {
  std::mt19937 random(15);
  auto periods = knownPeriods();
  periods.push_back(kI * MatrixXcd::Identity(4, 4));
  periods.push_back(std::polar(1.0, std::numbers::pi / 3) * MatrixXcd::Identity(3, 3));
  periods.push_back(kI * MatrixXcd::Identity(2, 2) + 0.5 * MatrixXcd::Ones(2, 2));
  for (const MatrixXcd& period : periods) {
    for (int trial = 0; trial < 20; ++trial) {
      const IntegerMatrix word = randomWord(random, period.rows(), trial);
      const MatrixXd given = congruence(word, energyOfPeriod(period));
      const auto reduced = reduce(given);
      ASSERT_OK(reduced);
      expectReduced(*reduced, given);
    }
  }
}

TEST(SiegelReduction, ReachesLargeGenus) {
  std::mt19937 random(16);
  const Index g = 26;
  const MatrixXd given =
      congruence(randomWord(random, g, 80), energyOfPeriod(randomPeriod(random, g, 1)));
  const auto reduced = reduce(given);
  ASSERT_OK(reduced);
  expectReduced(*reduced, given);
}

TEST(Faults, AreRefused) {
  const MatrixXd odd = MatrixXd::Identity(3, 3);
  const MatrixXd empty;
  const MatrixXd wide = MatrixXd::Ones(2, 4);
  for (const MatrixXd& energy : {odd, empty, wide}) {
    EXPECT_THAT(periodOfEnergy(energy), FailsWith(Reason::kInvalidOption));
    EXPECT_THAT(projectSymplectic(energy), FailsWith(Reason::kInvalidOption));
    EXPECT_THAT(reduce(energy), FailsWith(Reason::kInvalidOption));
  }
  MatrixXd not_a_number = MatrixXd::Identity(4, 4);
  not_a_number(2, 1) = not_a_number(1, 2) = std::nan("");
  MatrixXd indefinite = MatrixXd::Identity(4, 4);
  indefinite(0, 0) = -1;
  for (const MatrixXd& energy : {not_a_number, indefinite}) {
    EXPECT_THAT(periodOfEnergy(energy), FailsWith(Reason::kNotPositiveDefinite));
    EXPECT_THAT(projectSymplectic(energy), FailsWith(Reason::kNotPositiveDefinite));
    EXPECT_THAT(reduce(energy), FailsWith(Reason::kNotPositiveDefinite));
  }
  EXPECT_THAT(reduce(2 * MatrixXd::Identity(4, 4)), FailsWith(Reason::kInvalidOption));
  EXPECT_TRUE(std::isnan(energyOfPeriod(-kI * MatrixXcd::Identity(2, 2))(0, 0)));
}

TEST(Faults, OverflowOfTheBasisIsNoticed) {
  MatrixXcd far(2, 2);
  far << Complex(1e19, 1e13), 0, 0, Complex(0, 1);
  EXPECT_THAT(reduce(energyOfPeriod(far)), FailsWith(Reason::kOverflow));
}

TEST(SiegelReduction, StopsWhenCancelled) {
  Context context;
  CancelToken token;
  token.cancel();
  context.setCancelToken(token);
  EXPECT_THAT(siegelReduce(context, MatrixXd::Identity(4, 4)), FailsWith(Reason::kCancelled));
}

}  // namespace
}  // namespace moduli
