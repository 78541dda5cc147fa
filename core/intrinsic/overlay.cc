#include "core/intrinsic/overlay.h"

#include <algorithm>
#include <array>
#include <utility>

namespace moduli {
namespace {

constexpr std::size_t kFlipsPerCheck = 4096;

Index next(Index h) {
  return Connectivity::next(h);
}
Index previous(Index h) {
  return Connectivity::previous(h);
}

/// A given edge with a direction: twice its number, and 1 more against its own direction.
using Arc = Index;

Arc reversed(Arc arc) {
  return arc ^ 1;
}

/// A triangulation on its way from the given to the final one, with what crosses its edges.
class CrossedTriangulation {
 public:
  CrossedTriangulation(IntrinsicTriangulation start, const Connectivity& given)
      : triangulation_(std::move(start)),
        curve_(given.halfedgeCount()),
        forward_(given.halfedgeCount()),
        curves_(given.edgeCount()) {
    for (Index h = 0; h < given.halfedgeCount(); ++h) {
      curve_[h] = given.edge(h);
      forward_[h] = given.sign(h) > 0;
    }
    for (Index e = 0; e < given.edgeCount(); ++e) curves_[e].along = 2 * e;
  }

  const IntrinsicTriangulation& triangulation() const { return triangulation_; }

  void flip(Index h, double half_chord) {
    const Index t = triangulation_.twin(h);
    Curve diagonal = crossDiagonal(h, t);
    const std::array<Index, 4> from = {previous(h), next(t), previous(t), next(h)};
    const std::array<Index, 4> to = {next(h), previous(h), next(t), previous(t)};
    std::array<Index, 4> curves;
    std::array<bool, 4> directions;
    for (int n = 0; n < 4; ++n) {
      curves[n] = curve_[from[n]];
      directions[n] = forward_[from[n]];
    }
    triangulation_.flip(h, half_chord);
    for (int n = 0; n < 4; ++n) {
      curve_[to[n]] = curves[n];
      forward_[to[n]] = directions[n];
    }
    forward_[h] = true;
    forward_[t] = false;
    curves_[curve_[h]] = std::move(diagonal);
  }

  Index count(Index h) const { return static_cast<Index>(curves_[curve_[h]].arcs.size()); }
  NormalArcs normalArcs(Index h) const {
    return NormalArcs(count(h), count(next(h)), count(previous(h)));
  }

  /// The arc at a place along h, directed from the left of h to its right.
  Arc arc(Index h, Index place) const {
    const std::vector<Arc>& arcs = curves_[curve_[h]].arcs;
    return forward_[h] ? arcs[place] : reversed(arcs[arcs.size() - 1 - place]);
  }

  /// Where the arc that enters the face of h at a place along h leaves it.
  struct Exit {
    Index halfedge = kNone;  ///< kNone: it ends in the corner opposite h.
    Index place = 0;
  };
  Exit follow(Index h, Index place) const {
    const NormalArcs arcs = normalArcs(h);
    if (place < arcs.corner[0]) return {previous(h), count(previous(h)) - 1 - place};
    const Index fromHead = count(h) - 1 - place;
    if (fromHead < arcs.corner[1]) return {next(h), fromHead};
    return {};
  }

 private:
  /// What the edges of the triangulation meet of the given ones, along a direction of their own.
  struct Curve {
    std::vector<Arc> arcs;  ///< In order, each directed from left to right.
    Arc along = kNone;      ///< The given edge that it is; then nothing crosses it.
  };

  /// Of the edge that a flip of h, from i to j, puts in its place: from the apex l beyond h to the
  /// apex k. The arcs that cross it come in on i's side, in the order from l over i to k, and leave
  /// on j's.
  Curve crossDiagonal(Index h, Index t) const {
    Curve diagonal;
    std::vector<Arc>& arcs = diagonal.arcs;
    const Index ki = previous(h), il = next(t);
    appendCrossing(il, t, ki, arcs);
    appendEnding(previous(t), arcs);
    const Curve& old = curves_[curve_[h]];
    if (old.along != kNone) arcs.push_back(forward_[h] ? old.along : reversed(old.along));
    appendEnding(next(h), arcs);
    appendCrossing(ki, h, il, arcs);
    diagonal.along = straightThrough(t);
    return diagonal;
  }

