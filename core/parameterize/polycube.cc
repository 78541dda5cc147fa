#include "core/parameterize/polycube.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "core/base/text.h"
#include "core/parameterize/cones.h"
#include "core/parameterize/flat.h"
#include "core/parameterize/holonomy.h"
#include "core/topology/surface_topology.h"

namespace moduli {
namespace {

constexpr double kQuarter = std::numbers::pi / 2;
constexpr Index kMostCorners = 48;
/// Of the turning around handles.
constexpr double kClosed = 1e-9;

Status checkCorners(const Connectivity& surface, const std::vector<PolycubeCorner>& corners) {
  Index sum = 0;
  for (const PolycubeCorner& corner : corners) {
    if (corner.sign != 1 && corner.sign != -1) {
      return {Reason::kInvalidOption, "the corner at vertex " + std::to_string(corner.vertex) +
                                          " has the sign " + std::to_string(corner.sign) +
                                          ", which is neither 1 (convex) nor -1 (concave)"};
    }
    sum += corner.sign;
  }
  const Index wanted = 4 * surface.eulerCharacteristic();
  if (sum == wanted) return {};
  return {Reason::kInvalidOption,
          "by the theorem of Gauss and Bonnet the corners of a PolyCube of this genus, convex ones "
          "less concave ones, number " +
              std::to_string(wanted) + ", and these number " + std::to_string(sum),
          "add convex corners (1) or concave ones (-1)"};
}

Status checkTopology(const Connectivity& surface) {
  const SurfaceTopology topology = computeTopology(surface);
  if (topology.components == 1 && topology.boundary_loops.empty()) return {};
  return {Reason::kUnsupportedTopology,
          topology.components == 1 ? "a PolyCube is closed, and this surface has a boundary"
                                   : "a PolyCube is connected, and this surface has " +
                                         std::to_string(topology.components) + " components",
          topology.components == 1 ? "--fill-holes closes it" : "choose a component"};
}

}  // namespace

Result<Parameterization> parameterizePolycube(Context& context, const Connectivity& surface,
                                              const std::vector<double>& lengths,
                                              const PolycubeOptions& options) {
  RETURN_IF_ERROR(checkTopology(surface));
  FlatOptions flat;
  flat.initial_delaunay = options.initial_delaunay;
  flat.refine = options.refine;
  flat.cut_overlaps = options.cut_overlaps;
  flat.margin = options.margin;
  flat.seams = options.seams;
  std::optional<ChosenCones> chosen;
  ConeOptions choice;
  if (options.corners.empty()) {
    choice.spread = options.spread;
    choice.most = options.most_corners.value_or(
        std::max(kMostCorners, 5 * std::abs(surface.eulerCharacteristic())));
    choice.quantum = kQuarter;
    choice.most_quanta = 1;
    ASSIGN_OR_RETURN(chosen, chooseCones(context, surface, lengths, choice));
    flat.cones = chosen->cones;
  } else {
    RETURN_IF_ERROR(checkCorners(surface, options.corners));
    for (const PolycubeCorner& corner : options.corners) {
      flat.cones.push_back({corner.vertex, corner.sign * kQuarter});
    }
  }
  ASSIGN_OR_RETURN(Parameterization result, parameterizeFlat(context, surface, lengths, flat));
  if (chosen) tellChoice(*chosen, choice, result);
  const double residual = distanceFromMultiples(result.cones->handle_turns, kQuarter);
  result.certificate.holonomy_residual = residual;
  if (residual > kClosed) {
    result.certificate.warnings.push_back(
        "HANDLES_TURN: directions turn around handles by angles that are up to " +
        shortestDouble(residual) +
        " from a multiple of a right angle, so that squares do not close up along them");
  }
  return result;
}

}  // namespace moduli
