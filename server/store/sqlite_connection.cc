// The one place that knows SQLite's C interface.
#include "server/store/sqlite_connection.h"

#include <sqlite3.h>

#include <utility>

#include "core/base/log.h"

namespace moduli {

SqliteQuery::SqliteQuery(SqliteQuery&& other) noexcept
    : connection_(other.connection_),
      sql_(std::move(other.sql_)),
      statement_(std::exchange(other.statement_, nullptr)),
      bound_(other.bound_),
      bind_failure_(other.bind_failure_) {}

SqliteQuery::~SqliteQuery() {
  if (statement_ == nullptr) return;
  reset();
  const bool kept = connection_->idle_.emplace(std::move(sql_), statement_).second;
  if (!kept) sqlite3_finalize(statement_);
}

void SqliteQuery::note(int code) {
  if (code != SQLITE_OK) bind_failure_ = code;
}

SqliteQuery& SqliteQuery::bind(std::int64_t value) {
  note(sqlite3_bind_int64(statement_, ++bound_, value));
  return *this;
}

SqliteQuery& SqliteQuery::bind(double value) {
  note(sqlite3_bind_double(statement_, ++bound_, value));
  return *this;
}

SqliteQuery& SqliteQuery::bind(std::string_view text) {
  note(sqlite3_bind_text64(statement_, ++bound_, text.empty() ? "" : text.data(), text.size(),
                           SQLITE_TRANSIENT, SQLITE_UTF8));
  return *this;
}

SqliteQuery& SqliteQuery::bindBytes(std::string_view bytes) {
  note(sqlite3_bind_blob64(statement_, ++bound_, bytes.empty() ? "" : bytes.data(), bytes.size(),
                           SQLITE_TRANSIENT));
  return *this;
}

SqliteQuery& SqliteQuery::bindNull() {
  note(sqlite3_bind_null(statement_, ++bound_));
  return *this;
}

Result<bool> SqliteQuery::step() {
  if (bind_failure_ != SQLITE_OK) return connection_->failure(bind_failure_);
  const int code = sqlite3_step(statement_);
  if (code == SQLITE_ROW) return true;
  if (code == SQLITE_DONE) return false;
  return connection_->failure(code);
}

Status SqliteQuery::run() {
  for (;;) {
    ASSIGN_OR_RETURN(const bool row, step());
    if (!row) return {};
  }
}

void SqliteQuery::reset() {
  sqlite3_reset(statement_);
  sqlite3_clear_bindings(statement_);
  bound_ = 0;
  bind_failure_ = SQLITE_OK;
}

std::int64_t SqliteQuery::integer(int column) const {
  return sqlite3_column_int64(statement_, column);
}

double SqliteQuery::real(int column) const {
  return sqlite3_column_double(statement_, column);
}

std::string SqliteQuery::text(int column) const {
  return std::string(bytes(column));
}

std::string_view SqliteQuery::bytes(int column) const {
  const void* data = sqlite3_column_blob(statement_, column);
  const int size = sqlite3_column_bytes(statement_, column);
  return data == nullptr ? std::string_view()
                         : std::string_view(static_cast<const char*>(data), size);
}

Result<std::unique_ptr<SqliteConnection>> SqliteConnection::open(const std::filesystem::path& path,
                                                                 Mode mode) {
  const int flags =
      SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_EXRESCODE |
      (mode == Mode::kReadOnly ? SQLITE_OPEN_READONLY : SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE);
  sqlite3* handle = nullptr;
  const int code = sqlite3_open_v2(path.c_str(), &handle, flags, nullptr);
  // SQLite hands out an object that has to be closed even where it fails.
  std::unique_ptr<SqliteConnection> connection(new SqliteConnection(handle, path.string()));
  if (code != SQLITE_OK) return connection->failure(code);
  sqlite3_busy_timeout(handle, 10000);
  RETURN_IF_ERROR(connection->execute("PRAGMA cell_size_check = ON; PRAGMA trusted_schema = OFF"));
  if (mode == Mode::kReadWrite) {
    RETURN_IF_ERROR(
        connection->execute("PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL;"
                            "PRAGMA foreign_keys = ON; PRAGMA journal_size_limit = 67108864"));
    ASSIGN_OR_RETURN(SqliteQuery query, connection->prepare("PRAGMA journal_mode"));
    ASSIGN_OR_RETURN(const bool row, query.step());
    if (!row || query.text(0) != "wal") {
      return Status(Reason::kStoreFailure, path.string() + ": write-ahead logging is not possible",
                    "keep the store on a local file system");
    }
  }
  return connection;
}

SqliteConnection::~SqliteConnection() {
  for (const auto& [sql, statement] : idle_) sqlite3_finalize(statement);
  // The last one to close writes the log back into the database.
  if (sqlite3_close(handle_) != SQLITE_OK) {
    log(LogLevel::kError, file_ + ": cannot be closed: " + sqlite3_errmsg(handle_));
  }
}

Result<SqliteQuery> SqliteConnection::prepare(std::string_view sql) {
  if (const auto found = idle_.find(sql); found != idle_.end()) {
    SqliteQuery query(this, found->first, found->second);
    idle_.erase(found);
    return query;
  }
  sqlite3_stmt* statement = nullptr;
  const int code = sqlite3_prepare_v3(handle_, sql.data(), static_cast<int>(sql.size()),
                                      SQLITE_PREPARE_PERSISTENT, &statement, nullptr);
  if (code != SQLITE_OK) return failure(code);
  return SqliteQuery(this, std::string(sql), statement);
}

Status SqliteConnection::execute(const std::string& sql) {
  const int code = sqlite3_exec(handle_, sql.c_str(), nullptr, nullptr, nullptr);
  return code == SQLITE_OK ? Status() : failure(code);
}

Result<std::int64_t> SqliteConnection::integerOf(std::string_view sql) {
  ASSIGN_OR_RETURN(SqliteQuery query, prepare(sql));
  ASSIGN_OR_RETURN(const bool row, query.step());
  return row ? query.integer(0) : 0;
}

std::int64_t SqliteConnection::lastInsertId() const {
  return sqlite3_last_insert_rowid(handle_);
}

std::int64_t SqliteConnection::changedRows() const {
  return sqlite3_changes64(handle_);
}

bool SqliteConnection::inTransaction() const {
  return sqlite3_get_autocommit(handle_) == 0;
}

Status SqliteConnection::failure(int code) const {
  const std::string what =
      file_ + ": " + (handle_ == nullptr ? sqlite3_errstr(code) : sqlite3_errmsg(handle_));
  switch (code & 0xFF) {
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB:
      return {Reason::kStoreCorrupt, what,
              "restore the file from a backup, or what is left of it with sqlite3 '.recover'"};
    case SQLITE_FULL:
      return {Reason::kStoreFailure, what, "make room on the disk"};
    case SQLITE_CANTOPEN:
    case SQLITE_READONLY:
    case SQLITE_PERM:
      return {Reason::kStoreFailure, what, "check who may write to the store's folder"};
    default:
      return {Reason::kStoreFailure, what};
  }
}

Result<SqliteTransaction> SqliteTransaction::begin(SqliteConnection& connection, Kind kind) {
  RETURN_IF_ERROR(connection.execute(kind == Kind::kRead ? "BEGIN" : "BEGIN IMMEDIATE"));
  return SqliteTransaction(connection);
}

SqliteTransaction::~SqliteTransaction() {
  // Some failures have rolled back already; a second ROLLBACK would only complain.
  if (connection_ == nullptr || !connection_->inTransaction()) return;
  if (const Status status = connection_->execute("ROLLBACK"); !status.ok()) {
    log(LogLevel::kError, "a transaction cannot be rolled back: " + status.toString());
  }
}

Status SqliteTransaction::commit() {
  return connection_->execute("COMMIT");
}

}  // namespace moduli
