#include "core/spherical/landmark_alignment.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <optional>
#include <string>

namespace moduli {
namespace {

using Complex = std::complex<double>;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Pairs nearer to each other than this on a sphere count as one.
constexpr double kDistinct = 1e-8;
/// Maps that stretch more than this (cosh d) are on their way to infinity.
constexpr double kFarthest = 1e8;
constexpr int kMaxIterations = 200;

Eigen::Matrix3d crossMatrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

/// scalar + x.sigma, with the conjugates of Pauli's matrices: those of z = (x + i y) / (1 -
/// height).
MobiusMap fromPauli(Complex scalar, const Eigen::Vector3cd& x) {
  const Complex i(0, 1);
  return {scalar + x[2], x[0] + i * x[1], x[0] - i * x[1], scalar - x[2]};
}

/// exp of the element that turns by w and moves by b: p' = w x p + b - (b.p) p.
MobiusMap exponential(const Vector6& element) {
  const Eigen::Vector3cd x =
      0.5 * (element.tail<3>().cast<Complex>() + Complex(0, 1) * element.head<3>().cast<Complex>());
  // (x.sigma)^2 = x.x for complex vectors too.
  const Complex square = x[0] * x[0] + x[1] * x[1] + x[2] * x[2];
  const Complex root = std::sqrt(square);
  const Complex sinhc = std::abs(root) < 1e-4 ? 1.0 + square / 6.0 : std::sinh(root) / root;
  return fromPauli(std::cosh(root), sinhc * x);
}

/// 2 cosh of the hyperbolic distance by which a map moves the centre of the ball.
double squaredNorm(const MobiusMap& map) {
  return std::norm(map.a) + std::norm(map.b) + std::norm(map.c) + std::norm(map.d);
}

Status checkPairs(const std::vector<PointPair>& pairs) {
  if (pairs.empty()) return {Reason::kInvalidOption, "an alignment needs at least one pair"};
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const std::string name = "landmark pair " + std::to_string(i);
    for (const Eigen::Vector3d& p : {pairs[i].source, pairs[i].target}) {
      if (!(std::abs(p.norm() - 1) <= 1e-6)) {
        return {Reason::kInvalidOption, name + " has a point that is not on the unit sphere"};
      }
    }
    if (!(pairs[i].weight > 0) || !std::isfinite(pairs[i].weight)) {
      return {Reason::kInvalidOption, name + " needs a positive weight"};
    }
  }
  return {};
}

/// Pairs on exact unit vectors with weights of sum 1.
std::vector<PointPair> normalized(std::vector<PointPair> pairs) {
  double total = 0;
  for (const PointPair& pair : pairs) total += pair.weight;
  for (PointPair& pair : pairs) {
    pair = {pair.source.normalized(), pair.target.normalized(), pair.weight / total};
  }
  return pairs;
}

Eigen::Matrix3d kabsch(const std::vector<PointPair>& pairs) {
  Eigen::Matrix3d correlation = Eigen::Matrix3d::Zero();
  for (const PointPair& pair : pairs) {
    correlation += pair.weight * pair.target * pair.source.transpose();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(correlation,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d s = svd.singularValues();
  if (s[1] <= 1e-12 * s[0]) {
    return Eigen::Quaterniond::FromTwoVectors(svd.matrixV().col(0), svd.matrixU().col(0))
        .toRotationMatrix();
  }
  const double turn = (svd.matrixU() * svd.matrixV().transpose()).determinant();
  return svd.matrixU() * Eigen::Vector3d(1, 1, turn).asDiagonal() * svd.matrixV().transpose();
}

/// How far two pairs are from being the same landmark.
double separation(const PointPair& a, const PointPair& b) {
  return std::min((a.source - b.source).norm(), (a.target - b.target).norm());
}

/// Three pairs far from each other, greedily; nothing if no three are distinct.
std::optional<std::array<std::size_t, 3>> spreadTriple(const std::vector<PointPair>& pairs) {
  std::array<std::size_t, 3> best = {0, 0, 0};
  const auto farthest = [&](const auto& distance) {
    std::size_t found = 0;
    for (std::size_t i = 1; i < pairs.size(); ++i) {
      if (distance(i) > distance(found)) found = i;
    }
    return found;
  };
  for (int round = 0; round < 2; ++round) {  // The second start is an end of the first span.
    best[1] = farthest([&](std::size_t i) { return separation(pairs[i], pairs[best[0]]); });
    if (round == 0) best[0] = best[1];
  }
  const auto third = [&](std::size_t i) {
    return std::min(separation(pairs[i], pairs[best[0]]), separation(pairs[i], pairs[best[1]]));
  };
  best[2] = farthest(third);
  if (!(third(best[2]) > kDistinct)) return std::nullopt;
  return best;
}

Result<MobiusMap> throughTriple(const std::vector<PointPair>& pairs,
                                const std::array<std::size_t, 3>& t) {
  return mobiusThrough(std::array{pairs[t[0]].source, pairs[t[1]].source, pairs[t[2]].source},
                       std::array{pairs[t[0]].target, pairs[t[1]].target, pairs[t[2]].target});
}

/// The sum to be made small, with its derivatives along exp(X) M.
class AlignmentEnergy {
 public:
  AlignmentEnergy(const std::vector<PointPair>& pairs, double preference)
      : pairs_(pairs), preference_(preference) {}

  double value(const MobiusMap& map) const {
    double sum = preference_ * (squaredNorm(map) - 2);
    for (const PointPair& pair : pairs_) {
      sum += pair.weight * (map(pair.source) - pair.target).squaredNorm();
    }
    return sum;
  }

  void derivatives(const MobiusMap& map, Vector6& gradient, Matrix6& hessian) const {
    gradient.setZero();
    hessian.setZero();
    for (const PointPair& pair : pairs_) addPair(map, pair, gradient, hessian);
    // |exp(X) M|^2 = tr(exp(X) S exp(X)*) with S = M M*: to second order tr(exp(2 B) S) + tr(S (B R
    // - R B)) for X = B + R, a move and a turn.
    const Complex across = map.a * std::conj(map.c) + map.b * std::conj(map.d);
    const Eigen::Vector3d along(
        2 * across.real(), 2 * across.imag(),
        std::norm(map.a) + std::norm(map.b) - std::norm(map.c) - std::norm(map.d));
    gradient.tail<3>() += preference_ * along;
    hessian.bottomRightCorner<3, 3>() +=
        preference_ * squaredNorm(map) * Eigen::Matrix3d::Identity();
    const Eigen::Matrix3d mixed = 0.5 * preference_ * crossMatrix(along);
    hessian.topRightCorner<3, 3>() += mixed;
    hessian.bottomLeftCorner<3, 3>() -= mixed;
  }

 private:
  static void addPair(const MobiusMap& map, const PointPair& pair, Vector6& gradient,
                      Matrix6& hessian) {
    const Eigen::Vector3d p = map(pair.source);
    const Eigen::Vector3d& q = pair.target;
    Eigen::Matrix<double, 3, 6> velocity;
    velocity << -crossMatrix(p), Eigen::Matrix3d::Identity() - p * p.transpose();
    Eigen::Matrix<double, 6, 3> bend;
    bend << -crossMatrix(q), -p.dot(q) * Eigen::Matrix3d::Identity() - p * q.transpose();
    // p - q, not -q: its error at a met pair is that of the residual.
    gradient += 2 * pair.weight * velocity.transpose() * (p - q);
    const Matrix6 half = pair.weight * bend * velocity;
    hessian -= half + half.transpose();
  }

  const std::vector<PointPair>& pairs_;
  double preference_;
};

struct Minimum {
  MobiusMap map;
  double value = 0;
  int iterations = 0;
  bool converged = false;
};

/// Newton's step with the absolute values of the Hessian's eigenvalues, which descends from saddles
/// and along valleys too; no longer than 1.
Vector6 descent(const Vector6& gradient, const Matrix6& hessian) {
  const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(hessian);
  const Vector6 size = eigen.eigenvalues().cwiseAbs();
  const Vector6 curvature = size.cwiseMax(1e-12 * size.maxCoeff() + 1e-300);
  const Vector6 step = -eigen.eigenvectors() *
                       (eigen.eigenvectors().transpose() * gradient).cwiseQuotient(curvature);
  return step / std::max(1.0, step.norm());
}

/// The last steps are too small to show in the sum and are taken on the gradient's word.
Minimum minimize(const AlignmentEnergy& energy, const MobiusMap& start) {
  Minimum best{start, energy.value(start), 0, false};
  int blind_steps = 0;
  while (best.iterations < kMaxIterations && squaredNorm(best.map) < 2 * kFarthest) {
    Vector6 gradient;
    Matrix6 hessian;
    energy.derivatives(best.map, gradient, hessian);
    ++best.iterations;
    Vector6 step = descent(gradient, hessian);
    for (;; step /= 2) {
      const MobiusMap next = compose(exponential(step), best.map);
      const double value = energy.value(next);
      const bool is_blind = step.norm() <= 1e-6;
      if (!(value < best.value) && !is_blind) continue;
      best.map = next;
      best.value = value;
      best.converged = step.norm() <= 1e-14 || (is_blind && ++blind_steps == 3);
      break;
    }
    if (best.converged) break;
  }
  return best;
}

LandmarkAlignment report(const std::vector<PointPair>& pairs, const MobiusMap& map) {
  LandmarkAlignment result;
  result.map = map;
  double sum = 0;
  for (const PointPair& pair : pairs) {
    result.moved.push_back(map(pair.source));
    result.residuals.push_back((result.moved.back() - pair.target).norm());
    sum += pair.weight * result.residuals.back() * result.residuals.back();
  }
  result.rms = std::sqrt(sum);
  return result;
}

}  // namespace

MobiusMap mobiusOfRotation(const Eigen::Matrix3d& rotation) {
  const Eigen::Quaterniond q(rotation);
  return fromPauli(q.w(), Complex(0, 1) * q.vec().cast<Complex>());
}

Result<Eigen::Matrix3d> bestRotation(const std::vector<PointPair>& pairs) {
  RETURN_IF_ERROR(checkPairs(pairs));
  return kabsch(normalized(pairs));
}

Result<LandmarkAlignment> alignLandmarks(const std::vector<PointPair>& given,
                                         const AlignmentOptions& options) {
  RETURN_IF_ERROR(checkPairs(given));
  if (!(options.rotation_preference >= 0)) {
    return Status(Reason::kInvalidOption, "the preference for rotations must not be negative");
  }
  const std::vector<PointPair> pairs = normalized(given);
  const MobiusMap rigid = mobiusOfRotation(kabsch(pairs));
  const auto triple = spreadTriple(pairs);
  if (options.rigid || !triple) {
    LandmarkAlignment result = report(pairs, rigid);
    result.is_rotation = true;
    return result;
  }
  const AlignmentEnergy energy(pairs, options.rotation_preference);
  ASSIGN_OR_RETURN(const MobiusMap exact, throughTriple(pairs, *triple));
  Minimum best = minimize(energy, exact);
  const bool is_exact = pairs.size() == 3 && options.rotation_preference == 0;
  if (!is_exact) {
    const Minimum other = minimize(energy, rigid);
    const int iterations = best.iterations + other.iterations;
    if (other.value < best.value) best = other;
    best.iterations = iterations;
  }
  if (!best.converged && !is_exact) {
    return Status(Reason::kNoConvergence, "no Möbius map is the best for these landmarks",
                  "prefer rotations a little, or align by a rotation");
  }
  LandmarkAlignment result = report(pairs, best.map);
  result.iterations = best.iterations;
  return result;
}

}  // namespace moduli
