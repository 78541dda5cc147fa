#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/status.h"
#include "core/mesh/format.h"
#include "core/signature/signature.h"

namespace moduli {

/// Microseconds since 1970-01-01 UTC.
using Timestamp = std::chrono::sys_time<std::chrono::microseconds>;

/// What filters and lists want to know of a signature without parsing it.
struct TopologyKey {
  std::string type;  ///< Conformal type as in the API: "SPHERE", "TORUS", ...
  std::int32_t genus = 0;
  std::int32_t boundary_loops = 0;
  std::int32_t vertices = 0;
  std::int32_t faces = 0;
  double area = 0;  ///< Squared model units.
};

/// The name of a conformal type in the API and in TopologyKey::type.
std::string_view conformalTypeName(ConformalType type);

/// One shape of a collection.
struct ShapeRecord {
  /// Internal row number, given by the catalogue on insert and never given again, not even after
  /// the shape is gone: a replaced shape gets a new one. 0 before.
  std::int64_t id = 0;
  std::string collection;  ///< Name of the collection.
  std::string name;        ///< Unique in its collection; any printable UTF-8 but "/".
  std::string label;
  std::map<std::string, std::string> tags;
  std::string digest;  ///< SHA-256 of the mesh file, 64 lower-case hexadecimal digits.
  MeshFormat format = MeshFormat::kObj;
  std::string file_name;
  Timestamp create_time{};  ///< Given by the catalogue where it is zero.
  std::int64_t mesh_bytes = 0;
  TopologyKey topology;
  int descriptor_version = 0;
  /// Opaque here; the services keep a serialized moduli.v1.Shape with the signature and how the
  /// mesh was prepared for it. Empty in summaries.
  std::string signature;
  SearchVectors vectors;  ///< Read by putShape alone; empty in what the catalogue returns.
};

struct CollectionRecord {
  std::int64_t id = 0;  ///< Internal, never given again.
  std::string name;
  Timestamp create_time{};
  std::int64_t shape_count = 0;
  /// Share of the true nearest that searches are to find; empty: all of them.
  std::optional<double> wanted_recall = {};
};

/// 1 to 63 of a-z A-Z 0-9 "-" "_" ".", not starting with "." or "-"; otherwise kInvalidName.
Status validateCollectionName(std::string_view name);

/// Empty, or between 0 and 1 (neither of them); otherwise kInvalidOption.
Status validateWantedRecall(const std::optional<double>& wanted_recall);

/// 1 to 1024 bytes of printable UTF-8 without "/"; otherwise kInvalidName.
Status validateShapeName(std::string_view name);

/// 64 lower-case hexadecimal digits; otherwise kInvalidRequest.
Status validateDigest(std::string_view digest);

}  // namespace moduli
