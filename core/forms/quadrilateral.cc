#include "core/forms/quadrilateral.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/forms/cotan.h"
#include "core/forms/harmonic.h"
#include "core/topology/surface_topology.h"

namespace moduli {
namespace {

/// The boundary vertices in order, from corner a on.
Result<std::vector<Index>> boundaryFrom(const Connectivity& surface, Index start) {
  const SurfaceTopology topology = computeTopology(surface);
  if (topology.components != 1 || topology.genus != 0 || topology.boundary_loops.size() != 1) {
    return Status{Reason::kUnsupportedTopology,
                  "a quadrilateral is a disk; the surface has genus " +
                      std::to_string(topology.genus) + ", " +
                      std::to_string(topology.boundary_loops.size()) + " boundary loops and " +
                      std::to_string(topology.components) + " components"};
  }
  std::vector<Index> boundary;
  for (const Index h : topology.boundary_loops[0]) boundary.push_back(surface.tail(h));
  const auto first = std::find(boundary.begin(), boundary.end(), start);
  std::rotate(boundary.begin(), first, boundary.end());
  return boundary;
}

/// Places of the corners in the boundary, ascending from 0.
Result<std::array<std::size_t, 4>> placeCorners(const std::vector<Index>& boundary,
                                                const std::array<Index, 4>& corners) {
  std::array<std::size_t, 4> places{};
  for (std::size_t k = 0; k < 4; ++k) {
    const auto place = std::find(boundary.begin(), boundary.end(), corners[k]);
    const std::string name =
        "corner " + std::to_string(k) + " (vertex " + std::to_string(corners[k]) + ")";
    if (place == boundary.end()) {
      return Status{Reason::kInvalidOption, name + " does not lie on the boundary"};
    }
    places[k] = static_cast<std::size_t>(place - boundary.begin());
    if (k > 0 && places[k] <= places[k - 1]) {
      return Status{Reason::kInvalidOption, name + " does not follow the one before it",
                    "give four distinct corners in the order of the boundary, the surface on the "
                    "left"};
    }
  }
  return places;
}

/// Energy of the harmonic function that is 0 on the side from corner `side` to the next one and 1
/// on the opposite side.
Result<EnergyForm> energyBetween(Context& context, const Connectivity& surface,
                                 const std::vector<double>& lengths,
                                 const std::vector<Index>& boundary,
                                 const std::array<std::size_t, 4>& places, std::size_t side) {
  std::vector<bool> fixed(surface.vertexCount(), false);
  RowMajorMatrix values = RowMajorMatrix::Zero(surface.vertexCount(), 1);
  for (const std::size_t which : {side, (side + 2) % 4}) {
    const std::size_t last = which == 3 ? boundary.size() : places[which + 1];
    for (std::size_t k = places[which]; k <= last; ++k) {
      const Index v = boundary[k % boundary.size()];
      fixed[v] = true;
      values(v, 0) = which == side ? 0 : 1;
    }
  }
  FormBasis form;
  form.seam.assign(surface.edgeCount(), kNone);
  ASSIGN_OR_RETURN(form.potential,
                   harmonicFunctions(context, surface, cotanWeights(surface, lengths), fixed,
                                     std::move(values)));
  return energyForm(surface, lengths, form);
}

}  // namespace

Result<BoundedNumber> quadrilateralModulus(Context& context, const Connectivity& surface,
                                           const std::vector<double>& given_lengths,
                                           const std::array<Index, 4>& corners) {
  ASSIGN_OR_RETURN(const std::vector<Index> boundary, boundaryFrom(surface, corners[0]));
  ASSIGN_OR_RETURN(const auto places, placeCorners(boundary, corners));
  const std::vector<double> lengths = unitLengths(given_lengths);
  // Between bc and da the current flows through a rectangle of this length; across it, of this
  // width.
  ASSIGN_OR_RETURN(const EnergyForm lengthwise,
                   energyBetween(context, surface, lengths, boundary, places, 1));
  ASSIGN_OR_RETURN(const EnergyForm crosswise,
                   energyBetween(context, surface, lengths, boundary, places, 0));
  const double low = 1 / lengthwise.energy(0, 0);
  const double high = crosswise.energy(0, 0);
  return BoundedNumber{std::sqrt(low * high), low / (1 + lengthwise.rounding),
                       high * (1 + crosswise.rounding)};
}

}  // namespace moduli
