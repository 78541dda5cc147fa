#pragma once

#include <string>

#include "core/base/status.h"
#include "core/mesh/input_corners.h"

namespace moduli {

/// The vertex of a prepared surface that a request names by its number in the input. what: what
/// stands there, for messages: "a cone". Fails with kInvalidOption where there is none (out of
/// range, without faces, not in the component, dropped or split by repair), saying which.
Result<Index> namedVertex(const std::string& what, Index vertex, const VertexPlaces& places);

}  // namespace moduli
