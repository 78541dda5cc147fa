#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "core/base/status.h"

namespace grpc {
class Channel;
}

namespace moduli {

struct ServerOptions {
  /// HOST:PORT to listen on; port 0 picks a free one; "" serves the in-process channel alone.
  std::string listen = "127.0.0.1:7447";
  /// Folder of the store, created if missing. "": no store: computing works, CatalogService answers
  /// kStoreFailure, and uploads live in a temporary folder that goes with the server.
  std::string data_dir;
  std::size_t threads = 0;       ///< Computing threads; 0: one per processor.
  std::size_t queue_limit = 64;  ///< Jobs that may wait.
  std::size_t max_faces = 8'000'000;
  std::uint64_t max_upload_bytes = 2ULL << 30;
  std::chrono::seconds upload_ttl{24 * 3600};
  /// How long running work may go on after drain() before it is cancelled.
  std::chrono::seconds drain_timeout{30};
  /// Allow plain text on an address that is not loopback.
  bool insecure = false;
  std::string tls_certificate_file, tls_key_file;  ///< PEM; both or neither.
  std::string tls_client_ca_file;  ///< PEM; with it, clients must show a certificate.
  /// Lines "SHA256-OF-TOKEN ROLE", ROLE one of reader writer admin; "": no tokens asked for.
  std::string token_file;
};

/// $XDG_DATA_HOME/moduli, or ~/.local/share/moduli; "" where there is no home.
std::string defaultDataFolder();

/// The services, the catalogue and the computing threads behind them. Thread-safe.
class Server {
 public:
  /// Opens the store, rebuilds the indexes and starts serving. Fails with kInvalidConfiguration,
  /// kPortTaken, and the store's reasons (kStoreLocked names the holder).
  static Result<std::unique_ptr<Server>> start(const ServerOptions& options);

  /// Whether start could work as far as addresses, TLS files and tokens go; touches no store. Fails
  /// with kInvalidConfiguration.
  static Status check(const ServerOptions& options);

  virtual ~Server() = default;

  /// A channel to the services inside this process.
  virtual std::shared_ptr<grpc::Channel> inProcessChannel() = 0;

  /// HOST:PORT with the true port; "" without a listener.
  virtual std::string address() const = 0;

  /// Graceful end: health says NOT_SERVING, new work is refused with kServerDraining, running work
  /// may finish within drain_timeout and is cancelled then, the store is closed. Blocks.
  virtual void drain() = 0;

  /// Cancels everything that runs, so that a drain under way ends soon.
  virtual void cancelAll() = 0;
};

}  // namespace moduli
