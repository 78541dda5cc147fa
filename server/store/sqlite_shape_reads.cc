#include <utility>

#include "core/base/log.h"
#include "server/store/sqlite_catalog.h"

namespace moduli {
namespace {

// Columns 0 to 15 of every reading statement; readRow knows the order.
constexpr std::string_view kShapeColumns =
    "SELECT s.id, c.name, s.name, s.label, s.digest, s.format, s.file_name, s.create_time, "
    "s.mesh_bytes, s.type, s.genus, s.boundary_loops, s.vertices, s.faces, s.area, "
    "s.descriptor_version FROM shapes s JOIN collections c ON c.id = s.collection_id ";

Result<SqliteQuery> selectShapes(SqliteConnection& connection, std::string_view where) {
  return connection.prepare(std::string(kShapeColumns) + std::string(where));
}

Status damaged(const ShapeRecord& shape, std::string_view what) {
  return {Reason::kStoreCorrupt,
          "shape \"" + shape.name + "\" of collection \"" + shape.collection + "\" (row " +
              std::to_string(shape.id) + ") is damaged: " + std::string(what),
          "remove it and add it again"};
}

Result<ShapeRecord> readRow(const SqliteQuery& query) {
  ShapeRecord shape;
  shape.id = query.integer(0);
  shape.collection = query.text(1);
  shape.name = query.text(2);
  shape.label = query.text(3);
  shape.digest = query.text(4);
  shape.file_name = query.text(6);
  shape.create_time = Timestamp(std::chrono::microseconds(query.integer(7)));
  shape.mesh_bytes = query.integer(8);
  TopologyKey& topology = shape.topology;
  topology.type = query.text(9);
  topology.genus = static_cast<std::int32_t>(query.integer(10));
  topology.boundary_loops = static_cast<std::int32_t>(query.integer(11));
  topology.vertices = static_cast<std::int32_t>(query.integer(12));
  topology.faces = static_cast<std::int32_t>(query.integer(13));
  topology.area = query.real(14);
  shape.descriptor_version = static_cast<int>(query.integer(15));
  if (!validateShapeName(shape.name).ok()) return damaged(shape, "its name");
  if (!validateDigest(shape.digest).ok()) return damaged(shape, "its digest");
  const std::optional<MeshFormat> format = formatFromName(query.text(5));
  if (!format) return damaged(shape, "its format");
  shape.format = *format;
  return shape;
}

Status readTags(SqliteConnection& connection, ShapeRecord& shape) {
  ASSIGN_OR_RETURN(SqliteQuery query,
                   connection.prepare("SELECT key, value FROM tags WHERE shape_id = ?"));
  query.bind(shape.id);
  for (;;) {
    ASSIGN_OR_RETURN(const bool row, query.step());
    if (!row) return {};
    shape.tags.emplace(query.text(0), query.text(1));
  }
}

Status readSignature(SqliteConnection& connection, ShapeRecord& shape) {
  ASSIGN_OR_RETURN(SqliteQuery query,
                   connection.prepare("SELECT bytes FROM signatures WHERE shape_id = ?"));
  query.bind(shape.id);
  ASSIGN_OR_RETURN(const bool row, query.step());
  if (!row) return damaged(shape, "its signature is gone");
  shape.signature = query.text(0);
  return {};
}

Status readDetails(SqliteConnection& connection, ShapeView view, ShapeRecord& shape) {
  RETURN_IF_ERROR(readTags(connection, shape));
  return view == ShapeView::kFull ? readSignature(connection, shape) : Status();
}

// Shapes of one collection after a name, in the order of names. A damaged row is skipped.
Status scanAfter(Context& context, SqliteConnection& connection, std::int64_t collection_id,
                 std::string_view after, const Filter& filter,
                 const std::function<Result<bool>(ShapeRecord&)>& visit) {
  ASSIGN_OR_RETURN(
      SqliteQuery query,
      selectShapes(connection, "WHERE s.collection_id = ? AND s.name > ? ORDER BY s.name"));
  query.bind(collection_id).bind(after);
  for (std::size_t seen = 0;; ++seen) {
    if (seen % 256 == 0) RETURN_IF_ERROR(context.check());
    ASSIGN_OR_RETURN(const bool row, query.step());
    if (!row) return {};
    Result<ShapeRecord> shape = readRow(query);
    if (!shape.ok()) {
      log(LogLevel::kWarning, shape.status().message() + "; skipped");
      continue;
    }
    if (filter.usesTags()) RETURN_IF_ERROR(readTags(connection, *shape));
    if (!filter.matches(*shape)) continue;
    ASSIGN_OR_RETURN(const bool go_on, visit(*shape));
    if (!go_on) return {};
  }
}

}  // namespace

Result<ShapeRecord> SqliteCatalog::getShape(std::string_view collection, std::string_view name,
                                            ShapeView view) const {
  ASSIGN_OR_RETURN(const Reader connection, reader());
  ASSIGN_OR_RETURN(const SqliteTransaction snapshot,
                   SqliteTransaction::begin(*connection, SqliteTransaction::Kind::kRead));
  ASSIGN_OR_RETURN(const CollectionRecord found, findCollection(*connection, collection));
  ASSIGN_OR_RETURN(SqliteQuery query,
                   selectShapes(*connection, "WHERE s.collection_id = ? AND s.name = ?"));
  query.bind(found.id).bind(name);
  ASSIGN_OR_RETURN(const bool row, query.step());
  if (!row) {
    return Status(Reason::kShapeNotFound,
                  "collection \"" + found.name + "\" has no shape \"" + std::string(name) + "\"");
  }
  ASSIGN_OR_RETURN(ShapeRecord shape, readRow(query));
  RETURN_IF_ERROR(readDetails(*connection, view, shape));
  return shape;
}

Result<std::vector<ShapeRecord>> SqliteCatalog::getShapesById(std::span<const std::int64_t> ids,
                                                              ShapeView view) const {
  ASSIGN_OR_RETURN(const Reader connection, reader());
  ASSIGN_OR_RETURN(const SqliteTransaction snapshot,
                   SqliteTransaction::begin(*connection, SqliteTransaction::Kind::kRead));
  ASSIGN_OR_RETURN(SqliteQuery query, selectShapes(*connection, "WHERE s.id = ?"));
  std::vector<ShapeRecord> shapes;
  for (const std::int64_t id : ids) {
    query.reset();
    query.bind(id);
    ASSIGN_OR_RETURN(const bool row, query.step());
    if (!row) continue;
    Result<ShapeRecord> shape = readRow(query);
    Status status = shape.status();
    if (status.ok()) status = readDetails(*connection, view, *shape);
    if (status.ok()) {
      shapes.push_back(*std::move(shape));
    } else {
      log(LogLevel::kWarning, status.message() + "; skipped");
    }
  }
  return shapes;
}

Result<Page<ShapeRecord>> SqliteCatalog::listShapes(Context& context, std::string_view collection,
                                                    std::string_view filter_text,
                                                    const PageRequest& page) const {
  const std::string list = "shapes/" + std::string(collection) + "/" + std::string(filter_text);
  ASSIGN_OR_RETURN(const std::size_t size, effectivePageSize(page));
  ASSIGN_OR_RETURN(const Filter filter, Filter::parse(filter_text));
  ASSIGN_OR_RETURN(const std::string after, readPageToken(list, page.token));
  ASSIGN_OR_RETURN(const Reader connection, reader());
  ASSIGN_OR_RETURN(const SqliteTransaction snapshot,
                   SqliteTransaction::begin(*connection, SqliteTransaction::Kind::kRead));
  ASSIGN_OR_RETURN(const CollectionRecord found, findCollection(*connection, collection));
  Page<ShapeRecord> answer;
  const auto take = [&](ShapeRecord& shape) -> Result<bool> {
    if (answer.items.size() == size) {
      answer.next_token = makePageToken(list, answer.items.back().name);
      return false;
    }
    if (!filter.usesTags()) RETURN_IF_ERROR(readTags(*connection, shape));
    answer.items.push_back(std::move(shape));
    return true;
  };
  RETURN_IF_ERROR(scanAfter(context, *connection, found.id, after, filter, take));
  return answer;
}

Status SqliteCatalog::scanShapes(Context& context, std::string_view collection,
                                 const Filter& filter,
                                 const std::function<bool(const ShapeRecord&)>& visit) const {
  ASSIGN_OR_RETURN(const Reader connection, reader());
  ASSIGN_OR_RETURN(const SqliteTransaction snapshot,
                   SqliteTransaction::begin(*connection, SqliteTransaction::Kind::kRead));
  ASSIGN_OR_RETURN(const CollectionRecord found, findCollection(*connection, collection));
  return scanAfter(context, *connection, found.id, "", filter,
                   [&](ShapeRecord& shape) -> Result<bool> { return visit(shape); });
}

Result<bool> SqliteCatalog::hasMesh(std::string_view digest) const {
  ASSIGN_OR_RETURN(const Reader connection, reader());
  ASSIGN_OR_RETURN(SqliteQuery query,
                   connection->prepare("SELECT 1 FROM shapes WHERE digest = ? LIMIT 1"));
  query.bind(digest);
  return query.step();
}

Result<std::vector<ShapeName>> SqliteCatalog::outdatedShapes(int descriptor_version,
                                                             std::size_t limit) const {
  ASSIGN_OR_RETURN(const Reader connection, reader());
  ASSIGN_OR_RETURN(SqliteQuery query,
                   connection->prepare("SELECT c.name, s.name FROM shapes s "
                                       "JOIN collections c ON c.id = s.collection_id "
                                       "WHERE s.descriptor_version <> ? ORDER BY s.id LIMIT ?"));
  query.bind(std::int64_t{descriptor_version}).bind(static_cast<std::int64_t>(limit));
  std::vector<ShapeName> names;
  for (;;) {
    ASSIGN_OR_RETURN(const bool row, query.step());
    if (!row) return names;
    names.push_back({query.text(0), query.text(1)});
  }
}

}  // namespace moduli
