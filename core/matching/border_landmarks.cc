#include "core/matching/border_landmarks.h"

#include <algorithm>
#include <string>
#include <utility>

namespace moduli {
namespace {

/// A landmark on boundaries.
struct BorderMark {
  std::size_t number = 0;
  Index from = kNone, to = kNone;  ///< Loops.
  double here = 0, there = 0;      ///< Shares of these.
};

std::vector<BorderMark> marksOf(const BorderPlaces& a, const BorderPlaces& b,
                                const Connectivity& surface_a, const Connectivity& surface_b,
                                const std::vector<MatchLandmark>& landmarks) {
  std::vector<BorderMark> marks;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const auto from = borderPointAt(surface_a, landmarks[i].a);
    const auto to = borderPointAt(surface_b, landmarks[i].b);
    if (!from || !to) continue;
    marks.push_back(
        {i, a.loopOf(from->halfedge), b.loopOf(to->halfedge), a.shareAt(*from), b.shareAt(*to)});
  }
  std::stable_sort(marks.begin(), marks.end(), [](const BorderMark& x, const BorderMark& y) {
    return x.from != y.from ? x.from < y.from : x.here < y.here;
  });
  return marks;
}

Status contradiction(const std::vector<MatchLandmark>& landmarks, std::size_t i, std::size_t j,
                     const std::string& why) {
  return {Reason::kFoldedMap,
          landmarks[std::min(i, j)].name + " and " + landmarks[std::max(i, j)].name +
              " contradict each other: " + why,
          "leave one of them out, or give it as a soft landmark"};
}

/// The numbers of the longest ascending part.
std::vector<std::size_t> longestAscending(const std::vector<double>& values) {
  std::vector<std::size_t> ends, before(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto at = std::lower_bound(ends.begin(), ends.end(), values[i],
                                     [&](std::size_t k, double x) { return values[k] < x; });
    before[i] = at == ends.begin() ? i : *(at - 1);
    if (at == ends.end()) {
      ends.push_back(i);
    } else {
      *at = i;
    }
  }
  std::vector<std::size_t> part;
  for (std::size_t k = ends.empty() ? values.size() : ends.back(); part.size() < ends.size();
       k = before[k]) {
    part.push_back(k);
  }
  std::reverse(part.begin(), part.end());
  return part;
}

/// How far on from the first one's the targets are, for the marks from there on.
std::vector<double> onFrom(const std::vector<BorderMark>& marks, std::size_t first) {
  std::vector<double> values = {0};
  for (std::size_t n = 1; n < marks.size(); ++n) {
    const double on = marks[(first + n) % marks.size()].there - marks[first].there;
    values.push_back(on < 0 ? on + 1 : on);
  }
  return values;
}

/// One that is out of order, and the nearest of those that are not which it has changed places
/// with; nothing where all keep it. marks: of one loop, by their places on it.
std::optional<std::pair<std::size_t, std::size_t>> outOfOrder(
    const std::vector<BorderMark>& marks) {
  const std::size_t count = marks.size();
  std::vector<std::size_t> best;
  std::size_t start = 0;
  for (std::size_t first = 0; first < count && best.size() < count; ++first) {
    std::vector<std::size_t> part = longestAscending(onFrom(marks, first));
    if (part.size() <= best.size()) continue;
    best = std::move(part);
    start = first;
  }
  if (best.size() == count) return {};
  const std::vector<double> values = onFrom(marks, start);
  std::size_t odd = 0;
  while (odd < best.size() && best[odd] == odd) ++odd;
  std::size_t crossed = best.back(), least = count;
  for (const std::size_t n : best) {
    const std::size_t away = n < odd ? odd - n : n - odd;
    if ((n < odd) == (values[n] < values[odd]) || away >= least) continue;
    least = away;
    crossed = n;
  }
  return std::pair(marks[(start + odd) % count].number, marks[(start + crossed) % count].number);
}

}  // namespace

Status checkBorderSides(const Connectivity& a, const Connectivity& b,
                        const std::vector<MatchLandmark>& landmarks) {
  for (const MatchLandmark& landmark : landmarks) {
    if (borderPointAt(a, landmark.a).has_value() == borderPointAt(b, landmark.b).has_value()) {
      continue;
    }
    return {Reason::kInvalidOption,
            landmark.name + " is on the boundary of one surface, not on that of the other"};
  }
  return {};
}

Status checkBorderOrder(const BorderPlaces& a, const BorderPlaces& b, const Connectivity& surface_a,
                        const Connectivity& surface_b,
                        const std::vector<MatchLandmark>& landmarks) {
  const std::vector<BorderMark> marks = marksOf(a, b, surface_a, surface_b, landmarks);
  std::vector<const BorderMark*> from(a.loops().size(), nullptr), to(b.loops().size(), nullptr);
  for (const BorderMark& mark : marks) {
    const BorderMark*& here = from[mark.from];
    const BorderMark*& there = to[mark.to];
    if (here != nullptr && here->to != mark.to) {
      return contradiction(landmarks, here->number, mark.number,
                           "they are on one boundary loop of the first surface, but on two of the "
                           "second");
    }
    if (there != nullptr && there->from != mark.from) {
      return contradiction(landmarks, there->number, mark.number,
                           "they are on one boundary loop of the second surface, but on two of the "
                           "first");
    }
    here = there = &mark;
  }
  for (auto first = marks.begin(); first != marks.end();) {
    const auto last = std::find_if(
        first, marks.end(), [&](const BorderMark& mark) { return mark.from != first->from; });
    if (const auto pair = outOfOrder({first, last})) {
      return contradiction(landmarks, pair->first, pair->second,
                           "their boundary loop has them, and a third one, in another order on the "
                           "second surface");
    }
    first = last;
  }
  return {};
}

std::vector<Index> loopsByLandmarks(const BorderPlaces& a, const BorderPlaces& b,
                                    const Connectivity& surface_a, const Connectivity& surface_b,
                                    const std::vector<MatchLandmark>& landmarks) {
  std::vector<BorderMark> marks = marksOf(a, b, surface_a, surface_b, landmarks);
  std::sort(marks.begin(), marks.end(),
            [](const BorderMark& x, const BorderMark& y) { return x.number < y.number; });
  std::vector<Index> loops(a.loops().size(), kNone);
  for (const BorderMark& mark : marks) {
    const bool taken = std::find(loops.begin(), loops.end(), mark.to) != loops.end();
    if (loops[mark.from] == kNone && !taken) loops[mark.from] = mark.to;
  }
  return loops;
}

}  // namespace moduli
