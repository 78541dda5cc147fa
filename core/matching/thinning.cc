#include "core/matching/thinning.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <set>
#include <tuple>
#include <utility>

#include "core/mesh/triangle_geometry.h"

namespace moduli {
namespace {

constexpr std::size_t kHighestDegree = 12;
constexpr double kThinnest = 0.03;  // Relative area of new faces; an equilateral one has 0.43.

using Positions = std::vector<Eigen::Vector3d>;

/// Sum of the ways to a vertex's neighbours: tells the two ends of an edge apart, whatever their
/// numbers.
double reach(const RingMesh& mesh, const Positions& positions, Index v) {
  double sum = 0;
  for (const Index u : mesh.ring(v)) sum += (positions[u] - positions[v]).norm();
  return sum;
}

class EvenThinning {
 public:
  EvenThinning(RingMesh& mesh, const Positions& positions, const FaceRule& rule)
      : mesh_(mesh), positions_(positions), rule_(rule) {}

  /// The neighbour that v would best go into, and the length of the way; kNone if none will do.
  std::pair<double, Index> best(Index v) {
    choices_.clear();
    for (const Index u : mesh_.ring(v)) {
      choices_.emplace_back((positions_[u] - positions_[v]).norm(), u);
    }
    std::sort(choices_.begin(), choices_.end());
    for (const auto& choice : choices_) {
      if (isGood(v, choice.second)) return choice;
    }
    return {std::numeric_limits<double>::infinity(), kNone};
  }

  /// The length of a vertex's shortest edge.
  double shortest(Index v) const {
    double least = std::numeric_limits<double>::infinity();
    for (const Index u : mesh_.ring(v)) {
      least = std::min(least, (positions_[u] - positions_[v]).squaredNorm());
    }
    return std::sqrt(least);
  }

  bool isGood(Index v, Index u) const {
    const std::vector<Index>& ring = mesh_.ring(v);
    if (mesh_.ring(u).size() + ring.size() - 4 > kHighestDegree) return false;
    if (!mesh_.canCollapse(v, u)) return false;
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Index a = ring[i], b = ring[i + 1 == ring.size() ? 0 : i + 1];
      if (a == u || b == u) continue;
      if (mesh_.isCap(u, a, b)) {
        if (!rule_(u, a, b)) return false;
        continue;
      }
      const Eigen::Vector3d &p = positions_[a], &q = positions_[b];
      const Eigen::Vector3d before = (p - positions_[v]).cross(q - positions_[v]);
      const Eigen::Vector3d after = (p - positions_[u]).cross(q - positions_[u]);
      if (!(before.dot(after) > 0)) return false;
      if (triangleShape(positions_[u], p, q).relative_area < kThinnest) return false;
      if (!rule_(u, a, b)) return false;
    }
    return true;
  }

 private:
  RingMesh& mesh_;
  const Positions& positions_;
  const FaceRule& rule_;
  std::vector<std::pair<double, Index>> choices_;
};

/// The middle one of some numbers; infinity where there are none.
double median(std::vector<double> numbers) {
  if (numbers.empty()) return std::numeric_limits<double>::infinity();
  const auto middle = numbers.begin() + static_cast<std::ptrdiff_t>(numbers.size() / 2);
  std::nth_element(numbers.begin(), middle, numbers.end());
  return *middle;
}

/// Bad faces around a vertex.
int badFaces(const RingMesh& mesh, const FaceRule& rule, Index v) {
  const std::vector<Index>& ring = mesh.ring(v);
  int bad = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    if (!rule(v, ring[i], ring[(i + 1) % ring.size()])) ++bad;
  }
  return bad;
}

/// Bad faces among the new ones when v goes into u.
int badFacesAfter(const RingMesh& mesh, const FaceRule& rule, Index v, Index u) {
  const std::vector<Index>& ring = mesh.ring(v);
  int bad = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Index a = ring[i], b = ring[(i + 1) % ring.size()];
    if (a != u && b != u && !rule(u, a, b)) ++bad;
  }
  return bad;
}

/// What removing a vertex costs.
struct Collapse {
  int change = std::numeric_limits<int>::max();  ///< Of the number of bad faces.
  double length = 0, reach = 0;
  Index from = kNone, into = kNone;

