#pragma once

#include <memory>
#include <string>

#include "core/base/status.h"

namespace grpc {
class Channel;
}

namespace moduli {

inline constexpr int kDefaultPort = 7447;

struct ConnectOptions {
  /// HOST, HOST:PORT (default port 7447), or what gRPC takes as a target (ipv4:A:P,B:P,
  /// dns:///...); several addresses are used in turn.
  std::string server;
  bool tls = false;          ///< Encrypt; implied by a CA or a certificate.
  std::string ca_file = {};  ///< PEM of who signed the server's certificate; "": the system's.
  std::string cert_file = {},
              key_file = {};  ///< PEM of the client's own certificate; both or neither.
  /// A token will travel on this channel: refuse to send it unencrypted to another machine.
  bool carries_token = false;
  bool insecure = false;  ///< Send it all the same.
};

/// A channel to a server; it connects with the first call. Fails with kInvalidConfiguration,
/// kFileNotFound, kFileUnreadable.
Result<std::shared_ptr<grpc::Channel>> connectTo(const ConnectOptions& options);

/// `server` with the default port where it names none; unchanged if it is a gRPC target.
std::string serverTarget(const std::string& server);

}  // namespace moduli
