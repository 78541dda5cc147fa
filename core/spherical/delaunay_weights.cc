#include "core/spherical/delaunay_weights.h"

#include <utility>

#include "core/forms/cotan.h"
#include "core/intrinsic/delaunay.h"
#include "core/intrinsic/geometry.h"

namespace moduli::spherical {
namespace {

bool hasNegativeInside(const Connectivity& surface, const std::vector<double>& weights) {
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    if (weights[e] < 0 && !surface.isBoundaryEdge(e)) return true;
  }
  return false;
}

}  // namespace

Result<WeightedSurface> delaunayWeights(Context& context, const Connectivity& surface,
                                        const std::vector<double>& lengths) {
  std::vector<double> weights = cotanWeights(surface, lengths);
  if (!hasNegativeInside(surface, weights)) {
    return WeightedSurface{surface, lengths, std::move(weights), 0};
  }
  const Context::Stage stage(context, "delaunay");
  std::vector<double> half_chords(lengths.size());
  for (std::size_t e = 0; e < lengths.size(); ++e) {
    half_chords[e] = halfChord(Geometry::kEuclidean, lengths[e]);
  }
  IntrinsicTriangulation triangulation(surface, half_chords);
  ASSIGN_OR_RETURN(const std::size_t flips, flipToDelaunayIsometric(context, triangulation));
  Connectivity flipped = triangulation.connectivity();
  std::vector<double> flipped_lengths = triangulation.edgeHalfChords();
  for (double& length : flipped_lengths) length = lengthOfHalfChord(Geometry::kEuclidean, length);
  weights = cotanWeights(flipped, flipped_lengths);
  return WeightedSurface{std::move(flipped), std::move(flipped_lengths), std::move(weights), flips};
}

}  // namespace moduli::spherical
