#include "client/cli/mesh_argument.h"

#include <filesystem>

#include "core/mesh/format.h"

namespace moduli::cli {
namespace {

constexpr std::string_view kStorePrefix = "store:";

struct StoredName {
  std::string collection, shape;
};

std::optional<StoredName> storedName(const std::string& word) {
  const std::size_t slash = word.find('/');
  if (slash == 0 || slash == std::string::npos || slash + 1 == word.size()) return std::nullopt;
  if (word.front() == '.' || word.find('/', slash + 1) != std::string::npos) return std::nullopt;
  return StoredName{word.substr(0, slash), word.substr(slash + 1)};
}

Status noSuchFile(const std::string& word) {
  return {Reason::kFileNotFound, word + ": no such file",
          "check the path; a stored shape is named COLLECTION/SHAPE"};
}

}  // namespace

Result<MeshArgument> MeshArgument::open(const Session& session, const std::string& word,
                                        const std::string& format) {
  MeshArgument mesh;
  mesh.name_ = word;
  mesh.format_ = protoFormat(format);
  const bool of_store = word.starts_with(kStorePrefix);
  std::error_code ignored;
  if (!of_store && (word == "-" || std::filesystem::exists(word, ignored))) {
    if (word == "-") mesh.name_ = "standard input";
    ASSIGN_OR_RETURN(mesh.bytes_, MeshBytes::ofFile(word == "-" ? "/dev/stdin" : word));
    return mesh;
  }
  const auto stored = storedName(of_store ? word.substr(kStorePrefix.size()) : word);
  if (of_store && !stored) {
    return Status(Reason::kInvalidName, word + ": names no stored shape",
                  "write store:COLLECTION/SHAPE");
  }
  // Without a store the word can only be a path that is wrong.
  if (!stored || (!of_store && !session.hasStore())) return noSuchFile(word);
  mesh.resource_ = shapeName(stored->collection, stored->shape);
  return mesh;
}

Result<v1::MeshSource> MeshArgument::source(Client& client, std::uint64_t inline_limit) const {
  if (bytes_) return client.sendMesh(*bytes_, name_, format_, inline_limit);
  v1::MeshSource source;
  source.set_shape(resource_);
  return source;
}

Result<std::string> MeshArgument::content() const {
  return bytes_->read(0, bytes_->size());
}

Result<std::string> MeshArgument::content(Client& client) const {
  if (bytes_) return content();
  std::string bytes;
  RETURN_IF_ERROR(client
                      .download(resource_,
                                [&bytes](std::string_view piece) {
                                  bytes += piece;
                                  return Status();
                                })
                      .status());
  return bytes;
}

v1::MeshSource::Format protoFormat(const std::string& name) {
  const auto format = formatFromName(name);
  if (!format) return v1::MeshSource::FORMAT_UNSPECIFIED;
  switch (*format) {
    case MeshFormat::kObj:
      return v1::MeshSource::OBJ;
    case MeshFormat::kOff:
      return v1::MeshSource::OFF;
    case MeshFormat::kPly:
      return v1::MeshSource::PLY;
    case MeshFormat::kStl:
      return v1::MeshSource::STL;
    case MeshFormat::kJson:
      return v1::MeshSource::JSON;
    case MeshFormat::kGifti:
      return v1::MeshSource::GIFTI;
    case MeshFormat::kFreeSurfer:
      return v1::MeshSource::FREESURFER;
  }
  return v1::MeshSource::FORMAT_UNSPECIFIED;
}

}  // namespace moduli::cli
