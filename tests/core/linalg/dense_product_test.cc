#include "core/linalg/dense_product.h"

#include <gtest/gtest.h>

#include <cmath>

namespace moduli {
namespace {

Eigen::MatrixXd waves(Eigen::Index rows, Eigen::Index columns, double step) {
  Eigen::MatrixXd result(rows, columns);
  for (Eigen::Index i = 0; i < result.size(); ++i) {
    result.data()[i] = std::sin(step * static_cast<double>(i + 1));
  }
  return result;
}

TEST(DenseProduct, IsTheSumOfProducts) {
  const Eigen::MatrixXd a = waves(37, 5, 1.3), b = waves(37, 4, 0.7);
  const Eigen::MatrixXd product = transposedProduct(a, b);
  ASSERT_EQ(product.rows(), 5);
  ASSERT_EQ(product.cols(), 4);
  for (Eigen::Index i = 0; i < 5; ++i) {
    for (Eigen::Index j = 0; j < 4; ++j) {
      double sum = 0;
      for (Eigen::Index n = 0; n < 37; ++n) sum += a(n, i) * b(n, j);
      // 37 products of at most 1, each rounded twice.
      EXPECT_NEAR(product(i, j), sum, 37 * 0x1p-51);
    }
  }
}

TEST(DenseProduct, OfFloatsIsThatOfDoublesUpToTheirRounding) {
  const Eigen::MatrixXf a = waves(37, 5, 1.3).cast<float>(), b = waves(37, 70, 0.7).cast<float>();
  const Eigen::MatrixXd wanted =
      transposedProduct(Eigen::MatrixXd(a.cast<double>()), Eigen::MatrixXd(b.cast<double>()));
  const Eigen::MatrixXf product = transposedProduct(a, b);
  // 37 products and sums of at most 37, each rounded to 24 digits.
  EXPECT_LT((product.cast<double>() - wanted).cwiseAbs().maxCoeff(), 37 * 37 * 0x1p-24);
  // Columns of a larger matrix.
  const Eigen::MatrixXf part = transposedProduct(a, b.middleCols(10, 20));
  EXPECT_LT((part - product.middleCols(10, 20)).cwiseAbs().maxCoeff(), 37 * 37 * 0x1p-23F);
}

TEST(DenseProduct, OfNothingIsEmptyOrZero) {
  EXPECT_EQ(transposedProduct(Eigen::MatrixXf(3, 0), Eigen::MatrixXf(3, 2)).rows(), 0);
  EXPECT_EQ(transposedProduct(Eigen::MatrixXf(0, 2), Eigen::MatrixXf(0, 3)),
            Eigen::MatrixXf::Zero(2, 3));
}

}  // namespace
}  // namespace moduli
