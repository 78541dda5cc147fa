#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/context.h"
#include "moduli/v1/geometry_service.pb.h"
#include "server/service/backend.h"
#include "server/service/geodesic_rows.h"
#include "server/service/map_back.h"

/// From a request for a parameterization to what is sent back.
namespace moduli {

/// A surface with its map, in the numbering of the input.
struct ParameterizedSurface : MappedFaces {
  v1::Parameterization result;
  std::vector<double> carried;         ///< Per vertex of the input the reference's field; or empty.
  std::vector<GeodesicRow> geodesics;  ///< Of a map to the Poincaré disk.
  std::string atlas;                   ///< JSON of an affine atlas; or empty.
};

/// Loads, parses, prepares and maps the surface of a checked request. The arrays are left empty
/// where the request omits them. Fails as these steps do, and with kInvalidOption for cones,
/// corners, landmarks and Möbius maps that do not fit the surface.
Result<ParameterizedSurface> parameterizeMesh(Context& context, const Backend& backend,
                                              const v1::ParameterizeRequest& request);

/// The messages that carry a parameterization, one a call, nothing after the last: the arrays in
/// chunks of at most kMaxChunkBytes, unless they are omitted, then the result.
std::function<std::optional<v1::ParameterizeResponse>()> parameterizationParts(
    std::shared_ptr<const ParameterizedSurface> surface, bool omit_arrays);

}  // namespace moduli
