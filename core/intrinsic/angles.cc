#include "core/intrinsic/angles.h"

#include <cmath>
#include <numbers>

namespace moduli {

std::vector<double> cornerAngles(const Connectivity& surface, const std::vector<double>& lengths) {
  std::vector<double> angles(surface.halfedgeCount());
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    const double opposite = lengths[surface.edge(Connectivity::next(h))];
    const double left = lengths[surface.edge(Connectivity::previous(h))];
    const double right = lengths[surface.edge(h)];
    // With s half the perimeter: tan^2(angle / 2) = (s - left)(s - right) / (s (s - opposite)).
    const double past_left = (opposite + (right - left)) / 2;
    const double past_right = (opposite + (left - right)) / 2;
    const double past_opposite = (left + (right - opposite)) / 2;
    const double half_perimeter = (opposite + left + right) / 2;
    angles[h] = 2 * std::atan2(std::sqrt(past_left * past_right),
                               std::sqrt(half_perimeter * past_opposite));
  }
  return angles;
}

std::vector<double> vertexCurvatures(const Connectivity& surface,
                                     const std::vector<double>& lengths) {
  const std::vector<double> angles = cornerAngles(surface, lengths);
  std::vector<double> curvatures(surface.vertexCount());
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    curvatures[v] = surface.isBoundaryVertex(v) ? std::numbers::pi : 2 * std::numbers::pi;
  }
  for (Index h = 0; h < surface.halfedgeCount(); ++h) curvatures[surface.tail(h)] -= angles[h];
  return curvatures;
}

}  // namespace moduli
