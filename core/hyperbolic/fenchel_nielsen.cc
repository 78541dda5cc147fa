#include "core/hyperbolic/fenchel_nielsen.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

namespace moduli {
namespace {

/// A longer curve would not fit into doubles.
constexpr double kLongest = 300;

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
    if (!(length > 0 && length <= kLongest))
      return {Reason::kInvalidOption, "lengths are in (0, 300], not " + std::to_string(length)};
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

/// e^x for |x| <= 300: the series at x / 2^16, squared 16 times; an error of 1e-29 relative.
Wide exponential(Wide x) {
  constexpr int kSquarings = 16;
  x /= 1 << kSquarings;
  Wide result = 1;
  for (int n = 14; n > 0; --n) result = 1 + result * x / n;
  for (int n = 0; n < kSquarings; ++n) result *= result;
  return result;
}

/// The square root of a positive number that a double can hold.
Wide root(Wide x) {
  Wide result = std::sqrt(static_cast<double>(x));
  for (int n = 0; n < 2; ++n) result = (result + x / result) / 2;
  return result;
}

Wide cosine(Wide x) {
  const Wide e = exponential(x);
  return (e + 1 / e) / 2;
}
Wide sine(Wide x) {
  const Wide e = exponential(x);
  return (e - 1 / e) / 2;
}

/// As translation, rotation(pi) and rotation(pi / 2).
WideSu11 shift(Wide length) {
  return {cosine(length / 2), sine(length / 2)};
}
WideSu11 halfTurn() {
  return {WideComplex(Wide{0}, Wide{1}), Wide{0}};
}
WideSu11 quarterTurn() {
  const Wide half = root(Wide{1} / 2);
  return {WideComplex(half, half), Wide{0}};
}

/// The shift along the seam between half cuffs a and b, opposite c; as hexagonSide.
WideSu11 shiftAlongSeam(Wide a, Wide b, Wide c) {
  const Wide sines = 2 * sine(a) * sine(b);
  return {root((cosine(c) + cosine(a + b)) / sines), root((cosine(c) + cosine(a - b)) / sines)};
}

/// Frames at the marked feet of a pair of pants: 0 is carried to the foot and the positive real
/// axis along the cuff, with the pants on the left. The first is 1.
std::array<WideSu11, 3> markedFeet(const std::array<Wide, 3>& cuffs) {
  // Around one hexagon, which is on the left: along half a cuff to the marked foot, left, along the
  // seam to the next cuff, left.
  std::array<WideSu11, 3> feet;
  for (int k = 1; k < 3; ++k)
    feet[k] = renormalized(feet[k - 1] * quarterTurn() *
                           shiftAlongSeam(cuffs[k - 1] / 2, cuffs[k] / 2, cuffs[(k + 1) % 3] / 2) *
                           quarterTurn() * shift(cuffs[k] / 2));
  return feet;
}

std::vector<std::array<WideSu11, 3>> feetOfPants(const FenchelNielsen& coordinates) {
  std::vector<std::array<WideSu11, 3>> feet;
  for (const auto& pants : coordinates.pants) {
    std::array<Wide, 3> cuffs{};
    for (int k = 0; k < 3; ++k) cuffs[k] = coordinates.lengths[pants[k] / 2];
    feet.push_back(markedFeet(cuffs));
  }
  return feet;
}

/// Pairs of pants put side by side across some of the curves.
struct Layout {
  std::vector<WideSu11> placed;  ///< Per pair of pants: from its coordinates to the disk.
  std::vector<bool> crossed;     ///< Per curve: whether its two sides were put together.
  std::size_t count = 0;         ///< Pairs of pants that were reached.
  double radius = 0;             ///< The largest distance of a marked foot from 0.
};

struct Gluing {
  const FenchelNielsen& coordinates;
  const std::vector<Place>& places;
  const std::vector<std::array<WideSu11, 3>>& feet;

  const WideSu11& foot(int side) const { return feet[places[side].pants][places[side].k]; }
  /// From the coordinates of the pants on one side of a curve to those on the other.
  WideSu11 crossing(int side) const {
    return foot(side) * shift(coordinates.twists[side / 2]) * halfTurn() * inverse(foot(side ^ 1));
  }
  Layout layOut(std::size_t root) const;
};

Layout Gluing::layOut(std::size_t root) const {
  const std::size_t count = coordinates.pants.size();
  Layout layout{std::vector<WideSu11>(count), std::vector<bool>(coordinates.lengths.size(), false),
                0, 0};
  std::vector<bool> reached(count, false);
  std::vector<std::size_t> order{root};
  reached[root] = true;
  for (std::size_t i = 0; i < order.size(); ++i)
    for (const int side : coordinates.pants[order[i]]) {
      const WideSu11& here = layout.placed[order[i]];
      layout.radius = std::max(layout.radius, displacement(rounded(here * foot(side))));
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
  const auto feet = feetOfPants(coordinates);
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
    const WideSu11 frame = layout.placed[places[side].pants] * gluing.foot(side);
    return renormalized(frame * shift(coordinates.lengths[side / 2]) * inverse(frame));
  };
  for (const auto& pants : coordinates.pants)
    for (int k = 0; k < 2; ++k) group.generators.push_back(cuff(pants[k]));
  for (int i = 0; i < static_cast<int>(coordinates.lengths.size()); ++i) {
    group.curves.push_back(rounded(cuff(2 * i)));
    if (layout.crossed[i]) continue;
    group.generators.push_back(
        renormalized(layout.placed[places[2 * i].pants] * gluing.crossing(2 * i) *
                     inverse(layout.placed[places[2 * i + 1].pants])));
  }
  return group;
}

}  // namespace moduli
