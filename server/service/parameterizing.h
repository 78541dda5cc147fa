#pragma once

#include <Eigen/Core>
#include <complex>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "core/base/context.h"
#include "core/mesh/triangle_soup.h"
#include "moduli/v1/geometry_service.pb.h"
#include "server/service/backend.h"

/// From a request for a parameterization to what is sent back.
namespace moduli {

/// A surface with its map to the plane, in the numbering of the input. Of an intrinsic
/// triangulation, which has no positions, it is the image in the plane itself: a vertex (x, y, 0)
/// for every point.
struct ParameterizedSurface {
  std::vector<Eigen::Vector3d> positions;    ///< Of all vertices of the input.
  std::vector<Triangle> faces;               ///< All faces of the input.
  std::vector<std::complex<double>> points;  ///< Each is the image of a corner.
  std::vector<Triangle> corners;  ///< Per face its points; kNone, three times, where not mapped.
  v1::Parameterization result;
};

/// Loads, parses, prepares and maps the surface of a checked request. The arrays are left empty
/// where the request omits them. Fails as these steps do, and with kInvalidOption for cones that do
/// not fit the surface.
Result<ParameterizedSurface> parameterizeMesh(Context& context, const Backend& backend,
                                              const v1::ParameterizeRequest& request);

/// The messages that carry a parameterization, one a call, nothing after the last: the arrays in
/// chunks of at most kMaxChunkBytes, unless they are omitted, then the result.
std::function<std::optional<v1::ParameterizeResponse>()> parameterizationParts(
    std::shared_ptr<const ParameterizedSurface> surface, bool omit_arrays);

}  // namespace moduli
