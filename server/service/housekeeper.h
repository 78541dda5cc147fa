#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "core/base/context.h"
#include "server/service/backend.h"

namespace moduli {

/// Signs anew, as bulk work, the stored shapes whose signatures are of another descriptor version,
/// and drops expired files now and then. Has a thread of its own, which computes nothing.
class Housekeeper {
 public:
  /// backend must outlive it.
  Housekeeper(Backend& backend, std::chrono::seconds garbage_period);

  /// Cancels what it started and waits for it.
  ~Housekeeper();

 private:
  using Key = std::pair<std::string, std::string>;

  void run();
  void signOutdated();
  std::vector<ShapeName> nextBatch(const Catalog& catalog) const;
  void signBatch(const std::vector<ShapeName>& batch);

  Backend& backend_;
  const std::chrono::seconds garbage_period_;
  CancelToken token_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool stopping_ = false;
  std::size_t in_flight_ = 0;
  /// Shapes that cannot be signed by this version; tried again at the next start.
  std::set<Key> failed_;
  std::thread thread_;  ///< Last: it uses the others.
};

/// Signs a stored shape anew from its mesh and as its mesh was prepared then, unless it has been
/// replaced or removed meanwhile. Fails as signing and the store do.
Status signAnew(Context& context, const Backend& backend, const ShapeName& name);

}  // namespace moduli
