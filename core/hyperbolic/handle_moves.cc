#include "core/hyperbolic/handle_moves.h"

#include <algorithm>
#include <array>
#include <functional>
#include <utility>

namespace moduli {
namespace {

using Handles = std::vector<GroupHandle>;

class Search {
 public:
  Search(const Handles& handles, double corner_weight)
      : handles_(handles), corner_weight_(corner_weight) {
    WideSu11 corner;
    corner_.push_back(corner);
    for (const GroupHandle& h : handles) {
      quick_.push_back({BoundedSu11(h.a), BoundedSu11(h.b)});
      double length = lengthOf(h);
      for (const WideSu11& side : {h.a, h.b, inverse(h.a), inverse(h.b)}) {
        quick_corner_.emplace_back(corner);
        corner = corner * side;
        length += corner_weight * lengthOf(corner);
      }
      corner_.push_back(corner);
      length_.push_back(length);
    }
    quick_corner_.emplace_back(corner);
  }

  std::optional<HandleReplacement> best() {
    for (std::size_t k = 0; k < handles_.size(); ++k) {
      withinHandle(k);
      if (k + 1 < handles_.size()) betweenHandles(k);
    }
    aroundHandles();
    std::stable_sort(offers_.begin(), offers_.end(),
                     [](const Offer& x, const Offer& y) { return x.most > y.most; });
    std::optional<HandleReplacement> best;
    for (const Offer& offer : offers_) {
      if (best && !(offer.most > best->gain)) break;
      Handles handles = offer.handles();
      const double gain = exactGain(offer.first, handles);
      if (gain > (best ? best->gain : kLeastGain)) best = {offer.first, std::move(handles), gain};
    }
    return best;
  }

 private:
  /// A move that may gain something, not yet made.
  struct Offer {
    double most = 0;  ///< An upper bound of what it gains.
    std::size_t first = 0;
    std::function<Handles()> handles;
  };

  /// leastLength(i): no more than the length of what takes the place of handle first + i. An upper
  /// bound of the gain, where that is one.
  template <typename LeastLength>
  double mostGain(std::size_t first, std::size_t count, const LeastLength& leastLength) const {
    double gain = 0;
    for (std::size_t i = 0; i < count; ++i) gain += length_[first + i];
    for (std::size_t i = 0; i < count && gain > kLeastGain; ++i) gain -= leastLength(i);
    return gain;
  }

  double exactGain(std::size_t first, const Handles& handles) const {
    WideSu11 corner = corner_[first];
    double gain = 0;
    for (std::size_t i = 0; i < handles.size(); ++i) {
      gain += length_[first + i] - lengthFrom(corner, handles[i], corner_weight_);
    }
    return gain;
  }

  /// replaced(h, i): what takes the place of handle first + i of h, for handles_ and quick_.
  template <typename Replaced>
  void offer(std::size_t first, std::size_t count, const Replaced& replaced) {
    BoundedSu11 corner = quick_corner_[4 * first];
    const double most = mostGain(first, count, [&](std::size_t i) {
      return lengthFrom(corner, replaced(quick_, i), corner_weight_);
    });
    add(most, first, [this, count, replaced] {
      Handles handles;
      for (std::size_t i = 0; i < count; ++i) handles.push_back(replaced(handles_, i));
      return handles;
    });
  }

  template <typename Make>
  void add(double most, std::size_t first, const Make& make) {
    if (most > kLeastGain) offers_.push_back({most, first, make});
  }

  template <typename Replaced>
  void offerOne(std::size_t k, const Replaced& replaced) {
    offer(k, 1, [=](const auto& h, std::size_t) { return replaced(h[k]); });
  }

  template <typename Replaced>
  void offerTwo(std::size_t k, const Replaced& replaced) {
    offer(k, 2, [=](const auto& h, std::size_t i) { return replaced(h[k], h[k + 1])[i]; });
  }

  /// [a b^n, b] = [a, b] = [a, b a^n].
  void withinHandle(std::size_t k) {
    offerOne(k, [](auto h) { return decltype(h){h.a * h.b, h.b}; });
    offerOne(k, [](auto h) { return decltype(h){h.a * inverse(h.b), h.b}; });
    offerOne(k, [](auto h) { return decltype(h){h.a, h.b * h.a}; });
    offerOne(k, [](auto h) { return decltype(h){h.a, h.b * inverse(h.a)}; });
    // The quarter turn [a b a^-1, a^-1] = [a, b].
    offerOne(k, [](auto h) { return decltype(h){conjugate(h.a, h.b), inverse(h.a)}; });
    offerOne(k, [](auto h) { return decltype(h){inverse(h.b), conjugate(h.b, h.a)}; });
  }

