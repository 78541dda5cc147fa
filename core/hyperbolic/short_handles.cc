#include "core/hyperbolic/short_handles.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <optional>
#include <utility>

namespace moduli {
namespace {

/// A move that gains less is none.
constexpr double kGain = 1e-6;
/// A few dozen moves a handle were seen.
constexpr std::size_t kMovesPerHandle = 200;
constexpr int kBasePointSteps = 2000;
constexpr std::size_t kStarts = 8;
/// Handles that are longer on average outgrow the precision.
constexpr double kLongest = 60;

double lengthOf(const WideSu11& g) {
  return displacement(rounded(g));
}

WideSu11 conjugate(const WideSu11& by, const WideSu11& g) {
  return by * g * inverse(by);
}

WideSu11 commutator(const GroupHandle& h) {
  return h.a * h.b * inverse(h.a) * inverse(h.b);
}

GroupHandle conjugate(const WideSu11& by, const GroupHandle& h) {
  return {conjugate(by, h.a), conjugate(by, h.b)};
}

double lengthOf(const GroupHandle& h) {
  return lengthOf(h.a) + lengthOf(h.b);
}

/// The places of U a P b Q a^-1 R b^-1 S.
struct Link {
  std::size_t a = 0, b = 0, a_inverse = 0, b_inverse = 0;
};

/// A polygon's word with the corners that its sides lead to.
class Polygon {
 public:
  Polygon(const std::vector<WideSu11>& letters, Word word) : word_(std::move(word)) {
    corner_.emplace_back();
    for (const int x : word_) {
      const WideSu11& letter = letters[std::abs(x) - 1];
      corner_.push_back(corner_.back() * (x > 0 ? letter : inverse(letter)));
    }
  }

  /// All pairs of linked letters.
  std::vector<Link> links() const {
    std::vector<Link> result;
    for (std::size_t a = 0; a < word_.size(); ++a) {
      const std::size_t a_inverse = inverseOf(a);
      if (a_inverse == kNowhere) continue;
      for (std::size_t b = a + 1; b < a_inverse; ++b) {
        const std::size_t b_inverse = inverseOf(b);
        if (b_inverse == kNowhere || b_inverse < a_inverse) continue;
        result.push_back({a, b, a_inverse, b_inverse});
      }
    }
    return result;
  }

  /// [a', b'] U R Q P S is the word, in the free group, with a' = U a Q^-1 R^-1 U^-1 and
  /// b' = U R Q P b R^-1 U^-1.
  GroupHandle handle(const Link& link) const {
    const WideSu11 u = corner_[link.a];
    const WideSu11 p = slice(link.a + 1, link.b);
    const WideSu11 q = slice(link.b + 1, link.a_inverse);
    const WideSu11 r = slice(link.a_inverse + 1, link.b_inverse);
    const WideSu11 ur = u * r;
    return {corner_[link.a + 1] * inverse(ur * q),
            ur * q * p * slice(link.b, link.b + 1) * inverse(ur)};
  }

  /// U R Q P S.
  Word rest(const Link& link) const {
    Word result;
    const auto add = [&](std::size_t from, std::size_t to) {
      for (std::size_t i = from; i < to; ++i) result.push_back(word_[i]);
    };
    add(0, link.a);
    add(link.a_inverse + 1, link.b_inverse);
    add(link.b + 1, link.a_inverse);
    add(link.a + 1, link.b);
    add(link.b_inverse + 1, word_.size());
    return result;
  }

 private:
  static constexpr std::size_t kNowhere = ~std::size_t{0};

  /// The later place of the inverse letter.
  std::size_t inverseOf(std::size_t place) const {
    for (std::size_t i = place + 1; i < word_.size(); ++i) {
      if (word_[i] == -word_[place]) return i;
    }
    return kNowhere;
  }

  WideSu11 slice(std::size_t from, std::size_t to) const {
    return inverse(corner_[from]) * corner_[to];
  }

