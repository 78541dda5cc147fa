#include "core/hyperbolic/pants.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <queue>
#include <string>
#include <utility>

#include "core/hyperbolic/orbit_search.h"
#include "core/hyperbolic/trigonometry.h"

namespace moduli {
namespace {

constexpr double kPi = 3.14159265358979323846;
/// Axes pass the polygon within this, in sinh of distance: those that are looked at as cuffs, and,
/// twice as far, those that may lie in front of them.
constexpr double kPassing = 0.05;
constexpr double kSeamTolerance = 1e-6;
/// Copies of the polygon beside a curve: cuffs of 1e-3 need some ten thousand.
constexpr std::size_t kMostCopies = 1'000'000;

/// An axis over a curve that passes the polygon.
struct Lift {
  Axis axis;
  int curve = 0;
  bool passes = false;  ///< Within kPassing, not only within twice that.
  /// Per pairing s: +1 where the copy s of the polygon lies all on the axis's left, -1 right, 0
  /// neither.
  std::vector<int> side;
};

int sideOfCopy(const OrbitPolygon& polygon, const Axis& axis, const Su11& copy) {
  const Axis seen = imageOf(inverse(copy), axis);
  if (meetsPolygon(polygon, seen, kPassing)) return 0;
  return sideOf(seen, 0.0) > 0 ? 1 : -1;
}

std::vector<Lift> liftsOf(const OrbitPolygon& polygon, const std::vector<ClosedGeodesic>& curves) {
  std::vector<Lift> lifts;
  for (std::size_t i = 0; i < curves.size(); ++i)
    for (const Su11& g : conjugatesAcross(polygon, curves[i].element, 2 * kPassing)) {
      Lift lift{axisOf(g), static_cast<int>(i), false, {}};
      lift.passes = meetsPolygon(polygon, lift.axis, kPassing);
      for (const GroupElement& s : polygon.pairings)
        lift.side.push_back(sideOfCopy(polygon, lift.axis, s.map));
      lifts.push_back(std::move(lift));
    }
  return lifts;
}

/// Carries the diameter from -1 to 1 to an axis, and 0 to its point nearest to 0.
Su11 frameOf(const Axis& axis) {
  // The point (1, 0) + time (time, space) of Minkowski space, of norm 1 + time^2.
  const double norm = std::hypot(1.0, axis.time);
  const Complex foot = axis.time * axis.space / (norm * (1 + norm));
  const Su11 move = translationTo(foot);
  return move * rotation(std::arg(imageOf(inverse(move), axis).space) - kPi / 2);
}

/// The signed distances of the image of 0 along the diameter and from it, positive above.
double alongDiameter(const Su11& g) {
  const double time = std::norm(g.a) + std::norm(g.b);
  const double x = 2 * std::real(g.a * g.b);
  return std::log((time + x) / (time - x)) / 2;
}
double aboveDiameter(const Su11& g) {
  return std::asinh(2 * std::imag(g.a * g.b));
}

/// Whether axes a and b, which do not cross, lie on different sides of `between`: 0 is on a.
bool liesBetween(const Axis& between, const Axis& b) {
  const double time = 1 + b.time * b.time;
  const double beyond =
      std::real(between.space * std::conj(b.space)) * b.time - between.time * time;
  return (beyond > 0) != (between.time < 0);
}

/// The seam from a side to another: its foot along the diameter, and its length.
struct Seam {
  double foot = 0;
  double length = std::numeric_limits<double>::infinity();
};

/// Looks for the seams on one side of a curve.
class SeamSearch {
 public:
  SeamSearch(const OrbitPolygon& polygon, const std::vector<Lift>& lifts, std::size_t sides)
      : polygon_(polygon), lifts_(lifts), seams_(sides) {}

  /// frame: of the axis, with the side above the diameter. Fails like the context, or with
  /// kResidualTooLarge where two other sides are not found.
  Status run(Context& context, int side, const Su11& frame, double length);

  const std::vector<Seam>& seams() const { return seams_; }
  /// The two sides with the nearest axes.
  std::array<int, 2> neighbours() const;

 private:
  struct Copy {
    double above = 0;
    Su11 map;
    bool operator>(const Copy& other) const { return above > other.above; }
  };
  /// An axis as it is seen in the frame, and on which of its sides (+1: left) the pants lie.
  struct Seen {
    Axis axis;
    int wanted = 0;
    bool is_own = false;
  };

  Seen see(const Lift& lift, const Su11& copy) const;
  void note(const std::vector<Seen>& seen);
  void enter(const Su11& copy, OrbitIndex& known);

