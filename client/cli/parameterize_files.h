#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/cli/command.h"
#include "client/cli/file_writer.h"
#include "client/cli/mesh_argument.h"
#include "client/cpp/client.h"
#include "client/cpp/parameterized_mesh.h"
#include "core/base/status.h"

namespace moduli::cli {

/// -o and --texture of `parameterize`, and what belongs to its files.
std::vector<OptionSpec> parameterizeFileOptions();

/// What is wrong with them, if anything.
std::optional<std::string> checkParameterizeFiles(const Arguments& arguments);

/// The files that a run of `parameterize` writes. They come to their places together, when all of
/// them are there.
class ParameterizeFiles {
 public:
  /// Keeps `arguments`.
  explicit ParameterizeFiles(const Arguments& arguments);

  bool wanted() const { return !files_.empty(); }

  /// Before the work, so that a place where nothing can be written is told in time. Fails with
  /// kFileUnwritable.
  Status open();

  /// mesh: with its arrays. Fails as writing and drawing do.
  Status write(const ParameterizedMesh& mesh, const MeshArgument& input, Client& client);

 private:
  FileWriter* add(const std::string& path);
  Status writeTexture(const ParameterizedMesh& mesh);
  Status writeObj(const ParameterizedMesh& mesh, const MeshArgument& input, Client& client);
  Status writeGlb(const ParameterizedMesh& mesh, const MeshArgument& input, Client& client);
  Status writeOutput(const ParameterizedMesh& mesh, const MeshArgument& input, Client& client);

  const Arguments& arguments_;
  std::string output_, carried_;
  std::vector<std::unique_ptr<FileWriter>> files_;
  FileWriter *output_file_ = nullptr, *carried_file_ = nullptr, *picture_file_ = nullptr;
  FileWriter *texture_file_ = nullptr, *materials_file_ = nullptr, *atlas_file_ = nullptr;
};

}  // namespace moduli::cli
