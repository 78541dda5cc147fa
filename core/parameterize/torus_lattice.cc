#include "core/parameterize/torus_lattice.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <queue>
#include <string>
#include <unordered_map>
#include <utility>

#include "core/base/text.h"
#include "core/forms/modular.h"
#include "core/intrinsic/unfold.h"
#include "core/topology/homology.h"
#include "core/topology/tree_cotree.h"

namespace moduli {
namespace {

using Plane = std::complex<double>;

constexpr double kMaxResidual = 1e-6;

double cross(Plane a, Plane b) {
  return std::imag(std::conj(a) * b);
}

/// Per edge along its direction: the mean of what its two faces make of it, all turned alike.
std::vector<Plane> edgeVectors(const Connectivity& surface, const FlatCharts& charts) {
  std::vector<Index> twin(surface.halfedgeCount());
  for (Index h = 0; h < surface.halfedgeCount(); ++h) twin[h] = surface.twin(h);
  const std::vector<Plane> placed = unfold(charts, twin).placed;
  const auto along = [&](Index h) { return placed[Connectivity::next(h)] - placed[h]; };
  std::vector<Plane> vectors(surface.edgeCount());
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    const Index h = surface.halfedge(e);
    vectors[e] = (along(h) - along(twin[h])) / 2.0;
  }
  return vectors;
}

/// The integral of edge vectors along the vertices' tree, from its root.
std::vector<Plane> integrateTree(const Connectivity& surface, const TreeCotree& trees,
                                 const std::vector<Plane>& vectors) {
  std::vector<Plane> place(surface.vertexCount());
  std::vector<bool> known(surface.vertexCount(), false);
  std::vector<Index> way;
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    Index at = v;
    for (; !known[at] && trees.vertex_parent[at] != kNone;) {
      way.push_back(trees.vertex_parent[at]);
      at = surface.tail(trees.vertex_parent[at]);
    }
    known[at] = true;
    for (; !way.empty(); way.pop_back()) {
      const Index h = way.back();
      const double sign = surface.sign(h);
      place[surface.head(h)] = place[surface.tail(h)] + sign * vectors[surface.edge(h)];
      known[surface.head(h)] = true;
    }
  }
  return place;
}

Plane periodOf(const Walk& walk, const std::vector<Plane>& vectors) {
  Plane sum = 0;
  for (const Step& step : walk) sum += static_cast<double>(step.sign) * vectors[step.edge];
  return sum;
}

/// A point of the plane over a vertex.
struct CoverVertex {
  Index vertex = 0;
  LatticeVector shift;

  std::uint64_t key() const {
    const auto part = [](int n) { return static_cast<std::uint64_t>(n + 0x8000) & 0xffff; };
    return static_cast<std::uint64_t>(vertex) << 32 | part(shift.m) << 16 | part(shift.n);
  }
};

/// Shortest ways in the plane along edges, across one direction at a price.
class WaySearch {
 public:
  static constexpr double kAcross = 3;

  WaySearch(const Connectivity& surface, const TorusLattice& lattice, LatticeVector goal)
      : surface_(surface),
        lattice_(lattice),
        goal_(goal),
        direction_(lattice.at(goal) / std::abs(lattice.at(goal))) {}

  /// The halfedges of the way from an image of a vertex to that moved by the goal, past no vertex
  /// that is forbidden, if it costs less than `bound`, which then becomes its cost. A* search.
  std::vector<Index> find(Index from, const std::vector<bool>& forbidden, double& bound) const {
    struct Mark {
      double cost = 0;
      Index entry = kNone;
      bool closed = false;
    };
    using Entry = std::pair<double, std::uint64_t>;
    std::unordered_map<std::uint64_t, std::pair<CoverVertex, Mark>> marks;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    const CoverVertex start{from, {}}, end{from, goal_};
    marks[start.key()] = {start, {}};
    queue.push({estimate(start, end), start.key()});
    while (!queue.empty() && queue.top().first < bound) {
      auto& [at, mark] = marks[queue.top().second];
      queue.pop();
      if (mark.closed) continue;
      mark.closed = true;
      if (at.key() == end.key()) {
        bound = mark.cost;
        return walkBack(end, [&](const CoverVertex& v) { return marks[v.key()].second.entry; });
      }
      const CoverVertex here = at;
      const double cost = mark.cost;
      Index h = surface_.outgoing(here.vertex);
      const Index first = h;
      do {
        const CoverVertex next{surface_.head(h), here.shift + lattice_.shift[h]};
        if (!forbidden[next.vertex] || next.key() == end.key()) {
          const double there = cost + price(h);
          auto [place, is_new] = marks.try_emplace(next.key(), std::pair{next, Mark()});
          Mark& other = place->second.second;
          if (is_new || (!other.closed && there < other.cost)) {
            other = {there, h, false};
            queue.push({there + estimate(next, end), next.key()});
          }
        }
        h = surface_.rotate(h);
      } while (h != first);
    }
    return {};
  }