  const OrbitPolygon& polygon_;
  const std::vector<Lift>& lifts_;
  std::vector<Seam> seams_;
  std::priority_queue<Copy, std::vector<Copy>, std::greater<>> next_;
  int side_ = 0;
  double length_ = 0;
};

SeamSearch::Seen SeamSearch::see(const Lift& lift, const Su11& copy) const {
  Seen seen{imageOf(copy, lift.axis), 0, false};
  seen.is_own = lift.curve == side_ / 2 && std::abs(seen.axis.time) < 1e-6 &&
                std::abs(seen.axis.space.real()) < 1e-6;
  if (seen.is_own)
    seen.wanted = side_ % 2 == 0 ? 1 : -1;
  else
    seen.wanted = seen.axis.time < 0 ? 1 : -1;
  return seen;
}

void SeamSearch::note(const std::vector<Seen>& seen) {
  for (std::size_t i = 0; i < lifts_.size(); ++i) {
    const Axis& axis = seen[i].axis;
    if (seen[i].is_own || !lifts_[i].passes || axis.time * axis.space.imag() <= 0) continue;
    const int side = 2 * lifts_[i].curve + (seen[i].wanted > 0 ? 0 : 1);
    if (side == side_) continue;
    const double turn = std::abs(axis.space.real());
    const double time = std::abs(axis.time);
    const double length = std::asinh(std::sqrt(std::max(0.0, (time - turn) * (time + turn))));
    if (length >= seams_[side].length) continue;
    const bool hidden = std::any_of(seen.begin(), seen.end(), [&](const Seen& other) {
      return !other.is_own && &other != &seen[i] && liesBetween(other.axis, axis);
    });
    if (!hidden) seams_[side] = {footOnDiameter(axis), length};
  }
}

void SeamSearch::enter(const Su11& copy, OrbitIndex& known) {
  const double turns = std::floor(alongDiameter(copy) / length_);
  const Su11 moved = renormalized(translation(-turns * length_) * copy);
  if (known.find(moved) >= 0) return;
  known.enter(moved, 0);
  next_.push({aboveDiameter(moved), moved});
}

std::array<int, 2> SeamSearch::neighbours() const {
  std::array<int, 2> best{0, 1};
  if (seams_[1].length < seams_[0].length) std::swap(best[0], best[1]);
  for (int side = 2; side < static_cast<int>(seams_.size()); ++side) {
    if (seams_[side].length < seams_[best[1]].length) best[1] = side;
    if (seams_[best[1]].length < seams_[best[0]].length) std::swap(best[0], best[1]);
  }
  return best;
}

Status SeamSearch::run(Context& context, int side, const Su11& frame, double length) {
  side_ = side;
  length_ = length;
  OrbitIndex known(polygon_.separation);
  enter(inverse(frame), known);
  std::vector<Seen> seen(lifts_.size());
  for (std::size_t count = 0; !next_.empty() && count < kMostCopies; ++count) {
    if (count % 64 == 0) RETURN_IF_ERROR(context.check());
    const Copy copy = next_.top();
    next_.pop();
    if (copy.above - polygon_.radius > seams_[neighbours()[1]].length) return {};
    for (std::size_t i = 0; i < lifts_.size(); ++i) seen[i] = see(lifts_[i], copy.map);
    note(seen);
    for (std::size_t s = 0; s < polygon_.pairings.size(); ++s) {
      bool beyond = false;
      for (std::size_t i = 0; i < lifts_.size() && !beyond; ++i)
        beyond = lifts_[i].side[s] == -seen[i].wanted;
      if (!beyond) enter(copy.map * polygon_.pairings[s].map, known);
    }
  }
  if (std::isfinite(seams_[neighbours()[1]].length)) return {};
  return {Reason::kResidualTooLarge, "the pants beside a curve were not found"};
}

/// Per side the seams to other sides and the two sides that are nearest.
struct SideSeams {
  std::vector<Seam> seams;
  std::array<int, 2> neighbours{};
};

Result<std::vector<SideSeams>> searchSides(Context& context, const OrbitPolygon& polygon,
                                           const std::vector<ClosedGeodesic>& curves) {
  const std::vector<Lift> lifts = liftsOf(polygon, curves);
  std::vector<SideSeams> result;
  for (std::size_t side = 0; side < 2 * curves.size(); ++side) {
    const ClosedGeodesic& curve = curves[side / 2];
    const Su11 along = frameOf(axisOf(curve.element));
    const Su11 frame = side % 2 == 0 ? along : along * rotation(kPi);
    SeamSearch search(polygon, lifts, 2 * curves.size());
    RETURN_IF_ERROR(search.run(context, static_cast<int>(side), frame, curve.length));
    result.push_back({search.seams(), search.neighbours()});
  }
  return result;
}

/// Each side with its neighbours; fails unless these agree.
Result<std::vector<std::array<int, 3>>> gatherPants(const std::vector<SideSeams>& sides) {
  std::vector<std::array<int, 3>> triples;
  for (std::size_t side = 0; side < sides.size(); ++side) {
    const auto& near = sides[side].neighbours;
    std::array<int, 3> triple{static_cast<int>(side), near[0], near[1]};
    std::sort(triple.begin(), triple.end());
    triples.push_back(triple);
  }
  std::vector<std::array<int, 3>> pants;
  for (std::size_t side = 0; side < sides.size(); ++side) {
    for (const int other : triples[side])
      if (triples[other] != triples[side])
        return Status(Reason::kResidualTooLarge, "the sides of curves do not make pairs of pants");
    if (triples[side][0] == static_cast<int>(side)) pants.push_back(triples[side]);
  }
  return pants;
}

bool anyEqual(const std::vector<Axis>& a, const std::vector<Axis>& b) {
  for (const Axis& x : a)
    for (const Axis& y : b)
      if (std::abs(std::abs(product(x, y)) - 1) < 1e-8) return true;
  return false;
}

Status needDisjoint(const OrbitPolygon& polygon, const std::vector<ClosedGeodesic>& curves) {
  if (curves.size() != static_cast<std::size_t>(3 * polygon.genus - 3))
    return {Reason::kInvalidOption, "genus " + std::to_string(polygon.genus) +
                                        " is cut into pants by " +
                                        std::to_string(3 * polygon.genus - 3) + " curves, not " +
                                        std::to_string(curves.size())};
  std::vector<Axis> chosen;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const std::vector<Axis> axes = axesAcross(polygon, curves[i].element);
    if (anyCross(axes, axes) || anyCross(axes, chosen) || anyEqual(axes, chosen))
      return {Reason::kInvalidOption,
              "curve " + std::to_string(i) + " meets itself or one before it"};
    chosen.insert(chosen.end(), axes.begin(), axes.end());
  }
  return {};
}

}  // namespace

