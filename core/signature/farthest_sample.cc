#include "core/signature/farthest_sample.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "core/base/parallel.h"

namespace moduli {
namespace {

/// Squared distances this close to the largest, relatively, count as equal to it.
constexpr double kTie = 1e-9;
constexpr Eigen::Index kGrain = 16384;

double squaredDistance(const Eigen::MatrixXd& points, Eigen::Index a, Eigen::Index b) {
  const Eigen::Index rows = points.rows();
  const double* p = points.data() + a * rows;
  const double* q = points.data() + b * rows;
  double squared = 0;
  for (Eigen::Index k = 0; k < rows; ++k) squared += (p[k] - q[k]) * (p[k] - q[k]);
  return squared;
}

class Sampler {
 public:
  Sampler(Context& context, const Eigen::MatrixXd& points, const std::vector<double>& weights)
      : context_(context),
        points_(points),
        weights_(weights),
        from_origin_(points.colwise().squaredNorm()),
        nearest_(Eigen::VectorXd::Constant(points.cols(), std::numeric_limits<double>::max())) {}

  Result<std::vector<Eigen::Index>> run(Eigen::Index count) {
    Eigen::Index next = pick(from_origin_);
    while (static_cast<Eigen::Index>(chosen_.size()) < std::min(count, points_.cols())) {
      RETURN_IF_ERROR(context_.check());
      take(next);
      if (nearest_.maxCoeff() == 0) break;  // Only copies are left.
      next = pick(nearest_);
    }
    return std::move(chosen_);
  }

 private:
  void take(Eigen::Index point) {
    chosen_.push_back(point);
    parallelBlocks(
        static_cast<std::size_t>(points_.cols()), kGrain, [&](std::size_t begin, std::size_t end) {
          for (auto i = static_cast<Eigen::Index>(begin); i < static_cast<Eigen::Index>(end); ++i) {
            nearest_[i] = std::min(nearest_[i], squaredDistance(points_, i, point));
          }
        });
  }

  /// The point with the largest key; ties as the header says.
  Eigen::Index pick(const Eigen::VectorXd& key) const {
    const double largest = key.maxCoeff();
    std::vector<Eigen::Index> tied;
    for (Eigen::Index i = 0; i < key.size(); ++i) {
      if (key[i] >= (1 - kTie) * largest) tied.push_back(i);
    }
    if (tied.size() > 1) keepLargest(tied, [&](Eigen::Index i) { return from_origin_[i]; });
    if (tied.size() > 1) keepLargest(tied, [&](Eigen::Index i) { return distanceSum(i); });
    if (tied.size() > 1) keepLargest(tied, [&](Eigen::Index i) { return potential(i); });
    return tied.front();
  }

  template <typename Key>
  static void keepLargest(std::vector<Eigen::Index>& tied, const Key& key) {
    std::vector<double> keys;
    for (const Eigen::Index i : tied) keys.push_back(key(i));
    const double largest = *std::max_element(keys.begin(), keys.end());
    std::vector<Eigen::Index> kept;
    for (std::size_t k = 0; k < tied.size(); ++k) {
      if (keys[k] >= (1 - kTie) * largest) kept.push_back(tied[k]);
    }
    tied = std::move(kept);
  }

  double distanceSum(Eigen::Index point) const {
    double sum = 0;
    for (const Eigen::Index i : chosen_) sum += (points_.col(i) - points_.col(point)).norm();
    return sum;
  }

  double potential(Eigen::Index point) const {
    double sum = 0;
    for (Eigen::Index i = 0; i < points_.cols(); ++i) {
      sum += weights_[i] * std::sqrt(squaredDistance(points_, i, point));
    }
    return sum;
  }

  Context& context_;
  const Eigen::MatrixXd& points_;
  const std::vector<double>& weights_;
  Eigen::VectorXd from_origin_;
  Eigen::VectorXd nearest_;  ///< Squared distance to the chosen points.
  std::vector<Eigen::Index> chosen_;
};

}  // namespace

Result<std::vector<Eigen::Index>> farthestSample(Context& context, const Eigen::MatrixXd& points,
                                                 const std::vector<double>& weights,
                                                 Eigen::Index count) {
  return Sampler(context, points, weights).run(count);
}

Result<std::vector<double>> nearestWeights(Context& context, const Eigen::MatrixXd& points,
                                           const std::vector<double>& weights,
                                           const std::vector<Eigen::Index>& chosen) {
  std::vector<double> result(chosen.size(), 0.0);
  std::vector<double> squared(chosen.size());
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    if (i % kGrain == 0) RETURN_IF_ERROR(context.check());
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      squared[k] = squaredDistance(points, i, chosen[k]);
    }
    const double least = *std::min_element(squared.begin(), squared.end());
    const auto tied = [&](std::size_t k) { return squared[k] <= (1 + kTie) * least; };
    int sharers = 0;
    for (std::size_t k = 0; k < chosen.size(); ++k) sharers += tied(k) ? 1 : 0;
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      if (tied(k)) result[k] += weights[i] / sharers;
    }
  }
  return result;
}

}  // namespace moduli
