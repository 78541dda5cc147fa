#include "server/rpc/convert_parameterization.h"

#include <cmath>
#include <cstdint>
#include <optional>

#include "server/rpc/convert.h"

namespace moduli {
namespace {

using Options = v1::ParameterizationOptions;

static_assert(static_cast<int>(BoundaryRule::kStraight) + 1 == Options::STRAIGHT);
static_assert(static_cast<int>(BoundaryRule::kFree) + 1 == Options::FREE);
static_assert(static_cast<int>(Scheme::kVertexScaling) + 1 == Options::VERTEX_SCALING);
static_assert(static_cast<int>(Scheme::kInversiveDistance) + 1 == Options::INVERSIVE_DISTANCE);
static_assert(static_cast<int>(RicciSolver::kNewton) + 1 == Options::NEWTON);
static_assert(static_cast<int>(RicciSolver::kFlow) + 1 == Options::FLOW);
static_assert(static_cast<int>(RicciSolver::kAffineNormal) + 1 == Options::AFFINE_NORMAL);
static_assert(static_cast<int>(RicciSolver::kLbfgs) + 1 == Options::LBFGS);
static_assert(static_cast<int>(MapMethod::kAuto) + 1 == Options::AUTO);
static_assert(static_cast<int>(MapMethod::kRobust) + 1 == Options::ROBUST);

using Registration = v1::RegistrationResult;
static_assert(static_cast<int>(ComparedField::kGiven) == Registration::GIVEN);
static_assert(static_cast<int>(ComparedField::kAreaDistortion) == Registration::AREA_DISTORTION);

/// Both enums name the same things, ours from 0 and the message's from 1; 0 is the default there.
template <typename Core, typename Message>
Core shifted(Message value, Core otherwise) {
  return value == 0 ? otherwise : static_cast<Core>(static_cast<int>(value) - 1);
}

}  // namespace

FlatOptions fromProto(const v1::ParameterizationOptions& message) {
  FlatOptions options;
  options.boundary = shifted(message.boundary(), options.boundary);
  options.scheme = shifted(message.scheme(), options.scheme);
  options.solver = shifted(message.solver(), options.solver);
  if (message.has_initial_delaunay()) options.initial_delaunay = message.initial_delaunay();
  return options;
}

MapMethod fromProto(Options::Method method) {
  return shifted(method, MapMethod::kAuto);
}

Options::Method toProto(MapMethod method) {
  return static_cast<Options::Method>(static_cast<int>(method) + 1);
}

v1::HyperbolicDomain toProto(const HyperbolicDomain& domain) {
  v1::HyperbolicDomain message;
  for (const Su11& g : domain.generators) *message.add_generators() = toProto(g.a, g.b);
  for (const Su11& g : domain.neighbours) *message.add_neighbours() = toProto(g.a, g.b);
  message.set_radius(domain.radius);
  std::int32_t first = 0;
  for (const GeodesicPath& path : domain.geodesics) {
    v1::ClosedGeodesic& geodesic = *message.add_geodesics();
    geodesic.set_length(path.length);
    geodesic.set_first_point(first);
    geodesic.set_points(static_cast<std::int32_t>(path.steps.size()));
    first += geodesic.points();
  }
  for (const double length : domain.boundary_lengths) message.add_boundary_lengths(length);
  return message;
}

v1::ParameterizationCertificate toProto(const MapCertificate& certificate) {
  using Message = v1::ParameterizationCertificate;
  Message message;
  const auto set = [&message](void (Message::*field)(double), std::optional<double> value) {
    if (value && std::isfinite(*value)) (message.*field)(*value);
  };
  const MapQuality& quality = certificate.quality;
  set(&Message::set_curvature_residual, certificate.curvature_residual);
  set(&Message::set_gauss_bonnet_residual, certificate.gauss_bonnet_residual);
  set(&Message::set_layout_closure, certificate.layout_closure);
  set(&Message::set_max_link_angle, certificate.max_link_angle);
  set(&Message::set_smallest_angle, certificate.smallest_angle);
  set(&Message::set_centering_residual, certificate.centering_residual);
  set(&Message::set_boundary_deviation, certificate.boundary_deviation);
  set(&Message::set_clamped_fraction, certificate.clamped_fraction);
  set(&Message::set_convergence_rate, certificate.convergence_rate);
  set(&Message::set_cycle_residual, certificate.cycle_residual);
  set(&Message::set_relation_residual, certificate.relation_residual);
  set(&Message::set_spectrum_complete_to, certificate.spectrum_complete_to);
  set(&Message::set_holonomy_residual, certificate.holonomy_residual);
  set(&Message::set_mollification, certificate.mollification);
  set(&Message::set_max_dilatation, quality.max_dilatation);
  set(&Message::set_mean_dilatation, quality.mean_dilatation);
  set(&Message::set_dilatation_95, quality.dilatation_95);
  set(&Message::set_area_distortion, quality.area_distortion);
  if (quality.covering_degree != 0) message.set_covering_degree(quality.covering_degree);
  message.set_flipped_faces(quality.flipped_faces);
  for (const double share : quality.dilatation_histogram) message.add_dilatation_histogram(share);
  if (certificate.newton_iterations) message.set_newton_iterations(*certificate.newton_iterations);
  if (certificate.flips) message.set_flips(*certificate.flips);
  if (certificate.sweeps) message.set_sweeps(*certificate.sweeps);
  for (const std::string& warning : certificate.warnings) message.add_warnings(warning);
  return message;
}

v1::RegistrationResult toProto(const SphereRegistration& registration) {
  Registration message;
  const auto set = [&message](void (Registration::*field)(double), std::optional<double> value) {
    if (value && std::isfinite(*value)) (message.*field)(*value);
  };
  message.set_landmarks(registration.landmarks);
  if (registration.field != ComparedField::kNothing) {
    message.set_field(static_cast<Registration::Field>(static_cast<int>(registration.field)));
  }
  set(&Registration::set_landmark_distance, registration.landmark_distance);
  set(&Registration::set_mean_beltrami, registration.mean_beltrami);
  set(&Registration::set_max_beltrami, registration.max_beltrami);
  set(&Registration::set_correlation_before, registration.correlation_before);
  set(&Registration::set_correlation_after, registration.correlation_after);
  set(&Registration::set_mean_absolute_difference, registration.mean_absolute_difference);
  return message;
}

}  // namespace moduli
