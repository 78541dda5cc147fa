#include "core/parameterize/genus_zero.h"

#include <string>

namespace moduli {
namespace {

std::string counted(Index count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

}  // namespace

std::string targetOf(const SurfaceTopology& topology) {
  const auto loops = static_cast<Index>(topology.boundary_loops.size());
  if (topology.components != 1) return "name one with --component";
  if (topology.genus > 0) {
    return loops == 0 && topology.genus == 1
               ? "--to flat maps it, and --to torus to a parallelogram"
               : "--to hyperbolic maps it, and --to flat with cones; --fill-holes and --repair may "
                 "remove handles that are none";
  }
  switch (loops) {
    case 0:
      return "--to sphere maps it; cut or drop faces to give it a boundary";
    case 1:
      return "--to disk and --to rectangle map it; --fill-holes closes it";
    default:
      return loops == 2 ? "--to circle-domain maps it; --fill-holes closes small loops"
                        : "--to circle-domain and --to hyperbolic map it; --fill-holes closes "
                          "small loops";
  }
}

Status checkGenusZero(const Connectivity& surface, const std::string& map, Index least_loops,
                      Index most_loops) {
  const SurfaceTopology topology = computeTopology(surface);
  const auto loops = static_cast<Index>(topology.boundary_loops.size());
  if (topology.components == 1 && topology.genus == 0 && least_loops <= loops &&
      loops <= most_loops) {
    return {};
  }
  const std::string wanted = most_loops == 0 ? "no boundary"
                             : least_loops == most_loops
                                 ? counted(least_loops, "boundary loop")
                                 : "at least " + counted(least_loops, "boundary loop");
  return {Reason::kUnsupportedTopology,
          map + " needs a connected surface of genus 0 with " + wanted + ", not genus " +
              std::to_string(topology.genus) + " with " + counted(loops, "boundary loop") + " in " +
              counted(topology.components, "component"),
          targetOf(topology)};
}

Status foldedMap(const std::string& map, Index folded, Index faces, const std::string& hint) {
  return {Reason::kFoldedMap,
          map + " folds " + std::to_string(folded) + " of " + std::to_string(faces) + " faces",
          hint};
}

}  // namespace moduli