  /// The arcs that come in through side g, in the face of `inner`, and leave on the far side of the
  /// quadrilateral; `other` is the other side at i.
  void appendCrossing(Index g, Index inner, Index other, std::vector<Arc>& arcs) const {
    for (Index place = count(g) - 1; place >= 0; --place) {
      const Exit exit = follow(g, place);
      if (exit.halfedge == inner) {
        const Index beyond = triangulation_.twin(inner);
        const Exit last = follow(beyond, count(beyond) - 1 - exit.place);
        if (last.halfedge == kNone || last.halfedge == other) continue;
      }
      arcs.push_back(reversed(arc(g, place)));
    }
  }

  /// The arcs from the corner opposite g that leave through it.
  void appendEnding(Index g, std::vector<Arc>& arcs) const {
    const NormalArcs normal = normalArcs(g);
    for (Index n = 0; n < normal.ending[0]; ++n) arcs.push_back(arc(g, normal.corner[0] + n));
  }

  /// The given edge that runs from the corner opposite t to that opposite its twin.
  Arc straightThrough(Index t) const {
    const NormalArcs normal = normalArcs(t);
    for (Index n = 0; n < normal.ending[0]; ++n) {
      const Index place = normal.corner[0] + n;
      if (follow(triangulation_.twin(t), count(t) - 1 - place).halfedge == kNone) {
        return arc(t, place);
      }
    }
    return kNone;
  }

  IntrinsicTriangulation triangulation_;
  std::vector<Index> curve_;   ///< Per halfedge, its edge's among curves_.
  std::vector<bool> forward_;  ///< Per halfedge, whether it has its curve's direction.
  std::vector<Curve> curves_;
};

/// Goes along given edges through the faces of the final triangulation.
class Tracer {
 public:
  explicit Tracer(const CrossedTriangulation& crossed)
      : crossed_(crossed), triangulation_(crossed.triangulation()) {}

  /// The crossings of the edge that leaves the corner opposite h through a place along h.
  std::vector<Crossing> trace(Index h, Index place) const {
    std::vector<Crossing> crossings;
    std::vector<Ends> from_start, from_end;
    Index g = h;
    const Index start = previous(h);
    Ends ends{chord(start), chord(next(h))};
    for (;;) {
      crossings.push_back({g, 0, 0, 0});
      from_start.push_back(ends);
      const Index twin = triangulation_.twin(g);
      const auto exit = crossed_.follow(twin, crossed_.count(twin) - 1 - place);
      if (exit.halfedge == kNone) {
        // The far ends as seen from there: tail of g is the head of its twin.
        ends = {chord(next(twin)), chord(previous(twin))};
        break;
      }
      ends = advance(ends, g, exit.halfedge);
      g = exit.halfedge;
      place = exit.place;
    }
    from_end.resize(crossings.size());
    for (std::size_t n = crossings.size(); n-- > 0;) {
      from_end[n] = ends;
      if (n > 0) ends = retreat(ends, crossings[n].halfedge, crossings[n - 1].halfedge);
    }
    for (std::size_t n = 0; n < crossings.size(); ++n) {
      weigh(from_start[n], from_end[n], crossings[n]);
    }
    return crossings;
  }

 private:
  /// Half chords from one end of the traced edge to the ends of one that it crosses.
  struct Ends {
    double tail, head;
  };

  double chord(Index h) const { return triangulation_.halfChord(h); }

  /// From the ends of `from` to those of `to`, in the face beyond it, by Ptolemy's relation.
  Ends advance(const Ends& ends, Index from, Index to) const {
    const Index twin = triangulation_.twin(from);
    // The twin runs from the head of `from` to its tail; the apex is opposite.
    const double apex =
        (ends.tail * chord(previous(twin)) + ends.head * chord(next(twin))) / chord(from);
    // Out through the side at the tail of `from`, or through that at its head.
    return to == next(twin) ? Ends{ends.tail, apex} : Ends{apex, ends.head};
  }

  /// The same from the other end: from the ends of `from` back to those of `to`, which is in the
  /// face on its left.
  Ends retreat(const Ends& ends, Index from, Index to) const {
    const Index inner = triangulation_.twin(to);
    const double apex =
        (ends.tail * chord(next(from)) + ends.head * chord(previous(from))) / chord(from);
    // `from` starts where `to` does, or ends where it does.
    return from == next(inner) ? Ends{ends.tail, apex} : Ends{apex, ends.head};
  }

