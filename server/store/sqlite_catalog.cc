// Opening, connections and collections. Shapes are written in sqlite_shape_writes.cc and read in
// sqlite_shape_reads.cc, vectors and changes in sqlite_vectors.cc.
#include "server/store/sqlite_catalog.h"

#include <algorithm>
#include <utility>

#include "server/store/migrations.h"

namespace moduli {
namespace {

constexpr std::size_t kMaxIdleReaders = 8;
constexpr std::int64_t kRequestLifetime = std::int64_t{24} * 3600 * 1'000'000;
// How many steps of history are kept for those who catch up.
constexpr int kKeptChanges = 100000;

Timestamp toTimestamp(std::int64_t microseconds) {
  return Timestamp(std::chrono::microseconds(microseconds));
}

// Columns 0 to 4: id, name, creation time, number of shapes, wanted recall (0 for NULL).
CollectionRecord readCollection(const SqliteQuery& query) {
  CollectionRecord record{query.integer(0), query.text(1), toTimestamp(query.integer(2)),
                          query.integer(3)};
  if (const double recall = query.real(4); recall > 0) record.wanted_recall = recall;
  return record;
}

SqliteQuery& bindOrNull(SqliteQuery& query, const std::optional<double>& value) {
  return value ? query.bind(*value) : query.bindNull();
}

Status validateRequestId(std::string_view request_id) {
  const bool good = std::all_of(request_id.begin(), request_id.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
           c == '_';
  });
  if (!good || request_id.size() > 64) {
    return {Reason::kInvalidRequest,
            "request_id has other characters than a-z A-Z 0-9 - _ or more "
            "than 64 of them",
            "use a UUID"};
  }
  return {};
}

}  // namespace

Result<CollectionRecord> findCollection(SqliteConnection& connection, std::string_view name) {
  ASSIGN_OR_RETURN(SqliteQuery query,
                   connection.prepare("SELECT id, name, create_time, shape_count, wanted_recall "
                                      "FROM collections WHERE name = ?"));
  query.bind(name);
  ASSIGN_OR_RETURN(const bool row, query.step());
  if (!row) {
    return Status(Reason::kCollectionNotFound,
                  "there is no collection \"" + std::string(name) + "\"",
                  "create it, or list the collections there are");
  }
  return readCollection(query);
}

SqliteCatalog::SqliteCatalog(std::filesystem::path path, Clock clock)
    : path_(std::move(path)), clock_(std::move(clock)) {}

Result<std::unique_ptr<SqliteCatalog>> SqliteCatalog::open(const std::filesystem::path& path,
                                                           Clock clock) {
  std::unique_ptr<SqliteCatalog> catalog(new SqliteCatalog(path, std::move(clock)));
  ASSIGN_OR_RETURN(catalog->writer_,
                   SqliteConnection::open(path, SqliteConnection::Mode::kReadWrite));
  RETURN_IF_ERROR(migrate(*catalog->writer_, allMigrations()));
  // The newest change is never forgotten: it tells where history is.
  RETURN_IF_ERROR(catalog->writer_->execute(
      "DELETE FROM changes WHERE sequence <= (SELECT max(sequence) FROM changes) - " +
      std::to_string(kKeptChanges)));
  return catalog;
}

SqliteCatalog::Reader::~Reader() {
  if (connection_ == nullptr) return;
  const std::lock_guard lock(catalog_->pool_mutex_);
  if (catalog_->idle_readers_.size() < kMaxIdleReaders) {
    catalog_->idle_readers_.push_back(std::move(connection_));
  }
}

Result<SqliteCatalog::Reader> SqliteCatalog::reader() const {
  {
    const std::lock_guard lock(pool_mutex_);
    if (!idle_readers_.empty()) {
      Reader reader(*this, std::move(idle_readers_.back()));
      idle_readers_.pop_back();
      return reader;
    }
  }
  ASSIGN_OR_RETURN(std::unique_ptr<SqliteConnection> connection,
                   SqliteConnection::open(path_, SqliteConnection::Mode::kReadOnly));
  return Reader(*this, std::move(connection));
}

