#include "core/hyperbolic/piece_search.h"

#include <algorithm>
#include <cmath>
#include <unordered_set>
#include <utility>

#include "core/hyperbolic/polygon_copies.h"

namespace moduli {
namespace {

/// Of the disks: the work in each grows like e^{2 r}, their number like e^{-r} and faster.
constexpr double kDiskRadius = 0.7;
/// What touches a disk or the polygon may miss it by rounding.
constexpr double kTouching = 1e-6;

struct Farthest {
  std::size_t i = 0, j = 0;
  double distance = 0;
};

Farthest farthestOf(const std::vector<Point>& corners) {
  Farthest found;
  double most = -1;
  for (std::size_t i = 0; i < corners.size(); ++i)
    for (std::size_t j = i + 1; j < corners.size(); ++j) {
      const double cosine = distanceCosine(corners[i], corners[j]);
      if (cosine <= most) continue;
      most = cosine;
      found = {i, j, 0};
    }
  found.distance = distanceOf(corners[found.i], corners[found.j]);
  return found;
}

/// What is nearer to p than to q.
std::vector<Point> nearer(const std::vector<Point>& corners, const Point& p, const Point& q) {
  std::vector<Point> result;
  const auto gap = [&](const Point& x) { return distanceCosine(q, x) - distanceCosine(p, x); };
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Point& from = corners[i];
    const Point& to = corners[(i + 1) % corners.size()];
    const double a = gap(from);
    const double b = gap(to);
    if (a >= 0) result.push_back(from);
    if (a * b >= 0) continue;
    const double t = a / (a - b);
    result.push_back(normalized(
        {from.time + t * (to.time - from.time), from.space + t * (to.space - from.space)}));
  }
  return result;
}

struct Collar {
  Axis axis;
  double width = 0;
};

bool inCollar(const std::vector<Collar>& collars, const Point& centre, double radius) {
  return std::any_of(collars.begin(), collars.end(), [&](const Collar& collar) {
    return std::asinh(std::abs(sideOfPoint(collar.axis, centre))) + radius <
           collar.width - kTouching;
  });
}

/// Halves a convex polygon across its diameter until disks cover it.
void cover(std::vector<Point> first, int part, const std::vector<Collar>& collars,
           std::vector<SearchDisk>& disks) {
  std::vector<std::vector<Point>> next{std::move(first)};
  while (!next.empty()) {
    const std::vector<Point> corners = std::move(next.back());
    next.pop_back();
    if (corners.size() < 2) continue;
    const Farthest far = farthestOf(corners);
    const Point& p = corners[far.i];
    const Point& q = corners[far.j];
    const Point centre = normalized({p.time + q.time, p.space + q.space});
    double radius = 0;
    for (const Point& corner : corners) radius = std::max(radius, distanceOf(centre, corner));
    if (inCollar(collars, centre, radius)) continue;
    if (radius <= kDiskRadius || far.distance < kDiskRadius) {
      disks.push_back({centre, radius, part});
      continue;
    }
    next.push_back(nearer(corners, p, q));
    next.push_back(nearer(corners, q, p));
  }
}

/// Carries 0 to the point, along the straight line.
Su11 moveTo(const Point& point) {
  const double a = std::sqrt((1 + point.time) / 2);
  return {a, point.space / (2 * a)};
}

/// A part of a copy of the polygon, as the way to it.
struct Step {
  std::int32_t from = 0, pairing = 0, copy = 0, part = 0;
};

/// Looks around one disk.
class DiskSearch {
 public:
  DiskSearch(const OrbitPolygon& polygon, const CutSurface& cut, const SearchDisk& disk,
             double above, double upto)
      : cut_(cut),
        disk_(disk),
        move_(moveTo(disk.centre)),
        above_(above),
        upto_(upto),
        sine_(std::cosh(disk.radius) * std::sinh(upto / 2) * (1 + kTouching)),
        cosine_((1 + 2 * sine_ * sine_) * (1 + kTouching)),
        copies_(polygon, inverse(move_)) {}

