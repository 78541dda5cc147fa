#include "core/forms/lattice_reduction.h"

#include <cmath>
#include <limits>
#include <random>

#include "tests/core/testing.h"

namespace moduli {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

double uniform(std::mt19937& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
}

MatrixXd randomGram(std::mt19937& random, Index n) {
  MatrixXd basis(n, n);
  for (double& entry : basis.reshaped()) entry = uniform(random, -1, 1);
  return basis * basis.transpose() + 0.1 * MatrixXd::Identity(n, n);
}

/// A product of `letters` elementary matrices with entries up to `largest`.
IntegerMatrix randomUnimodular(std::mt19937& random, Index n, int letters, int largest) {
  IntegerMatrix word = IntegerMatrix::Identity(n, n);
  for (int k = 0; k < letters; ++k) {
    const auto to = static_cast<Index>(random() % n);
    const auto from = static_cast<Index>(random() % n);
    const auto times = static_cast<Integer>(random() % (2 * largest + 1)) - largest;
    if (to == from) continue;
    EXPECT_OK(addRow(word, to, times, from));
  }
  return word;
}

void expectReduced(const MatrixXd& gram) {
  const auto steps = gramSchmidt(gram);
  ASSERT_OK(steps);
  for (Index i = 1; i < gram.rows(); ++i) {
    for (Index j = 0; j < i; ++j) EXPECT_LE(std::abs(steps->mu(i, j)), 0.5 + 2e-9);
    const double m = steps->mu(i, i - 1);
    EXPECT_GE(steps->squares(i), (0.99 - m * m) * steps->squares(i - 1) * (1 - 1e-9));
  }
}

TEST(GramSchmidt, FactorsTheGramMatrix) {
  std::mt19937 random(1);
  for (const Index n : {1, 2, 5, 30}) {
    const MatrixXd gram = randomGram(random, n);
    const auto steps = gramSchmidt(gram);
    ASSERT_OK(steps);
    const MatrixXd product = steps->mu * steps->squares.asDiagonal() * steps->mu.transpose();
    EXPECT_LT((product - gram).cwiseAbs().maxCoeff(), 1e-13 * static_cast<double>(n));
    EXPECT_TRUE(steps->mu.isLowerTriangular(0));
  }
}

TEST(LatticeReduction, GivesReducedBasesWithExactTransforms) {
  std::mt19937 random(2);
  for (const Index n : {1, 2, 3, 4, 8, 20, 52}) {
    for (int trial = 0; trial < 5; ++trial) {
      const MatrixXd start = randomGram(random, n);
      const MatrixXd gram =
          congruence(randomUnimodular(random, n, 3 * static_cast<int>(n), 2), start);
      const auto lattice = reduceLattice(gram);
      ASSERT_OK(lattice);
      expectReduced(lattice->gram);
      EXPECT_EQ(lattice->gram, congruence(lattice->transform, gram));
      const auto identity = multiply(lattice->transform, lattice->dual.transpose());
      ASSERT_OK(identity);
      EXPECT_EQ(*identity, IntegerMatrix::Identity(n, n));
      EXPECT_NEAR(gramSchmidt(lattice->gram)->squares.array().log().sum(),
                  gramSchmidt(start)->squares.array().log().sum(), 1e-6);
    }
  }
}

TEST(LatticeReduction, KeepsReducedBases) {
  std::mt19937 random(3);
  for (const Index n : {1, 2, 6, 24}) {
    const auto once = reduceLattice(randomGram(random, n));
    ASSERT_OK(once);
    const auto twice = reduceLattice(once->gram);
    ASSERT_OK(twice);
    EXPECT_EQ(twice->transform, IntegerMatrix::Identity(n, n));
    EXPECT_EQ(twice->dual, IntegerMatrix::Identity(n, n));
    EXPECT_EQ(twice->gram, once->gram);
  }
}

/// Ties everywhere: the hexagonal lattice and the root lattices A_n, whose coefficients are 1/2.
TEST(LatticeReduction, EndsOnTies) {
  for (const Index n : {2, 3, 10}) {
    MatrixXd gram = MatrixXd::Identity(n, n) + MatrixXd::Ones(n, n);
    for (const double scale : {1.0, 1 - 1e-15, 1 / 3.0}) {
      const auto lattice = reduceLattice(scale * gram);
      ASSERT_OK(lattice);
      expectReduced(lattice->gram);
      EXPECT_NEAR(lattice->gram(0, 0), 2 * scale, 1e-14);
    }
  }
}

TEST(LatticeReduction, FindsTheCubicLatticeInSkewBases) {
  std::mt19937 random(4);
  for (const Index n : {2, 3, 8, 24, 52}) {
    const IntegerMatrix word = randomUnimodular(random, n, 5 * static_cast<int>(n), 2);
    const auto lattice = reduceLattice(congruence(word, MatrixXd::Identity(n, n)));
    ASSERT_OK(lattice);
    EXPECT_EQ(lattice->gram, MatrixXd::Identity(n, n));
  }
}

/// Lengths from 1e-6 to 1e6, and a basis that hides them: the exact transform finds them again.
TEST(LatticeReduction, SeparatesLengthsOfManyOrders) {
  const Eigen::Vector4d squares(0x1p-20, 1, 0x1p10, 0x1p20);
  IntegerMatrix word = IntegerMatrix::Identity(4, 4);
  ASSERT_OK(addRow(word, 1, 12345, 0));
  ASSERT_OK(addRow(word, 3, -77, 1));
  ASSERT_OK(addRow(word, 2, 9, 1));
  ASSERT_OK(addRow(word, 3, 1000, 0));
  const auto lattice = reduceLattice(congruence(word, squares.asDiagonal()));
  ASSERT_OK(lattice);
  EXPECT_EQ(lattice->gram, MatrixXd(squares.asDiagonal()));
}

TEST(LatticeReduction, ReducesSkewBasesOfTheGreatestDimension) {
  std::mt19937 random(5);
  const Index n = 256;
  MatrixXd chain = 2.2 * MatrixXd::Identity(n, n);
  for (Index i = 1; i < n; ++i) chain(i, i - 1) = chain(i - 1, i) = -1;
  const IntegerMatrix word = randomUnimodular(random, n, 500, 1);
  const auto lattice = reduceLattice(congruence(word, chain));
  ASSERT_OK(lattice);
  EXPECT_LE(lattice->gram(0, 0), 2.2);
  const auto steps = gramSchmidt(lattice->gram);
  ASSERT_OK(steps);
  EXPECT_NEAR(steps->squares.array().log().sum(), gramSchmidt(chain)->squares.array().log().sum(),
              1e-8);
}

TEST(LatticeReduction, RefusesWhatIsNotPositiveDefinite) {
  const double nan = std::nan("");
  const double infinity = std::numeric_limits<double>::infinity();
  const Eigen::Matrix2d negative{{1, 0}, {0, -1}}, indefinite{{1, 2}, {2, 1}},
      singular{{1, 1}, {1, 1}}, skew{{1, 0.1}, {0, 1}}, zero{{0, 0}, {0, 0}},
      not_a_number{{1, nan}, {nan, 1}}, infinite{{infinity, 0}, {0, 1}};
  for (const auto& gram : {negative, indefinite, singular, skew, zero, not_a_number, infinite}) {
    EXPECT_THAT(reduceLattice(gram), FailsWith(Reason::kNotPositiveDefinite)) << gram;
    EXPECT_THAT(gramSchmidt(gram), FailsWith(Reason::kNotPositiveDefinite)) << gram;
  }
  EXPECT_THAT(reduceLattice(MatrixXd()), FailsWith(Reason::kNotPositiveDefinite));
  EXPECT_THAT(reduceLattice(MatrixXd::Ones(2, 3)), FailsWith(Reason::kNotPositiveDefinite));
}

/// Their last squares are of the order of rounding, some of them positive.
TEST(LatticeReduction, RefusesWhatIsSingularUpToRounding) {
  std::mt19937 random(6);
  for (int trial = 0; trial < 200; ++trial) {
    MatrixXd flat(3, 2);
    for (double& entry : flat.reshaped()) entry = uniform(random, -0.3, 0.3);
    flat.topRows(2).diagonal().array() += 1;
    EXPECT_THAT(reduceLattice(flat * flat.transpose()), FailsWith(Reason::kNotPositiveDefinite));
  }
}

TEST(LatticeReduction, NoticesOverflow) {
  const Eigen::Matrix2d one_step{{1, 1e19}, {1e19, 2e38}};
  EXPECT_THAT(reduceLattice(one_step), FailsWith(Reason::kOverflow));
  // Two steps of 2^40 each: b_1 = 2^40 b_0 + .., b_2 = 2^40 b*_1 + ...
  const double q = 0x1p40;
  const double s = 0x1p60;
  Eigen::Matrix3d two_steps;
  two_steps << 1, q, 0, q, q * q + s, q * s, 0, q * s, q * q * s + 0x1p100;
  EXPECT_THAT(reduceLattice(two_steps), FailsWith(Reason::kOverflow));
}

/// (2^30 + 1) a has 62 bits, so that doubles would give 1 instead of a.
TEST(Congruence, CancelsWithoutLoss) {
  const double a = 1 + 0x1p-31;
  IntegerMatrix r(1, 2);
  r << (1LL << 30) + 1, -(1LL << 30);
  EXPECT_EQ(congruence(r, MatrixXd::Constant(2, 2, a))(0, 0), a);
}

}  // namespace
}  // namespace moduli
