#include "core/spherical/disk_finish.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "core/spherical/disk_centering.h"
#include "core/topology/surface_topology.h"

namespace moduli::spherical {
namespace {

/// Whether the boundary vertices run once around the circle, every step forwards.
bool runsAround(const Connectivity& surface, const DiskMap& map) {
  double turn = 0;
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    if (!surface.isBoundaryEdge(e)) continue;
    const Index h = surface.halfedge(e);
    const double step = std::arg(map.points[surface.head(h)] / map.points[surface.tail(h)]);
    if (step == 0) return false;
    // An edge may take more than half of the circle: one that seems to turn back by nearly all of
    // it. The whole turn tells.
    turn += step < 0 ? step + 2 * std::numbers::pi : step;
  }
  return std::abs(turn - 2 * std::numbers::pi) < 1;
}

/// Parts of an arc smaller than this times their share are due to rounding.
constexpr double kCollapsed = 1e-3;

/// Moves the tips, as the header says. Returns how many.
Index resetFoldedTips(const Connectivity& surface, const std::vector<double>& lengths,
                      std::vector<std::complex<double>>& points) {
  Index count = 0;
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    const Index next = Connectivity::next(h), third = Connectivity::previous(h);
    if (surface.twin(h) != kNone || surface.twin(next) != kNone || surface.twin(third) == kNone) {
      continue;
    }
    const std::complex<double>& from = points[surface.tail(h)];
    std::complex<double>& tip = points[surface.head(h)];
    const std::complex<double>& to = points[surface.head(next)];
    const double before = lengths[surface.edge(h)], after = lengths[surface.edge(next)];
    const double share = before / (before + after);
    double arc = std::arg(to / from);
    if (arc < 0) arc += 2 * std::numbers::pi;
    const double there = std::arg(tip / from) / arc;
    if (there > kCollapsed * share && 1 - there > kCollapsed * (1 - share)) continue;
    tip = from * std::polar(1.0, share * arc);
    ++count;
  }
  return count;
}

}  // namespace

Status checkDisk(const Connectivity& surface) {
  const SurfaceTopology topology = computeTopology(surface);
  if (topology.components == 1 && topology.genus == 0 && topology.boundary_loops.size() == 1) {
    return {};
  }
  return {Reason::kUnsupportedTopology,
          "the map to the disk needs a connected surface of genus 0 with one boundary loop, not "
          "genus " +
              std::to_string(topology.genus) + " with " +
              std::to_string(topology.boundary_loops.size()) + " boundary loops in " +
              std::to_string(topology.components) + " component(s)"};
}

Result<DiskMap> centeredDiskMap(Context& context, const Connectivity& surface,
                                const std::vector<double>& lengths,
                                const std::vector<double>& areas,
                                const std::vector<std::complex<double>>& points) {
  ASSIGN_OR_RETURN(DiskCentering centered, centerDisk(context, points, areas));
  DiskMap map;
  map.points = std::move(centered.points);
  map.centering_residual = centered.residual;
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    if (!surface.isBoundaryVertex(v)) continue;
    map.points[v] /= std::abs(map.points[v]);
    map.boundary_deviation =
        std::max(map.boundary_deviation, std::abs(std::abs(map.points[v]) - 1));
  }
  map.quality = measurePlaneMap(surface, lengths, map.points);
  return map;
}

Result<DiskMap> withTipsReset(Context& context, const Connectivity& surface,
                              const std::vector<double>& lengths, const std::vector<double>& areas,
                              DiskMap map) {
  const Index count = resetFoldedTips(surface, lengths, map.points);
  if (count == 0) return map;
  ASSIGN_OR_RETURN(map, centeredDiskMap(context, surface, lengths, areas, map.points));
  map.reset_tips = count;
  return map;
}

Status checkUnfolded(const Connectivity& surface, const DiskMap& map) {
  if (map.quality.flipped_faces > 0) {
    return {Reason::kFoldedMap,
            "the map to the disk folds " + std::to_string(map.quality.flipped_faces) + " of " +
                std::to_string(surface.faceCount()) + " faces",
            "use the method robust"};
  }
  if (!runsAround(surface, map)) {
    return {Reason::kFoldedMap, "the map to the disk turns back along the boundary",
            "use the method robust"};
  }
  return {};
}

}  // namespace moduli::spherical
