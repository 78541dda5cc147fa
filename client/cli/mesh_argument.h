#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "client/cli/session.h"
#include "client/cpp/mesh_bytes.h"
#include "core/base/status.h"
#include "moduli/v1/mesh.pb.h"

namespace moduli::cli {

/// A MESH of the command line: a file, "-" for standard input, or COLLECTION/SHAPE of the store. An
/// existing file wins; "store:COLLECTION/SHAPE" is of the store in any case.
class MeshArgument {
 public:
  /// Finds out what the word means, and opens a file or reads standard input. Fails with
  /// kFileNotFound, kFileUnreadable, kInvalidName.
  static Result<MeshArgument> open(const Session& session, const std::string& word,
                                   const std::string& format);

  bool stored() const { return !bytes_; }
  /// What the store has to be for this mesh.
  StoreNeed need() const { return stored() ? StoreNeed::kExisting : StoreNeed::kNone; }
  /// As the user knows it, for messages.
  const std::string& name() const { return name_; }

  /// As a source for requests; sends the mesh where it has to be sent, within the request up to
  /// `inline_limit` bytes.
  Result<v1::MeshSource> source(Client& client,
                                std::uint64_t inline_limit = Client::kInlineLimit) const;

  /// The whole file that was given; not for a stored one.
  Result<std::string> content() const;
  /// The whole file, also a stored one. Fails as Client::download does.
  Result<std::string> content(Client& client) const;

  /// The resource name of a stored one.
  const std::string& resource() const { return resource_; }

 private:
  std::string name_;
  std::string resource_;
  v1::MeshSource::Format format_ = v1::MeshSource::FORMAT_UNSPECIFIED;
  std::optional<MeshBytes> bytes_;
};

/// "obj" and so on; FORMAT_UNSPECIFIED for "".
v1::MeshSource::Format protoFormat(const std::string& name);

}  // namespace moduli::cli
