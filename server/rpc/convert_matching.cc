#include "server/rpc/convert_matching.h"

#include <cmath>
#include <optional>

namespace moduli {
namespace {

using Message = v1::SurfaceMatch;

static_assert(static_cast<int>(MatchMethod::kSameTriangulation) + 1 == Message::SAME_TRIANGULATION);
static_assert(static_cast<int>(MatchMethod::kNearIsometry) + 1 == Message::NEAR_ISOMETRY);
static_assert(static_cast<int>(MatchMethod::kMobius) + 1 == Message::MOBIUS);
static_assert(static_cast<int>(MatchMethod::kShape) + 1 == Message::SHAPE);

Message::Method methodOf(MatchMethod method) {
  return static_cast<Message::Method>(static_cast<int>(method) + 1);
}

v1::MatchCertificate certificateOf(const SurfaceMatch& match) {
  using Certificate = v1::MatchCertificate;
  Certificate certificate;
  const auto set = [&certificate](void (Certificate::*field)(double), std::optional<double> value) {
    if (value && std::isfinite(*value)) (certificate.*field)(*value);
  };
  const MapReport& report = match.report;
  certificate.set_flipped_faces(report.folded_faces);
  set(&Certificate::set_mean_dilatation, report.mean_dilatation);
  set(&Certificate::set_dilatation_95, report.dilatation_95);
  set(&Certificate::set_max_dilatation, report.max_dilatation);
  set(&Certificate::set_area_distortion, report.area_distortion);
  set(&Certificate::set_cycle_error, match.cycle_error);
  set(&Certificate::set_landmark_error, match.landmark_error);
  set(&Certificate::set_soft_landmark_error, match.soft_landmark_error);
  set(&Certificate::set_defect, match.defect);
  set(&Certificate::set_teichmuller_distance, match.teichmuller_distance);
  return certificate;
}

}  // namespace

MatchOptions fromProto(const v1::MatchOptions& message) {
  MatchOptions options;
  options.mirror = message.mirror();
  if (message.has_same_triangulation()) options.same_triangulation = message.same_triangulation();
  if (message.has_initial_delaunay()) options.initial_delaunay = message.initial_delaunay();
  options.alternative = message.alternative();
  return options;
}

v1::SurfaceMatch toProto(const SurfaceMatch& match) {
  Message message;
  if (std::isfinite(match.distance)) message.set_distance(match.distance);
  message.set_method(methodOf(match.method));
  *message.mutable_certificate() = certificateOf(match);
  for (const MatchAlternative& alternative : match.alternatives) {
    Message::Alternative& other = *message.add_alternatives();
    other.set_method(methodOf(alternative.method));
    other.set_defect(alternative.defect);
  }
  return message;
}

}  // namespace moduli
