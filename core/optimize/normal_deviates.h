#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <random>

namespace moduli {

/// Standard normal deviates from a seed, by Marsaglia's polar method. The deviates of the standard
/// library differ from one implementation to the next; these do not, but for the last digits of the
/// logarithm.
class NormalDeviates {
 public:
  explicit NormalDeviates(std::uint64_t seed) : random_(seed) {}

  double next() {
    if (has_spare_) {
      has_spare_ = false;
      return spare_;
    }
    double u = 0, v = 0, s = 0;
    do {
      u = uniform();
      v = uniform();
      s = u * u + v * v;
    } while (s >= 1 || s == 0);
    const double scale = std::sqrt(-2 * std::log(s) / s);
    spare_ = v * scale;
    has_spare_ = true;
    return u * scale;
  }

  Eigen::VectorXd vector(Eigen::Index n) {
    Eigen::VectorXd result(n);
    for (double& entry : result) entry = next();
    return result;
  }

  /// Filled column after column.
  Eigen::MatrixXd matrix(Eigen::Index rows, Eigen::Index columns) {
    Eigen::MatrixXd result(rows, columns);
    for (Eigen::Index j = 0; j < columns; ++j) result.col(j) = vector(rows);
    return result;
  }

 private:
  /// In [-1, 1), from the upper 53 bits.
  double uniform() { return static_cast<double>(random_() >> 11) * 0x1p-52 - 1; }

  std::mt19937_64 random_;
  double spare_ = 0;
  bool has_spare_ = false;
};

}  // namespace moduli
