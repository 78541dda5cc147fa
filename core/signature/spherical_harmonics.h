#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace moduli {

/// The real orthonormal spherical harmonics Y_lm, l <= degree. For m > 0 the pair with cos(m phi)
/// and sin(m phi). Evaluated for many points at once by the recurrence in l at fixed m of the
/// normalized associated Legendre functions, which is stable, started from (x + i y)^m, which needs
/// no angle and no division at the poles. Immutable, thread-safe.
class SphericalHarmonics {
 public:
  explicit SphericalHarmonics(int degree);

  int degree() const { return degree_; }
  int count() const { return (degree_ + 1) * (degree_ + 1); }
  /// Row of a harmonic in the coefficients: m from -l (sine) to l (cosine).
  static int index(int l, int m) { return l * l + l + m; }

  /// Adds sum_i values(i, k) Y_lm(point_i) to coefficients(index(l, m), k).
  /// points: n x 3 unit vectors; values: n x k, weights included. O(n degree^2).
  void project(const Eigen::Ref<const Eigen::MatrixX3d>& points,
               const Eigen::Ref<const Eigen::MatrixXd>& values,
               Eigen::Ref<Eigen::MatrixXd> coefficients) const;

  /// All harmonics at one unit vector.
  Eigen::VectorXd evaluate(const Eigen::Vector3d& point) const;

 private:
  static constexpr int kBatch = 64;
  using Batch = Eigen::Array<double, kBatch, 1>;

  /// Values times (sin theta)^m cos(m phi) and sin(m phi).
  struct Wave {
    Batch cosine, sine;
  };
  void projectBatch(const std::array<Batch, 3>& point, std::vector<Wave>& waves,
                    Eigen::Ref<Eigen::MatrixXd> coefficients) const;

  int degree_;
  std::vector<double> start_;    ///< P_mm / (sin theta)^m, with the sqrt(2) of m > 0.
  Eigen::MatrixXd rise_, drop_;  ///< P_l = rise(l, m) z P_{l-1} - drop(l, m) P_{l-2}.
};

}  // namespace moduli
