#include "core/hyperbolic/cut_surface.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <string>
#include <utility>

namespace moduli {
namespace {

constexpr double kPi = 3.14159265358979323846;
/// A corner this near to a cut, in sinh of distance, is on it: corners at distance r are right to
/// 1e-16 e^{2 r}.
constexpr double kOnCut = 1e-7;
/// Shorter edges are corners that rounding took apart; nothing is beyond them.
constexpr double kShortEdge = 1e-5;
/// The ends of cuts that sides of the polygon meet at small angles are on them or not by rounding.
constexpr double kWholeCut = 1e-3;
/// Areas of pieces are multiples of 2 pi to this; parts that make no more are slivers.
constexpr double kAreaTolerance = 1e-4;

struct Lift {
  Axis axis;
  int curve = 0;
};

/// What an edge lies on: the side of the polygon, or the lift ~on.
using Border = int;

/// A part while the polygon is cut.
struct Scrap {
  std::vector<Point> corners;
  std::vector<Border> on;  ///< Per edge.
};

double onCut(const Axis& axis, const Point& point) {
  const double side = sideOfPoint(axis, point);
  return std::abs(side) < kOnCut ? 0 : side;
}

Point between(const Point& p, const Point& q, double t) {
  return normalized({p.time + t * (q.time - p.time), p.space + t * (q.space - p.space)});
}

/// What is on the left of a cut that passes the scrap. above: per corner its side, 0 on the cut.
Scrap leftOf(const Scrap& scrap, const std::vector<double>& above, int lift) {
  Scrap left;
  const std::size_t n = scrap.corners.size();
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t j = (i + 1) % n;
    const bool leaves = above[i] >= 0 && above[j] < 0;
    if (above[i] >= 0) {
      left.corners.push_back(scrap.corners[i]);
      left.on.push_back(leaves && above[i] == 0 ? ~lift : scrap.on[i]);
    }
    if (above[i] * above[j] >= 0) continue;
    const double t = above[i] / (above[i] - above[j]);
    left.corners.push_back(between(scrap.corners[i], scrap.corners[j], t));
    left.on.push_back(leaves ? ~lift : scrap.on[i]);
  }
  return left;
}

std::vector<Scrap> cutAlong(const std::vector<Scrap>& scraps, const Axis& axis, int lift) {
  std::vector<Scrap> result;
  for (const Scrap& scrap : scraps) {
    std::vector<double> above;
    for (const Point& corner : scrap.corners) above.push_back(onCut(axis, corner));
    const auto [least, most] = std::minmax_element(above.begin(), above.end());
    if (*least >= 0 || *most <= 0) {
      result.push_back(scrap);
      continue;
    }
    result.push_back(leftOf(scrap, above, lift));
    for (double& side : above) side = -side;
    result.push_back(leftOf(scrap, above, lift));
  }
  return result;
}

/// The axis from one point to another, and the one through the first at a right angle to it, with
/// the second on its left.
struct Frame {
  Axis line, across;
};

Frame frameAt(const Point& from, const Point& to) {
  // The tangent of the way at `from`: what remains of the chord at a right angle to `from`.
  const double time = to.time - from.time;
  const Complex space = to.space - from.space;
  const double along = std::real(space * std::conj(from.space)) - time * from.time;
  Axis tangent{time + along * from.time, space + along * from.space};
  const double norm = std::sqrt(std::norm(tangent.space) - tangent.time * tangent.time);
  tangent = {tangent.time / norm, tangent.space / norm};
  // The Minkowski cross product of both: at right angles to both.
  const Complex i(0, 1);
  const Axis normal{std::imag(from.space * std::conj(tangent.space)),
                    i * (from.time * tangent.space - tangent.time * from.space)};
  return {normal, tangent};
}

PartEdge edgeBetween(const Point& from, const Point& to) {
  PartEdge edge{};
  edge.length = distanceOf(from, to);
  edge.from = from;
  edge.to = to;
  edge.span = std::tanh(edge.length);
  if (edge.length > 0) {
    const Frame frame = frameAt(from, to);
    edge.line = frame.line;
    edge.across = frame.across;
  }
  return edge;
}

Point middleOf(const std::vector<Point>& points) {
  Point sum{0, 0};
  for (const Point& p : points) sum = {sum.time + p.time, sum.space + p.space};
  return normalized(sum);
}

double areaOf(const PolygonPart& part) {
  double area = 0;
  for (std::size_t i = 0; i < part.corners.size(); ++i) {
    const Complex p = inDisk(part.corners[i]);
    const Complex q = inDisk(part.corners[(i + 1) % part.corners.size()]);
    area -= 2 * std::arg(1.0 - std::conj(p) * q);
  }
  return area;
}

/// The lift that an edge runs along, where one does.
int liftAlong(const std::vector<Lift>& lifts, const Point& from, const Point& to) {
  for (std::size_t i = 0; i < lifts.size(); ++i)
    if (std::abs(sideOfPoint(lifts[i].axis, from)) < 2 * kOnCut &&
        std::abs(sideOfPoint(lifts[i].axis, to)) < 2 * kOnCut)
      return static_cast<int>(i);
  return -1;
}

PolygonPart partOf(const Scrap& scrap, const std::vector<Lift>& lifts) {
  PolygonPart part{scrap.corners, {}, -1};
  const Point middle = middleOf(part.corners);
  const std::size_t n = part.corners.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Point& from = part.corners[i];
    const Point& to = part.corners[(i + 1) % n];
    PartEdge edge = edgeBetween(from, to);
    int lift = scrap.on[i] < 0 ? ~scrap.on[i] : -1;
    if (lift < 0 && edge.length > kShortEdge) lift = liftAlong(lifts, from, to);
    if (lift >= 0) {
      const Axis& axis = lifts[lift].axis;
      const bool left = sideOfPoint(axis, middle) > 0;
      edge.cuff = 2 * lifts[lift].curve + (left ? 0 : 1);
      // Corners of short edges know it less well.
      edge.line = left ? axis : Axis{-axis.time, -axis.space};
    }
    part.edges.push_back(edge);
  }
  return part;
}

