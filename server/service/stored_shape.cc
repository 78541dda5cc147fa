#include "server/service/stored_shape.h"

#include <utility>

#include "server/rpc/convert.h"
#include "server/service/request.h"

namespace moduli {
namespace {

google::protobuf::Timestamp toProto(Timestamp time) {
  const auto seconds = std::chrono::floor<std::chrono::seconds>(time);
  google::protobuf::Timestamp message;
  message.set_seconds(seconds.time_since_epoch().count());
  message.set_nanos(static_cast<std::int32_t>(
      std::chrono::duration_cast<std::chrono::nanoseconds>(time - seconds).count()));
  return message;
}

Status corrupt(const ShapeRecord& record) {
  return {Reason::kStoreCorrupt, "the signature of shape " + record.name + " cannot be read",
          "remove the shape and add it again"};
}

v1::Signature summary(const ShapeRecord& record) {
  v1::Signature signature;
  v1::Topology& topology = *signature.mutable_topology();
  const TopologyKey& key = record.topology;
  topology.set_vertices(key.vertices);
  topology.set_faces(key.faces);
  topology.set_components(1);  // Signed surfaces are connected and oriented.
  topology.set_genus(key.genus);
  topology.set_boundary_loops(key.boundary_loops);
  topology.set_euler_characteristic(2 - 2 * key.genus - key.boundary_loops);
  topology.set_orientable(true);
  topology.set_area(key.area);
  v1::ConformalBlock::Type type = v1::ConformalBlock::TYPE_UNSPECIFIED;
  if (v1::ConformalBlock::Type_Parse(key.type, &type))
    signature.mutable_conformal()->set_type(type);
  signature.set_descriptor_version(record.descriptor_version);
  return signature;
}

}  // namespace

Result<StoredSignature> readStored(const ShapeRecord& record) {
  v1::Shape message;
  if (!message.ParseFromString(record.signature)) return corrupt(record);
  Result<Signature> signature = fromProto(message.signature());
  if (!signature.ok()) return corrupt(record);
  return StoredSignature{*std::move(signature), fromProto(message.prepare())};
}

Result<PrepareOptions> readPrepare(const ShapeRecord& record) {
  v1::Shape message;
  if (!message.ParseFromString(record.signature)) return corrupt(record);
  return fromProto(message.prepare());
}

void fillRecord(const StoredSignature& stored, ShapeRecord& record) {
  const Signature& signature = stored.signature;
  v1::Shape message;
  *message.mutable_signature() = toProto(signature);
  *message.mutable_prepare() = toProto(stored.prepare);
  record.signature = message.SerializeAsString();
  record.vectors = signature.vectors;
  record.descriptor_version = signature.descriptor_version;
  record.topology = {
      .type = signature.conformal ? std::string(conformalTypeName(signature.conformal->type)) : "",
      .genus = signature.topology.genus,
      .boundary_loops = signature.topology.boundary_loops,
      .vertices = signature.topology.vertices,
      .faces = signature.topology.faces,
      .area = signature.topology.area};
}

Result<v1::Shape> toProto(const ShapeRecord& record, bool full) {
  v1::Shape shape;
  if (full) {
    if (!shape.ParseFromString(record.signature) || !shape.has_signature()) return corrupt(record);
  } else {
    *shape.mutable_signature() = summary(record);
  }
  shape.set_name(shapeName(record.collection, record.name));
  shape.set_label(record.label);
  shape.mutable_tags()->insert(record.tags.begin(), record.tags.end());
  shape.set_digest(record.digest);
  shape.set_format(toProto(record.format));
  shape.set_file_name(record.file_name);
  *shape.mutable_create_time() = toProto(record.create_time);
  shape.set_mesh_bytes(static_cast<double>(record.mesh_bytes));
  return shape;
}

v1::Collection toProto(const CollectionRecord& record) {
  v1::Collection collection;
  collection.set_name(collectionName(record.name));
  *collection.mutable_create_time() = toProto(record.create_time);
  collection.set_shape_count(static_cast<std::int32_t>(record.shape_count));
  if (record.wanted_recall) collection.set_wanted_recall(*record.wanted_recall);
  return collection;
}

}  // namespace moduli
