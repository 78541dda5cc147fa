#include "tests/bench/signature_vectors.h"

#include <Eigen/QR>
#include <cmath>

namespace moduli::bench {

SignatureVectors::SignatureVectors(std::size_t dimension, const Options& options, unsigned seed)
    : random_(seed), spread_(static_cast<float>(options.spread)) {
  const auto size = static_cast<Eigen::Index>(dimension);
  const auto gauss = [&] { return normal_(random_); };
  axes_ = Eigen::HouseholderQR<Eigen::MatrixXf>(Eigen::MatrixXf::NullaryExpr(size, size, gauss))
              .householderQ();
  deviations_ = Eigen::VectorXf::LinSpaced(size, 1, static_cast<float>(dimension))
                    .array()
                    .pow(static_cast<float>(-options.decay));
  centres_ = deviations_.asDiagonal() *
             Eigen::MatrixXf::NullaryExpr(size, static_cast<Eigen::Index>(options.families), gauss);
}

void SignatureVectors::draw(float* vector) {
  Eigen::VectorXf point = centres_.col(static_cast<Eigen::Index>(random_() % centres_.cols()));
  for (Eigen::Index i = 0; i < point.size(); ++i) {
    point[i] += spread_ * deviations_[i] * normal_(random_);
  }
  Eigen::Map<Eigen::VectorXf>(vector, point.size()).noalias() = axes_ * point;
}

VectorSet SignatureVectors::rows(std::size_t count) {
  const auto dimension = static_cast<std::size_t>(deviations_.size());
  VectorSet set{dimension, std::vector<float>(count * dimension), std::vector<std::int64_t>(count)};
  for (std::size_t row = 0; row < count; ++row) {
    set.ids[row] = static_cast<std::int64_t>(row + 1);
    draw(set.values.data() + row * dimension);
  }
  return set;
}

std::vector<std::vector<float>> SignatureVectors::queries(std::size_t count) {
  std::vector<std::vector<float>> all(count, std::vector<float>(deviations_.size()));
  for (std::vector<float>& query : all) draw(query.data());
  return all;
}

}  // namespace moduli::bench
