#include "core/hyperbolic/central_face.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <queue>
#include <utility>

namespace moduli {
namespace {

/// The disks that these would be have the surface's area; there are some more patches.
constexpr double kPatches = 1000;

/// A step from the centre of one patch to that of a neighbour. Patches may have several.
struct Arc {
  Index to = 0;
  Su11 step;
};

/// A coarse picture of the surface.
struct Patches {
  std::vector<Index> seed;             ///< Per patch its central face.
  std::vector<std::vector<Arc>> arcs;  ///< Per patch.
};

/// Which patch a face belongs to, and where it is as seen from the patch's centre.
struct Membership {
  Index patch = kNone;
  Su11 place;
};

bool sameIsometry(const Su11& g, const Su11& h) {
  constexpr double kSame = 1e-12;
  return std::norm(g.b - h.b) + std::norm(g.a - h.a) < kSame ||
         std::norm(g.b + h.b) + std::norm(g.a + h.a) < kSame;
}

class Gathering {
 public:
  Gathering(const HyperbolicTriangles& triangles, const std::vector<Su11>& crossing,
            const std::vector<Su11>& centre)
      : surface_(triangles.surface),
        largest_(patchSize(triangles)),
        member_(surface_.faceCount()),
        step_(surface_.halfedgeCount()) {
    for (Index e = 0; e < surface_.edgeCount(); ++e) {
      const Index h = surface_.halfedge(e);
      const Index twin = surface_.twin(h);
      if (twin == kNone) continue;
      step_[h] = inverse(centre[Connectivity::faceOf(h)]) *
                 (crossing[h] * centre[Connectivity::faceOf(twin)]);
      step_[twin] = inverse(step_[h]);
    }
  }

  Patches patches() {
    Patches result;
    for (Index f = 0; f < surface_.faceCount(); ++f) {
      if (member_[f].patch != kNone) continue;
      gather(f, static_cast<Index>(result.seed.size()));
      result.seed.push_back(f);
    }
    result.arcs.resize(result.seed.size());
    for (Index h = 0; h < surface_.halfedgeCount(); ++h) addArc(result, h);
    return result;
  }

 private:
  /// The faces around `seed` that are nearer than the radius of a patch and not taken.
  void gather(Index seed, Index patch) {
    member_[seed] = {patch, {}};
    pending_ = {seed};
    while (!pending_.empty()) {
      const Index f = pending_.back();
      pending_.pop_back();
      for (Index h = 3 * f; h < 3 * f + 3; ++h) {
        if (surface_.twin(h) == kNone) continue;
        const Index g = Connectivity::faceOf(surface_.twin(h));
        if (member_[g].patch != kNone) continue;
        const Su11 place = member_[f].place * step_[h];
        if (std::norm(place.b) > largest_) continue;
        member_[g] = {patch, place};
        pending_.push_back(g);
      }
    }
  }

  void addArc(Patches& result, Index h) const {
    if (surface_.twin(h) == kNone) return;
    const Membership& here = member_[Connectivity::faceOf(h)];
    const Membership& beyond = member_[Connectivity::faceOf(surface_.twin(h))];
    if (here.patch == beyond.patch) return;
    const Su11 step = here.place * step_[h] * inverse(beyond.place);
    std::vector<Arc>& arcs = result.arcs[here.patch];
    const bool known = std::any_of(arcs.begin(), arcs.end(), [&](const Arc& arc) {
      return arc.to == beyond.patch && sameIsometry(arc.step, step);
    });
    if (!known) arcs.push_back({beyond.patch, step});
  }

  /// sinh(r / 2)^2 of the radius r of a disk with its part of the area.
  static double patchSize(const HyperbolicTriangles& triangles) {
    const double angles = std::accumulate(triangles.angles.begin(), triangles.angles.end(), 0.0);
    const double area = std::numbers::pi * triangles.surface.faceCount() - angles;
    return area / (4 * std::numbers::pi * kPatches);
  }

  const Connectivity& surface_;
  double largest_;
  std::vector<Membership> member_;
  std::vector<Su11> step_;  ///< Per halfedge, from centre to centre.
  std::vector<Index> pending_;
};

/// Per patch sinh(d / 2)^2 of its distance from `root` in the layout from there, nearest first.
std::vector<double> distancesFrom(const Patches& patches, Index root) {
  struct Candidate {
    double distance = 0;
    Index patch = 0;
    Su11 place;
    bool operator<(const Candidate& other) const {
      return distance != other.distance ? distance > other.distance : patch > other.patch;
    }
  };
  std::vector<double> distance(patches.seed.size(), -1.0);
  std::priority_queue<Candidate> queue;
  queue.push({0, root, {}});
  while (!queue.empty()) {
    const Candidate next = queue.top();
    queue.pop();
    if (distance[next.patch] >= 0) continue;
    distance[next.patch] = next.distance;
    const Su11 place = renormalized(next.place);
    for (const Arc& arc : patches.arcs[next.patch]) {
      if (distance[arc.to] >= 0) continue;
      const Su11 there = place * arc.step;
      queue.push({std::norm(there.b), arc.to, there});
    }
  }
  return distance;
}

/// The patch with the smallest radius of those tried.
Result<Index> findCentralPatch(Context& context, const Patches& patches, int candidates) {
  const std::size_t n = patches.seed.size();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::vector<double> nearest(n, kInfinity);  // To the candidates so far.
  std::vector<double> farthest(n, 0.0);
  std::pair<double, Index> best{kInfinity, 0};
  Index root = 0;
  for (int k = 1; k <= candidates; ++k) {
    RETURN_IF_ERROR(context.check());
    const std::vector<double> distance = distancesFrom(patches, root);
    best = std::min(best, {*std::max_element(distance.begin(), distance.end()), root});
    for (std::size_t i = 0; i < n; ++i) {
      nearest[i] = std::min(nearest[i], distance[i]);
      farthest[i] = std::max(farthest[i], distance[i]);
    }
    farthest[root] = kInfinity;  // Not twice.
    // Far from all at first: their distances bound everyone's radius from below. Then the lowest
    // bound wins.
    if (2 * k <= candidates) {
      root = static_cast<Index>(std::max_element(nearest.begin(), nearest.end()) - nearest.begin());
    } else {
      const auto lowest = std::min_element(farthest.begin(), farthest.end());
      if (*lowest >= best.first) break;
      root = static_cast<Index>(lowest - farthest.begin());
    }
  }
  return best.second;
}

}  // namespace

Result<Index> findCentralFace(Context& context, const HyperbolicTriangles& triangles,
                              const std::vector<Su11>& crossing, const std::vector<Su11>& centre,
                              int candidates) {
  const Patches patches = Gathering(triangles, crossing, centre).patches();
  ASSIGN_OR_RETURN(const Index patch, findCentralPatch(context, patches, candidates));
  return patches.seed[patch];
}

}  // namespace moduli
