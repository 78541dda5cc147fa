#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/base/status.h"

namespace moduli {

/// Where to listen.
struct Endpoint {
  std::string host;  ///< Without the brackets of an IPv6 address.
  std::uint16_t port = 0;

  /// HOST:PORT, an IPv6 address in brackets.
  std::string toString() const;
  /// localhost, 127.0.0.0/8 or ::1.
  bool isLoopback() const;
};

/// "HOST:PORT" or "[IPV6]:PORT". Fails with kInvalidConfiguration.
Result<Endpoint> parseEndpoint(std::string_view text);

/// Why nothing can listen there: kPortTaken, or kInvalidConfiguration with the system's words; OK
/// if something could.
Status tryToBind(const Endpoint& endpoint);

}  // namespace moduli
