#include "core/parameterize/atlas.h"

#include <algorithm>
#include <numbers>
#include <utility>

#include "core/base/text.h"
#include "core/parameterize/cones.h"
#include "core/parameterize/flatten.h"
#include "core/topology/surface_topology.h"

namespace moduli {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kMaxResidual = 1e-9;

Status checkPoints(Index chi, std::size_t count) {
  if (chi > 0 && count < 3) {
    return {Reason::kInvalidOption,
            "by the theorem of Gauss and Bonnet the extraordinary points of a sphere share a "
            "curvature of 4 pi, and each has less than 2 pi: " +
                std::to_string(count) + " cannot, three can",
            "name three vertices at least, or none to have them chosen"};
  }
  if (chi == 0 && count > 0) {
    return {Reason::kInvalidOption,
            "by the theorem of Gauss and Bonnet the extraordinary points of a torus share a "
            "curvature of 0: it needs none",
            "name none"};
  }
  return {};
}

/// Where nobody names them: three with a third of 4 pi each, or one.
Result<std::vector<Cone>> pointsOf(Context& context, const Connectivity& surface,
                                   const std::vector<double>& lengths,
                                   const AtlasOptions& options) {
  const Index chi = surface.eulerCharacteristic();
  std::vector<Cone> cones;
  if (!options.extraordinary.empty()) {
    const auto count = static_cast<double>(options.extraordinary.size());
    for (const Index v : options.extraordinary) cones.push_back({v, 2 * kPi * chi / count});
    return cones;
  }
  if (chi == 0) return cones;
  ConeOptions choice;
  choice.most = leastExtraordinary(chi);
  if (chi > 0) {
    choice.quantum = 2 * kPi / 3;
    choice.most_quanta = 2;
  }
  ASSIGN_OR_RETURN(ChosenCones chosen, chooseCones(context, surface, lengths, choice));
  return std::move(chosen.cones);
}

}  // namespace

Index leastExtraordinary(Index euler_characteristic) {
  return euler_characteristic > 0 ? 3 : euler_characteristic == 0 ? 0 : 1;
}

Result<Parameterization> parameterizeAtlas(Context& context, const Connectivity& surface,
                                           const std::vector<double>& lengths,
                                           const AtlasOptions& options) {
  const SurfaceTopology topology = computeTopology(surface);
  if (topology.components != 1 || !topology.boundary_loops.empty()) {
    return Status(Reason::kUnsupportedTopology,
                  "an affine atlas is that of a closed connected surface",
                  topology.components == 1 ? "--fill-holes closes it" : "choose a component");
  }
  if (!options.extraordinary.empty()) {
    RETURN_IF_ERROR(checkPoints(topology.euler_characteristic, options.extraordinary.size()));
  }
  FlatOptions flat;
  flat.initial_delaunay = options.initial_delaunay;
  flat.refine = options.refine;
  flat.margin = options.margin;
  flat.seams = options.seams;
  ASSIGN_OR_RETURN(flat.cones, pointsOf(context, surface, lengths, options));
  ASSIGN_OR_RETURN(FlatMap found, flatten(context, surface, lengths, flat));
  Parameterization& result = found.map;
  AffineAtlas atlas = atlasOfCharts(found.faces.surface, found.faces.charts, flat.cones);
  const double residual = std::max(atlas.overlap_residual, atlas.cocycle_residual);
  result.certificate.cycle_residual = residual;
  if (!(residual <= kMaxResidual)) {
    return Status(Reason::kResidualTooLarge,
                  "the charts of the atlas fit up to " + shortestDouble(residual) +
                      " of an edge (allowed: " + shortestDouble(kMaxResidual) + ")",
                  "remesh parts that are thin");
  }
  result.atlas = std::move(atlas);
  return std::move(result);
}

}  // namespace moduli
