#include "core/hyperbolic/pants.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "core/hyperbolic/cut_surface.h"
#include "core/hyperbolic/lifts.h"
#include "core/hyperbolic/seam_search.h"
#include "core/hyperbolic/trigonometry.h"

namespace moduli {
namespace {

constexpr double kSeamTolerance = 1e-6;
bool anyEqual(const std::vector<Axis>& a, const std::vector<Axis>& b) {
  for (const Axis& x : a)
    for (const Axis& y : b)
      if (sameAxis(x, y)) return true;
  return false;
}

/// The axes over the curves; fails unless these are as many as they must be, simple and disjoint.
Result<Cuts> disjointCuts(const OrbitPolygon& polygon, const std::vector<ClosedGeodesic>& curves) {
  if (curves.size() != static_cast<std::size_t>(3 * polygon.genus - 3))
    return Status(Reason::kInvalidOption, "genus " + std::to_string(polygon.genus) +
                                              " is cut into pants by " +
                                              std::to_string(3 * polygon.genus - 3) +
                                              " curves, not " + std::to_string(curves.size()));
  Cuts cuts;
  for (const ClosedGeodesic& curve : curves) {
    std::vector<Axis> axes = axesAcross(polygon, curve.element);
    const auto meets = [&axes](const std::vector<Axis>& others) {
      return anyCross(axes, others) || anyEqual(axes, others);
    };
    if (anyCross(axes, axes) || std::any_of(cuts.lifts.begin(), cuts.lifts.end(), meets))
      return Status(Reason::kInvalidOption, "curve " + std::to_string(cuts.lifts.size()) +
                                                " meets itself or one before it");
    cuts.lifts.push_back(std::move(axes));
    cuts.lengths.push_back(curve.length);
  }
  return cuts;
}

/// The pants that a surface is cut into, ascending.
Result<std::vector<std::array<int, 3>>> pantsOf(const CutSurface& cut) {
  std::vector<std::array<int, 3>> pants;
  for (const SurfacePiece& piece : cut.pieces) {
    if (piece.genus != 0 || piece.cuffs.size() != 3)
      return Status(Reason::kResidualTooLarge, "the curves do not cut the surface into pants");
    pants.push_back({piece.cuffs[0], piece.cuffs[1], piece.cuffs[2]});
  }
  std::sort(pants.begin(), pants.end());
  return pants;
}

/// The foot marked on a side of a curve.
struct Mark {
  double foot = 0;
  double error = 0;  ///< Of the seam's length, relative to 1 + it.
};

/// Per side of a curve its marked foot.
Result<std::vector<Mark>> markFeet(Context& context, const OrbitPolygon& polygon,
                                   const CutSurface& cut, const FenchelNielsen& coordinates) {
  ASSIGN_OR_RETURN(const std::vector<SeamStart> starts,
                   seamStarts(polygon, cut, coordinates.lengths.size()));
  std::vector<Mark> marks(starts.size());
  for (const auto& pants : coordinates.pants) {
    std::array<double, 3> cuffs{};
    for (int k = 0; k < 3; ++k) cuffs[k] = coordinates.lengths[pants[k] / 2];
    ASSIGN_OR_RETURN(const auto expected, pantsSeams(cuffs));
    for (int k = 0; k < 3; ++k) {
      ASSIGN_OR_RETURN(const std::vector<Seam> seams,
                       findSeams(context, polygon, cut, pants[k], starts[pants[k]], cuffs[k]));
      Mark& mark = marks[pants[k]];
      for (int other = 1; other < 3; ++other) {
        const double length = seams[pants[(k + other) % 3]].length;
        const double right = expected[(k + 3 - other) % 3];
        mark.error = std::max(mark.error, std::abs(length - right) / (1 + right));
      }
      mark.foot = seams[pants[(k + 1) % 3]].foot;
    }
  }
  return marks;
}

}  // namespace

std::vector<Axis> axesAcross(const OrbitPolygon& polygon, const Su11& element) {
  const std::vector<std::int32_t> pairings = pairingsOf(polygon, element);
  const WideSu11 exact = pairings.empty() ? widened(element) : productOf(polygon, pairings);
  std::vector<Axis> axes;
  for (const Lift& lift : liftsAcross(polygon, exact)) axes.push_back(lift.axis());
  // The product is the element or the other lift to SU(1, 1), which has the same axis.
  return axes;
}

bool anyCross(const std::vector<Axis>& a, const std::vector<Axis>& b) {
  for (const Axis& x : a)
    for (const Axis& y : b) {
      // Far ones lose what is left of their squares.
      const double slack = 5e-9 + 1e-15 * std::abs(x.time * y.time);
      if (std::abs(product(x, y)) < 1 - slack && !sameAxis(x, y)) return true;
    }
  return false;
}

Result<FenchelNielsenReading> fenchelNielsen(Context& context, const OrbitPolygon& polygon,
                                             const std::vector<ClosedGeodesic>& curves) {
  const Context::Stage stage(context, "pants");
  ASSIGN_OR_RETURN(const Cuts cuts, disjointCuts(polygon, curves));
  ASSIGN_OR_RETURN(const CutSurface cut, cutSurface(polygon, cuts));
  FenchelNielsenReading reading;
  FenchelNielsen& coordinates = reading.coordinates;
  coordinates.genus = polygon.genus;
  ASSIGN_OR_RETURN(coordinates.pants, pantsOf(cut));
  coordinates.lengths = cuts.lengths;
  ASSIGN_OR_RETURN(const std::vector<Mark> marks, markFeet(context, polygon, cut, coordinates));
  for (const Mark& mark : marks) reading.seam_error = std::max(reading.seam_error, mark.error);
  if (!(reading.seam_error < kSeamTolerance))
    return Status(Reason::kResidualTooLarge, "seams differ by " +
                                                 std::to_string(reading.seam_error) +
                                                 " from what the lengths of the curves make them");
  for (std::size_t i = 0; i < curves.size(); ++i)
    coordinates.twists.push_back(
        normalizedTwist(-marks[2 * i + 1].foot - marks[2 * i].foot, curves[i].length));
  return reading;
}

}  // namespace moduli