 private:
  double norm(Plane way) const {
    const Plane seen = way * std::conj(direction_);
    return std::hypot(seen.real(), kAcross * seen.imag());
  }

  /// Of one of many equally short ways none is the shortest twice: a millionth decides.
  double price(Index h) const {
    const auto e = static_cast<std::uint64_t>(surface_.edge(h)) + 1;
    const double some = static_cast<double>((e * 0x9E3779B97F4A7C15ULL) >> 40) / (1 << 24);
    return norm(lattice_.along(surface_, h)) * (1 + 1e-6 * some);
  }

  double estimate(const CoverVertex& at, const CoverVertex& end) const {
    return norm(lattice_.place[end.vertex] - lattice_.place[at.vertex] +
                lattice_.at(end.shift - at.shift));
  }

  template <typename EntryOf>
  std::vector<Index> walkBack(CoverVertex at, const EntryOf& entryOf) const {
    std::vector<Index> way;
    for (Index h = entryOf(at); h != kNone; h = entryOf(at)) {
      way.push_back(h);
      at = {surface_.tail(h), at.shift - lattice_.shift[h]};
    }
    std::reverse(way.begin(), way.end());
    return way;
  }

  const Connectivity& surface_;
  const TorusLattice& lattice_;
  LatticeVector goal_;
  Plane direction_;
};

bool meetsVertexTwice(const Connectivity& surface, const std::vector<Index>& walk) {
  std::vector<Index> vertices;
  for (const Index h : walk) vertices.push_back(surface.tail(h));
  std::sort(vertices.begin(), vertices.end());
  return std::adjacent_find(vertices.begin(), vertices.end()) != vertices.end();
}

/// The best of the ways from every so manieth of these vertices; empty where it meets a vertex
/// twice.
std::vector<Index> bestWay(const Connectivity& surface, const WaySearch& search,
                           const std::vector<Index>& starts, const std::vector<bool>& forbidden,
                           std::size_t stride) {
  double bound = std::numeric_limits<double>::infinity();
  std::vector<Index> best;
  for (std::size_t n = 0; n < starts.size(); n += stride) {
    std::vector<Index> way = search.find(starts[n], forbidden, bound);
    if (!way.empty()) best = std::move(way);
  }
  return meetsVertexTwice(surface, best) ? std::vector<Index>() : best;
}

/// From some of these vertices or, where that finds none, from all: the best of all crosses no
/// translate of itself, because the parts between crossings could be exchanged for better ones.
std::vector<Index> shortestWay(const Connectivity& surface, const WaySearch& search,
                               const std::vector<Index>& starts,
                               const std::vector<bool>& forbidden) {
  constexpr std::size_t kSome = 24;
  const std::size_t stride = 1 + starts.size() / kSome;
  std::vector<Index> way = bestWay(surface, search, starts, forbidden, stride);
  return way.empty() ? bestWay(surface, search, starts, forbidden, 1) : way;
}

std::vector<Index> verticesOf(const Connectivity& surface, const std::vector<Index>& walk) {
  std::vector<Index> vertices;
  for (const Index h : walk) vertices.push_back(surface.tail(h));
  return vertices;
}

}  // namespace

