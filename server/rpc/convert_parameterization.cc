#include "server/rpc/convert_parameterization.h"

#include <cmath>

namespace moduli {
namespace {

using Options = v1::ParameterizationOptions;

static_assert(static_cast<int>(BoundaryRule::kStraight) + 1 == Options::STRAIGHT);
static_assert(static_cast<int>(BoundaryRule::kFree) + 1 == Options::FREE);
static_assert(static_cast<int>(Scheme::kVertexScaling) + 1 == Options::VERTEX_SCALING);
static_assert(static_cast<int>(Scheme::kInversiveDistance) + 1 == Options::INVERSIVE_DISTANCE);
static_assert(static_cast<int>(RicciSolver::kNewton) + 1 == Options::NEWTON);
static_assert(static_cast<int>(RicciSolver::kFlow) + 1 == Options::FLOW);

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

v1::ParameterizationCertificate toProto(const FlatCertificate& certificate) {
  using Message = v1::ParameterizationCertificate;
  Message message;
  const auto set = [&message](void (Message::*field)(double), double value) {
    if (std::isfinite(value)) (message.*field)(value);
  };
  set(&Message::set_curvature_residual, certificate.curvature_residual);
  set(&Message::set_gauss_bonnet_residual, certificate.gauss_bonnet_residual);
  set(&Message::set_layout_closure, certificate.layout_closure);
  set(&Message::set_max_dilatation, certificate.max_dilatation);
  set(&Message::set_mean_dilatation, certificate.mean_dilatation);
  set(&Message::set_smallest_angle, certificate.smallest_angle);
  set(&Message::set_mollification, certificate.mollification);
  if (certificate.clamped_fraction) {
    set(&Message::set_clamped_fraction, *certificate.clamped_fraction);
  }
  message.set_flipped_faces(certificate.flipped_faces);
  message.set_newton_iterations(certificate.newton_iterations);
  message.set_flips(certificate.flips);
  for (const std::string& warning : certificate.warnings) message.add_warnings(warning);
  return message;
}

}  // namespace moduli