  Word word_;
  std::vector<WideSu11> corner_;
};

using Handles = std::vector<GroupHandle>;

/// What takes the place of `count` handles from `first` on.
struct Replacement {
  std::size_t first = 0;
  Handles handles;
  double gain = 0;  ///< Of the sum of lengths.
};

/// The lengths of the generators and of the corners a, a b, a b a^-1, .. of the polygon whose sides
/// they are, from the corner `from` on.
double lengthFrom(Su11 from, const GroupHandle* first, std::size_t count, double corner_weight) {
  double total = 0;
  for (const GroupHandle* h = first; h != first + count; ++h) {
    const Su11 a = rounded(h->a);
    const Su11 b = rounded(h->b);
    total += displacement(a) + displacement(b);
    for (const Su11& side : {a, b, inverse(a), inverse(b)}) {
      from = from * side;
      total += corner_weight * displacement(from);
    }
  }
  return total;
}

class Search {
 public:
  Search(const Handles& handles, double corner_weight)
      : handles_(handles), corner_weight_(corner_weight) {
    WideSu11 corner;
    for (const GroupHandle& h : handles) {
      corner_.push_back(rounded(corner));
      corner = corner * commutator(h);
    }
  }

  Replacement best() {
    for (std::size_t k = 0; k < handles_.size(); ++k) {
      withinHandle(k);
      if (k + 1 < handles_.size()) betweenHandles(k);
    }
    aroundHandles();
    return best_;
  }

 private:
  void offer(std::size_t first, Handles handles) {
    const double gain =
        lengthFrom(corner_[first], &handles_[first], handles.size(), corner_weight_) -
        lengthFrom(corner_[first], handles.data(), handles.size(), corner_weight_);
    if (gain > best_.gain) best_ = {first, std::move(handles), gain};
  }

  /// [a b^n, b] = [a, b] = [a, b a^n].
  void withinHandle(std::size_t k) {
    const GroupHandle& h = handles_[k];
    offer(k, {{h.a * h.b, h.b}});
    offer(k, {{h.a * inverse(h.b), h.b}});
    offer(k, {{h.a, h.b * h.a}});
    offer(k, {{h.a, h.b * inverse(h.a)}});
    // The quarter turn [a b a^-1, a^-1] = [a, b].
    offer(k, {{conjugate(h.a, h.b), inverse(h.a)}});
    offer(k, {{inverse(h.b), conjugate(h.b, h.a)}});
  }

  void betweenHandles(std::size_t k) {
    const GroupHandle& g = handles_[k];
    const GroupHandle& h = handles_[k + 1];
    // The loop e = b a^-1 b^-1 a' and twists along it.
    const WideSu11 e = conjugate(g.b, inverse(g.a)) * h.a;
    const WideSu11 back = inverse(e);
    offer(k, {{g.a, back * g.b}, {conjugate(back, h.a), h.b * e}});
    offer(k, {{g.a, e * g.b}, {conjugate(e, h.a), h.b * back}});
    const WideSu11 c = commutator(g);
    const WideSu11 d = commutator(h);
    offer(k, {conjugate(c, h), g});
    offer(k, {h, conjugate(inverse(d), g)});
  }

  /// Twists along the loops around the handles first .. last.
  void aroundHandles() {
    for (std::size_t first = 0; first < handles_.size(); ++first) {
      WideSu11 around;
      Handles forward;
      Handles backward;
      for (std::size_t last = first; last + 1 < handles_.size() + (first > 0); ++last) {
        around = around * commutator(handles_[last]);
        forward.clear();
        backward.clear();
        for (std::size_t i = first; i <= last; ++i) {
          forward.push_back(conjugate(around, handles_[i]));
          backward.push_back(conjugate(inverse(around), handles_[i]));
        }
        offer(first, forward);
        offer(first, backward);
      }
    }
  }

