#pragma once

#include <optional>
#include <string>
#include <vector>

#include "client/cli/command.h"
#include "client/cli/map_picture.h"
#include "client/cli/mesh_argument.h"
#include "client/cpp/client.h"
#include "client/cpp/parameterized_mesh.h"
#include "core/base/status.h"

namespace moduli::cli {

/// --picture, --draw, --size and --view of `parameterize`.
std::vector<OptionSpec> pictureOptions();

/// What is wrong with them, if anything.
std::optional<std::string> checkPicture(const Arguments& arguments);

/// A map with what its picture needs beside it.
class DrawnMap {
 public:
  /// map: with its arrays; has to stay. Maps to the sphere need the mesh itself once more, for its
  /// place in space. Fails as reading it does, and as checkDrawable.
  static Result<DrawnMap> open(Client& client, const Arguments& arguments, const MeshArgument& mesh,
                               const ParameterizedMesh& map);

  /// What the arguments ask for. Valid while this object is.
  MapPicture picture() const;

 private:
  MapPicture picture_;
  std::vector<double> space_, field_;
};

}  // namespace moduli::cli
