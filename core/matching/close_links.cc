#include "core/matching/close_links.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <utility>

namespace moduli {
namespace {

using Eigen::Vector3d;

constexpr double kClosed = 1e-6;
constexpr int kMostFaces = 20000;
constexpr int kMostDoublings = 24;

bool isOpen(const std::vector<Motion>& transitions, Index f) {
  const Motion* t = &transitions[3 * f];
  return !(distanceToUnit(t[0] * t[1] * t[2]) < kClosed);
}

class LinkClosing {
 public:
  LinkClosing(const Connectivity& surface, const CoverPlane& plane,
              const std::vector<Vector3d>& places, std::vector<Motion> transitions)
      : surface_(surface),
        plane_(plane),
        places_(places),
        transitions_(std::move(transitions)),
        state_(surface.faceCount()) {}

  Status run(Context& context) {
    std::vector<Index> open = openFaces(surface_, transitions_);
    if (open.empty()) return {};
    double limit = medianLength();
    for (int n = 0; n < kMostDoublings && !open.empty(); ++n, limit *= 2) {
      for (const Index f : open) {
        RETURN_IF_ERROR(context.check());
        if (isOpen(transitions_, f)) close(f, limit);
      }
      std::erase_if(open, [&](Index f) { return !isOpen(transitions_, f); });
    }
    return {};
  }

  std::vector<Motion> take() { return std::move(transitions_); }

 private:
  struct State {
    int round = 0;
    Index entry = kNone;  ///< Of the face, with a changed transition.
    Motion changed;
  };
  struct Candidate {
    double cost = 0;
    Index entry = kNone;
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

  /// As the search has changed it at the entry of its face.
  const Motion& transition(Index h) const {
    const State& state = state_[h / 3];
    return state.round == now_ && state.entry == h ? state.changed : transitions_[h];
  }

  /// What would close the face of h.
  Motion wanted(Index h) const {
    const Motion others = transition(Connectivity::next(h)) * transition(Connectivity::previous(h));
    return plane_.normalized(plane_.inverse(others));
  }

  void close(Index start, double limit) {
    ++now_;
    std::priority_queue<Candidate> queue;
    state_[start] = {now_, kNone, Motion::Identity()};
    leave(start, 0, queue);
    for (int n = 0; n < kMostFaces && !queue.empty(); ++n) {
      const Candidate next = queue.top();
      queue.pop();
      if (next.cost > limit) return;
      const Index f = next.entry / 3;
      if (state_[f].round == now_) continue;
      state_[f] = {now_, next.entry, next.changed};
      if (distanceToUnit(transition(3 * f) * transition(3 * f + 1) * transition(3 * f + 2)) <
          kClosed) {
        apply(f);
        return;
      }
      leave(f, next.cost, queue);
    }
  }

  void leave(Index f, double cost, std::priority_queue<Candidate>& queue) const {
    for (Index h = 3 * f; h < 3 * f + 3; ++h) {
      const Index entry = surface_.twin(h);
      if (entry == kNone || h == state_[f].entry || state_[entry / 3].round == now_) continue;
      const Motion changed = wanted(h);
      queue.push({cost + lengthOf(h, changed), entry, plane_.inverse(changed)});
    }
  }

  /// Along the way back to the start.
  void apply(Index f) {
    for (Index h = state_[f].entry; h != kNone; h = state_[surface_.twin(h) / 3].entry) {
      transitions_[h] = state_[h / 3].changed;
      transitions_[surface_.twin(h)] = plane_.inverse(transitions_[h]);
    }
  }

  const Connectivity& surface_;
  const CoverPlane& plane_;
  const std::vector<Vector3d>& places_;
  std::vector<Motion> transitions_;
  std::vector<State> state_;  ///< Per face.
  int now_ = 0;
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
