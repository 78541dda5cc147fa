#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "server/store/filter.h"
#include "server/store/pagination.h"
#include "server/store/shape_record.h"

namespace moduli {

/// What to do about a shape of the same name.
enum class OnExists : std::uint8_t { kSkip, kReplace, kError };

enum class PutOutcome : std::uint8_t { kAdded, kReplaced, kSkipped };

struct PutResult {
  PutOutcome outcome = PutOutcome::kAdded;
  std::int64_t id = 0;          ///< Of the row that is there now.
  std::string existing_digest;  ///< Of the shape found under the name; empty if there was none.
};

/// Whether a shape comes with its signature's bytes (kFull) or without (kSummary, much cheaper).
enum class ShapeView : std::uint8_t { kSummary, kFull };

template <typename T>
struct Page {
  std::vector<T> items;
  std::string next_token;  ///< "" on the last page.
};

/// One vector of one shape, as the indexes want it.
struct VectorRow {
  std::int64_t collection_id = 0;
  std::int64_t shape_id = 0;
  Space space = Space::kConformal;
  std::string_view type;  ///< TopologyKey::type of the shape.
  int descriptor_version = 0;
  std::span<const float> values;  ///< Finite, at least one.
};

/// One step in the catalogue's history.
struct Change {
  enum class Kind : std::uint8_t {
    kShapeAdded,
    kShapeRemoved,
    kCollectionRemoved,
    kCollectionChanged  ///< Its wanted recall.
  };
  std::int64_t sequence = 0;
  Kind kind = Kind::kShapeAdded;
  std::int64_t collection_id = 0;
  std::int64_t shape_id = 0;  ///< 0 for what happened to a collection.
};

struct ChangeBatch {
  std::vector<Change> changes;  ///< Ascending sequence.
  /// False if steps after the asked one have been forgotten already: read everything anew.
  bool complete = true;
};

struct ShapeName {
  std::string collection;
  std::string name;
};

/// What to change of a shape; what is not given stays.
struct ShapeUpdate {
  std::optional<std::string> name;
  std::optional<std::string> label;
  std::optional<std::map<std::string, std::string>> tags;  ///< As a whole.
};

/// Collections of signed shapes in an SQL store. Every write that has returned OK survives a killed
/// process and a power failure; readers see whole writes or none. Thread-safe: one writer at a
/// time, readers beside it. A row that is damaged is skipped with a warning in the log where many
/// are read, and answered with kStoreCorrupt where it was asked for by name.
///
/// Mesh files are not the catalogue's: hold a MeshPin of the digest (mesh_store.h) while putShape
/// runs. Failures of the engine are kStoreFailure, a damaged database kStoreCorrupt.
class Catalog {
 public:
  virtual ~Catalog() = default;

  /// An empty collection. request_id (at most 64 of a-z A-Z 0-9 "-" "_", "" for none): a second
  /// call with it within a day answers the first one's success again; with another name it fails
  /// with kInvalidRequest. Fails with kInvalidName, kInvalidOption (validateWantedRecall),
  /// kCollectionExists.
  virtual Result<CollectionRecord> createCollection(
      std::string_view name, std::string_view request_id,
      const std::optional<double>& wanted_recall = {}) = 0;

  /// Sets its wanted recall. Fails with kCollectionNotFound, kInvalidOption.
  virtual Result<CollectionRecord> updateCollection(std::string_view name,
                                                    const std::optional<double>& wanted_recall) = 0;

  /// The wanted recalls of the collections that have one, by their ids.
  virtual Result<std::map<std::int64_t, double>> wantedRecalls() const = 0;

  /// Fails with kCollectionNotFound.
  virtual Result<CollectionRecord> getCollection(std::string_view name) const = 0;

  /// By ascending name (bytewise). Fails with kInvalidPageToken, kInvalidRequest.
  virtual Result<Page<CollectionRecord>> listCollections(const PageRequest& page) const = 0;

