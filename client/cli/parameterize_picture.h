#pragma once

#include <optional>
#include <string>
#include <vector>

#include "client/cli/command.h"
#include "client/cli/mesh_argument.h"
#include "client/cpp/client.h"
#include "client/cpp/parameterized_mesh.h"
#include "core/base/status.h"

namespace moduli::cli {

/// --picture, --size and --view of `parameterize`.
std::vector<OptionSpec> pictureOptions();

/// What is wrong with them, if anything.
std::optional<std::string> checkPicture(const Arguments& arguments);

/// The bytes of the picture that they ask for. map: with its arrays. A map to the sphere needs the
/// mesh itself once more, for its place in space. Fails as reading it does, and with kInternal.
Result<std::string> pictureOf(Client& client, const Arguments& arguments, const MeshArgument& mesh,
                              const ParameterizedMesh& map);

}  // namespace moduli::cli
