#include "core/intrinsic/mollify.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "core/base/text.h"

namespace moduli {
namespace {

/// The longest length, or why the lengths are none.
Result<double> longestLength(const Connectivity& surface, const std::vector<double>& lengths) {
  if (lengths.size() != static_cast<std::size_t>(surface.edgeCount())) {
    return Status{Reason::kInvalidOption, "there are " + std::to_string(lengths.size()) +
                                              " lengths for " +
                                              std::to_string(surface.edgeCount()) + " edges"};
  }
  double longest = 0;
  for (std::size_t e = 0; e < lengths.size(); ++e) {
    if (!(lengths[e] >= 0) || !std::isfinite(lengths[e])) {
      return Status{Reason::kInvalidOption,
                    "edge " + std::to_string(e) + " has the length " + shortestDouble(lengths[e]),
                    "lengths are finite and not negative"};
    }
    longest = std::max(longest, lengths[e]);
  }
  if (!(longest > 0)) return Status{Reason::kInvalidOption, "all edges have length 0"};
  return longest;
}

/// What a face needs beyond rounding errors of its own: lengths differ from what they stand for by
/// half a unit in the last place each.
constexpr double kRoundingSlack = 8 * std::numeric_limits<double>::epsilon();

}  // namespace

Result<MollifiedLengths> mollify(const Connectivity& surface, std::vector<double> lengths,
                                 double relative_slack) {
  ASSIGN_OR_RETURN(const double longest, longestLength(surface, lengths));
  double sum = 0;  // Of lengths over the longest one: huge lengths must not overflow.
  for (const double length : lengths) sum += length / longest;
  const double mean = longest * (sum / static_cast<double>(lengths.size()));
  double shift = 0;
  for (Index f = 0; f < surface.faceCount(); ++f) {
    std::array<double, 3> side = {lengths[surface.edge(3 * f)], lengths[surface.edge(3 * f + 1)],
                                  lengths[surface.edge(3 * f + 2)]};
    std::sort(side.begin(), side.end());
    // The least of the three slacks; the difference first, which is exact where it matters.
    const double slack = side[0] - (side[2] - side[1]);
    const double needed = std::max(relative_slack * mean, kRoundingSlack * side[2]);
    shift = std::max(shift, needed - slack);
  }
  if (shift > 0) {
    for (double& length : lengths) length += shift;
  }
  return MollifiedLengths{std::move(lengths), shift / mean};
}

}  // namespace moduli
