#include "core/matching/close_links.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <utility>

namespace moduli {
namespace {

using Eigen::Vector3d;

constexpr double kClosed = 1e-6;
constexpr std::size_t kMostSteps = 20000;
/// That are looked at to one face.
constexpr int kMostWays = 6;
constexpr int kMostDoublings = 24;
/// Of a changed edge's length, that it costs at least.
constexpr double kLeastShare = 0.05;

bool isOpen(const std::vector<Motion>& transitions, Index f) {
  const Motion* t = &transitions[3 * f];
  return !(distanceToUnit(t[0] * t[1] * t[2]) < kClosed);
}

bool alike(const Motion& a, const Motion& b) {
  return (a - b).cwiseAbs().maxCoeff() < kClosed * (1 + a.cwiseAbs().maxCoeff());
}

class LinkClosing {
 public:
  LinkClosing(const Connectivity& surface, const CoverPlane& plane,
              const std::vector<Vector3d>& places, std::vector<Motion> transitions)
      : surface_(surface),
        plane_(plane),
        places_(places),
        transitions_(std::move(transitions)),
        last_(surface.faceCount(), kNone) {}

  Status run(Context& context) {
    std::vector<Index> open = openFaces(surface_, transitions_);
    if (open.empty()) return {};
    double limit = medianLength();
    for (int n = 0; n < kMostDoublings && !open.empty(); ++n, limit *= 2) {
      bool goes_on = false;
      for (const Index f : open) {
        RETURN_IF_ERROR(context.check());
        if (isOpen(transitions_, f) && close(f, limit)) goes_on = true;
      }
      if (!goes_on) break;
      std::erase_if(open, [&](Index f) { return !isOpen(transitions_, f); });
    }
    return {};
  }

  std::vector<Motion> take() { return std::move(transitions_); }

 private:
  /// A face on a way that the search knows.
  struct Step {
    Index face = kNone;
    Index entry = kNone;  ///< Of the face, with a changed transition.
    Motion changed;
    Index from = kNone;   ///< The step before.
    Index other = kNone;  ///< Another one to this face.
  };
  struct Candidate {
    double cost = 0;
    Index entry = kNone;
    Index from = kNone;
    Motion changed;
    bool operator<(const Candidate& other) const {
      return cost != other.cost ? cost > other.cost : entry > other.entry;
    }
  };

  double medianLength() const {
    std::vector<double> lengths;
    for (Index e = 0; e < surface_.edgeCount(); ++e) {
      const Index h = surface_.halfedge(e);
      lengths.push_back(lengthOf(h, transitions_[h]));
    }
    const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
    std::nth_element(lengths.begin(), middle, lengths.end());
    return *middle;
  }

  double lengthOf(Index h, const Motion& transition) const {
    const Motion to_tail = plane_.inverse(plane_.shift(plane_.wayTo(places_[surface_.tail(h)])));
    return plane_.wayTo(to_tail * transition * places_[surface_.head(h)]).norm();
  }

  const Motion& transition(const Step& step, Index h) const {
    return step.entry == h ? step.changed : transitions_[h];
  }

  /// What would close the face of h.
  Motion wanted(const Step& step, Index h) const {
    return plane_.normalized(plane_.inverse(Motion(transition(step, Connectivity::next(h)) *
                                                   transition(step, Connectivity::previous(h)))));
  }

  /// Whether this changed something, or a larger limit may do so.
  bool close(Index start, double limit) {
    std::priority_queue<Candidate> queue;
    steps_.clear();
    steps_.push_back({start, kNone, Motion::Identity(), kNone, kNone});
    last_[start] = 0;
    leave(0, 0, queue);
    bool closed = false;
    while (!queue.empty() && steps_.size() < kMostSteps && queue.top().cost <= limit) {
      const Candidate next = queue.top();
      queue.pop();
      if (isKnown(next)) continue;
      const Index f = next.entry / 3;
      const auto step = static_cast<Index>(steps_.size());
      steps_.push_back({f, next.entry, next.changed, next.from, last_[f]});
      last_[f] = step;
      const Step& here = steps_.back();
      if (distanceToUnit(transition(here, 3 * f) * transition(here, 3 * f + 1) *
                         transition(here, 3 * f + 2)) < kClosed) {
        apply(step);
        closed = true;
        break;
      }
      leave(step, next.cost, queue);
    }
    for (const Step& step : steps_) last_[step.face] = kNone;
    return closed || (!queue.empty() && steps_.size() < kMostSteps);
  }

  /// Ways on both sides of a handle bring different motions to one face.
  bool isKnown(const Candidate& next) const {
    int count = 0;
    for (Index s = last_[next.entry / 3]; s != kNone; s = steps_[s].other) {
      if (++count == kMostWays || steps_[s].from == kNone) return true;
      if (steps_[s].entry == next.entry && alike(steps_[s].changed, next.changed)) return true;
    }
    return false;
  }

  void leave(Index s, double cost, std::priority_queue<Candidate>& queue) const {
    const Step& step = steps_[s];
    for (Index h = 3 * step.face; h < 3 * step.face + 3; ++h) {
      const Index entry = surface_.twin(h);
      if (entry == kNone || h == step.entry || isOnWay(s, entry / 3)) continue;
      const Motion changed = wanted(step, h);
      queue.push({cost + costOf(h, changed), entry, s, plane_.inverse(changed)});
    }
  }

  /// An edge that went around the wrong side is hardly longer on the right one.
  double costOf(Index h, const Motion& changed) const {
    const double length = lengthOf(h, changed);
    return std::max(0.0, length - lengthOf(h, transitions_[h])) + kLeastShare * length;
  }

  bool isOnWay(Index s, Index face) const {
    if (last_[face] == kNone) return false;
    for (; s != kNone; s = steps_[s].from) {
      if (steps_[s].face == face) return true;
    }
    return false;
  }

  /// Along the way back to the start.
  void apply(Index s) {
    for (; steps_[s].entry != kNone; s = steps_[s].from) {
      const Step& step = steps_[s];
      transitions_[step.entry] = step.changed;
      transitions_[surface_.twin(step.entry)] = plane_.inverse(step.changed);
    }
  }

  const Connectivity& surface_;
  const CoverPlane& plane_;
  const std::vector<Vector3d>& places_;
  std::vector<Motion> transitions_;
  std::vector<Step> steps_;  ///< Of the search, in the order in which they were reached.
  std::vector<Index> last_;  ///< Per face the last step to it.
};

}  // namespace

std::vector<Index> openFaces(const Connectivity& surface, const std::vector<Motion>& transitions) {
  std::vector<Index> open;
  for (Index f = 0; f < surface.faceCount(); ++f) {
    if (isOpen(transitions, f)) open.push_back(f);
  }
  return open;
}

Result<std::vector<Motion>> closeLinks(Context& context, const Connectivity& surface,
                                       const CoverPlane& plane, const std::vector<Vector3d>& places,
                                       std::vector<Motion> transitions) {
  LinkClosing closing(surface, plane, places, std::move(transitions));
  RETURN_IF_ERROR(closing.run(context));
  return closing.take();
}

}  // namespace moduli
