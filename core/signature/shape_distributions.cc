#include "core/signature/shape_distributions.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/signature/farthest_sample.h"
#include "core/signature/soft_bins.h"

namespace moduli {
namespace {

constexpr std::size_t kPairPoints = 512;
constexpr std::size_t kTriplePoints = 96;
constexpr int kFineBins = 512;
/// Of the radius of gyration: lengths below count as this much longer, so that logarithms stay
/// bounded.
constexpr double kLengthFloor = 0.01;

std::vector<double> logLengths(std::vector<double> means, double radius) {
  for (double& mean : means) mean = std::log(mean / radius + kLengthFloor);
  return means;
}

struct WeightedPoints {
  std::vector<Eigen::Vector3d> points;
  std::vector<double> weights;
};

/// The first `count` chosen points.
Result<WeightedPoints> firstPoints(Context& context, const SurfacePoints& points,
                                   std::vector<Eigen::Index> chosen, std::size_t count) {
  WeightedPoints result;
  chosen.resize(std::min(chosen.size(), count));
  for (const Eigen::Index i : chosen) result.points.push_back(points.points.col(i));
  ASSIGN_OR_RETURN(result.weights, nearestWeights(context, points.points, points.areas, chosen));
  return result;
}

std::vector<double> pairDistances(const WeightedPoints& sample, double radius, double diameter) {
  SoftHistogram histogram(diameter, kFineBins);
  for (std::size_t i = 0; i < sample.points.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      histogram.add((sample.points[j] - sample.points[i]).norm(),
                    sample.weights[i] * sample.weights[j]);
    }
  }
  return logLengths(histogram.quantileMeans(kDistributionParts), radius);
}

/// Angle at the corner between two sides; by atan2, which is exact for flat angles too.
double angleBetween(const Eigen::Vector3d& u, const Eigen::Vector3d& v, double doubled_area) {
  return std::atan2(doubled_area, u.dot(v));
}

Status addTriples(Context& context, const WeightedPoints& sample, double radius, double diameter,
                  ShapeDistributions& result) {
  SoftHistogram areas(diameter, kFineBins);
  SoftHistogram angles(std::numbers::pi, kFineBins);
  for (std::size_t i = 0; i < sample.points.size(); ++i) {
    RETURN_IF_ERROR(context.check());
    for (std::size_t j = 0; j < i; ++j) {
      const Eigen::Vector3d u = sample.points[j] - sample.points[i];
      for (std::size_t k = 0; k < j; ++k) {
        const Eigen::Vector3d v = sample.points[k] - sample.points[i];
        const double doubled = u.cross(v).norm();
        const double weight = sample.weights[i] * sample.weights[j] * sample.weights[k];
        areas.add(std::sqrt(doubled / 2), weight);
        angles.add(angleBetween(u, v, doubled), weight);
        angles.add(angleBetween(-u, v - u, doubled), weight);
        angles.add(angleBetween(-v, u - v, doubled), weight);
      }
    }
  }
  result.d3 = logLengths(areas.quantileMeans(kDistributionParts), radius);
  result.a3 = angles.quantileMeans(kDistributionParts);
  return {};
}

}  // namespace

Result<ShapeDistributions> shapeDistributions(Context& context, const SurfacePoints& points) {
  const Context::Stage stage(context, "distributions");
  ShapeDistributions result;
  const Eigen::VectorXd distances = points.points.colwise().norm();
  result.d1 = logLengths(
      quantileMeans({distances.begin(), distances.end()}, points.areas, kDistributionParts),
      points.radius);
  ASSIGN_OR_RETURN(const std::vector<Eigen::Index> chosen,
                   farthestSample(context, points.points, points.areas, kPairPoints));
  const double diameter = 2 * distances.maxCoeff();
  ASSIGN_OR_RETURN(const WeightedPoints many, firstPoints(context, points, chosen, kPairPoints));
  result.d2 = pairDistances(many, points.radius, diameter);
  ASSIGN_OR_RETURN(const WeightedPoints few, firstPoints(context, points, chosen, kTriplePoints));
  RETURN_IF_ERROR(addTriples(context, few, points.radius, diameter, result));
  return result;
}

}  // namespace moduli
