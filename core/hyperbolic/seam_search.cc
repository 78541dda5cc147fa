#include "core/hyperbolic/seam_search.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <queue>
#include <string>
#include <unordered_map>

#include "core/hyperbolic/polygon_copies.h"

namespace moduli {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr std::size_t kMostParts = 1'000'000;

/// An edge of a part may miss a strip by this, as sinh of distance.
constexpr double kTouching = 1e-6;

/// Lengths of one seam as seen from several copies differ by less, relative to 1 + length.
constexpr double kSameSeam = 1e-4;

/// Where the middle of an edge on an axis is along the diameter, which g carries the axis to.
double footOf(const Su11& g, const PartEdge& edge) {
  const Point start = imageOf(g, edge.from);
  return std::asinh(start.space.real()) + edge.length / 2;
}

/// The sinh of the distance of an edge from an axis that does not cross it.
double heightOf(const PartEdge& edge, const Axis& axis) {
  // Along the edge it is x cosh t + y sinh t.
  const double x = sideOfPoint(axis, edge.from);
  const double y = product(axis, edge.across);
  const double end = x * std::cosh(edge.length) + y * std::sinh(edge.length);
  const double least = std::min(std::abs(x), std::abs(end));
  const double t = std::abs(y) < std::abs(x) ? std::atanh(-y / x) : -1;
  if (t <= 0 || t >= edge.length) return least;
  return std::min(least, std::sqrt((x - y) * (x + y)));
}

/// The points of the plane whose feet on the diameter are within a span.
class Strip {
 public:
  Strip(double from, double to)
      : from_{std::sinh(from), std::cosh(from)}, to_{-std::sinh(to), -std::cosh(to)} {}

  Strip seenFrom(const PolygonCopies& copies, std::int32_t copy) const {
    return {copies.seenFrom(copy, from_), copies.seenFrom(copy, to_)};
  }

  /// Up to rounding: feet of points on an edge go one way.
  bool meets(const PartEdge& edge) const {
    const auto misses = [&](const Axis& axis) {
      const double rounding = 1e-14 * std::abs(axis.time) * std::max(edge.from.time, edge.to.time);
      const double slack = -kTouching - rounding;
      return sideOfPoint(axis, edge.from) < slack && sideOfPoint(axis, edge.to) < slack;
    };
    return !misses(from_) && !misses(to_);
  }

 private:
  Strip(const Axis& from, const Axis& to) : from_(from), to_(to) {}

  Axis from_, to_;
};

/// A seam, and 1e16 times what rounding may have made of it.
struct Sight {
  Seam seam;
  double rounding = std::numeric_limits<double>::infinity();
};

class SeamSearch {
 public:
  SeamSearch(const OrbitPolygon& polygon, const CutSurface& cut, int side, const SeamStart& start,
             double length)
      : cut_(cut),
        side_(side),
        start_(start),
        strip_(start.foot - length / 2, start.foot + length / 2),
        copies_(polygon, inverse(start.frame) * start.copy) {}

  Result<std::vector<Seam>> run(Context& context);

 private:
  /// A part of a copy of the polygon, and sinh of how far from the diameter it was entered.
  struct Step {
    double height = 0;
    std::int32_t copy = 0;
    int part = 0;
    bool operator>(const Step& other) const { return height > other.height; }
  };

  std::int64_t keyOf(std::int32_t copy, int part) const {
    return copy * static_cast<std::int64_t>(cut_.parts.size()) + part;
  }
  void enter(std::int32_t copy, int part, double height);
  void note(const PartEdge& edge, const Axis& diameter, const Axis& tangent);
  void leave(const Step& step);
  double longest() const;
  std::vector<Seam> seams() const;

