#pragma once

#include "core/matching/match_surfaces.h"
#include "moduli/v1/matching.pb.h"

/// Matches as messages of the public API and back. Pure; O(size of the value).
namespace moduli {

/// Without the landmarks: those speak of the input's vertices.
MatchOptions fromProto(const v1::MatchOptions& message);

/// Without the map. Numbers that are not finite are left out.
v1::SurfaceMatch toProto(const SurfaceMatch& match);

}  // namespace moduli
