#include "core/parameterize/ideal_certificate.h"

namespace moduli {

void certifyIdeal(const IdealPolyhedron& ideal, MapCertificate& certificate) {
  const MetricCertificate& metric = ideal.metric.metric.certificate;
  certificate.curvature_residual = metric.curvature_residual;
  certificate.gauss_bonnet_residual = metric.gauss_bonnet_residual;
  certificate.layout_closure = ideal.layout_closure;
  certificate.max_link_angle = ideal.metric.max_link_angle;
  certificate.smallest_angle = metric.smallest_angle;
  certificate.centering_residual = ideal.centering_residual;
  certificate.newton_iterations = metric.newton_iterations;
  certificate.flips = metric.flips;
}

std::vector<Index> vertexCorners(const Connectivity& surface) {
  std::vector<Index> corner;
  corner.reserve(surface.halfedgeCount());
  for (Index h = 0; h < surface.halfedgeCount(); ++h) corner.push_back(surface.tail(h));
  return corner;
}

}  // namespace moduli