  void betweenHandles(std::size_t k) {
    // The loop e = b a^-1 b^-1 a' and twists along it.
    const auto link = [](const auto& g, const auto& h) {
      return conjugate(g.b, inverse(g.a)) * h.a;
    };
    const auto twisted = [](auto g, auto h, const auto& e) {
      return std::array{decltype(g){g.a, inverse(e) * g.b},
                        decltype(g){conjugate(inverse(e), h.a), h.b * e}};
    };
    offerTwo(k, [=](auto g, auto h) { return twisted(g, h, link(g, h)); });
    offerTwo(k, [=](auto g, auto h) { return twisted(g, h, inverse(link(g, h))); });
    offerExchanges(k);
  }

  void offerExchanges(std::size_t k) {
    const BoundedSu11& start = quick_corner_[4 * k];
    const BoundedSu11& between = quick_corner_[4 * k + 4];
    const BoundedSu11& end = quick_corner_[4 * k + 8];
    const BoundedSu11 c = inverse(start) * between;
    const BoundedSu11 d = inverse(between) * end;
    const double forward = mostGain(k, 2, [&](std::size_t i) {
      return i == 0 ? leastMoved(k + 1, c, {}) : leastMoved(k, {}, end * inverse(start * c));
    });
    add(forward, k, [this, k] {
      return Handles{conjugate(commutator(handles_[k]), handles_[k + 1]), handles_[k]};
    });
    const double backward = mostGain(k, 2, [&](std::size_t i) {
      return i == 0 ? leastMoved(k + 1, {}, start * inverse(between))
                    : leastMoved(k, inverse(d), {});
    });
    add(backward, k, [this, k] {
      const WideSu11 by = inverse(commutator(handles_[k + 1]));
      return Handles{handles_[k + 1], conjugate(by, handles_[k])};
    });
  }

  /// No more than the length of a handle conjugated by an element, whose corners C become shift C
  /// by^-1: along the new sides, doubles would not find the last of them.
  double leastMoved(std::size_t k, const BoundedSu11& by, const BoundedSu11& shift) const {
    const BoundedSu11 back = inverse(by);
    double length = lengthOf(conjugate(by, quick_[k]));
    for (std::size_t i = 4 * k + 1; i <= 4 * k + 4; ++i) {
      length += corner_weight_ * lengthOf(shift * quick_corner_[i] * back);
    }
    return length;
  }

  /// Twists along the loops around the handles first .. last.
  void aroundHandles() {
    for (std::size_t first = 0; first < handles_.size(); ++first) {
      for (std::size_t last = first; last + 1 < handles_.size() + (first > 0); ++last) {
        const BoundedSu11& from = quick_corner_[4 * first];
        const BoundedSu11& to = quick_corner_[4 * last + 4];
        const BoundedSu11 around = inverse(from) * to;
        const BoundedSu11 shift = to * inverse(from);
        offerAround(first, last, around, shift, true);
        offerAround(first, last, inverse(around), inverse(shift), false);
      }
    }
  }

  void offerAround(std::size_t first, std::size_t last, const BoundedSu11& around,
                   const BoundedSu11& shift, bool forward) {
    const double most = mostGain(first, last + 1 - first, [&](std::size_t i) {
      return leastMoved(first + i, around, shift);
    });
    add(most, first, [=, this] { return twistedAround(first, last, forward); });
  }

  Handles twistedAround(std::size_t first, std::size_t last, bool forward) const {
    WideSu11 around;
    for (std::size_t i = first; i <= last; ++i) around = around * commutator(handles_[i]);
    if (!forward) around = inverse(around);
    Handles handles;
    for (std::size_t i = first; i <= last; ++i) handles.push_back(conjugate(around, handles_[i]));
    return handles;
  }

  const Handles& handles_;
  double corner_weight_;
  std::vector<WideSu11> corner_;  ///< Per handle, where it begins; and the end.
  std::vector<double> length_;    ///< Per handle.
  /// The same in doubles, with all corners of the polygon.
  std::vector<HandleOf<BoundedSu11>> quick_;
  std::vector<BoundedSu11> quick_corner_;
  std::vector<Offer> offers_;
};

}  // namespace

std::optional<HandleReplacement> bestMove(const std::vector<GroupHandle>& handles,
                                          double corner_weight) {
  return Search(handles, corner_weight).best();
}

}  // namespace moduli