/// What an edge covers of a side of the polygon, measured from the side's first corner.
struct Span {
  std::size_t part = 0, edge = 0;
  double from = 0, to = 0;
};

/// Per side of the polygon the edges on it.
std::vector<std::vector<Span>> spansOf(const OrbitPolygon& polygon,
                                       const std::vector<Scrap>& scraps,
                                       const std::vector<PolygonPart>& parts) {
  std::vector<std::vector<Span>> spans(polygon.corners.size());
  for (std::size_t k = 0; k < parts.size(); ++k)
    for (std::size_t i = 0; i < parts[k].edges.size(); ++i) {
      const PartEdge& edge = parts[k].edges[i];
      const Border side = scraps[k].on[i];
      if (side < 0 || edge.length < kShortEdge) continue;
      const double start = distanceOf(pointAt(polygon.corners[side]), edge.from);
      spans[side].push_back({k, i, start, start + edge.length});
    }
  return spans;
}

/// The side with the inverse pairing; -1 where rounding left none.
int partnerOf(const OrbitPolygon& polygon, std::size_t side) {
  const Su11 back = inverse(polygon.pairings[polygon.sides[side]].map);
  for (std::size_t other = 0; other < polygon.sides.size(); ++other)
    if (sameElement(polygon.pairings[polygon.sides[other]].map, back))
      return static_cast<int>(other);
  return -1;
}

double lengthOf(const OrbitPolygon& polygon, std::size_t side) {
  return distanceOf(pointAt(polygon.corners[side]),
                    pointAt(polygon.corners[(side + 1) % polygon.corners.size()]));
}

/// Across a cut within the polygon.
void findPartsBeyondCuts(const std::vector<Scrap>& scraps, std::vector<PolygonPart>& parts) {
  for (std::size_t k = 0; k < parts.size(); ++k)
    for (std::size_t i = 0; i < parts[k].edges.size(); ++i) {
      if (scraps[k].on[i] >= 0) continue;
      for (std::size_t other = 0; other < parts.size(); ++other)
        for (std::size_t j = 0; other != k && j < parts[other].edges.size(); ++j)
          if (scraps[other].on[j] == scraps[k].on[i])
            parts[k].edges[i].part = static_cast<int>(other);
    }
}

/// Sides are put together backwards.
Status findPartners(const OrbitPolygon& polygon, const std::vector<Scrap>& scraps,
                    std::vector<PolygonPart>& parts) {
  const auto spans = spansOf(polygon, scraps, parts);
  for (std::size_t side = 0; side < spans.size(); ++side) {
    const int partner = partnerOf(polygon, side);
    for (const Span& span : spans[side]) {
      PartEdge& edge = parts[span.part].edges[span.edge];
      edge.pairing = polygon.sides[side];
      const double place = lengthOf(polygon, side) - (span.from + span.to) / 2;
      for (std::size_t k = 0; partner >= 0 && k < spans[partner].size(); ++k)
        if (spans[partner][k].from < place && place < spans[partner][k].to)
          edge.part = static_cast<int>(spans[partner][k].part);
      if (edge.part < 0 && edge.cuff < 0 && edge.length > 100 * kShortEdge)
        return {Reason::kResidualTooLarge, "the sides of the polygon do not fit together"};
    }
  }
  return {};
}

/// Numbers the connected sets of parts. Returns their areas.
std::vector<double> numberPieces(std::vector<PolygonPart>& parts) {
  std::vector<double> areas;
  for (std::size_t root = 0; root < parts.size(); ++root) {
    if (parts[root].piece >= 0) continue;
    const int piece = static_cast<int>(areas.size());
    areas.push_back(0);
    std::vector<std::size_t> next{root};
    parts[root].piece = piece;
    while (!next.empty()) {
      const PolygonPart& part = parts[next.back()];
      next.pop_back();
      areas.back() += areaOf(part);
      for (const PartEdge& edge : part.edges) {
        if (edge.cuff >= 0 || edge.part < 0 || parts[edge.part].piece >= 0) continue;
        parts[edge.part].piece = piece;
        next.push_back(static_cast<std::size_t>(edge.part));
      }
    }
  }
  return areas;
}

