#include "core/ricci/prescribe.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "core/intrinsic/delaunay.h"
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

/// The constant u whose area fits the total curvature wanted: sum K = 2 pi chi + area. The area
/// grows from 0 to pi per face.
Result<double> fittingScale(Context& context, VertexScalingModel& model, double wanted_area,
                            Index euler_characteristic, double all_faces) {
  double u = 0;
  for (int n = 0; n < kMaxScalings; ++n) {
    RETURN_IF_ERROR(model.moveTo(context, Eigen::VectorXd::Constant(model.size(), u)));
    model.accept();
    const double area = model.curvature().sum() - 2 * std::numbers::pi * euler_characteristic;
    // Far from saturation the area is proportional to e^{2 u}; log(A / (A_all - A)) behaves well
    // at both ends.
    const auto odds = [&](double a) {
      return std::log(std::max(a, 1e-300)) - std::log(std::max(all_faces - a, 1e-300));
    };
    if (std::abs(area - wanted_area) <= kAreaRatio * wanted_area) break;
    u += std::clamp((odds(wanted_area) - odds(area)) / 2, -10.0, 10.0);
  }
  return u;
}

MetricCertificate certify(const VertexScalingModel& model, const Unknowns& unknowns,
                          const std::vector<double>& target, const RicciSolution& solution) {
  MetricCertificate certificate;
  certificate.newton_iterations = solution.iterations();
  certificate.residuals = solution.residuals;
  certificate.flips = static_cast<int>(model.triangulation().history().size());
  certificate.smallest_angle = *std::min_element(model.angles().begin(), model.angles().end());

  const std::vector<double> curvatures = model.vertexCurvatures();
  const auto vertices = static_cast<Index>(curvatures.size());
  double total = 0, deviation = 0;
  Index solved = 0;
  for (Index v = 0; v < vertices; ++v) {
    total += curvatures[v];
    if (unknowns.of_vertex[v] == kNone) continue;
    deviation += curvatures[v] - target[v];
    ++solved;
  }
  const double mean = model.scaleFree() ? deviation / std::max(solved, Index{1}) : 0;
  for (Index v = 0; v < vertices; ++v) {
    if (unknowns.of_vertex[v] == kNone) continue;
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

Result<DiscreteMetric> prescribeCurvature(Context& context, const Connectivity& surface,
                                          const std::vector<double>& lengths,
                                          const std::vector<double>& target,
                                          const Unknowns& unknowns,
                                          const PrescribeOptions& options) {
  IntrinsicTriangulation triangulation(surface, unitHalfChords(lengths));
  if (options.initial_delaunay) {
    const Context::Stage stage(context, "delaunay");
    RETURN_IF_ERROR(flipToDelaunayIsometric(context, triangulation).status());
  }
  VertexScalingModel model(options.geometry, std::move(triangulation), unknowns,
                           VertexScalingModel::Flips::kOn);
  Eigen::VectorXd wanted = Eigen::VectorXd::Zero(unknowns.count);
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    if (unknowns.of_vertex[v] != kNone) wanted[unknowns.of_vertex[v]] += target[v];
  }
  Eigen::VectorXd start = Eigen::VectorXd::Zero(unknowns.count);
  if (options.geometry == Geometry::kHyperbolic) {
    const Index chi = surface.eulerCharacteristic();
    const double area = wanted.sum() - 2 * std::numbers::pi * chi;
    ASSIGN_OR_RETURN(const double u, fittingScale(context, model, area, chi,
                                                  std::numbers::pi * surface.faceCount()));
    start.setConstant(u);
  }
  ASSIGN_OR_RETURN(const RicciSolution solution, solveCurvature(context, model, wanted, start));

  DiscreteMetric metric{options.geometry,
                        model.triangulation(),
                        std::vector<double>(surface.vertexCount(), 0.0),
                        model.scaledHalfChords(),
                        model.angles(),
                        certify(model, unknowns, target, solution)};
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    if (unknowns.of_vertex[v] != kNone) metric.u[v] = solution.u[unknowns.of_vertex[v]];
  }
  return metric;
}

}  // namespace moduli
