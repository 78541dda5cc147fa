#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "server/service/access.h"
#include "server/service/call_registry.h"
#include "server/service/scheduler.h"
#include "server/store/index_keeper.h"
#include "server/store/store.h"

namespace moduli {

inline constexpr std::size_t kMaxInlineBytes = std::size_t{4} << 20;
inline constexpr std::size_t kMaxChunkBytes = std::size_t{1} << 20;
inline constexpr int kMaxMessageBytes = 8 << 20;
inline constexpr int kDefaultHits = 10;
/// Of one search over all its pages, or of all queries of a batch.
inline constexpr int kMaxHits = 1'000'000;
inline constexpr int kMaxHitsAtOnce = 1000;  ///< Of a page, or of each query of a batch.
inline constexpr int kMaxQueries = 10'000;   ///< Of a batch.

/// What all calls share. Outlives every call and every job: the server joins the threads before it
/// lets go of it. Its members are thread-safe.
struct Backend {
  struct Limits {
    std::size_t max_faces = 0;
    std::uint64_t max_upload_bytes = 0;
  };

  Backend(const Executor::Options& computing, const Limits& limits_, AccessList access_,
          std::unique_ptr<Store> store_)
      : limits(limits_),
        access(std::move(access_)),
        store(std::move(store_)),
        compute(computing),
        io({.threads = kIoThreads, .queue_limit = kIoQueue}) {}

  /// The catalogue, or kStoreFailure on a server without a store.
  Result<Catalog*> catalog() const;

  // Disk work is short; what waits longer than this is a sign that the disk is stuck.
  static constexpr std::size_t kIoThreads = 4;
  static constexpr std::size_t kIoQueue = 1024;

  const Limits limits;
  const AccessList access;
  std::unique_ptr<Store> store;          ///< Closed when the last call has ended.
  std::unique_ptr<IndexKeeper> indexes;  ///< Null without a catalogue. Set before serving.
  bool log_calls = true;
  CallRegistry calls;
  Scheduler compute;  ///< For anything whose cost grows with a mesh.
  Scheduler io;       ///< For short work on disk, so that it needs not wait for a solver.
};

}  // namespace moduli
