#include "core/topology/integer_matrix.h"

#include <limits>

#include "tests/core/testing.h"

namespace moduli {
namespace {

constexpr Integer kMax = std::numeric_limits<Integer>::max();

IntegerMatrix matrix2(Integer a, Integer b, Integer c, Integer d) {
  IntegerMatrix matrix(2, 2);
  matrix << a, b, c, d;
  return matrix;
}

TEST(IntegerMatrix, AddsRows) {
  IntegerMatrix matrix = matrix2(1, 2, 3, 4);
  ASSERT_OK(addRow(matrix, 1, -3, 0));
  EXPECT_EQ(matrix, matrix2(1, 2, 0, -2));
  ASSERT_OK(addRow(matrix, 0, 1, 1));
  EXPECT_EQ(matrix, matrix2(1, 0, 0, -2));
}

TEST(IntegerMatrix, AddingARowNoticesOverflow) {
  IntegerMatrix product = matrix2(0, kMax / 2 + 1, 0, 0);
  EXPECT_THAT(addRow(product, 1, 2, 0), FailsWith(Reason::kOverflow));
  IntegerMatrix sum = matrix2(0, kMax, 0, 1);
  EXPECT_THAT(addRow(sum, 1, 1, 0), FailsWith(Reason::kOverflow));
  IntegerMatrix least = matrix2(0, -kMax, 0, -2);
  EXPECT_THAT(addRow(least, 1, 1, 0), FailsWith(Reason::kOverflow));
  IntegerMatrix fits = matrix2(0, kMax, 0, -1);
  ASSERT_OK(addRow(fits, 1, 1, 0));
  EXPECT_EQ(fits, matrix2(0, kMax, 0, kMax - 1));
}

TEST(IntegerMatrix, MultipliesAsEigenDoes) {
  IntegerMatrix a(2, 3);
  IntegerMatrix b(3, 4);
  a << 1, -2, 3, 0, 5, -6;
  b << 1, 2, 0, 4, -5, 6, 7, 0, 9, -1, 2, 3;
  const auto product = multiply(a, b);
  ASSERT_OK(product);
  EXPECT_EQ(*product, a * b);
}

TEST(IntegerMatrix, MultiplyingNoticesOverflow) {
  constexpr Integer kRoot = Integer{1} << 32;
  EXPECT_THAT(multiply(matrix2(kRoot, 0, 0, 0), matrix2(kRoot, 0, 0, 0)),
              FailsWith(Reason::kOverflow));
  EXPECT_THAT(multiply(matrix2(kMax, 1, 0, 0), matrix2(1, 0, 1, 0)), FailsWith(Reason::kOverflow));
  const auto fits = multiply(matrix2(kMax, -1, 0, 0), matrix2(1, 0, 1, 0));
  ASSERT_OK(fits);
  EXPECT_EQ(*fits, matrix2(kMax - 1, 0, 0, 0));
}

TEST(IntegerMatrix, TheStandardFormPairsTheFirstHalfWithTheSecond) {
  EXPECT_EQ(standardSymplecticForm(1), matrix2(0, 1, -1, 0));
  IntegerMatrix form(4, 4);
  form << 0, 0, 1, 0, 0, 0, 0, 1, -1, 0, 0, 0, 0, -1, 0, 0;
  EXPECT_EQ(standardSymplecticForm(2), form);
  EXPECT_EQ(standardSymplecticForm(0).size(), 0);
}

TEST(IntegerMatrix, TwoByTwoIsSymplecticIfItsDeterminantIsOne) {
  EXPECT_TRUE(isSymplectic(matrix2(1, 0, 0, 1)));
  EXPECT_TRUE(isSymplectic(matrix2(2, 1, 1, 1)));
  EXPECT_TRUE(isSymplectic(matrix2(0, 1, -1, 0)));
  EXPECT_FALSE(isSymplectic(matrix2(0, 1, 1, 0)));
  EXPECT_FALSE(isSymplectic(matrix2(2, 0, 0, 1)));
  EXPECT_FALSE(isSymplectic(matrix2(0, 0, 0, 0)));
}

TEST(IntegerMatrix, TransvectionsAreSymplecticAndDeterminantOneIsNotEnough) {
  // x + <x, v> v for a vector v, in rows.
  const IntegerMatrix form = standardSymplecticForm(3);
  IntegerMatrix v(1, 6);
  v << 1, -2, 0, 3, 1, 5;
  const IntegerMatrix transvection = IntegerMatrix::Identity(6, 6) + form * v.transpose() * v;
  EXPECT_TRUE(isSymplectic(transvection));
  EXPECT_TRUE(isSymplectic(transvection * transvection));
  IntegerMatrix shear = IntegerMatrix::Identity(6, 6);
  shear(0, 1) = 1;
  EXPECT_FALSE(isSymplectic(shear));
}

TEST(IntegerMatrix, OddOblongOrOverflowingMatricesAreNotSymplectic) {
  EXPECT_FALSE(isSymplectic(IntegerMatrix::Identity(3, 3)));
  EXPECT_FALSE(isSymplectic(IntegerMatrix::Zero(2, 4)));
  // Modulo 2^64 its determinant would be 1.
  EXPECT_FALSE(isSymplectic(matrix2(Integer{1} << 32, 1, -1, Integer{1} << 32)));
}

}  // namespace
}  // namespace moduli