  const Handles& handles_;
  double corner_weight_;
  std::vector<Su11> corner_;  ///< Per handle, where it begins.
  Replacement best_;
};

double totalLength(const Handles& handles, double corner_weight) {
  return lengthFrom({}, handles.data(), handles.size(), corner_weight);
}

/// Conjugates so that 0 comes to where the total length is smallest, which is a convex function of
/// the point: steps in four directions, halved where none helps. Whether that gained anything.
bool moveBasePoint(ShortHandles& moved_handles, double corner_weight) {
  Handles& handles = moved_handles.handles;
  double total = totalLength(handles, corner_weight);
  const double start = total;
  int steps = kBasePointSteps;
  for (double step = 0.5; step > 0.01 && steps > 0;) {
    bool moved = false;
    for (const Complex direction : {Complex(1, 0), Complex(0, 1), Complex(-1, 0), Complex(0, -1)}) {
      --steps;
      const WideSu11 to = widened(translationTo(std::tanh(step / 2) * direction));
      Handles there;
      for (const GroupHandle& h : handles) there.push_back(conjugate(to, h));
      const double length = totalLength(there, corner_weight);
      if (!(length < total - kGain)) continue;
      total = length;
      handles = std::move(there);
      moved_handles.base = moved_handles.base * inverse(to);
      moved = true;
    }
    if (!moved) step /= 2;
  }
  return total < start - kGain;
}

/// The rotations of the relation to start from.
std::vector<Word> startingWords(const Word& relation) {
  std::vector<Word> words;
  const std::size_t count = std::min(kStarts, relation.size());
  for (std::size_t k = 0; k < count; ++k) {
    Word word = relation;
    std::rotate(word.begin(),
                word.begin() + static_cast<std::ptrdiff_t>(k * relation.size() / count),
                word.end());
    words.push_back(std::move(word));
  }
  return words;
}

}  // namespace

double roundingGrowth(const std::vector<GroupHandle>& handles) {
  const auto size = [](const Su11& g) { return std::cosh(displacement(g) / 2); };
  double sum = 0;
  WideSu11 corner;
  for (const GroupHandle& h : handles) {
    for (const WideSu11& side : {h.a, h.b, inverse(h.a), inverse(h.b)}) {
      const WideSu11 next = corner * side;
      const double factor = size(rounded(corner)) * size(rounded(side)) * size(rounded(next));
      sum += factor * factor;
      corner = next;
    }
  }
  return std::sqrt(sum);
}

Result<std::vector<GroupHandle>> splitIntoHandles(const std::vector<WideSu11>& letters,
                                                  const Word& relation) {
  Handles handles;
  Word word = relation;
  while (!word.empty()) {
    const Polygon polygon(letters, word);
    std::optional<Link> best;
    double shortest = 0;
    for (const Link& link : polygon.links()) {
      const double length = lengthOf(polygon.handle(link));
      if (best && !(length < shortest)) continue;
      best = link;
      shortest = length;
    }
    if (!best) {
      return Status(Reason::kInvalidOption,
                    "the polygon's corners do not meet at one point: no two letters are linked");
    }
    handles.push_back(polygon.handle(*best));
    word = polygon.rest(*best);
  }
  return handles;
}

Result<ShortHandles> shortenHandles(Context& context, std::vector<GroupHandle> handles,
                                    double corner_weight) {
  std::size_t moves = kMovesPerHandle * handles.size();
  ShortHandles result{std::move(handles), {}};
  do {
    for (; moves > 0; --moves) {
      RETURN_IF_ERROR(context.check());
      Replacement best = Search(result.handles, corner_weight).best();
      if (!(best.gain > kGain)) break;
      std::move(best.handles.begin(), best.handles.end(),
                result.handles.begin() + static_cast<std::ptrdiff_t>(best.first));
    }
  } while (moveBasePoint(result, corner_weight) && moves > 0);
  return result;
}

Result<ShortHandles> findShortHandles(Context& context, const std::vector<WideSu11>& letters,
                                      const Word& relation) {
  ShortHandles best;
  double smallest = std::numeric_limits<double>::infinity();
  for (const Word& word : startingWords(relation)) {
    ASSIGN_OR_RETURN(const Handles start, splitIntoHandles(letters, word));
    if (!(totalLength(start, 0) < kLongest * static_cast<double>(start.size()))) continue;
    for (const double corner_weight : {0.5, 2.0}) {
      ASSIGN_OR_RETURN(ShortHandles found, shortenHandles(context, start, corner_weight));
      const double growth = roundingGrowth(found.handles);
      if (!(growth < smallest)) continue;
      smallest = growth;
      best = std::move(found);
    }
  }
  if (best.handles.empty()) {
    return Status(Reason::kNoConvergence,
                  "no generators of the group are short enough to be found");
  }
  return best;
}

}  // namespace moduli