Status misfit(const std::string& what) {
  return {Reason::kResidualTooLarge, "the surface is not cut into surfaces: " + what};
}

/// Fails unless the cuts along both sides of every curve are as long as it is: where an axis is
/// missing, one piece may hang together across the curve, and nothing else shows it.
Status needWholeCuts(const std::vector<PolygonPart>& parts, const std::vector<double>& lengths) {
  std::vector<double> sums(2 * lengths.size(), 0);
  for (const PolygonPart& part : parts)
    for (const PartEdge& edge : part.edges)
      if (edge.cuff >= 0 && part.piece >= 0) sums[edge.cuff] += edge.length;
  for (std::size_t side = 0; side < sums.size(); ++side)
    if (std::abs(sums[side] - lengths[side / 2]) > kWholeCut * (1 + lengths[side / 2]))
      return misfit("a curve of length " + std::to_string(lengths[side / 2]) + " is cut along " +
                    std::to_string(sums[side]));
  return {};
}

/// The topology of a piece of this area. chi: 2 - 2 genus - cuffs, -area / 2 pi.
Result<SurfacePiece> pieceOf(double area, std::vector<int> cuffs) {
  std::sort(cuffs.begin(), cuffs.end());
  cuffs.erase(std::unique(cuffs.begin(), cuffs.end()), cuffs.end());
  const auto turns = static_cast<int>(std::lround(area / (2 * kPi)));
  const int doubled = turns + 2 - static_cast<int>(cuffs.size());
  if (std::abs(area - 2 * kPi * turns) > kAreaTolerance || doubled < 0 || doubled % 2 != 0)
    return misfit("one with " + std::to_string(cuffs.size()) + " cuffs has the area 2 pi times " +
                  std::to_string(area / (2 * kPi)));
  return SurfacePiece{doubled / 2, std::move(cuffs)};
}

}  // namespace

double distanceCosine(const PartEdge& edge, const Point& point) {
  const double start = distanceCosine(edge.from, point);
  const double foot = sideOfPoint(edge.across, point) / start;  // tanh of where it is.
  if (foot <= 0) return start;
  if (foot >= edge.span) return distanceCosine(edge.to, point);
  const double side = sideOfPoint(edge.line, point);
  return std::sqrt(1 + side * side);
}

Result<CutSurface> cutSurface(const OrbitPolygon& polygon, const Cuts& cuts) {
  const std::vector<std::vector<Axis>>& lifts = cuts.lifts;
  std::vector<Lift> all;
  for (std::size_t i = 0; i < lifts.size(); ++i)
    for (const Axis& axis : lifts[i]) all.push_back({axis, static_cast<int>(i)});
  std::vector<Scrap> scraps(1);
  for (const Complex& corner : polygon.corners) scraps[0].corners.push_back(pointAt(corner));
  scraps[0].on.resize(polygon.corners.size());
  std::iota(scraps[0].on.begin(), scraps[0].on.end(), 0);
  for (std::size_t i = 0; i < all.size(); ++i)
    scraps = cutAlong(scraps, all[i].axis, static_cast<int>(i));
  CutSurface cut;
  for (const Scrap& scrap : scraps) cut.parts.push_back(partOf(scrap, all));
  RETURN_IF_ERROR(findPartners(polygon, scraps, cut.parts));
  findPartsBeyondCuts(scraps, cut.parts);
  const std::vector<double> areas = numberPieces(cut.parts);
  std::vector<std::vector<int>> cuffs(areas.size());
  for (const PolygonPart& part : cut.parts)
    for (const PartEdge& edge : part.edges)
      if (edge.cuff >= 0) cuffs[part.piece].push_back(edge.cuff);
  RETURN_IF_ERROR(needWholeCuts(cut.parts, cuts.lengths));
  std::vector<int> number(areas.size(), -1);
  std::vector<bool> seen(2 * lifts.size(), false);
  int missing = 0;
  for (std::size_t k = 0; k < areas.size(); ++k) {
    if (areas[k] < kAreaTolerance) continue;
    ASSIGN_OR_RETURN(SurfacePiece piece, pieceOf(areas[k], std::move(cuffs[k])));
    for (const int cuff : piece.cuffs) {
      if (seen[cuff]) return misfit("two have one cuff");
      seen[cuff] = true;
    }
    missing += piece.missing();
    number[k] = static_cast<int>(cut.pieces.size());
    cut.pieces.push_back(std::move(piece));
  }
  for (PolygonPart& part : cut.parts) part.piece = number[part.piece];
  if (missing + static_cast<int>(lifts.size()) != 3 * polygon.genus - 3)
    return misfit("they miss " + std::to_string(missing) + " curves");
  return cut;
}

}  // namespace moduli