std::int64_t SqliteCatalog::now() const {
  const Timestamp time = clock_ ? clock_()
                                : std::chrono::time_point_cast<std::chrono::microseconds>(
                                      std::chrono::system_clock::now());
  return time.time_since_epoch().count();
}

Result<std::optional<CollectionRecord>> SqliteCatalog::earlierAnswer(std::string_view request_id,
                                                                     std::string_view name) {
  ASSIGN_OR_RETURN(SqliteQuery old, writer_->prepare("DELETE FROM requests WHERE create_time < ?"));
  RETURN_IF_ERROR(old.bind(now() - kRequestLifetime).run());
  ASSIGN_OR_RETURN(SqliteQuery query,
                   writer_->prepare("SELECT r.collection_id, r.collection_name, r.create_time, 0, "
                                    "c.wanted_recall FROM requests r LEFT JOIN collections c "
                                    "ON c.id = r.collection_id WHERE r.request_id = ?"));
  query.bind(request_id);
  ASSIGN_OR_RETURN(const bool row, query.step());
  if (!row) return std::optional<CollectionRecord>();
  CollectionRecord answer = readCollection(query);
  if (answer.name != name) {
    return Status(Reason::kInvalidRequest,
                  "this request_id has created collection \"" + answer.name + "\" already",
                  "use a new request_id for another request");
  }
  return std::optional<CollectionRecord>(std::move(answer));
}

Result<CollectionRecord> SqliteCatalog::createCollection(
    std::string_view name, std::string_view request_id,
    const std::optional<double>& wanted_recall) {
  RETURN_IF_ERROR(validateCollectionName(name));
  RETURN_IF_ERROR(validateRequestId(request_id));
  RETURN_IF_ERROR(validateWantedRecall(wanted_recall));
  const std::lock_guard lock(write_mutex_);
  ASSIGN_OR_RETURN(SqliteTransaction transaction,
                   SqliteTransaction::begin(*writer_, SqliteTransaction::Kind::kWrite));
  if (!request_id.empty()) {
    ASSIGN_OR_RETURN(std::optional<CollectionRecord> answer, earlierAnswer(request_id, name));
    if (answer) return *std::move(answer);
  }
  const std::int64_t create_time = now();
  ASSIGN_OR_RETURN(SqliteQuery insert,
                   writer_->prepare("INSERT INTO collections (name, create_time, wanted_recall) "
                                    "VALUES (?, ?, ?) ON CONFLICT (name) DO NOTHING"));
  insert.bind(name).bind(create_time);
  RETURN_IF_ERROR(bindOrNull(insert, wanted_recall).run());
  if (writer_->changedRows() == 0) {
    return Status(Reason::kCollectionExists,
                  "there is a collection \"" + std::string(name) + "\" already");
  }
  const std::int64_t id = writer_->lastInsertId();
  if (!request_id.empty()) {
    ASSIGN_OR_RETURN(SqliteQuery note,
                     writer_->prepare("INSERT INTO requests VALUES (?, ?, ?, ?)"));
    RETURN_IF_ERROR(note.bind(request_id).bind(id).bind(name).bind(create_time).run());
  }
  RETURN_IF_ERROR(transaction.commit());
  return CollectionRecord{id, std::string(name), toTimestamp(create_time), 0, wanted_recall};
}

