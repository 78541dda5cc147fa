#include "core/ricci/prescribe.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "core/intrinsic/delaunay.h"
#include "core/ricci/minimize_curvature.h"
#include "core/ricci/newton.h"

namespace moduli {
namespace {

/// The start needs the right scale, not the last digit of it.
constexpr double kAreaRatio = 0.05;
constexpr int kMaxScalings = 60;

/// Half chords whose Euclidean scale is that of a mean edge of 1.
std::vector<double> unitHalfChords(const std::vector<double>& lengths) {
  std::vector<double> result = lengths;
  const double mean = std::accumulate(lengths.begin(), lengths.end(), 0.0) /
                      static_cast<double>(std::max<std::size_t>(lengths.size(), 1));
  for (double& length : result) length /= 2 * mean;
  return result;
}

MetricCertificate certify(const VertexScalingModel& model, const Unknowns& unknowns,
                          const std::vector<double>& target, const std::vector<bool>& fixed,
                          const RicciSolution& solution) {
  MetricCertificate certificate;
  certificate.newton_iterations = solution.iterations();
  certificate.residuals = solution.residuals;
  certificate.flips = static_cast<int>(model.triangulation().history().size());
  certificate.smallest_angle = *std::min_element(model.angles().begin(), model.angles().end());

  const std::vector<double> curvatures = model.vertexCurvatures();
  const auto vertices = static_cast<Index>(curvatures.size());
  const auto isFixed = [&](Index v) { return !fixed.empty() && fixed[unknowns.of_vertex[v]]; };
  double total = 0, mean = 0;
  for (Index v = 0; v < vertices; ++v) {
    total += curvatures[v];
    mean += (curvatures[v] - target[v]) / vertices;
  }
  const bool any_fixed = std::find(fixed.begin(), fixed.end(), true) != fixed.end();
  if (!model.scaleFree() || any_fixed) mean = 0;
  for (Index v = 0; v < vertices; ++v) {
    if (isFixed(v)) continue;
    certificate.curvature_residual =
        std::max(certificate.curvature_residual, std::abs(curvatures[v] - target[v] - mean));
  }
  const Index faces = model.triangulation().faceCount();
  const Index characteristic = vertices - faces / 2;
  const int curvature = planeCurvature(model.geometry());
  const double area = curvature == 0 ? 0 : model.area();
  certificate.gauss_bonnet_residual =
      std::abs(total + curvature * area - 2 * std::numbers::pi * characteristic);
  return certificate;
}

}  // namespace

PrescribedCurvature::PrescribedCurvature(const Connectivity& surface, Unknowns unknowns,
                                         PrescribeOptions options)
    : euler_characteristic_(surface.eulerCharacteristic()),
      surface_(surface),
      unknowns_(std::move(unknowns)),
      options_(std::move(options)),
      u_(Eigen::VectorXd::Zero(unknowns_.count)) {}

Status PrescribedCurvature::start(Context& context, const std::vector<double>& lengths) {
  IntrinsicTriangulation triangulation(surface_, unitHalfChords(lengths));
  if (options_.initial_delaunay) {
    const Context::Stage stage(context, "delaunay");
    RETURN_IF_ERROR(flipToDelaunayIsometric(context, triangulation).status());
  }
  model_.emplace(options_.geometry, std::move(triangulation), unknowns_,
                 VertexScalingModel::Flips::kOn);
  return {};
}

Eigen::VectorXd PrescribedCurvature::perUnknown(const std::vector<double>& target) const {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(unknowns_.count);
  for (std::size_t v = 0; v < target.size(); ++v) result[unknowns_.of_vertex[v]] += target[v];
  return result;
}

/// Finds the constant u whose area fits the total curvature wanted: sum K = 2 pi chi + area. The
/// area grows from 0 to pi per face.
Status PrescribedCurvature::fitScale(Context& context, const Eigen::VectorXd& target) {
  const double topological = 2 * std::numbers::pi * euler_characteristic_;
  const double wanted = target.sum() - topological;
  const double all_faces = std::numbers::pi * surface_.faceCount();
  // Far from saturation areas are proportional to e^{2 u}; their odds behave well at both ends.
  const auto odds = [&](double area) {
    return std::log(std::max(area, 1e-300)) - std::log(std::max(all_faces - area, 1e-300));
  };
  for (int n = 0; n < kMaxScalings; ++n) {
    RETURN_IF_ERROR(model_->moveTo(context, u_));
    model_->accept();
    const double area = model_->curvature().sum() - topological;
    if (std::abs(area - wanted) <= kAreaRatio * wanted) break;
    u_.array() += std::clamp((odds(wanted) - odds(area)) / 2, -10.0, 10.0);
  }
  return {};
}

Result<PrescribedCurvature::Search> PrescribedCurvature::search(Context& context,
                                                                const std::vector<double>& target) {
  Eigen::VectorXd wanted = perUnknown(target);
  if (options_.geometry == Geometry::kHyperbolic && !scaled_) {
    RETURN_IF_ERROR(fitScale(context, wanted));
    scaled_ = true;
  }
  return Search{*model_, std::move(wanted), u_};
}

Result<DiscreteMetric> PrescribedCurvature::solve(Context& context,
                                                  const std::vector<double>& target) {
  return find(context, target, NewtonOptions());
}

Result<DiscreteMetric> PrescribedCurvature::approach(Context& context,
                                                     const std::vector<double>& target,
                                                     double tolerance) {
  NewtonOptions options;
  options.tolerance = options.acceptable = tolerance;
  return find(context, target, options);
}

Result<DiscreteMetric> PrescribedCurvature::find(Context& context,
                                                 const std::vector<double>& target,
                                                 NewtonOptions options) {
  options.fixed = options_.fixed;
  ASSIGN_OR_RETURN(const Search from, search(context, target));
  ASSIGN_OR_RETURN(
      const RicciSolution solution,
      findCurvature(context, from.model, from.target, from.start, options, options_.solver));
  u_ = solution.u;
  DiscreteMetric metric{options_.geometry,
                        model_->triangulation(),
                        std::vector<double>(target.size(), 0.0),
                        model_->scaledHalfChords(),
                        model_->angles(),
                        certify(*model_, unknowns_, target, options_.fixed, solution)};
  for (std::size_t v = 0; v < target.size(); ++v) metric.u[v] = u_[unknowns_.of_vertex[v]];
  return metric;
}

Result<DiscreteMetric> prescribeCurvature(Context& context, const Connectivity& surface,
                                          const std::vector<double>& lengths,
                                          const std::vector<double>& target,
                                          const Unknowns& unknowns,
                                          const PrescribeOptions& options) {
  PrescribedCurvature problem(surface, unknowns, options);
  RETURN_IF_ERROR(problem.start(context, lengths));
  return problem.solve(context, target);
}

}  // namespace moduli