  const CutSurface& cut_;
  int side_;
  const SeamStart& start_;
  Strip strip_;
  PolygonCopies copies_;
  std::unordered_map<std::int64_t, double> heights_;  ///< Per part of a copy the least so far.
  std::priority_queue<Step, std::vector<Step>, std::greater<>> next_;
  std::vector<int> wanted_;  ///< The other sides.
  std::vector<Sight> seams_;
};

void SeamSearch::enter(std::int32_t copy, int part, double height) {
  const auto [least, is_new] = heights_.try_emplace(keyOf(copy, part), height);
  if (!is_new && least->second <= height) return;
  least->second = height;
  next_.push({height, copy, part});
}

/// diameter, tangent: in the copy's coordinates, where they are not as far off as the cuff is in
/// the frame; the tangent is the normal of the perpendicular at the frame's 0.
void SeamSearch::note(const PartEdge& edge, const Axis& diameter, const Axis& tangent) {
  if (edge.cuff == side_) return;
  const double cosine = std::abs(product(edge.line, diameter));
  const double sine = std::sqrt(std::max(0.0, (cosine - 1) * (cosine + 1)));
  const double length = std::asinh(sine);
  // The same cuff is seen from many copies, from far ones less well.
  Sight& best = seams_[edge.cuff];
  const double rounding = std::abs(edge.line.time * diameter.time);
  const double slack = kSameSeam * (1 + length);
  const bool nearer = length < best.seam.length - slack;
  if (!nearer && (length > best.seam.length + slack || rounding >= best.rounding)) return;
  // With the pants on its left, the cuff's normal in the frame points back to the diameter.
  best = {{std::asinh(-product(edge.line, tangent) / sine), length}, rounding};
}

double SeamSearch::longest() const {
  double length = 0;
  for (const int side : wanted_) length = std::max(length, seams_[side].seam.length);
  return length;
}

std::vector<Seam> SeamSearch::seams() const {
  std::vector<Seam> result;
  for (const Sight& sight : seams_) result.push_back(sight.seam);
  return result;
}

/// Looks at the sides of a part and what is beyond those that meet the strip.
void SeamSearch::leave(const Step& step) {
  const Axis diameter = copies_.seenFrom(step.copy, {0, {0, 1}});
  const Axis tangent = copies_.seenFrom(step.copy, {0, 1});
  const Strip strip = strip_.seenFrom(copies_, step.copy);
  for (const PartEdge& edge : cut_.parts[step.part].edges) {
    if (edge.cuff >= 0)
      note(edge, diameter, tangent);
    else if (edge.part >= 0 && strip.meets(edge))
      enter(copies_.beyond(step.copy, edge.pairing), edge.part, heightOf(edge, diameter));
  }
}

Result<std::vector<Seam>> SeamSearch::run(Context& context) {
  std::size_t sides = 0;
  for (const SurfacePiece& piece : cut_.pieces) sides += piece.cuffs.size();
  seams_.assign(sides, {});
  wanted_ = cut_.pieces[cut_.parts[start_.part].piece].cuffs;
  std::erase(wanted_, side_);
  enter(0, start_.part, 0);
  for (std::size_t count = 0; !next_.empty() && count < kMostParts; ++count) {
    if (count % 256 == 0) RETURN_IF_ERROR(context.check());
    const Step step = next_.top();
    next_.pop();
    if (step.height > heights_[keyOf(step.copy, step.part)]) continue;
    if (std::asinh(step.height) > longest() * (1 + kSameSeam) + kSameSeam) return seams();
    leave(step);
  }
  if (next_.empty() && std::isfinite(longest())) return seams();
  return Status(Reason::kResidualTooLarge,
                "the pants on side " + std::to_string(side_) + " of the curves were not found");
}

}  // namespace

Result<std::vector<SeamStart>> seamStarts(const OrbitPolygon& polygon, const CutSurface& cut,
                                          std::size_t curves) {
  std::vector<SeamStart> starts(2 * curves);
  std::vector<double> longest(curves, 0);
  for (std::size_t k = 0; k < cut.parts.size(); ++k)
    for (const PartEdge& edge : cut.parts[k].edges) {
      if (edge.cuff < 0 || edge.cuff % 2 != 0 || edge.part < 0) continue;
      if (cut.parts[k].piece < 0 || cut.parts[edge.part].piece < 0) continue;
      const int curve = edge.cuff / 2;
      if (edge.length <= longest[curve]) continue;
      longest[curve] = edge.length;
      const Su11 frame = frameOf(edge.line);
      const Su11 beyond = edge.pairing < 0 ? Su11{} : polygon.pairings[edge.pairing].map;
      const double foot = footOf(inverse(frame), edge);
      starts[2 * curve] = {frame, foot, Su11{}, static_cast<int>(k)};
      starts[2 * curve + 1] = {frame * rotation(kPi), -foot, beyond, edge.part};
    }
  for (std::size_t i = 0; i < curves; ++i)
    if (longest[i] == 0)
      return Status(Reason::kResidualTooLarge,
                    "curve " + std::to_string(i) + " does not separate parts of the polygon");
  return starts;
}

Result<std::vector<Seam>> findSeams(Context& context, const OrbitPolygon& polygon,
                                    const CutSurface& cut, int side, const SeamStart& start,
                                    double length) {
  return SeamSearch(polygon, cut, side, start, length).run(context);
}

}  // namespace moduli