Result<CollectionRecord> SqliteCatalog::updateCollection(
    std::string_view name, const std::optional<double>& wanted_recall) {
  RETURN_IF_ERROR(validateWantedRecall(wanted_recall));
  const std::lock_guard lock(write_mutex_);
  ASSIGN_OR_RETURN(SqliteTransaction transaction,
                   SqliteTransaction::begin(*writer_, SqliteTransaction::Kind::kWrite));
  ASSIGN_OR_RETURN(CollectionRecord collection, findCollection(*writer_, name));
  if (collection.wanted_recall == wanted_recall) return collection;
  ASSIGN_OR_RETURN(SqliteQuery update,
                   writer_->prepare("UPDATE collections SET wanted_recall = ? WHERE id = ?"));
  RETURN_IF_ERROR(bindOrNull(update, wanted_recall).bind(collection.id).run());
  RETURN_IF_ERROR(noteChange(Change::Kind::kCollectionChanged, collection.id, 0));
  RETURN_IF_ERROR(transaction.commit());
  collection.wanted_recall = wanted_recall;
  return collection;
}

Result<std::map<std::int64_t, double>> SqliteCatalog::wantedRecalls() const {
  ASSIGN_OR_RETURN(const Reader connection, reader());
  ASSIGN_OR_RETURN(SqliteQuery query,
                   connection->prepare("SELECT id, wanted_recall FROM collections "
                                       "WHERE wanted_recall IS NOT NULL"));
  std::map<std::int64_t, double> recalls;
  for (;;) {
    ASSIGN_OR_RETURN(const bool row, query.step());
    if (!row) return recalls;
    recalls.emplace(query.integer(0), query.real(1));
  }
}

Result<CollectionRecord> SqliteCatalog::getCollection(std::string_view name) const {
  ASSIGN_OR_RETURN(const Reader connection, reader());
  return findCollection(*connection, name);
}

Result<Page<CollectionRecord>> SqliteCatalog::listCollections(const PageRequest& page) const {
  constexpr std::string_view kQuery = "collections";
  ASSIGN_OR_RETURN(const std::size_t size, effectivePageSize(page));
  ASSIGN_OR_RETURN(const std::string after, readPageToken(kQuery, page.token));
  ASSIGN_OR_RETURN(const Reader connection, reader());
  ASSIGN_OR_RETURN(SqliteQuery query,
                   connection->prepare("SELECT id, name, create_time, shape_count, wanted_recall "
                                       "FROM collections WHERE name > ? ORDER BY name LIMIT ?"));
  query.bind(after).bind(static_cast<std::int64_t>(size + 1));
  Page<CollectionRecord> answer;
  for (;;) {
    ASSIGN_OR_RETURN(const bool row, query.step());
    if (!row) return answer;
    if (answer.items.size() == size) {
      answer.next_token = makePageToken(kQuery, answer.items.back().name);
      return answer;
    }
    answer.items.push_back(readCollection(query));
  }
}

Result<std::int64_t> SqliteCatalog::deleteCollection(std::string_view name, bool force) {
  const std::lock_guard lock(write_mutex_);
  ASSIGN_OR_RETURN(SqliteTransaction transaction,
                   SqliteTransaction::begin(*writer_, SqliteTransaction::Kind::kWrite));
  ASSIGN_OR_RETURN(const CollectionRecord collection, findCollection(*writer_, name));
  const std::int64_t deleted = collection.shape_count;
  if (deleted > 0 && !force) {
    return Status(Reason::kCollectionNotEmpty,
                  "collection \"" + collection.name + "\" has " + std::to_string(deleted) +
                      (deleted == 1 ? " shape" : " shapes"),
                  "remove them first, or delete with --force");
  }
  ASSIGN_OR_RETURN(SqliteQuery shapes,
                   writer_->prepare("DELETE FROM shapes WHERE collection_id = ?"));
  RETURN_IF_ERROR(shapes.bind(collection.id).run());
  ASSIGN_OR_RETURN(SqliteQuery row, writer_->prepare("DELETE FROM collections WHERE id = ?"));
  RETURN_IF_ERROR(row.bind(collection.id).run());
  RETURN_IF_ERROR(noteChange(Change::Kind::kCollectionRemoved, collection.id, 0));
  RETURN_IF_ERROR(transaction.commit());
  return deleted;
}

}  // namespace moduli