  /// Returns the number of shapes that went with it. Fails with kCollectionNotFound, and without
  /// `force` with kCollectionNotEmpty.
  virtual Result<std::int64_t> deleteCollection(std::string_view name, bool force) = 0;

  /// Stores a shape with its signature and vectors in one transaction. With `only_if_id` the write
  /// happens only if the name now belongs to that row (which is then replaced, whatever on_exists
  /// says) and is kSkipped otherwise: for re-signing. Fails with kCollectionNotFound, kShapeExists
  /// (kError), kInvalidName, kInvalidRequest (digest, non-finite vector, text that is not UTF-8).
  virtual Result<PutResult> putShape(const ShapeRecord& shape, OnExists on_exists,
                                     std::optional<std::int64_t> only_if_id = std::nullopt) = 0;

  /// Fails with kCollectionNotFound, kShapeNotFound.
  virtual Result<ShapeRecord> getShape(std::string_view collection, std::string_view name,
                                       ShapeView view) const = 0;

  /// Those of the rows that are there (and sound), in no particular order.
  virtual Result<std::vector<ShapeRecord>> getShapesById(std::span<const std::int64_t> ids,
                                                         ShapeView view) const = 0;

  /// Summaries by ascending name (bytewise). `filter_text` is the filter as the caller wrote it: a
  /// page token is good for the same collection and text only. Fails with kCollectionNotFound,
  /// kInvalidFilter, kInvalidPageToken, kInvalidRequest, kCancelled, kDeadlineExceeded.
  virtual Result<Page<ShapeRecord>> listShapes(Context& context, std::string_view collection,
                                               std::string_view filter_text,
                                               const PageRequest& page) const = 0;

  /// Calls `visit` with the summary of every shape of the collection that passes the filter, by
  /// ascending name, until it returns false. Tags are filled only if the filter looks at them.
  virtual Status scanShapes(Context& context, std::string_view collection, const Filter& filter,
                            const std::function<bool(const ShapeRecord&)>& visit) const = 0;

  /// Fails with kCollectionNotFound, kShapeNotFound.
  virtual Status deleteShape(std::string_view collection, std::string_view name) = 0;

  /// Deletes the shapes that pass the filter, all in one transaction, and returns their names, by
  /// ascending name; with `dry_run` only the names. Fails with kCollectionNotFound, kCancelled,
  /// kDeadlineExceeded.
  virtual Result<std::vector<std::string>> deleteShapes(Context& context,
                                                        std::string_view collection,
                                                        const Filter& filter, bool dry_run) = 0;

  /// Changes a shape in place: it keeps its id, mesh, signature and vectors. Fails with
  /// kCollectionNotFound, kShapeNotFound, kShapeExists (the new name is taken), kInvalidName,
  /// kInvalidRequest.
  virtual Status updateShape(std::string_view collection, std::string_view name,
                             const ShapeUpdate& update) = 0;

  /// Whether any shape has this mesh.
  virtual Result<bool> hasMesh(std::string_view digest) const = 0;

  /// Up to `limit` shapes whose signature is of another version than `descriptor_version`.
  virtual Result<std::vector<ShapeName>> outdatedShapes(int descriptor_version,
                                                        std::size_t limit) const = 0;

  /// Calls `visit` for every vector in the store, in one consistent snapshot, and returns the
  /// sequence number that the snapshot is at. Signatures are not touched. A failing `visit` ends
  /// it.
  virtual Result<std::int64_t> forEachVector(
      Context& context, const std::function<Status(const VectorRow&)>& visit) const = 0;

  /// The same for some shapes only; ids that are gone are skipped.
  virtual Status forEachVectorOf(std::span<const std::int64_t> ids,
                                 const std::function<Status(const VectorRow&)>& visit) const = 0;

  /// Up to `limit` steps after `sequence`.
  virtual Result<ChangeBatch> changesSince(std::int64_t sequence, std::size_t limit) const = 0;
};

}  // namespace moduli
