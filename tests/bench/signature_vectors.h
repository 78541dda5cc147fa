#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>
#include <vector>

#include "core/retrieval/vector_index.h"

namespace moduli::bench {

/// Vectors as signatures are: families around class centres, both with a decaying spectrum along
/// axes that are not those of the coordinates. The same seed gives the same vectors.
class SignatureVectors {
 public:
  struct Options {
    std::size_t families = 2000;
    double decay = 0.75;   ///< Standard deviation of the i-th axis: (1 + i)^-decay.
    double spread = 0.35;  ///< Of a family, relative to that of the centres.
  };

  SignatureVectors(std::size_t dimension, const Options& options, unsigned seed);

  VectorSet rows(std::size_t count);
  std::vector<std::vector<float>> queries(std::size_t count);

 private:
  void draw(float* vector);

  std::mt19937 random_;
  std::normal_distribution<float> normal_;
  Eigen::MatrixXf axes_;
  Eigen::MatrixXf centres_;  ///< A column each, along the axes.
  Eigen::VectorXf deviations_;
  float spread_;
};

}  // namespace moduli::bench
