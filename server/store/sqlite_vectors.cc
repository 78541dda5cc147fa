#include <cmath>
#include <cstring>
#include <utility>

#include "core/base/log.h"
#include "server/store/sqlite_catalog.h"

namespace moduli {
namespace {

// Columns 0 to 5 of both reading statements.
constexpr std::string_view kVectorColumns =
    "SELECT s.collection_id, v.shape_id, v.space, s.type, s.descriptor_version, v.bytes "
    "FROM vectors v JOIN shapes s ON s.id = v.shape_id ";

Result<SqliteQuery> selectVectors(SqliteConnection& connection, std::string_view rest) {
  return connection.prepare(std::string(kVectorColumns) + std::string(rest));
}

// The floats of a row; false if they are not what putShape wrote.
bool readVector(const SqliteQuery& query, std::vector<float>& values) {
  const std::string_view bytes = query.bytes(5);
  const std::int64_t space = query.integer(2);
  if (space < 1 || space > 3 || bytes.empty() || bytes.size() % sizeof(float) != 0) return false;
  values.resize(bytes.size() / sizeof(float));
  std::memcpy(values.data(), bytes.data(), bytes.size());
  for (const float value : values) {
    if (!(std::abs(value) <= 1e38F)) return false;
  }
  return true;
}

Status visitRow(const SqliteQuery& query, std::vector<float>& values,
                const std::function<Status(const VectorRow&)>& visit) {
  if (!readVector(query, values)) {
    log(LogLevel::kWarning, "the vector of shape row " + std::to_string(query.integer(1)) +
                                " in space " + std::to_string(query.integer(2)) +
                                " is damaged; it is left out of searches");
    return {};
  }
  VectorRow row;
  row.collection_id = query.integer(0);
  row.shape_id = query.integer(1);
  row.space = static_cast<Space>(query.integer(2) - 1);
  row.type = query.bytes(3);
  row.descriptor_version = static_cast<int>(query.integer(4));
  row.values = values;
  return visit(row);
}

}  // namespace

Result<std::int64_t> SqliteCatalog::forEachVector(
    Context& context, const std::function<Status(const VectorRow&)>& visit) const {
  ASSIGN_OR_RETURN(const Reader connection, reader());
  ASSIGN_OR_RETURN(const SqliteTransaction snapshot,
                   SqliteTransaction::begin(*connection, SqliteTransaction::Kind::kRead));
  ASSIGN_OR_RETURN(const std::int64_t sequence,
                   connection->integerOf("SELECT max(sequence) FROM changes"));
  ASSIGN_OR_RETURN(SqliteQuery query, selectVectors(*connection, "ORDER BY v.shape_id, v.space"));
  std::vector<float> values;
  for (std::size_t seen = 0;; ++seen) {
    if (seen % 1024 == 0) RETURN_IF_ERROR(context.check());
    ASSIGN_OR_RETURN(const bool row, query.step());
    if (!row) return sequence;
    RETURN_IF_ERROR(visitRow(query, values, visit));
  }
}

Status SqliteCatalog::forEachVectorOf(std::span<const std::int64_t> ids,
                                      const std::function<Status(const VectorRow&)>& visit) const {
  ASSIGN_OR_RETURN(const Reader connection, reader());
  ASSIGN_OR_RETURN(const SqliteTransaction snapshot,
                   SqliteTransaction::begin(*connection, SqliteTransaction::Kind::kRead));
  ASSIGN_OR_RETURN(SqliteQuery query,
                   selectVectors(*connection, "WHERE v.shape_id = ? ORDER BY v.space"));
  std::vector<float> values;
  for (const std::int64_t id : ids) {
    query.reset();
    query.bind(id);
    for (;;) {
      ASSIGN_OR_RETURN(const bool row, query.step());
      if (!row) break;
      RETURN_IF_ERROR(visitRow(query, values, visit));
    }
  }
  return {};
}

Result<ChangeBatch> SqliteCatalog::changesSince(std::int64_t sequence, std::size_t limit) const {
  ASSIGN_OR_RETURN(const Reader connection, reader());
  ASSIGN_OR_RETURN(const SqliteTransaction snapshot,
                   SqliteTransaction::begin(*connection, SqliteTransaction::Kind::kRead));
  ASSIGN_OR_RETURN(const std::int64_t oldest,
                   connection->integerOf("SELECT min(sequence) FROM changes"));
  ASSIGN_OR_RETURN(const std::int64_t newest,
                   connection->integerOf("SELECT max(sequence) FROM changes"));
  ChangeBatch batch;
  // Later than the newest: the store is an older copy of what the caller has seen.
  batch.complete = sequence <= newest && (sequence == newest || sequence + 1 >= oldest);
  ASSIGN_OR_RETURN(
      SqliteQuery query,
      connection->prepare("SELECT sequence, kind, collection_id, shape_id "
                          "FROM changes WHERE sequence > ? ORDER BY sequence LIMIT ?"));
  query.bind(sequence).bind(static_cast<std::int64_t>(limit));
  for (;;) {
    ASSIGN_OR_RETURN(const bool row, query.step());
    if (!row) return batch;
    batch.changes.push_back({query.integer(0), static_cast<Change::Kind>(query.integer(1) - 1),
                             query.integer(2), query.integer(3)});
  }
}

}  // namespace moduli
