#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "core/base/status.h"

struct sqlite3;
struct sqlite3_stmt;

namespace moduli {

class SqliteConnection;

/// One run of a prepared statement: bind in order, then step. The statement goes back to its
/// connection, which must outlive it. For one thread at a time.
///
///   ASSIGN_OR_RETURN(SqliteQuery query, connection.prepare("SELECT name FROM t WHERE id = ?"));
///   query.bind(7);
///   for (;;) {
///     ASSIGN_OR_RETURN(const bool row, query.step());
///     if (!row) break;
///     use(query.text(0));
///   }
class SqliteQuery {
 public:
  SqliteQuery(SqliteConnection* connection, std::string sql, sqlite3_stmt* statement)
      : connection_(connection), sql_(std::move(sql)), statement_(statement) {}
  SqliteQuery(SqliteQuery&& other) noexcept;
  SqliteQuery& operator=(SqliteQuery&&) = delete;
  ~SqliteQuery();

  /// The next parameter. Text and bytes are copied.
  SqliteQuery& bind(std::int64_t value);
  SqliteQuery& bind(double value);
  SqliteQuery& bind(std::string_view text);
  SqliteQuery& bindBytes(std::string_view bytes);
  SqliteQuery& bindNull();

  /// True if there is a row to read; also reports failed binds.
  Result<bool> step();
  /// Steps to the end.
  Status run();
  /// Ready for other parameters.
  void reset();

  /// Columns of the current row, from 0. Views are good until the next step.
  std::int64_t integer(int column) const;
  double real(int column) const;
  std::string text(int column) const;
  std::string_view bytes(int column) const;

 private:
  void note(int code);

  SqliteConnection* connection_;
  std::string sql_;
  sqlite3_stmt* statement_;
  int bound_ = 0;
  int bind_failure_ = 0;
};

/// One connection to an SQLite database. For one thread at a time. All failures are kStoreFailure,
/// but kStoreCorrupt where the file is damaged or no database.
class SqliteConnection {
 public:
  enum class Mode { kReadOnly, kReadWrite };

  /// kReadWrite creates the file and sets WAL and synchronous=FULL: a commit is on disk when it
  /// returns.
  static Result<std::unique_ptr<SqliteConnection>> open(const std::filesystem::path& path,
                                                        Mode mode);
  ~SqliteConnection();
  SqliteConnection(const SqliteConnection&) = delete;
  SqliteConnection& operator=(const SqliteConnection&) = delete;

  /// Prepared statements are kept for the next time.
  Result<SqliteQuery> prepare(std::string_view sql);
  /// Runs statements that answer nothing.
  Status execute(const std::string& sql);
  /// The first column of the first row; 0 if there is none.
  Result<std::int64_t> integerOf(std::string_view sql);

  std::int64_t lastInsertId() const;
  /// Rows that the last statement changed.
  std::int64_t changedRows() const;
  bool inTransaction() const;

 private:
  friend class SqliteQuery;
  SqliteConnection(sqlite3* handle, std::string file) : handle_(handle), file_(std::move(file)) {}
  Status failure(int code) const;

  sqlite3* handle_;
  std::string file_;
  std::map<std::string, sqlite3_stmt*, std::less<>> idle_;
};

/// Begins a transaction and rolls it back at the end of the scope unless committed.
class SqliteTransaction {
 public:
  enum class Kind { kRead, kWrite };
  static Result<SqliteTransaction> begin(SqliteConnection& connection, Kind kind);
  SqliteTransaction(SqliteTransaction&& other) noexcept
      : connection_(std::exchange(other.connection_, nullptr)) {}
  SqliteTransaction& operator=(SqliteTransaction&&) = delete;
  ~SqliteTransaction();
  Status commit();

 private:
  explicit SqliteTransaction(SqliteConnection& connection) : connection_(&connection) {}
  SqliteConnection* connection_;
};

}  // namespace moduli
