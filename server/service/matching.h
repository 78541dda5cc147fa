#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "core/base/context.h"
#include "moduli/v1/geometry_service.pb.h"
#include "server/service/backend.h"
#include "server/service/input_points.h"

/// From a request for a match to what is sent back.
namespace moduli {

/// A match in the numbering of the files.
struct MatchedMeshes {
  v1::SurfaceMatch result;
  InputPoints map;      ///< Of the first surface's vertices.
  InputPoints inverse;  ///< Of the second's; empty unless the request wants it.
};

/// Loads, parses, prepares and matches the surfaces of a checked request. Fails as these steps do,
/// faults of one surface naming it; with kInvalidOption for landmarks that do not fit,
/// kUnsupportedContent for an intrinsic triangulation.
Result<MatchedMeshes> matchMeshes(Context& context, const Backend& backend,
                                  const v1::MatchSurfacesRequest& request);

/// The messages that carry a match, one a call, nothing after the last: the map in chunks of at
/// most kMaxChunkBytes, as far as the request wants it, then the result.
std::function<std::optional<v1::MatchSurfacesResponse>()> matchParts(
    std::shared_ptr<const MatchedMeshes> match, const v1::MatchSurfacesRequest& request);

}  // namespace moduli
