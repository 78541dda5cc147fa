#include "core/hyperbolic/short_handles.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <optional>
#include <utility>

#include "core/hyperbolic/bounded_su11.h"

namespace moduli {
namespace {

/// A few dozen moves a handle were seen.
constexpr std::size_t kMovesPerHandle = 200;
constexpr int kBasePointSteps = 2000;
constexpr std::size_t kStarts = 8;
/// Handles that are longer on average outgrow the precision.
constexpr double kLongest = 60;

using Handles = std::vector<GroupHandle>;

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
    for (const WideSu11& corner : corner_) quick_.emplace_back(corner);
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
  GroupHandle handle(const Link& link) const { return handle(corner_, link); }

  /// No more than the handle's length.
  double leastLength(const Link& link) const { return lengthOf(handle(quick_, link)); }

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

  template <typename Element>
  static HandleOf<Element> handle(const std::vector<Element>& corner, const Link& link) {
    const auto slice = [&corner](std::size_t from, std::size_t to) {
      return inverse(corner[from]) * corner[to];
    };
    const Element p = slice(link.a + 1, link.b);
    const Element q = slice(link.b + 1, link.a_inverse);
    const Element r = slice(link.a_inverse + 1, link.b_inverse);
    const Element ur = corner[link.a] * r;
    const Element urq = ur * q;
    return {corner[link.a + 1] * inverse(urq), urq * p * slice(link.b, link.b + 1) * inverse(ur)};
  }

  Word word_;
  std::vector<WideSu11> corner_;
  std::vector<BoundedSu11> quick_;  ///< The corners in doubles.
};

double totalLength(const Handles& handles, double corner_weight) {
  WideSu11 corner;
  double total = 0;
  for (const GroupHandle& h : handles) total += lengthFrom(corner, h, corner_weight);
  return total;
}

/// What the total length is the sum of, in doubles: elements with weights.
class LengthFromPoint {
 public:
  LengthFromPoint(const Handles& handles, double corner_weight) {
    WideSu11 corner;
    for (const GroupHandle& h : handles) {
      add(h.a, 1);
      add(h.b, 1);
      for (const WideSu11& side : {h.a, h.b, inverse(h.a), inverse(h.b)}) {
        corner = corner * side;
        add(corner, corner_weight);
      }
    }
  }

  /// Of the conjugates by `to`.
  double operator()(const Su11& to) const {
    const Su11 back = inverse(to);
    double total = 0;
    for (std::size_t i = 0; i < elements_.size(); ++i) {
      total += weights_[i] * displacement(to * elements_[i] * back);
    }
    return total;
  }

 private:
  void add(const WideSu11& g, double weight) {
    elements_.push_back(rounded(g));
    weights_.push_back(weight);
  }

  std::vector<Su11> elements_;
  std::vector<double> weights_;
};

/// Conjugates so that 0 comes to where the total length is smallest, which is a convex function of
/// the point: steps in four directions, halved where none helps. Whether that gained anything.
bool moveBasePoint(ShortHandles& moved_handles, double corner_weight) {
  Handles& handles = moved_handles.handles;
  LengthFromPoint length(handles, corner_weight);
  double total = length({});
  const double start = total;
  int steps = kBasePointSteps;
  for (double step = 0.5; step > 0.01 && steps > 0;) {
    bool moved = false;
    for (const Complex direction : {Complex(1, 0), Complex(0, 1), Complex(-1, 0), Complex(0, -1)}) {
      --steps;
      const Su11 to = translationTo(std::tanh(step / 2) * direction);
      if (!(length(to) < total - kLeastGain)) continue;
      const WideSu11 wide = widened(to);
      for (GroupHandle& h : handles) h = conjugate(wide, h);
      moved_handles.base = moved_handles.base * inverse(wide);
      length = LengthFromPoint(handles, corner_weight);
      total = length({});
      moved = true;
    }
    if (!moved) step /= 2;
  }
  return total < start - kLeastGain;
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
      if (best && !(polygon.leastLength(link) < shortest)) continue;
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
      std::optional<HandleReplacement> best = bestMove(result.handles, corner_weight);
      if (!best) break;
      std::move(best->handles.begin(), best->handles.end(),
                result.handles.begin() + static_cast<std::ptrdiff_t>(best->first));
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
