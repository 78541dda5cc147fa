#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/store/catalog.h"
#include "server/store/sqlite_connection.h"

namespace moduli {

/// The catalogue in one SQLite file: one connection that writes, behind a mutex, and a small pool
/// of reading ones, which the write-ahead log lets go on meanwhile.
class SqliteCatalog final : public Catalog {
 public:
  using Clock = std::function<Timestamp()>;

  /// Opens or creates the file and brings its schema up to date. `clock` gives creation times;
  /// empty: the system's. Fails with kStoreTooNew, kStoreCorrupt, kStoreFailure.
  static Result<std::unique_ptr<SqliteCatalog>> open(const std::filesystem::path& path,
                                                     Clock clock = {});

  Result<CollectionRecord> createCollection(std::string_view name, std::string_view request_id,
                                            const std::optional<double>& wanted_recall) override;
  Result<CollectionRecord> updateCollection(std::string_view name,
                                            const std::optional<double>& wanted_recall) override;
  Result<std::map<std::int64_t, double>> wantedRecalls() const override;
  Result<CollectionRecord> getCollection(std::string_view name) const override;
  Result<Page<CollectionRecord>> listCollections(const PageRequest& page) const override;
  Result<std::int64_t> deleteCollection(std::string_view name, bool force) override;
  Result<PutResult> putShape(const ShapeRecord& shape, OnExists on_exists,
                             std::optional<std::int64_t> only_if_id) override;
  Result<ShapeRecord> getShape(std::string_view collection, std::string_view name,
                               ShapeView view) const override;
  Result<std::vector<ShapeRecord>> getShapesById(std::span<const std::int64_t> ids,
                                                 ShapeView view) const override;
  Result<Page<ShapeRecord>> listShapes(Context& context, std::string_view collection,
                                       std::string_view filter_text,
                                       const PageRequest& page) const override;
  Status scanShapes(Context& context, std::string_view collection, const Filter& filter,
                    const std::function<bool(const ShapeRecord&)>& visit) const override;
  Status deleteShape(std::string_view collection, std::string_view name) override;
  Result<std::vector<std::string>> deleteShapes(Context& context, std::string_view collection,
                                                const Filter& filter, bool dry_run) override;
  Status updateShape(std::string_view collection, std::string_view name,
                     const ShapeUpdate& update) override;
  Result<bool> hasMesh(std::string_view digest) const override;
  Result<std::vector<ShapeName>> outdatedShapes(int descriptor_version,
                                                std::size_t limit) const override;
  Result<std::int64_t> forEachVector(
      Context& context, const std::function<Status(const VectorRow&)>& visit) const override;
  Status forEachVectorOf(std::span<const std::int64_t> ids,
                         const std::function<Status(const VectorRow&)>& visit) const override;
  Result<ChangeBatch> changesSince(std::int64_t sequence, std::size_t limit) const override;

 private:
  /// A reading connection that goes back to the pool.
  class Reader {
   public:
    Reader(const SqliteCatalog& catalog, std::unique_ptr<SqliteConnection> connection)
        : catalog_(&catalog), connection_(std::move(connection)) {}
    Reader(Reader&&) = default;
    Reader& operator=(Reader&&) = delete;
    ~Reader();
    SqliteConnection& operator*() const { return *connection_; }
    SqliteConnection* operator->() const { return connection_.get(); }

   private:
    const SqliteCatalog* catalog_;
    std::unique_ptr<SqliteConnection> connection_;
  };

  struct Found {
    std::int64_t id = 0;
    std::string digest;
    Timestamp create_time{};
  };

  SqliteCatalog(std::filesystem::path path, Clock clock);
  Result<Reader> reader() const;
  std::int64_t now() const;

  // On the writing connection, inside a transaction.
  Result<std::optional<CollectionRecord>> earlierAnswer(std::string_view request_id,
                                                        std::string_view name);
  Result<std::optional<Found>> findForWrite(std::int64_t collection_id, std::string_view name);
  Result<std::int64_t> insertShape(const ShapeRecord& shape, std::int64_t collection_id,
                                   std::int64_t create_time);
  Status insertDetails(const ShapeRecord& shape, std::int64_t id);
  Status insertTags(const std::map<std::string, std::string>& tags, std::int64_t id);
  Status removeShapeRow(std::int64_t collection_id, std::int64_t id);
  Status noteChange(Change::Kind kind, std::int64_t collection_id, std::int64_t shape_id);

  const std::filesystem::path path_;
  const Clock clock_;
  std::mutex write_mutex_;
  std::unique_ptr<SqliteConnection> writer_;
  mutable std::mutex pool_mutex_;
  mutable std::vector<std::unique_ptr<SqliteConnection>> idle_readers_;
};

/// The collection of that name; kCollectionNotFound.
Result<CollectionRecord> findCollection(SqliteConnection& connection, std::string_view name);

}  // namespace moduli
