#include "core/ricci/target_curvature.h"

#include <cmath>
#include <numbers>
#include <numeric>
#include <string>

#include "core/base/text.h"
#include "core/topology/surface_topology.h"

namespace moduli {
namespace {

constexpr double kPi = std::numbers::pi;
/// What typing a curvature with five decimals loses.
constexpr double kTypedRounding = 1e-5;
/// Of a sum of n curvatures: rounding, and no more.
constexpr double kSumRounding = 1e-12;

std::string radians(double value) {
  return shortestDouble(value) + " (" + shortestDouble(std::round(1e4 * value / kPi) / 1e4) +
         " pi)";
}

Status badSum(double sum, const char* relation, double wanted, const char* hint) {
  return {Reason::kInvalidOption,
          "the curvatures sum up to " + radians(sum) + " where Gauss and Bonnet ask for " +
              relation + radians(wanted) + ", 2 pi times the Euler characteristic",
          hint};
}

Status checkSum(Geometry geometry, const Connectivity& surface, const std::vector<double>& target) {
  const double sum = std::accumulate(target.begin(), target.end(), 0.0);
  const double wanted = 2 * kPi * surface.eulerCharacteristic();
  if (geometry == Geometry::kHyperbolic) {
    if (sum > wanted) return {};
    return badSum(sum, "more than ", wanted, "lower no curvature, or take a flat metric");
  }
  double size = std::abs(wanted);
  for (const double curvature : target) size += std::abs(curvature);
  const double slack = kSumRounding * (size + static_cast<double>(target.size()));
  if (std::abs(sum - wanted) <= slack) return {};
  return badSum(sum, "", wanted, "change the cones so that the sum is right");
}

Status readCones(const Connectivity& surface, const std::vector<Cone>& cones,
                 std::vector<double>& target, std::vector<bool>& is_cone) {
  for (const Cone& cone : cones) {
    const std::string name = "the cone at vertex " + std::to_string(cone.vertex);
    if (cone.vertex < 0 || cone.vertex >= surface.vertexCount()) {
      return {Reason::kInvalidOption, name + " is none of the surface's: it has " +
                                          std::to_string(surface.vertexCount()) +
                                          " vertices, counted from 0"};
    }
    if (is_cone[cone.vertex]) {
      return {Reason::kInvalidOption, "vertex " + std::to_string(cone.vertex) + " has two cones",
              "give one curvature for each vertex"};
    }
    if (!std::isfinite(cone.curvature)) {
      return {Reason::kInvalidOption, name + " has no finite curvature"};
    }
    target[cone.vertex] = cone.curvature;
    is_cone[cone.vertex] = true;
  }
  return {};
}

/// Shares out the turning of each boundary loop by length.
void turnEvenly(const Connectivity& surface, const std::vector<double>& lengths,
                const std::vector<bool>& is_cone, std::vector<double>& target) {
  const SurfaceTopology topology = computeTopology(surface);
  const auto loops = topology.boundary_loops.size();
  std::vector<double> length(loops, 0.0);
  for (std::size_t n = 0; n < loops; ++n) {
    for (const Index h : topology.boundary_loops[n]) length[n] += lengths[surface.edge(h)];
  }
  std::size_t longest = 0;
  for (std::size_t n = 1; n < loops; ++n) {
    if (length[n] > length[longest]) longest = n;
  }
  double inner = 0;
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    if (!surface.isBoundaryVertex(v)) inner += target[v];
  }
  for (std::size_t n = 0; n < loops; ++n) {
    double turning = -2 * kPi;
    if (n == longest) {
      turning = 2 * kPi * surface.eulerCharacteristic() - inner +
                2 * kPi * static_cast<double>(loops - 1);
    }
    double weight = 0;
    std::vector<double> share(topology.boundary_loops[n].size());
    for (std::size_t m = 0; m < share.size(); ++m) {
      const Index h = topology.boundary_loops[n][m];
      const Index before = topology.boundary_loops[n][(m + share.size() - 1) % share.size()];
      const Index v = surface.tail(h);
      if (is_cone[v]) {
        turning -= target[v];
      } else {
        share[m] = lengths[surface.edge(h)] + lengths[surface.edge(before)];
        weight += share[m];
      }
    }
    for (std::size_t m = 0; m < share.size(); ++m) {
      const Index v = surface.tail(topology.boundary_loops[n][m]);
      if (!is_cone[v]) target[v] = turning * (share[m] / weight);
    }
  }
}

/// Moves typed figures by what their rounding may be.
void completeSum(const Connectivity& surface, const std::vector<Cone>& cones,
                 std::vector<double>& target) {
  const double missing =
      2 * kPi * surface.eulerCharacteristic() - std::accumulate(target.begin(), target.end(), 0.0);
  const auto count = static_cast<double>(cones.size());
  if (cones.empty() || std::abs(missing) > kTypedRounding * count) return;
  for (const Cone& cone : cones) target[cone.vertex] += missing / count;
}

Status checkCurvatures(const Connectivity& surface, const std::vector<double>& target,
                       bool free_boundary) {
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    const bool boundary = surface.isBoundaryVertex(v);
    if (boundary && free_boundary) continue;
    if (target[v] < (boundary ? kPi : 2 * kPi)) continue;
    return {Reason::kInvalidOption,
            "a curvature of " + radians(target[v]) + " is asked for at vertex " +
                std::to_string(v) + (boundary ? ", on the boundary, where" : ", where") +
                " it has to be below " + (boundary ? "pi" : "2 pi"),
            "no angle would be left there; lower the curvature"};
  }
  return {};
}

}  // namespace

Status checkAdmissible(Geometry geometry, const Connectivity& surface,
                       const std::vector<double>& target) {
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    if (!std::isfinite(target[v])) {
      return {Reason::kInvalidOption,
              "the curvature asked for at vertex " + std::to_string(v) + " is not finite"};
    }
  }
  RETURN_IF_ERROR(checkCurvatures(surface, target, false));
  return checkSum(geometry, surface, target);
}

Result<std::vector<double>> flatTarget(const Connectivity& surface, const std::vector<Cone>& cones,
                                       BoundaryRule rule, const std::vector<double>& lengths) {
  std::vector<double> target(surface.vertexCount(), 0.0);
  std::vector<bool> is_cone(surface.vertexCount(), false);
  RETURN_IF_ERROR(readCones(surface, cones, target, is_cone));
  bool bordered = false;
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    bordered = bordered || surface.isBoundaryVertex(v);
  }
  if (bordered && rule == BoundaryRule::kFree) {
    RETURN_IF_ERROR(checkCurvatures(surface, target, true));
    return target;
  }
  if (bordered && rule == BoundaryRule::kCircle) turnEvenly(surface, lengths, is_cone, target);
  completeSum(surface, cones, target);
  RETURN_IF_ERROR(checkAdmissible(Geometry::kEuclidean, surface, target));
  return target;
}

}  // namespace moduli
