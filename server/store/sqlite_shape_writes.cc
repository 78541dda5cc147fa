#include <bit>
#include <cmath>
#include <utility>

#include "core/base/text.h"
#include "server/store/sqlite_catalog.h"

namespace moduli {
namespace {

constexpr std::size_t kMaxTextBytes = 1024;
constexpr std::size_t kMaxTags = 64;

static_assert(std::endian::native == std::endian::little, "vectors are stored little-endian");

Status validateText(std::string_view what, std::string_view text) {
  if (text.size() <= kMaxTextBytes && isPrintableUtf8(text)) return {};
  return {Reason::kInvalidRequest,
          std::string(what) + " is longer than 1024 bytes or no printable UTF-8"};
}

Status validateVector(std::string_view what, std::span<const float> vector) {
  for (const float value : vector) {
    // The indexes' limit: sums of larger values would overflow.
    if (!(std::abs(value) <= 1e38F)) {
      return {Reason::kInvalidRequest,
              "the " + std::string(what) + " vector has a value that is not finite"};
    }
  }
  return {};
}

Status validateTags(const std::map<std::string, std::string>& tags) {
  if (tags.size() > kMaxTags) return {Reason::kInvalidRequest, "a shape has at most 64 tags"};
  for (const auto& [key, value] : tags) {
    if (key.empty()) return {Reason::kInvalidRequest, "a tag needs a key"};
    RETURN_IF_ERROR(validateText("a tag's key", key));
    RETURN_IF_ERROR(validateText("tag " + key, value));
  }
  return {};
}

Status validateUpdate(const ShapeUpdate& update) {
  if (update.name) RETURN_IF_ERROR(validateShapeName(*update.name));
  if (update.label) RETURN_IF_ERROR(validateText("the label", *update.label));
  return update.tags ? validateTags(*update.tags) : Status();
}

Status noShape(const std::string& collection, std::string_view name) {
  return {Reason::kShapeNotFound,
          "collection \"" + collection + "\" has no shape \"" + std::string(name) + "\""};
}

Status nameTaken(const std::string& collection, std::string_view name, const std::string& hint) {
  return {Reason::kShapeExists,
          "collection \"" + collection + "\" has a shape \"" + std::string(name) + "\" already",
          hint};
}

Status validateShape(const ShapeRecord& shape) {
  RETURN_IF_ERROR(validateShapeName(shape.name));
  RETURN_IF_ERROR(validateDigest(shape.digest));
  RETURN_IF_ERROR(validateText("the label", shape.label));
  RETURN_IF_ERROR(validateText("the file name", shape.file_name));
  RETURN_IF_ERROR(validateText("the type", shape.topology.type));
  RETURN_IF_ERROR(validateTags(shape.tags));
  if (!std::isfinite(shape.topology.area)) {
    return {Reason::kInvalidRequest, "the area is not finite"};
  }
  RETURN_IF_ERROR(validateVector("conformal", shape.vectors.conformal));
  RETURN_IF_ERROR(validateVector("metric", shape.vectors.metric));
  return validateVector("shape", shape.vectors.shape);
}

std::string_view bytesOf(std::span<const float> values) {
  return {reinterpret_cast<const char*>(values.data()), values.size_bytes()};
}

}  // namespace

Result<std::optional<SqliteCatalog::Found>> SqliteCatalog::findForWrite(std::int64_t collection_id,
                                                                        std::string_view name) {
  ASSIGN_OR_RETURN(SqliteQuery query, writer_->prepare("SELECT id, digest, create_time FROM shapes "
                                                       "WHERE collection_id = ? AND name = ?"));
  query.bind(collection_id).bind(name);
  ASSIGN_OR_RETURN(const bool row, query.step());
  if (!row) return std::optional<Found>();
  return std::optional<Found>(Found{query.integer(0), query.text(1),
                                    Timestamp(std::chrono::microseconds(query.integer(2)))});
}

Status SqliteCatalog::noteChange(Change::Kind kind, std::int64_t collection_id,
                                 std::int64_t shape_id) {
  ASSIGN_OR_RETURN(SqliteQuery query,
                   writer_->prepare("INSERT INTO changes (kind, collection_id, shape_id) "
                                    "VALUES (?, ?, ?)"));
  return query.bind(static_cast<std::int64_t>(kind) + 1).bind(collection_id).bind(shape_id).run();
}

Status SqliteCatalog::removeShapeRow(std::int64_t collection_id, std::int64_t id) {
  // Tags, signature and vectors go with the row.
  ASSIGN_OR_RETURN(SqliteQuery remove, writer_->prepare("DELETE FROM shapes WHERE id = ?"));
  RETURN_IF_ERROR(remove.bind(id).run());
  ASSIGN_OR_RETURN(SqliteQuery count,
                   writer_->prepare("UPDATE collections SET shape_count = shape_count - 1 "
                                    "WHERE id = ?"));
  RETURN_IF_ERROR(count.bind(collection_id).run());
  return noteChange(Change::Kind::kShapeRemoved, collection_id, id);
}

Result<std::int64_t> SqliteCatalog::insertShape(const ShapeRecord& shape,
                                                std::int64_t collection_id,
                                                std::int64_t create_time) {
  ASSIGN_OR_RETURN(
      SqliteQuery insert,
      writer_->prepare("INSERT INTO shapes (collection_id, name, label, digest, format, file_name, "
                       "create_time, mesh_bytes, type, genus, boundary_loops, vertices, faces, "
                       "area, descriptor_version) "
                       "VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)"));
  const TopologyKey& topology = shape.topology;
  insert.bind(collection_id).bind(shape.name).bind(shape.label).bind(shape.digest);
  insert.bind(formatName(shape.format)).bind(shape.file_name).bind(create_time);
  insert.bind(shape.mesh_bytes).bind(topology.type).bind(std::int64_t{topology.genus});
  insert.bind(std::int64_t{topology.boundary_loops}).bind(std::int64_t{topology.vertices});
  insert.bind(std::int64_t{topology.faces}).bind(topology.area);
  RETURN_IF_ERROR(insert.bind(std::int64_t{shape.descriptor_version}).run());
  const std::int64_t id = writer_->lastInsertId();
  RETURN_IF_ERROR(insertDetails(shape, id));
  ASSIGN_OR_RETURN(SqliteQuery count,
                   writer_->prepare("UPDATE collections SET shape_count = shape_count + 1 "
                                    "WHERE id = ?"));
  RETURN_IF_ERROR(count.bind(collection_id).run());
  RETURN_IF_ERROR(noteChange(Change::Kind::kShapeAdded, collection_id, id));
  return id;
}

Status SqliteCatalog::insertDetails(const ShapeRecord& shape, std::int64_t id) {
  ASSIGN_OR_RETURN(SqliteQuery signature, writer_->prepare("INSERT INTO signatures VALUES (?, ?)"));
  RETURN_IF_ERROR(signature.bind(id).bindBytes(shape.signature).run());
  RETURN_IF_ERROR(insertTags(shape.tags, id));
  ASSIGN_OR_RETURN(SqliteQuery vector, writer_->prepare("INSERT INTO vectors VALUES (?, ?, ?)"));
  const std::span<const float> spaces[] = {shape.vectors.conformal, shape.vectors.metric,
                                           shape.vectors.shape};
  for (std::int64_t space = 0; space < 3; ++space) {
    if (spaces[space].empty()) continue;
    RETURN_IF_ERROR(vector.bind(id).bind(space + 1).bindBytes(bytesOf(spaces[space])).run());
    vector.reset();
  }
  return {};
}

Status SqliteCatalog::insertTags(const std::map<std::string, std::string>& tags, std::int64_t id) {
  ASSIGN_OR_RETURN(SqliteQuery tag, writer_->prepare("INSERT INTO tags VALUES (?, ?, ?)"));
  for (const auto& [key, value] : tags) {
    RETURN_IF_ERROR(tag.bind(id).bind(key).bind(value).run());
    tag.reset();
  }
  return {};
}

Result<PutResult> SqliteCatalog::putShape(const ShapeRecord& shape, OnExists on_exists,
                                          std::optional<std::int64_t> only_if_id) {
  RETURN_IF_ERROR(validateShape(shape));
  const std::lock_guard lock(write_mutex_);
  ASSIGN_OR_RETURN(SqliteTransaction transaction,
                   SqliteTransaction::begin(*writer_, SqliteTransaction::Kind::kWrite));
  ASSIGN_OR_RETURN(const CollectionRecord collection, findCollection(*writer_, shape.collection));
  ASSIGN_OR_RETURN(const std::optional<Found> found, findForWrite(collection.id, shape.name));
  PutResult result;
  if (found) {
    result = {PutOutcome::kSkipped, found->id, found->digest};
    if (!only_if_id && on_exists == OnExists::kError) {
      return nameTaken(collection.name, shape.name,
                       "choose another name, or say --on-exists skip or replace");
    }
  }
  if (only_if_id && (!found || found->id != *only_if_id)) {
    result.outcome = PutOutcome::kSkipped;
    return result;
  }
  if (found && !only_if_id && on_exists == OnExists::kSkip) return result;
  if (found) RETURN_IF_ERROR(removeShapeRow(collection.id, found->id));
  result.outcome = found ? PutOutcome::kReplaced : PutOutcome::kAdded;
  const std::int64_t given = shape.create_time.time_since_epoch().count();
  ASSIGN_OR_RETURN(result.id, insertShape(shape, collection.id, given != 0 ? given : now()));
  RETURN_IF_ERROR(transaction.commit());
  return result;
}

Status SqliteCatalog::deleteShape(std::string_view collection_name, std::string_view name) {
  const std::lock_guard lock(write_mutex_);
  ASSIGN_OR_RETURN(SqliteTransaction transaction,
                   SqliteTransaction::begin(*writer_, SqliteTransaction::Kind::kWrite));
  ASSIGN_OR_RETURN(const CollectionRecord collection, findCollection(*writer_, collection_name));
  ASSIGN_OR_RETURN(const std::optional<Found> found, findForWrite(collection.id, name));
  if (!found) return noShape(collection.name, name);
  RETURN_IF_ERROR(removeShapeRow(collection.id, found->id));
  return transaction.commit();
}

Result<std::vector<std::string>> SqliteCatalog::deleteShapes(Context& context,
                                                             std::string_view collection_name,
                                                             const Filter& filter, bool dry_run) {
  // Nobody writes between the look and the deletion.
  const std::lock_guard lock(write_mutex_);
  std::vector<std::string> names;
  std::vector<std::int64_t> ids;
  RETURN_IF_ERROR(scanShapes(context, collection_name, filter, [&](const ShapeRecord& shape) {
    names.push_back(shape.name);
    ids.push_back(shape.id);
    return true;
  }));
  if (dry_run) return names;
  ASSIGN_OR_RETURN(SqliteTransaction transaction,
                   SqliteTransaction::begin(*writer_, SqliteTransaction::Kind::kWrite));
  ASSIGN_OR_RETURN(const CollectionRecord collection, findCollection(*writer_, collection_name));
  for (const std::int64_t id : ids) {
    RETURN_IF_ERROR(context.check());
    RETURN_IF_ERROR(removeShapeRow(collection.id, id));
  }
  RETURN_IF_ERROR(transaction.commit());
  return names;
}

Status SqliteCatalog::updateShape(std::string_view collection_name, std::string_view name,
                                  const ShapeUpdate& update) {
  RETURN_IF_ERROR(validateUpdate(update));
  const std::lock_guard lock(write_mutex_);
  ASSIGN_OR_RETURN(SqliteTransaction transaction,
                   SqliteTransaction::begin(*writer_, SqliteTransaction::Kind::kWrite));
  ASSIGN_OR_RETURN(const CollectionRecord collection, findCollection(*writer_, collection_name));
  ASSIGN_OR_RETURN(const std::optional<Found> found, findForWrite(collection.id, name));
  if (!found) return noShape(collection.name, name);
  if (update.name && *update.name != name) {
    ASSIGN_OR_RETURN(const std::optional<Found> other, findForWrite(collection.id, *update.name));
    if (other) return nameTaken(collection.name, *update.name, "choose another name");
    ASSIGN_OR_RETURN(SqliteQuery rename,
                     writer_->prepare("UPDATE shapes SET name = ? WHERE id = ?"));
    RETURN_IF_ERROR(rename.bind(*update.name).bind(found->id).run());
  }
  if (update.label) {
    ASSIGN_OR_RETURN(SqliteQuery label,
                     writer_->prepare("UPDATE shapes SET label = ? WHERE id = ?"));
    RETURN_IF_ERROR(label.bind(*update.label).bind(found->id).run());
  }
  if (update.tags) {
    ASSIGN_OR_RETURN(SqliteQuery clear, writer_->prepare("DELETE FROM tags WHERE shape_id = ?"));
    RETURN_IF_ERROR(clear.bind(found->id).run());
    RETURN_IF_ERROR(insertTags(*update.tags, found->id));
  }
  return transaction.commit();
}

}  // namespace moduli
