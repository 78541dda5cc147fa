#pragma once

#include <google/protobuf/repeated_field.h>

#include <vector>

#include "core/base/status.h"
#include "core/mesh/connectivity.h"
#include "core/mesh/input_corners.h"
#include "moduli/v1/parameterization.pb.h"

namespace moduli {

/// Per edge of a prepared surface, whether a seam of a request runs along it; empty without seams.
///
/// Fails with kInvalidOption for a vertex that is not there (as namedVertex) and for two in a row
/// that no edge joins, in the numbers of the input. O(E + degrees along the seams).
Result<std::vector<bool>> seamsOnSurface(
    const google::protobuf::RepeatedPtrField<v1::SeamPath>& seams, const Connectivity& surface,
    const VertexPlaces& places);

}  // namespace moduli
