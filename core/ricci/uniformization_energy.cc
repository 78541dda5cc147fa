#include "core/ricci/uniformization_energy.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "core/base/text.h"
#include "core/intrinsic/geometry.h"
#include "core/ricci/mirror_symmetry.h"

namespace moduli {
namespace {

/// Logarithm of how many times as large as its neighbour a circle may be.
constexpr double kSteep = 6.9;

bool isBordered(const Connectivity& surface) {
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    if (surface.isBoundaryVertex(v)) return true;
  }
  return false;
}

double areaOf(const Connectivity& surface, const std::vector<double>& lengths) {
  double area = 0;
  for (Index f = 0; f < surface.faceCount(); ++f) {
    const auto length = [&](Index c) { return lengths[surface.edge(3 * f + c)]; };
    area += triangleArea(Geometry::kEuclidean, {length(0), length(1), length(2)});
  }
  return area;
}

/// sinh(l / 2) = c l_Euclidean keeps triangles proper; small ones keep their shape, and have the
/// area 4 c^2 times the Euclidean one. That of curvature -1 and a geodesic boundary is -2 pi chi.
std::vector<double> hyperbolicLengths(const Connectivity& surface,
                                      const std::vector<double>& lengths) {
  const double area = -2 * std::numbers::pi * surface.eulerCharacteristic();
  const double c = std::sqrt(area / areaOf(surface, lengths)) / 2;
  std::vector<double> result = lengths;
  for (double& length : result) length = 2 * std::asinh(c * length);
  return result;
}

}  // namespace

Geometry UniformizationEnergy::geometry() const {
  return surface_.eulerCharacteristic() < 0 ? Geometry::kHyperbolic : Geometry::kEuclidean;
}

Status UniformizationEnergy::scaleVertices(Context& context, const std::vector<double>& lengths,
                                           bool initial_delaunay) {
  PrescribeOptions options;
  options.geometry = geometry();
  options.initial_delaunay = initial_delaunay;
  if (isBordered(surface_)) {
    ASSIGN_OR_RETURN(cover_, doubleCover(surface_));
    scaling_.emplace(cover_->connectivity, mirrorUnknowns(*cover_), options);
    RETURN_IF_ERROR(scaling_->start(context, lengthsOnDouble(*cover_, lengths)));
  } else {
    scaling_.emplace(surface_, Unknowns::all(surface_.vertexCount()), options);
    RETURN_IF_ERROR(scaling_->start(context, lengths));
  }
  const Index vertices = cover_ ? cover_->connectivity.vertexCount() : surface_.vertexCount();
  ASSIGN_OR_RETURN(const PrescribedCurvature::Search search,
                   scaling_->search(context, std::vector<double>(vertices, 0.0)));
  start_ = search.start;
  objective_.emplace(search.model, search.target, search.start);
  return {};
}

Status UniformizationEnergy::packCircles(const std::vector<double>& lengths, Scheme scheme) {
  const bool hyperbolic = geometry() == Geometry::kHyperbolic;
  ASSIGN_OR_RETURN(circles_, CirclePackingModel::make(
                                 surface_, geometry(), scheme,
                                 hyperbolic ? hyperbolicLengths(surface_, lengths) : lengths));
  start_ = circles_->initial();
  objective_.emplace(*circles_, Eigen::VectorXd::Zero(surface_.vertexCount()), start_);
  return {};
}

std::vector<std::string> UniformizationEnergy::remarks(const Eigen::VectorXd& u) const {
  std::vector<std::string> remarks;
  if (!circles_) return remarks;
  if (const double share = circles_->clampedFraction().value_or(0); share > 0) {
    remarks.push_back("CLAMPED: the circles of " + shortestDouble(std::round(1000 * share) / 10) +
                      " % of the edges did not meet, or met beyond a right angle");
  }
  if (circles_->brokenFaces() > 0) {
    remarks.push_back("BROKEN_FACES: " + std::to_string(circles_->brokenFaces()) +
                      " faces are no proper triangles");
  }
  double steepest = 0;
  for (Index h = 0; h < surface_.halfedgeCount(); ++h) {
    steepest = std::max(steepest, std::abs(u[surface_.tail(h)] - u[surface_.head(h)]));
  }
  if (steepest > kSteep) {
    remarks.push_back("SHRINKING_CIRCLES: one is e^" +
                      shortestDouble(std::round(10 * steepest) / 10) +
                      " times as small as one beside it; there may be no packing on these "
                      "triangles");
  }
  return remarks;
}

Result<std::unique_ptr<UniformizationEnergy>> UniformizationEnergy::make(
    Context& context, const Connectivity& surface, const std::vector<double>& lengths,
    const UniformizationEnergyOptions& options) {
  if (surface.eulerCharacteristic() > 0) {
    return Status{Reason::kUnsupportedTopology,
                  "a surface of Euler characteristic " +
                      std::to_string(surface.eulerCharacteristic()) +
                      ", a sphere or a disk, has no metric of curvature 0 or -1 without cones",
                  "take one with handles, or with two boundary loops or more"};
  }
  std::unique_ptr<UniformizationEnergy> energy(new UniformizationEnergy(surface));
  if (options.scheme == Scheme::kVertexScaling) {
    RETURN_IF_ERROR(energy->scaleVertices(context, lengths, options.initial_delaunay));
  } else {
    RETURN_IF_ERROR(energy->packCircles(lengths, options.scheme));
  }
  return energy;
}

}  // namespace moduli