  bool operator<(const Collapse& other) const {
    return std::tie(change, length, reach, from, into) <
           std::tie(other.change, other.length, other.reach, other.from, other.into);
  }
};

/// The best way to remove a vertex with bad faces; into kNone where it has none or cannot go.
Collapse bestCollapse(const RingMesh& mesh, const Positions& positions, const FaceRule& rule,
                      Index v) {
  Collapse best;
  if (v == mesh.pole()) return best;
  const int bad = badFaces(mesh, rule, v);
  if (bad == 0) return best;
  for (const Index u : mesh.ring(v)) {
    const Collapse choice{badFacesAfter(mesh, rule, v, u) - bad,
                          (positions[u] - positions[v]).norm(), reach(mesh, positions, v), v, u};
    if ((best.into == kNone || choice < best) && mesh.canCollapse(v, u)) best = choice;
  }
  return best;
}

}  // namespace

Status thinEvenly(Context& context, RingMesh& mesh, const Positions& positions,
                  const std::vector<char>& movable, const FaceRule& rule, Index wanted) {
  const Context::Stage stage(context, "thin");
  EvenThinning thinning(mesh, positions, rule);
  const auto vertices = static_cast<Index>(positions.size());
  bool look_at_all = false;
  while (mesh.vertexCount() > wanted) {
    std::vector<double> shortest;
    for (Index v = 0; v < vertices; ++v) {
      if (mesh.isPresent(v) && movable[v] != 0) shortest.push_back(thinning.shortest(v));
    }
    // What takes longer ways waits: after this round there may be shorter ones.
    const double longest =
        look_at_all ? std::numeric_limits<double>::infinity() : median(std::move(shortest));
    std::vector<std::tuple<double, double, Index, Index>> queue;  // Length, reach, from, into.
    for (Index v = 0; v < vertices; ++v) {
      if (v % 10000 == 0) RETURN_IF_ERROR(context.check());
      if (!mesh.isPresent(v) || movable[v] == 0 || thinning.shortest(v) > longest) continue;
      const auto [length, u] = thinning.best(v);
      if (u != kNone && length <= longest) {
        queue.emplace_back(length, reach(mesh, positions, v), v, u);
      }
    }
    std::sort(queue.begin(), queue.end());
    const std::size_t looked_at =
        look_at_all ? std::max<std::size_t>(queue.size() / 2, 1) : queue.size();
    std::vector<char> locked(vertices, 0);
    const Index before = mesh.vertexCount();
    for (std::size_t i = 0; i < std::min(looked_at, queue.size()); ++i) {
      const auto& [length, from_reach, v, u] = queue[i];
      if (mesh.vertexCount() <= wanted) break;
      if (locked[v] != 0 || !thinning.isGood(v, u)) continue;
      mesh.collapse(v, u);
      for (const Index w : mesh.ring(v)) locked[w] = 1;
    }
    if (mesh.vertexCount() < before) continue;
    // No vertex with a short edge can go.
    if (look_at_all) break;
    look_at_all = true;
  }
  return {};
}

bool thinUntil(RingMesh& mesh, const std::vector<Eigen::Vector3d>& positions,
               const FaceRule& rule) {
  const auto vertices = static_cast<Index>(positions.size());
  std::vector<Collapse> choices(vertices);
  std::set<Collapse> queue;
  const auto look = [&](Index v) {
    queue.erase(choices[v]);
    choices[v] = mesh.isPresent(v) ? bestCollapse(mesh, positions, rule, v) : Collapse();
    if (choices[v].into != kNone) queue.insert(choices[v]);
  };
  for (Index v = 0; v < vertices; ++v) look(v);
  while (!queue.empty()) {
    const Collapse best = *queue.begin();
    mesh.collapse(best.from, best.into);
    look(best.from);
    std::set<Index> near;  // Whose rings, or whose neighbours' rings, are others now.
    for (const Index w : mesh.ring(best.from)) {
      near.insert(w);
      near.insert(mesh.ring(w).begin(), mesh.ring(w).end());
    }
    for (const Index w : near) look(w);
  }
  for (Index v = 0; v < vertices; ++v) {
    if (mesh.isPresent(v) && badFaces(mesh, rule, v) > 0) return false;
  }
  return true;
}

}  // namespace moduli
