#pragma once

#include <functional>
#include <string_view>

#include "client/cpp/matched_surfaces.h"
#include "core/base/status.h"

namespace moduli::cli {

/// A map as comma-separated values: the header "vertex,face,b0,b1,b2", then a line a vertex in
/// order, numbers as the shortest text that reads back as the same. In pieces; a failure of the
/// sink ends it and is returned.
Status writeVertexMap(const VertexMap& map, const std::function<Status(std::string_view)>& sink);

}  // namespace moduli::cli
