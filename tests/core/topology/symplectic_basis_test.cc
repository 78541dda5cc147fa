#include "core/topology/symplectic_basis.h"

#include <Eigen/LU>
#include <cmath>
#include <random>

#include "tests/core/testing.h"

namespace moduli {
namespace {

/// g pairs and then a radical, as reduceSymplectic gives them.
IntegerMatrix standardForm(Eigen::Index pairs, Eigen::Index radical) {
  IntegerMatrix form = IntegerMatrix::Zero(2 * pairs + radical, 2 * pairs + radical);
  form.topLeftCorner(2 * pairs, 2 * pairs) = standardSymplecticForm(pairs);
  return form;
}

/// A random unimodular change of basis with small entries.
IntegerMatrix scramble(Eigen::Index n, int steps, std::mt19937& random) {
  IntegerMatrix change = IntegerMatrix::Identity(n, n);
  for (int step = 0; step < steps; ++step) {
    const auto to = static_cast<Eigen::Index>(random() % n);
    const auto from = static_cast<Eigen::Index>(random() % n);
    if (to == from) continue;
    EXPECT_OK(addRow(change, to, static_cast<Integer>(random() % 3) - 1, from));
  }
  return change;
}

IntegerMatrix conjugate(const IntegerMatrix& change, const IntegerMatrix& form) {
  const auto left = multiply(change, form);
  EXPECT_OK(left);
  const auto image = multiply(*left, change.transpose());
  EXPECT_OK(image);
  return *image;
}

/// CHECKS A4: S J S^T = J0, det S = +-1, for forms with and without radical.
TEST(SymplecticBasis, BringsEveryUnimodularFormToItsNormalForm) {
  std::mt19937 random(5);
  for (Eigen::Index pairs = 0; pairs < 7; ++pairs) {
    for (Eigen::Index radical = 0; radical < 4; ++radical) {
      const Eigen::Index n = 2 * pairs + radical;
      if (n == 0) continue;
      for (int trial = 0; trial < 10; ++trial) {
        const IntegerMatrix form =
            conjugate(scramble(n, static_cast<int>(4 * n), random), standardForm(pairs, radical));
        const auto reduced = reduceSymplectic(form);
        ASSERT_OK(reduced);
        ASSERT_EQ(reduced->pairs, pairs);
        EXPECT_EQ(conjugate(reduced->basis, form), standardForm(pairs, radical));
        EXPECT_NEAR(std::abs(reduced->basis.cast<double>().determinant()), 1, 1e-6);
      }
    }
  }
}

/// The antisymmetric 4 x 4 form with these entries; its determinant is the square of their Pfaffian
/// f01 f23 - f02 f13 + f03 f12.
IntegerMatrix formOfFour(Integer f01, Integer f02, Integer f03, Integer f12, Integer f13,
                         Integer f23) {
  IntegerMatrix form(4, 4);
  form << 0, f01, f02, f03, -f01, 0, f12, f13, -f02, -f12, 0, f23, -f03, -f13, -f23, 0;
  return form;
}

TEST(SymplecticBasis, FindsAProductOfOneByEuclid) {
  // Pfaffian 2 * 5 - 3 * 3 = 1, although no product is 1.
  const IntegerMatrix form = formOfFour(2, 3, 0, 0, 3, 5);
  const auto reduced = reduceSymplectic(form);
  ASSERT_OK(reduced);
  EXPECT_EQ(reduced->pairs, 2);
  EXPECT_EQ(conjugate(reduced->basis, form), standardForm(2, 0));
  // Pfaffian 6 * 0 - 10 * 0 + 15 * 1: the invariant factors are 1 and 15.
  const auto other = reduceSymplectic(formOfFour(6, 10, 15, 1, 0, 0));
  EXPECT_THAT(other, FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(other.status().message(), testing::HasSubstr("15"));
}

TEST(SymplecticBasis, RefusesWhatIsNoIntersectionForm) {
  IntegerMatrix form = IntegerMatrix::Zero(2, 2);
  form(0, 1) = 1;
  form(1, 0) = 1;
  EXPECT_THAT(reduceSymplectic(form), FailsWith(Reason::kInvalidOption));
  form(1, 0) = -3;
  form(0, 1) = 3;
  EXPECT_THAT(reduceSymplectic(form), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(reduceSymplectic(IntegerMatrix::Zero(2, 3)), FailsWith(Reason::kInvalidOption));
}

TEST(SymplecticBasis, NoticesOverflow) {
  // Orthogonalizing the third row against the first two takes the product of 2^40 and 2^40.
  const Integer big = Integer{1} << 40;
  IntegerMatrix form = IntegerMatrix::Zero(4, 4);
  form(0, 1) = 1;
  form(0, 2) = form(0, 3) = big;
  form(1, 2) = big;
  form(1, 3) = -big;
  for (Eigen::Index i = 0; i < 4; ++i) {
    for (Eigen::Index k = 0; k < i; ++k) form(i, k) = -form(k, i);
  }
  EXPECT_THAT(reduceSymplectic(form), FailsWith(Reason::kOverflow));
}

}  // namespace
}  // namespace moduli