  static void weigh(const Ends& start, const Ends& end, Crossing& crossing) {
    const double tail = start.head * end.head, head = start.tail * end.tail;
    crossing.weight_tail = tail / (tail + head);
    crossing.weight_head = head / (tail + head);
    const double near_start = end.tail * end.head, near_end = start.tail * start.head;
    crossing.fraction = near_end / (near_start + near_end);
  }

  const CrossedTriangulation& crossed_;
  const IntrinsicTriangulation& triangulation_;
};

}  // namespace

NormalArcs::NormalArcs(Index count0, Index count1, Index count2) {
  const std::array<Index, 3> n = {count0, count1, count2};
  for (int c = 0; c < 3; ++c) {
    ending[c] = std::max<Index>(0, n[c] - n[(c + 1) % 3] - n[(c + 2) % 3]);
  }
  for (int c = 0; c < 3; ++c) {
    // Between side c and the one before it; arcs that end in a corner are no part of this.
    const int before = (c + 2) % 3, opposite = (c + 1) % 3;
    corner[c] = std::max<Index>(
        0, (n[c] - ending[c] + n[before] - ending[before] - (n[opposite] - ending[opposite])) / 2);
  }
}

Result<Overlay> Overlay::make(Context& context, const IntrinsicTriangulation& final_triangulation) {
  IntrinsicTriangulation start = final_triangulation;
  std::vector<IntrinsicTriangulation::Flip> flips = start.history();
  for (std::size_t n = flips.size(); n-- > 0;) {
    flips[n].half_chord = start.halfChord(flips[n].halfedge);
    start.undoTo(n);
  }
  Overlay overlay(start.connectivity());
  CrossedTriangulation crossed(std::move(start), overlay.given_);
  for (std::size_t n = 0; n < flips.size(); ++n) {
    if (n % kFlipsPerCheck == 0) RETURN_IF_ERROR(context.check());
    crossed.flip(flips[n].halfedge, flips[n].half_chord);
  }
  overlay.crossings_.resize(overlay.given_.edgeCount());
  const Tracer tracer(crossed);
  for (Index h = 0; h < final_triangulation.halfedgeCount(); ++h) {
    const NormalArcs arcs = crossed.normalArcs(h);
    for (Index n = 0; n < arcs.ending[0]; ++n) {
      const Index place = arcs.corner[0] + n;
      const Arc arc = crossed.arc(h, place);
      if (arc % 2 == 0) overlay.crossings_[arc / 2] = tracer.trace(h, place);
    }
  }
  return overlay;
}

std::vector<Overlay::BoundaryPoint> Overlay::boundary(Index face) const {
  std::vector<BoundaryPoint> points;
  for (Index h = 3 * face; h < 3 * face + 3; ++h) {
    points.push_back({h, kNone});
    for (Index n = 0; n < count(h); ++n) points.push_back({h, n});
  }
  return points;
}

std::vector<Overlay::Chord> Overlay::chords(Index face) const {
  const Index h = 3 * face;
  const std::array<Index, 3> counts = {count(h), count(h + 1), count(h + 2)};
  const std::array<Index, 3> corners = {0, counts[0] + 1, counts[0] + counts[1] + 2};
  const Index size = counts[0] + counts[1] + counts[2] + 3;
  const NormalArcs arcs(counts[0], counts[1], counts[2]);
  std::vector<Chord> chords;
  for (int c = 0; c < 3; ++c) {
    for (Index n = 1; n <= arcs.corner[c]; ++n) {
      chords.push_back({corners[c] + n, (corners[c] - n + size) % size});
    }
    for (Index n = 1; n <= arcs.ending[c]; ++n) {
      chords.push_back({corners[(c + 2) % 3], corners[c] + arcs.corner[c] + n});
    }
  }
  return chords;
}

const Crossing& Overlay::crossing(const BoundaryPoint& point) const {
  const std::vector<Crossing>& all = crossings_[given_.edge(point.halfedge)];
  const auto n = static_cast<std::size_t>(point.crossing);
  return given_.sign(point.halfedge) > 0 ? all[n] : all[all.size() - 1 - n];
}

}  // namespace moduli