Result<TorusLattice> latticeOfTorus(const Connectivity& surface, const FlatCharts& charts) {
  ASSIGN_OR_RETURN(const TreeCotree trees, computeTreeCotree(surface));
  const std::vector<Walk> walks = homologyBasis(surface, trees);
  const std::vector<Cochain> cochains = cohomologyBasis(surface, trees);
  std::vector<Plane> vectors = edgeVectors(surface, charts);
  double area = 0;
  for (Index f = 0; f < surface.faceCount(); ++f) area += doubledArea(charts, f) / 2;
  const std::size_t first =
      cross(periodOf(walks[0], vectors), periodOf(walks[1], vectors)) > 0 ? 0 : 1;
  const Plane p = periodOf(walks[first], vectors), q = periodOf(walks[1 - first], vectors);
  const double gap = std::abs(cross(p, q) / area - 1);
  if (!(gap <= kMaxResidual)) {
    return Status(Reason::kResidualTooLarge,
                  "the translations of the flat torus span an area that is off by " +
                      shortestDouble(gap) +
                      " of its own (allowed: " + shortestDouble(kMaxResidual) + ")",
                  "remesh parts that are thin");
  }
  ASSIGN_OR_RETURN(const ReducedTau reduced, reduceToFundamentalDomain(q / p));
  const auto [a, b, c, d] = reduced.transform;
  const auto times = [](long long n, Plane z) { return static_cast<double>(n) * z; };
  const Plane one = times(c, q) + times(d, p), other = times(a, q) + times(b, p);
  const Plane scale = std::conj(one) / std::abs(one) / std::sqrt(cross(one, other));
  TorusLattice lattice;
  lattice.generators = {std::abs(one) / std::sqrt(cross(one, other)), other * scale};
  lattice.tau = reduced.tau;
  lattice.area_residual = gap;
  lattice.place = integrateTree(surface, trees, vectors);
  for (Plane& z : lattice.place) z *= scale;
  lattice.shift.resize(surface.halfedgeCount());
  const auto add = [&](const Cochain& cochain, long long m, long long n) {
    for (const CochainTerm& term : cochain) {
      for (const Index h :
           {surface.halfedge(term.edge), surface.twin(surface.halfedge(term.edge))}) {
        const long long value = surface.sign(h) * term.value;
        lattice.shift[h] = lattice.shift[h] +
                           LatticeVector{static_cast<int>(value * m), static_cast<int>(value * n)};
      }
    }
  };
  // p = a one - c other, q = d other - b one.
  add(cochains[first], a, -c);
  add(cochains[1 - first], -b, d);
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    const Plane way = lattice.along(surface, surface.halfedge(e));
    lattice.residual = std::max(lattice.residual, std::abs(way - vectors[e] * scale));
  }
  return lattice;
}

std::optional<std::vector<LatticeVector>> liftFaces(const Connectivity& surface,
                                                    const std::vector<LatticeVector>& shift,
                                                    const std::vector<bool>& seam) {
  const auto corner = [&](Index h) {
    LatticeVector sum;
    for (Index g = h - h % 3; g < h; ++g) sum = sum + shift[g];
    return sum;
  };
  std::vector<std::optional<LatticeVector>> lift(surface.faceCount());
  std::vector<Index> order = {0};
  lift[0] = LatticeVector();
  for (std::size_t n = 0; n < order.size(); ++n) {
    for (Index h = 3 * order[n]; h < 3 * order[n] + 3; ++h) {
      if (seam[surface.edge(h)]) continue;
      const Index twin = surface.twin(h), beyond = Connectivity::faceOf(twin);
      const LatticeVector there = *lift[order[n]] + corner(h) - corner(Connectivity::next(twin));
      if (!lift[beyond]) {
        lift[beyond] = there;
        order.push_back(beyond);
      } else if (*lift[beyond] != there) {
        return std::nullopt;
      }
    }
  }
  if (order.size() < lift.size()) return std::nullopt;
  std::vector<LatticeVector> result;
  for (const auto& vector : lift) result.push_back(*vector);
  return result;
}

TorusCut shortCut(const Connectivity& surface, const TorusLattice& lattice) {
  const WaySearch first(surface, lattice, {1, 0}), second(surface, lattice, {0, 1});
  std::vector<bool> forbidden(surface.vertexCount(), false);
  // Every way around by a crosses every way around by b.
  const std::vector<Index> across = verticesOf(surface, [&] {
    double bound = std::numeric_limits<double>::infinity();
    return second.find(0, forbidden, bound);
  }());
  TorusCut cut;
  cut.walks[0] = shortestWay(surface, first, across, forbidden);
  const std::vector<Index> starts = verticesOf(surface, cut.walks[0]);
  for (const Index v : starts) forbidden[v] = true;
  cut.walks[1] = shortestWay(surface, second, starts, forbidden);
  if (cut.walks[0].empty() || cut.walks[1].empty()) return {};
  // Both from the vertex that they share.
  const Index base = surface.tail(cut.walks[1].front());
  const auto start = std::find_if(cut.walks[0].begin(), cut.walks[0].end(),
                                  [&](Index h) { return surface.tail(h) == base; });
  std::rotate(cut.walks[0].begin(), start, cut.walks[0].end());
  return cut;
}

}  // namespace moduli
