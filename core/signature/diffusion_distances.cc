#include "core/signature/diffusion_distances.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/signature/farthest_sample.h"
#include "core/signature/soft_bins.h"

namespace moduli {
namespace {

constexpr Eigen::Index kPoints = 256;
constexpr int kFineBins = 512;
/// Distances below this part of the largest count as that much longer.
constexpr double kFloor = 0.01;

/// Columns: vertices, in coordinates psi_k / mu_k^power.
Eigen::MatrixXd embed(const SurfaceModes& modes, double power) {
  Eigen::VectorXd scale(kModeCount);
  for (Eigen::Index k = 0; k < kModeCount; ++k) {
    scale[k] =
        modeTaper(modes.values[k], modes.values[kModeCount - 1]) / std::pow(modes.values[k], power);
  }
  return scale.asDiagonal() * modes.functions.transpose();
}

std::vector<double> logQuantiles(const Eigen::MatrixXd& points,
                                 const std::vector<Eigen::Index>& chosen,
                                 const std::vector<double>& weights) {
  const auto forPairs = [&](const auto& visit) {
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        visit((points.col(chosen[i]) - points.col(chosen[j])).norm(), weights[i] * weights[j]);
      }
    }
  };
  double largest = 0;
  forPairs([&](double distance, double) { largest = std::max(largest, distance); });
  std::vector<double> means(kDiffusionParts, 0.0);
  if (largest > 0) {
    SoftHistogram histogram(largest, kFineBins);
    forPairs([&](double distance, double weight) { histogram.add(distance, weight); });
    means = histogram.quantileMeans(kDiffusionParts);
  }
  for (double& mean : means) mean = std::log(mean + kFloor * largest);
  return means;
}

}  // namespace

Result<std::vector<double>> diffusionDistances(Context& context, const SurfaceModes& modes) {
  const Context::Stage stage(context, "diffusion");
  const Eigen::MatrixXd biharmonic = embed(modes, 1);
  ASSIGN_OR_RETURN(const std::vector<Eigen::Index> chosen,
                   farthestSample(context, biharmonic, modes.areas, kPoints));
  ASSIGN_OR_RETURN(const std::vector<double> weights,
                   nearestWeights(context, biharmonic, modes.areas, chosen));
  std::vector<double> result = logQuantiles(biharmonic, chosen, weights);
  const std::vector<double> commute = logQuantiles(embed(modes, 0.5), chosen, weights);
  result.insert(result.end(), commute.begin(), commute.end());
  return result;
}

}  // namespace moduli
