#pragma once

#include <span>
#include <string_view>

#include "core/base/status.h"
#include "server/store/sqlite_connection.h"

namespace moduli {

/// One numbered step of the schema, from the file migrations/NNNN_name.sql.
struct Migration {
  int number = 0;
  std::string_view name;
  std::string_view sql;
};

/// All of them, ascending from 1 without gaps. Written by CMake from the files.
std::span<const Migration> allMigrations();

/// Brings the database to the newest schema, in one transaction: all steps or none. Fails with
/// kStoreTooNew if it is newer than that, kStoreCorrupt if it is a database of something else.
Status migrate(SqliteConnection& connection, std::span<const Migration> migrations);

}  // namespace moduli
