#pragma once

#include <optional>
#include <string>

#include "core/base/status.h"
#include "core/mesh/connectivity.h"
#include "core/topology/surface_topology.h"

/// What the maps of genus-0 surfaces ask of theirs. Internal to this room.
namespace moduli {

/// Fails with kUnsupportedTopology unless the surface is connected, of genus 0, and has so many
/// boundary loops, at least and at most. map: "the map to the sphere". The hint names the target
/// that such a surface has. O(F).
Status checkGenusZero(const Connectivity& surface, const std::string& map, Index least_loops,
                      Index most_loops);

/// Which target maps a surface: the hint of messages that refuse another.
std::string targetOf(const SurfaceTopology& topology);

/// For each face whether its image is turned over or has no area.
template <typename Points, typename Sign>
std::vector<bool> foldedFaces(const Connectivity& surface, const Points& points, const Sign& sign) {
  std::vector<bool> folded(surface.faceCount());
  for (Index f = 0; f < surface.faceCount(); ++f) {
    const Triangle& face = surface.face(f);
    folded[f] = sign(points[face[0]], points[face[1]], points[face[2]]) <= 0;
  }
  return folded;
}

/// kFoldedMap with the number of faces.
Status foldedMap(const std::string& map, Index folded, Index faces, const std::string& hint);

}  // namespace moduli
