#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/retrieval/vector_index.h"
#include "server/store/catalog.h"
#include "server/store/live_index.h"

namespace moduli {

/// The vector indexes of a catalogue, in memory: one per collection and space, in conformal space
/// one per conformal type too. Built from the catalogue's vectors when opened, and kept up by its
/// change sequence. Vectors of another descriptor version than the program's are left out. Large
/// tails are folded in by a background thread. Where a collection wants a recall, the indexes of
/// its metric and shape space are approximate (in conformal space vectors are a mere stand-in).
/// Thread-safe.
///
///   RETURN_IF_ERROR(catalog.putShape(...));
///   RETURN_IF_ERROR(keeper.refresh());          // now every search sees it
class IndexKeeper {
 public:
  struct Options {
    int descriptor_version = kDescriptorVersion;
    LiveIndex::Options index;
    /// Runs a rebuild later, on any thread, or drops it (it is asked for again at the next write).
    /// Empty: the keeper's own thread.
    std::function<void(std::function<void()>)> background;
  };

  /// Reads all vectors. `catalog` must outlive the object. Fails as Catalog::forEachVector.
  static Result<std::unique_ptr<IndexKeeper>> open(Context& context, const Catalog& catalog,
                                                   Options options);

  virtual ~IndexKeeper() = default;

  /// Takes in every write that the catalogue had acknowledged before the call. Call it after each
  /// write, and when told of writes by another process. Cheap when there is nothing new.
  virtual Status refresh() = 0;

  /// The k nearest shapes' ids by the Euclidean distance of their vectors, as VectorIndex::search.
  /// type: only shapes of this conformal type (conformal space; ignored in the others). Shapes
  /// whose vector has another length than the query are never found.
  virtual Result<NearestRows> search(
      Context& context, std::int64_t collection_id, Space space, std::string_view type,
      std::span<const float> query, std::size_t k,
      const std::function<bool(std::int64_t)>& accept = {}) const = 0;

  /// search() of each query in metric or shape space, as LiveIndex::searchMany. All have one
  /// length; otherwise kInvalidOption.
  virtual Result<std::vector<NearestRows>> searchMany(
      Context& context, std::int64_t collection_id, Space space,
      std::span<const std::vector<float>> queries, std::size_t k,
      const std::function<bool(std::int64_t)>& accept = {}) const = 0;

  /// The measured recall of the worst index of a collection; empty if all are exact.
  virtual std::optional<double> recall(std::int64_t collection_id) const = 0;

  /// Number of vectors that such a search looks through.
  virtual std::size_t size(std::int64_t collection_id, Space space, std::string_view type,
                           std::size_t dimension) const = 0;

  /// The catalogue's sequence number up to which writes are taken in.
  virtual std::int64_t sequence() const = 0;
};

}  // namespace moduli