  /// Looks at no more than `most` parts; false: these did not suffice.
  Result<bool> run(Context& context, std::size_t most,
                   std::vector<std::vector<std::int32_t>>& found);
  std::size_t visited() const { return steps_.size(); }

 private:
  void enter(const Step& step);
  void note(std::int32_t i, std::vector<std::vector<std::int32_t>>& found) const;

  const CutSurface& cut_;
  const SearchDisk& disk_;
  const Su11 move_;
  double above_, upto_;
  double sine_;           ///< sinh of half of how far the point may be moved.
  double cosine_;         ///< cosh of all of it.
  PolygonCopies copies_;  ///< As seen from the point: move^-1 g.
  std::vector<Step> steps_;
  std::unordered_set<std::int64_t> entered_;
};

void DiskSearch::enter(const Step& step) {
  const auto parts = static_cast<std::int64_t>(cut_.parts.size());
  if (entered_.insert(step.copy * parts + step.part).second) steps_.push_back(step);
}

void DiskSearch::note(std::int32_t i, std::vector<std::vector<std::int32_t>>& found) const {
  const Step& step = steps_[i];
  if (step.part != disk_.part || step.copy == 0) return;
  const Su11 seen = copies_.map(step.copy) * move_;
  if (std::norm(seen.b) > sine_ * sine_) return;
  const double length = translationLength(seen);
  if (length <= above_ || length > upto_) return;
  if (std::abs(axisOf(seen).time) > std::sinh(disk_.radius) * (1 + kTouching) + kTouching) return;
  std::vector<std::int32_t> pairings;
  for (std::int32_t k = i; k > 0; k = steps_[k].from) pairings.push_back(steps_[k].pairing);
  std::reverse(pairings.begin(), pairings.end());
  found.push_back(std::move(pairings));
}

Result<bool> DiskSearch::run(Context& context, std::size_t most,
                             std::vector<std::vector<std::int32_t>>& found) {
  enter({0, 0, 0, disk_.part});
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    if (i % 1024 == 0) RETURN_IF_ERROR(context.check());
    if (steps_.size() > most) return false;
    note(static_cast<std::int32_t>(i), found);
    const Step step = steps_[i];
    const Point point = imageOf(inverse(copies_.map(step.copy)), Point{});
    for (const PartEdge& edge : cut_.parts[step.part].edges)
      if (edge.cuff < 0 && edge.part >= 0 && distanceCosine(edge, point) <= cosine_)
        enter({static_cast<std::int32_t>(i), edge.pairing, copies_.beyond(step.copy, edge.pairing),
               edge.part});
  }
  return true;
}

}  // namespace

std::vector<SearchDisk> coverPieces(const CutSurface& cut, const Cuts& cuts) {
  std::vector<Collar> collars;
  for (std::size_t i = 0; i < cuts.lifts.size(); ++i)
    for (const Axis& axis : cuts.lifts[i])
      collars.push_back({axis, std::asinh(1 / std::sinh(cuts.lengths[i] / 2))});
  std::vector<SearchDisk> disks;
  for (std::size_t k = 0; k < cut.parts.size(); ++k) {
    const PolygonPart& part = cut.parts[k];
    if (part.piece >= 0 && cut.pieces[part.piece].missing() > 0)
      cover(part.corners, static_cast<int>(k), collars, disks);
  }
  return disks;
}

Result<PieceElements> searchPieces(Context& context, const OrbitPolygon& polygon,
                                   const CutSurface& cut, const std::vector<SearchDisk>& disks,
                                   double above, double upto, std::size_t most) {
  PieceElements result;
  for (const SearchDisk& disk : disks) {
    DiskSearch search(polygon, cut, disk, above, upto);
    ASSIGN_OR_RETURN(const bool complete,
                     search.run(context, most - result.visited, result.elements));
    result.visited += search.visited();
    if (!complete || result.visited > most) return result;
  }
  result.complete = true;
  return result;
}

}  // namespace moduli
