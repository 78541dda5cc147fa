#include "core/spherical/mobius.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include "core/base/parallel.h"

namespace moduli {
namespace {

constexpr std::size_t kGrain = 8192;
constexpr int kMaxIterations = 200;
// Newton's step as a hyperbolic length. Longer ones are shortened: past this the map would squeeze
// points on the far side closer than the sphere's doubles can tell apart.
constexpr double kMaxStep = 3;

/// Sums what `term` gives over blocks of points; the same bytes for any number of threads.
template <typename Value, typename Term>
Value blockedSum(std::size_t count, const Value& zero, const Term& term) {
  std::vector<Value> partial((count + kGrain - 1) / kGrain, zero);
  parallelBlocks(count, kGrain, [&](std::size_t begin, std::size_t end) {
    Value sum = zero;
    for (std::size_t i = begin; i < end; ++i) sum += term(i);
    partial[begin / kGrain] = sum;
  });
  Value sum = zero;
  for (const Value& value : partial) sum += value;
  return sum;
}

Eigen::Vector3d weightedMean(const Points3& points, const std::vector<double>& weights) {
  return blockedSum<Eigen::Vector3d>(
      points.size(), Eigen::Vector3d::Zero(),
      [&](std::size_t i) -> Eigen::Vector3d { return weights[i] * points[i]; });
}

Eigen::Matrix3d weightedSecondMoment(const Points3& points, const std::vector<double>& weights) {
  return blockedSum<Eigen::Matrix3d>(points.size(), Eigen::Matrix3d::Zero(),
                                     [&](std::size_t i) -> Eigen::Matrix3d {
                                       return weights[i] * points[i] * points[i].transpose();
                                     });
}

/// The convex potential at the ball point `center`, less its value at 0:
/// sum w log(|v - c|^2 / (1 - |c|^2)).
double potential(const Points3& points, const std::vector<double>& weights,
                 const Eigen::Vector3d& center) {
  const double sum = blockedSum<double>(points.size(), 0.0, [&](std::size_t i) {
    return weights[i] > 0 ? weights[i] * std::log((points[i] - center).squaredNorm()) : 0.0;
  });
  return sum - std::log1p(-center.squaredNorm());
}

/// T_c on the unit sphere, written as an inversion at c: differences only, so that points close to
/// c / |c| keep their relative positions. Renormalized.
void translatePoints(Points3& points, const Eigen::Vector3d& center) {
  const double gap = 1 - center.squaredNorm();
  parallelBlocks(points.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Eigen::Vector3d offset = points[i] - center;
      points[i] = (gap / offset.squaredNorm() * offset - center).normalized();
    }
  });
}

/// The ball point at the end of a geodesic from 0 with this initial velocity (in units where the
/// metric at 0 is 4 |dx|^2).
Eigen::Vector3d geodesicEnd(const Eigen::Vector3d& velocity) {
  const double length = velocity.norm();
  return length > 0 ? Eigen::Vector3d(std::tanh(length) / length * velocity) : velocity;
}

Result<std::vector<double>> normalizedWeights(const Points3& points,
                                              const std::vector<double>& weights) {
  if (points.size() != weights.size()) {
    return Status(Reason::kInvalidOption, "there are " + std::to_string(points.size()) +
                                              " points but " + std::to_string(weights.size()) +
                                              " weights");
  }
  const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
  const bool sound = std::all_of(weights.begin(), weights.end(), [](double w) { return w >= 0; });
  if (!sound || !(total > 0) || !std::isfinite(total)) {
    return Status(Reason::kInvalidOption, "weights must be finite, not negative and not all 0");
  }
  std::vector<double> shares = weights;
  for (double& share : shares) share /= total;
  const auto heaviest = std::max_element(shares.begin(), shares.end());
  if (*heaviest >= 0.5) {
    return Status(Reason::kInvalidOption,
                  "point " + std::to_string(heaviest - shares.begin()) +
                      " carries half of the weight or more: no Moebius map centres the points");
  }
  return shares;
}

/// Newton's direction in the moving frame. The matrix is positive definite unless all points lie
/// on one line through 0; then its smallest eigenvalue is lifted.
Eigen::Vector3d newtonDirection(const Eigen::Vector3d& mean, const Eigen::Matrix3d& moment) {
  const Eigen::Matrix3d hessian = 2 * (Eigen::Matrix3d::Identity() - moment);
  const Eigen::LLT<Eigen::Matrix3d> factor(hessian);
  const Eigen::Vector3d step = factor.solve(mean);
  if (factor.info() != Eigen::Success || !step.allFinite() || step.dot(mean) <= 0) return mean;
  return step;
}

}  // namespace

Eigen::Vector3d ballTranslate(const Eigen::Vector3d& center, const Eigen::Vector3d& x) {
  const double c2 = center.squaredNorm();
  const double xc = x.dot(center);
  const double x2 = x.squaredNorm();
  return ((1 - c2) * x - (1 - 2 * xc + x2) * center) / (1 - 2 * xc + c2 * x2);
}

Result<MobiusCentering> centerByMobius(Context& context, Points3 points,
                                       const std::vector<double>& weights) {
  ASSIGN_OR_RETURN(const std::vector<double> shares, normalizedWeights(points, weights));
  // What rounding leaves of the mean of unit vectors: every sum is of terms at most 1 in total.
  const double rounding = 8 * std::numeric_limits<double>::epsilon();

  MobiusCentering result;
  Eigen::Vector3d mean = weightedMean(points, shares);
  while (mean.norm() > rounding) {
    RETURN_IF_ERROR(context.check());
    if (++result.iterations > kMaxIterations) {
      return Status(Reason::kNoConvergence,
                    "Moebius centring did not converge: half of the weight or more sits closer "
                    "together than doubles can tell apart");
    }
    Eigen::Vector3d velocity = newtonDirection(mean, weightedSecondMoment(points, shares));
    if (velocity.norm() > kMaxStep) velocity *= kMaxStep / velocity.norm();

    // Armijo's rule on the potential, whose derivative along the velocity is -2 mean.velocity.
    // Close to the minimum the potential's own rounding would decide, so Newton runs free there.
    if (mean.norm() > 1e-3) {
      const double slope = 2 * mean.dot(velocity);
      double t = 1;
      while (t > 1e-6 && potential(points, shares, geodesicEnd(t * velocity)) > -1e-4 * t * slope) {
        t /= 2;
      }
      velocity *= t;
    }
    Points3 moved = points;
    translatePoints(moved, geodesicEnd(velocity));
    const Eigen::Vector3d moved_mean = weightedMean(moved, shares);
    // At the level of rounding a step no longer helps: keep the better of the two.
    if (mean.norm() < 1e-12 && moved_mean.norm() >= mean.norm()) break;
    points = std::move(moved);
    mean = moved_mean;
  }
  result.residual = mean.norm();
  result.points = std::move(points);
  return result;
}

}  // namespace moduli
