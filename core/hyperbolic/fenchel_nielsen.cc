#include "core/hyperbolic/fenchel_nielsen.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include "core/hyperbolic/trigonometry.h"

namespace moduli {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// Where a side belongs: the k-th of a pair of pants.
struct Place {
  int pants = -1;
  int k = 0;
};

Status needCounts(const FenchelNielsen& coordinates) {
  const auto g = static_cast<std::size_t>(coordinates.genus);
  if (coordinates.genus < 2 || coordinates.pants.size() != 2 * g - 2 ||
      coordinates.lengths.size() != 3 * g - 3 || coordinates.twists.size() != 3 * g - 3)
    return {Reason::kInvalidOption,
            "genus " + std::to_string(coordinates.genus) +
                " >= 2 has 2 g - 2 pairs of pants, 3 g - 3 lengths and 3 g - 3 twists"};
  for (const double length : coordinates.lengths)
    if (!(length > 0) || !std::isfinite(length))
      return {Reason::kInvalidOption, "lengths are positive, not " + std::to_string(length)};
  for (const double twist : coordinates.twists)
    if (!std::isfinite(twist)) return {Reason::kInvalidOption, "twists are finite"};
  return {};
}

/// Per side its place. Fails unless each occurs once.
Result<std::vector<Place>> placesOf(const FenchelNielsen& coordinates) {
  std::vector<Place> places(2 * coordinates.lengths.size());
  for (std::size_t p = 0; p < coordinates.pants.size(); ++p)
    for (int k = 0; k < 3; ++k) {
      const int side = coordinates.pants[p][k];
      if (side < 0 || side >= static_cast<int>(places.size()) || places[side].pants >= 0)
        return Status(Reason::kInvalidOption, "side " + std::to_string(side) +
                                                  " of a curve is not one of one pair of pants");
      places[side] = {static_cast<int>(p), k};
    }
  return places;
}

/// Frames at the marked feet of a pair of pants: 0 is carried to the foot and the positive real
/// axis along the cuff, with the pants on the left. The first is 1.
Result<std::array<Su11, 3>> markedFeet(const std::array<double, 3>& cuffs) {
  ASSIGN_OR_RETURN(const auto seams, pantsSeams(cuffs));
  // Around one hexagon, which is on the left: along half a cuff to the marked foot, left, along the
  // seam to the next cuff, left.
  std::array<Su11, 3> feet;
  for (int k = 1; k < 3; ++k)
    feet[k] = renormalized(feet[k - 1] * rotation(kPi / 2) * translation(seams[(k + 1) % 3]) *
                           rotation(kPi / 2) * translation(cuffs[k] / 2));
  return feet;
}

Result<std::vector<std::array<Su11, 3>>> feetOfPants(const FenchelNielsen& coordinates) {
  std::vector<std::array<Su11, 3>> feet;
  for (const auto& pants : coordinates.pants) {
    std::array<double, 3> cuffs{};
    for (int k = 0; k < 3; ++k) cuffs[k] = coordinates.lengths[pants[k] / 2];
    ASSIGN_OR_RETURN(const auto marked, markedFeet(cuffs));
    feet.push_back(marked);
  }
  return feet;
}

/// Pairs of pants put side by side across some of the curves.
struct Layout {
  std::vector<Su11> placed;   ///< Per pair of pants: from its coordinates to the disk.
  std::vector<bool> crossed;  ///< Per curve: whether its two sides were put together.
  std::size_t count = 0;      ///< Pairs of pants that were reached.
  double radius = 0;          ///< The largest distance of a marked foot from 0.
};

struct Gluing {
  const FenchelNielsen& coordinates;
  const std::vector<Place>& places;
  const std::vector<std::array<Su11, 3>>& feet;

  const Su11& foot(int side) const { return feet[places[side].pants][places[side].k]; }
  /// From the coordinates of the pants on one side of a curve to those on the other.
  Su11 crossing(int side) const {
    return foot(side) * translation(coordinates.twists[side / 2]) * rotation(kPi) *
           inverse(foot(side ^ 1));
  }
  Layout layOut(std::size_t root) const;
};

Layout Gluing::layOut(std::size_t root) const {
  const std::size_t count = coordinates.pants.size();
  Layout layout{std::vector<Su11>(count), std::vector<bool>(coordinates.lengths.size(), false), 0,
                0};
  std::vector<bool> reached(count, false);
  std::vector<std::size_t> order{root};
  reached[root] = true;
  for (std::size_t i = 0; i < order.size(); ++i)
    for (const int side : coordinates.pants[order[i]]) {
      const Su11& here = layout.placed[order[i]];
      layout.radius = std::max(layout.radius, displacement(here * foot(side)));
      const int q = places[side ^ 1].pants;
      if (reached[q]) continue;
      reached[q] = true;
      layout.crossed[side / 2] = true;
      layout.placed[q] = renormalized(here * crossing(side));
      order.push_back(q);
    }
  layout.count = order.size();
  return layout;
}

}  // namespace

double normalizedTwist(double twist, double length) {
  const double turns = twist / length;
  const double rest = turns - std::floor(turns + 0.5 + 1e-9);
  return rest * length;
}

Result<PantsGroup> groupFromFenchelNielsen(const FenchelNielsen& coordinates) {
  RETURN_IF_ERROR(needCounts(coordinates));
  ASSIGN_OR_RETURN(const std::vector<Place> places, placesOf(coordinates));
  ASSIGN_OR_RETURN(const auto feet, feetOfPants(coordinates));
  const Gluing gluing{coordinates, places, feet};
  Layout layout = gluing.layOut(0);
  if (layout.count < coordinates.pants.size())
    return Status(Reason::kInvalidOption, "the pairs of pants do not hang together");
  for (std::size_t root = 1; root < coordinates.pants.size(); ++root) {
    Layout other = gluing.layOut(root);
    if (other.radius < layout.radius) layout = std::move(other);
  }
  PantsGroup group;
  const auto cuff = [&](int side) {
    const Su11 frame = layout.placed[places[side].pants] * gluing.foot(side);
    return renormalized(frame * translation(coordinates.lengths[side / 2]) * inverse(frame));
  };
  for (const auto& pants : coordinates.pants)
    for (int k = 0; k < 2; ++k) group.generators.push_back(cuff(pants[k]));
  for (int i = 0; i < static_cast<int>(coordinates.lengths.size()); ++i) {
    group.curves.push_back(cuff(2 * i));
    if (layout.crossed[i]) continue;
    group.generators.push_back(
        renormalized(layout.placed[places[2 * i].pants] * gluing.crossing(2 * i) *
                     inverse(layout.placed[places[2 * i + 1].pants])));
  }
  return group;
}

}  // namespace moduli
