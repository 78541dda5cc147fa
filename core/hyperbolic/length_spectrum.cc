#include "core/hyperbolic/length_spectrum.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "core/hyperbolic/axis.h"
#include "core/hyperbolic/lifts.h"
#include "core/hyperbolic/orbit_search.h"
#include "core/hyperbolic/polygon_copies.h"

namespace moduli {
namespace {

/// Lengths are compared to this, relative.
constexpr double kLengthTolerance = 1e-9;
/// An axis that touches the polygon may miss it by the rounding of the polygon.
constexpr double kTouching = 1e-6;
/// Axes are followed through copies of the polygon that they miss by this, so that those through
/// corners are followed past them whatever rounding makes of the corners.
constexpr double kFollowing = 0.05;

/// How far an element over a geodesic through the polygon may move 0, and the inverse.
double reachOfLength(const OrbitPolygon& polygon, double length) {
  return 2 * std::asinh(std::cosh(polygon.radius) * std::sinh(length / 2));
}
double lengthOfReach(const OrbitPolygon& polygon, double reach) {
  return 2 * std::asinh(std::sinh(reach / 2) / std::cosh(polygon.radius));
}

struct Candidate {
  double length = 0;
  std::size_t index = 0;
};

/// Elements of the ball over closed geodesics of length at most `length` through the polygon, the
/// shortest first, among equal ones the one that moves 0 least.
std::vector<Candidate> candidates(const OrbitPolygon& polygon, const OrbitBall& ball,
                                  double length) {
  std::vector<Candidate> result;
  // The half trace tells long ones quickly, but short lengths not to the last digits.
  const double cosine = std::cosh(length / 2) * (1 + kLengthTolerance);
  for (std::size_t i = 1; i < ball.elements.size(); ++i) {
    const Su11& g = ball.elements[i];
    if (std::abs(g.a.real()) > cosine || !meetsPolygon(polygon, axisOf(g), kTouching)) continue;
    const double found = translationLength(g);
    if (found <= length) result.push_back({found, i});
  }
  const auto byLength = [](const Candidate& x, const Candidate& y) { return x.length < y.length; };
  const auto byIndex = [](const Candidate& x, const Candidate& y) { return x.index < y.index; };
  std::sort(result.begin(), result.end(), byLength);
  for (auto first = result.begin(), last = first; first != result.end(); first = last) {
    while (last != result.end() && last->length <= first->length * (1 + kLengthTolerance)) ++last;
    std::sort(first, last, byIndex);
  }
  return result;
}

/// Enters the powers of g and their inverses up to a length.
void enterPowers(OrbitIndex& known, const Su11& g, int powers) {
  Su11 power = g;
  for (int k = 1; k <= powers; ++k) {
    for (const Su11& h : {power, inverse(power)})
      if (known.find(h) < 0) known.enter(h, k);
    power = renormalized(power * g);
  }
}

Status needLength(double length) {
  if (length > 0 && std::isfinite(length)) return {};
  return {Reason::kInvalidOption,
          "the length of a spectrum must be positive and finite, not " + std::to_string(length)};
}

}  // namespace

Su11 carriedToPolygon(const OrbitPolygon& polygon, const Su11& element) {
  // While the point of the axis that is nearest to 0 is outside, it is nearer to a neighbour of 0.
  Su11 g = renormalized(inverse(polygon.base) * element * polygon.base);
  for (bool nearer = true; nearer;) {
    nearer = false;
    const double distance = std::abs(axisOf(g).time);
    for (const GroupElement& s : polygon.pairings) {
      const Su11 other = renormalized(inverse(s.map) * g * s.map);
      if (std::abs(axisOf(other).time) > distance * (1 - 1e-9) - 1e-12) continue;
      g = other;
      nearer = true;
      break;
    }
  }
  return g;
}

std::vector<Su11> conjugatesAcross(const OrbitPolygon& polygon, const Su11& element, double slack) {
  std::vector<Su11> found{element};
  if (reachesFar(polygon)) {
    // In doubles, the axes at one end of a long collar would be copied without end at the other.
    const auto pairings = pairingsOf(polygon, element);
    const auto map = pairings.empty() ? widened(element) : productOf(polygon, pairings);
    found.clear();
    for (const Lift& lift : liftsAcross(polygon, map, slack)) found.push_back(lift.shape);
    return found;
  }
  OrbitIndex index(polygon.separation);
  index.enter(element, 0);
  for (std::size_t i = 0; i < found.size(); ++i)
    for (const GroupElement& s : polygon.pairings) {
      const Su11 g = renormalized(inverse(s.map) * found[i] * s.map);
      if (index.find(g) >= 0 || !meetsPolygon(polygon, axisOf(g), slack)) continue;
      index.enter(g, 0);
      found.push_back(g);
    }
  return found;
}

Result<LengthSpectrum> lengthSpectrum(Context& context, const OrbitPolygon& polygon, double length,
                                      const SpectrumOptions& options) {
  RETURN_IF_ERROR(needLength(length));
  const Context::Stage stage(context, "length spectrum");
  const double longest = length * (1 + kLengthTolerance);
  const double reach = reachOfLength(polygon, longest) + kTouching;
  ASSIGN_OR_RETURN(const OrbitBall ball,
                   searchOrbit(context, polygon, reach, options.most_elements));
  LengthSpectrum spectrum;
  spectrum.elements = ball.elements.size();
  const bool complete = ball.complete_to >= reach;
  spectrum.complete_to =
      complete ? length : std::min(length, lengthOfReach(polygon, ball.complete_to - kTouching));
  const double last = complete ? longest : spectrum.complete_to;
  OrbitIndex known(polygon.separation);
  for (const Candidate& candidate : candidates(polygon, ball, last)) {
    const Su11& g = ball.elements[candidate.index];
    if (known.find(g) >= 0) continue;
    RETURN_IF_ERROR(context.check());
    const int powers = static_cast<int>(last / candidate.length + 1e-6);
    for (const Su11& h : conjugatesAcross(polygon, g, kFollowing)) enterPowers(known, h, powers);
    spectrum.geodesics.push_back({candidate.length, g, ball.wordOf(polygon, candidate.index)});
  }
  std::stable_sort(
      spectrum.geodesics.begin(), spectrum.geodesics.end(),
      [](const ClosedGeodesic& x, const ClosedGeodesic& y) { return x.length < y.length; });
  return spectrum;
}

Result<LengthSpectrum> systoles(Context& context, const OrbitPolygon& polygon,
                                const SpectrumOptions& options) {
  // The shortest of any elements is an upper bound, up to the rounding of their lengths.
  double length = translationLength(polygon.pairings.front().map);
  for (const GroupElement& g : polygon.pairings)
    length = std::min(length, translationLength(g.map));
  for (std::size_t i = 0; i < polygon.pairings.size(); ++i)
    for (std::size_t k = 0; k < polygon.pairings.size(); ++k) {
      const Su11 product = polygon.pairings[i].map * polygon.pairings[k].map;
      if (displacement(product) < polygon.separation / 2 || translationLength(product) >= length)
        continue;
      // The product of far ones is a short one with the rounding of far ones.
      const double exact = translationLength(rounded(polygon.wide[i] * polygon.wide[k]));
      if (exact > 0) length = std::min(length, exact);
    }
  length *= 1 + 1e-5;
  ASSIGN_OR_RETURN(LengthSpectrum spectrum, lengthSpectrum(context, polygon, length, options));
  if (spectrum.complete_to < length)
    return Status(
        Reason::kNoConvergence,
        "the shortest closed geodesics are not known: " + std::to_string(spectrum.elements) +
            " elements suffice up to length " + std::to_string(spectrum.complete_to),
        "allow more elements");
  if (spectrum.geodesics.empty())
    return Status(Reason::kInternal, "no closed geodesic is as short as a pairing");
  const double least = spectrum.geodesics.front().length;
  std::erase_if(spectrum.geodesics, [least](const ClosedGeodesic& geodesic) {
    return geodesic.length > least * (1 + kLengthTolerance);
  });
  spectrum.complete_to = least;
  return spectrum;
}

}  // namespace moduli
