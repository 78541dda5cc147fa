#pragma once

#include <functional>
#include <string_view>

#include "client/cpp/parameterized_mesh.h"
#include "core/base/status.h"

namespace moduli::cli {

/// Writes a parameterized surface as OBJ: all vertices and faces in their order, a `vt` for every
/// point, and in each face that is mapped the points of its corners. Numbers are the shortest
/// decimals that read back as the same doubles. `sink` gets the text in pieces; its failure ends
/// the writing and is returned. O(V + F).
Status writeTexturedObj(const ParameterizedMesh& mesh,
                        const std::function<Status(std::string_view)>& sink);

}  // namespace moduli::cli
