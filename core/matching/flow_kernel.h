#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

#include "core/base/context.h"

/// What flows to landmarks have in common: flowToLandmarks and flowOnHemisphere.
namespace moduli {

/// Of a kernel, in ways that its landmark has before it at first.
inline constexpr double kFlowReach = 6;
/// And at least, in edges.
inline constexpr double kFlowEdges = 3;
/// Of a kernel's reach: how far a landmark goes in one step.
inline constexpr double kFlowStep = 0.1;
/// Of an edge.
inline constexpr double kFlowMet = 1e-7;
inline constexpr int kMostFlowSteps = 200, kMostFlowHalvings = 12;

/// Smooth, 1 at 0 and 0 from 1 on (Wendland 1995).
inline double flowKernel(double x) {
  if (!(x < 1)) return 0;
  const double rest = (1 - x) * (1 - x);
  return rest * rest * (4 * x + 1);
}

/// Raises how far landmarks go to how far others would take them along: to stay behind takes as
/// much room. sharesOf(i): per landmark the share of the way of landmark i that it would go with
/// it.
template <typename SharesOf>
void spreadTravels(std::vector<double>& travels, const SharesOf& sharesOf) {
  std::vector<std::size_t> rest(travels.size());
  std::iota(rest.begin(), rest.end(), 0);
  while (!rest.empty()) {
    // Farthest first: nothing takes it along farther.
    const auto next = std::max_element(rest.begin(), rest.end(), [&](std::size_t i, std::size_t j) {
      return travels[i] < travels[j];
    });
    const std::size_t i = *next;
    rest.erase(next);
    if (!(travels[i] > 0)) return;
    const std::vector<double> shares = sharesOf(i);
    for (const std::size_t j : rest) travels[j] = std::max(travels[j], shares[j] * travels[i]);
  }
}

struct FlowCourse {
  bool met = true;
  int steps = 0;
};

/// Goes on by flow.step(share of what a step could be), which says whether no face folds, until
/// flow.met(). partly: where that does not come about, flow.stayBehind() leaves a landmark where it
/// is, if it can, and the others go on.
template <typename Flow>
Result<FlowCourse> runFlow(Context& context, Flow& flow, bool partly) {
  FlowCourse course;
  double share = 1;
  int halvings = 0, steps = 0;
  while (!flow.met()) {
    RETURN_IF_ERROR(context.check());
    if (++steps > kMostFlowSteps || halvings > kMostFlowHalvings) {
      course.met = false;
      if (!partly || !flow.stayBehind()) break;
      share = 1;
      halvings = steps = 0;
      continue;
    }
    ++course.steps;
    if (flow.step(share)) {
      share = std::min(1.0, 2 * share);
      halvings = std::max(0, halvings - 1);
    } else {
      share /= 2;
      ++halvings;
    }
  }
  return course;
}

}  // namespace moduli
