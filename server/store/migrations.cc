#include "server/store/migrations.h"

#include <string>

namespace moduli {
namespace {

// "modu" in ASCII: tells our databases from others.
constexpr std::int64_t kApplicationId = 0x6D6F6475;

Status checkOurs(SqliteConnection& connection, std::int64_t version) {
  ASSIGN_OR_RETURN(const std::int64_t application, connection.integerOf("PRAGMA application_id"));
  ASSIGN_OR_RETURN(const std::int64_t tables,
                   connection.integerOf("SELECT count(*) FROM sqlite_schema"));
  const bool fresh = version == 0 && application == 0 && tables == 0;
  if (!fresh && application != kApplicationId) {
    return {Reason::kStoreCorrupt, "catalog.sqlite is a database of some other program",
            "choose another folder with --data"};
  }
  return {};
}

}  // namespace

Status migrate(SqliteConnection& connection, std::span<const Migration> migrations) {
  ASSIGN_OR_RETURN(SqliteTransaction transaction,
                   SqliteTransaction::begin(connection, SqliteTransaction::Kind::kWrite));
  ASSIGN_OR_RETURN(const std::int64_t version, connection.integerOf("PRAGMA user_version"));
  RETURN_IF_ERROR(checkOurs(connection, version));
  const std::int64_t newest = migrations.back().number;
  if (version > newest) {
    return {Reason::kStoreTooNew,
            "the store has schema " + std::to_string(version) + ", this program knows up to " +
                std::to_string(newest),
            "use the program that wrote it, or a newer one"};
  }
  if (version == newest) return {};
  for (const Migration& migration : migrations) {
    if (migration.number <= version) continue;
    const Status status = connection.execute(std::string(migration.sql));
    if (!status.ok()) return status.withContext("migration " + std::string(migration.name));
  }
  RETURN_IF_ERROR(
      connection.execute("PRAGMA user_version = " + std::to_string(newest) +
                         "; PRAGMA application_id = " + std::to_string(kApplicationId)));
  return transaction.commit();
}

}  // namespace moduli