std::vector<Axis> axesAcross(const OrbitPolygon& polygon, const Su11& element) {
  std::vector<Axis> axes;
  for (const Su11& g : conjugatesAcross(polygon, element, kPassing)) axes.push_back(axisOf(g));
  return axes;
}

bool anyCross(const std::vector<Axis>& a, const std::vector<Axis>& b) {
  constexpr double kCosine = 1 - 5e-9;
  for (const Axis& x : a)
    for (const Axis& y : b)
      if (std::abs(product(x, y)) < kCosine) return true;
  return false;
}

Result<FenchelNielsenReading> fenchelNielsen(Context& context, const OrbitPolygon& polygon,
                                             const std::vector<ClosedGeodesic>& curves) {
  const Context::Stage stage(context, "pants");
  RETURN_IF_ERROR(needDisjoint(polygon, curves));
  ASSIGN_OR_RETURN(const std::vector<SideSeams> sides, searchSides(context, polygon, curves));
  FenchelNielsenReading reading;
  FenchelNielsen& coordinates = reading.coordinates;
  coordinates.genus = polygon.genus;
  ASSIGN_OR_RETURN(coordinates.pants, gatherPants(sides));
  for (const ClosedGeodesic& curve : curves) coordinates.lengths.push_back(curve.length);
  std::vector<double> marked(sides.size());
  for (const auto& pants : coordinates.pants) {
    std::array<double, 3> cuffs{};
    for (int k = 0; k < 3; ++k) cuffs[k] = coordinates.lengths[pants[k] / 2];
    ASSIGN_OR_RETURN(const auto seams, pantsSeams(cuffs));
    for (int k = 0; k < 3; ++k) {
      const Seam& seam = sides[pants[k]].seams[pants[(k + 1) % 3]];
      const double expected = seams[(k + 2) % 3];
      marked[pants[k]] = seam.foot;
      reading.seam_error =
          std::max(reading.seam_error, std::abs(seam.length - expected) / (1 + expected));
    }
  }
  if (!(reading.seam_error < kSeamTolerance))
    return Status(Reason::kResidualTooLarge, "seams differ by " +
                                                 std::to_string(reading.seam_error) +
                                                 " from what the lengths of the curves make them");
  for (std::size_t i = 0; i < curves.size(); ++i)
    coordinates.twists.push_back(
        normalizedTwist(-marked[2 * i + 1] - marked[2 * i], curves[i].length));
  return reading;
}

}  // namespace moduli
