#include "core/ricci/uniformize.h"

#include <string>
#include <utility>

#include "core/ricci/mirror_symmetry.h"
#include "core/ricci/prescribe.h"

namespace moduli {

Result<Uniformization> uniformize(Context& context, const Connectivity& surface,
                                  const std::vector<double>& lengths,
                                  const UniformizeOptions& options) {
  const Index characteristic = surface.eulerCharacteristic();
  if (characteristic > 0) {
    return Status{Reason::kUnsupportedTopology,
                  "a surface of Euler characteristic " + std::to_string(characteristic) +
                      " has neither a flat nor a hyperbolic metric without cones"};
  }
  PrescribeOptions prescribe;
  prescribe.geometry = characteristic < 0 ? Geometry::kHyperbolic : Geometry::kEuclidean;
  prescribe.initial_delaunay = options.initial_delaunay;
  prescribe.solver = options.solver;
  bool bordered = false;
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    bordered = bordered || surface.isBoundaryVertex(v);
  }
  if (!bordered) {
    const std::vector<double> target(surface.vertexCount(), 0.0);
    ASSIGN_OR_RETURN(DiscreteMetric metric,
                     prescribeCurvature(context, surface, lengths, target,
                                        Unknowns::all(surface.vertexCount()), prescribe));
    return Uniformization{std::move(metric), std::nullopt};
  }
  ASSIGN_OR_RETURN(DoubleCover cover, doubleCover(surface));
  const std::vector<double> target(cover.involution.size(), 0.0);
  ASSIGN_OR_RETURN(DiscreteMetric metric,
                   prescribeCurvature(context, cover.connectivity, lengthsOnDouble(cover, lengths),
                                      target, mirrorUnknowns(cover), prescribe));
  return Uniformization{std::move(metric), std::move(cover)};
}

}  // namespace moduli
