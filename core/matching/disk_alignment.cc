#include "core/matching/disk_alignment.h"

#include <Eigen/Dense>
#include <cmath>
#include <limits>

#include "core/spherical/robust_disk.h"

namespace moduli {
namespace {

using Complex = std::complex<double>;

constexpr double kInside = 0.999;  ///< Modulus of points that may be carried to each other.
constexpr int kSteps = 50;
constexpr double kTurn = 1e-12;

/// 2 (cosh d - 1) with |a|^2 = (cosh d + 1) / 2.
double squeeze(const MobiusMap& map) {
  return 4 * std::norm(map.b);
}

class Aligning {
 public:
  Aligning(const std::vector<DiskPair>& pairs, double preference)
      : pairs_(pairs), preference_(preference) {
    for (const DiskPair& pair : pairs) targets_.push_back(diskToSphere(pair.target));
  }

  double cost(const MobiusMap& map) const {
    double sum = 0;
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      sum += (diskToSphere(map(pairs_[i].source)) - targets_[i]).squaredNorm();
    }
    return sum / static_cast<double>(pairs_.size()) + preference_ * squeeze(map);
  }

  /// That takes z to w and turns the others best.
  MobiusMap carrying(const Complex& z, const Complex& w) const {
    const MobiusMap from = diskAutomorphism(z), to = diskAutomorphism(w);
    Complex sum = 0;
    for (const DiskPair& pair : pairs_) {
      sum += std::conj(from(pair.source)) * to(pair.target);
    }
    return compose(to.inverse(), diskAutomorphism(z, std::abs(sum) > 0 ? std::arg(sum) : 0.0));
  }

  MobiusMap best() const {
    MobiusMap best = carrying(0, 0);
    double least = cost(best);
    for (const DiskPair& pair : pairs_) {
      if (!(std::abs(pair.source) < kInside) || !(std::abs(pair.target) < kInside)) continue;
      const MobiusMap other = carrying(pair.source, pair.target);
      const double there = cost(other);
      if (!(there < least)) continue;
      least = there;
      best = other;
    }
    return improved(best, least);
  }

 private:
  /// By flows dw/dt = b + i t w - conj(b) w^2 on the image.
  static MobiusMap flow(const Eigen::Vector3d& x) {
    const Complex b(x[0], x[1]);
    const double length = std::abs(b);
    // Along the translation for the time 1, after the turn.
    const MobiusMap turn = diskAutomorphism(0, x[2]);
    if (!(length > 0)) return turn;
    return compose(diskAutomorphism(-b / length * std::tanh(length)), turn);
  }

  MobiusMap improved(MobiusMap map, double least) const {
    double damping = 1e-3;
    for (int step = 0; step < kSteps && damping < 1e9; ++step) {
      Eigen::Matrix3d square = Eigen::Matrix3d::Zero();
      Eigen::Vector3d slope = Eigen::Vector3d::Zero();
      differentiate(map, square, slope);
      Eigen::Matrix3d damped = square;
      damped.diagonal() *= 1 + damping;
      damped.diagonal().array() += std::numeric_limits<double>::min();
      const Eigen::Vector3d x = -damped.ldlt().solve(slope);
      if (!(x.norm() > kTurn)) break;
      const MobiusMap trial = compose(flow(x), map);
      const double there = cost(trial);
      if (there < least) {
        least = there;
        map = trial;
        damping /= 10;
      } else {
        damping *= 10;
      }
    }
    return map;
  }

  /// Gauss's part of the second derivatives, and half of the first.
  void differentiate(const MobiusMap& map, Eigen::Matrix3d& square, Eigen::Vector3d& slope) const {
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      const Complex w = map(pairs_[i].source), i_w(-w.imag(), w.real());
      const Complex i_unit(0, 1);
      Eigen::Matrix3d jacobian;  // Of the point on the sphere.
      jacobian.col(0) = onSphere(w, 1.0 - w * w);
      jacobian.col(1) = onSphere(w, i_unit + i_unit * w * w);
      jacobian.col(2) = onSphere(w, i_w);
      square += jacobian.transpose() * jacobian;
      slope += jacobian.transpose() * (diskToSphere(w) - targets_[i]);
    }
    square /= static_cast<double>(pairs_.size());
    slope /= static_cast<double>(pairs_.size());
    // |b|^2 grows by the translation's real part along a conj b, and quadratically by |a|^2 +
    // |b|^2.
    const Complex along = 4.0 * map.b * std::conj(map.d);
    slope[0] += preference_ * along.real();
    slope[1] += preference_ * along.imag();
    const double grows = 4 * (std::norm(map.a) + std::norm(map.b));
    square(0, 0) += preference_ * grows;
    square(1, 1) += preference_ * grows;
  }

  /// How the point over w moves as w does.
  static Eigen::Vector3d onSphere(const Complex& w, const Complex& motion) {
    const double n = 1 + std::norm(w);
    const double rate = 2 * (std::conj(w) * motion).real();
    return {2 * motion.real() / n - 2 * w.real() * rate / (n * n),
            2 * motion.imag() / n - 2 * w.imag() * rate / (n * n),
            -rate / n - (1 - std::norm(w)) * rate / (n * n)};
  }

  const std::vector<DiskPair>& pairs_;
  double preference_;
  std::vector<Eigen::Vector3d> targets_;
};

}  // namespace

Result<MobiusMap> alignDisks(const std::vector<DiskPair>& pairs, double rotation_preference) {
  if (pairs.empty() || !(rotation_preference >= 0)) {
    return Status(Reason::kInvalidOption,
                  "disks are aligned by at least one pair and a preference >= 0");
  }
  for (const DiskPair& pair : pairs) {
    if (std::abs(pair.source) <= 1 + 1e-9 && std::abs(pair.target) <= 1 + 1e-9) continue;
    return Status(Reason::kInvalidOption, "a point to align is outside the unit disk");
  }
  return Aligning(pairs, rotation_preference).best();
}

}  // namespace moduli
