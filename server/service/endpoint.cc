#include "server/service/endpoint.h"

#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "core/base/text.h"

namespace moduli {

std::string Endpoint::toString() const {
  const bool bracket = host.find(':') != std::string::npos;
  return (bracket ? "[" + host + "]" : host) + ":" + std::to_string(port);
}

bool Endpoint::isLoopback() const {
  return host == "localhost" || host == "::1" ||
         (host.starts_with("127.") && host.find_first_not_of("0123456789.") == std::string::npos);
}

Result<Endpoint> parseEndpoint(std::string_view text) {
  const Status wrong(Reason::kInvalidConfiguration,
                     std::string(text) + " is not an address to listen on",
                     "give HOST:PORT, such as 127.0.0.1:7447 or [::1]:7447");
  const std::size_t colon = text.rfind(':');
  if (colon == std::string_view::npos) return wrong;
  std::string_view host = text.substr(0, colon);
  const auto port = parseInteger(text.substr(colon + 1));
  if (!port || *port < 0 || *port > 65535) return wrong;
  if (host.starts_with('[') && host.ends_with(']')) {
    host = host.substr(1, host.size() - 2);
  } else if (host.find(':') != std::string_view::npos) {
    return wrong;
  }
  if (host.empty() || !isPrintableUtf8(host)) return wrong;
  return Endpoint{std::string(host), static_cast<std::uint16_t>(*port)};
}

Status tryToBind(const Endpoint& endpoint) {
  const auto refuse = [&](const std::string& why) {
    return Status(Reason::kInvalidConfiguration,
                  "cannot listen on " + endpoint.toString() + ": " + why,
                  "choose another address with --listen");
  };
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_PASSIVE;
  addrinfo* found = nullptr;
  const std::string port = std::to_string(endpoint.port);
  if (const int error = getaddrinfo(endpoint.host.c_str(), port.c_str(), &hints, &found)) {
    return refuse(gai_strerror(error));
  }
  int bind_error = 0;
  const int one = 1;
  for (const addrinfo* at = found; at != nullptr && bind_error == 0; at = at->ai_next) {
    const int handle = socket(at->ai_family, at->ai_socktype | SOCK_CLOEXEC, at->ai_protocol);
    if (handle < 0) continue;
    setsockopt(handle, SOL_SOCKET, SO_REUSEADDR, &one, sizeof one);
    if (bind(handle, at->ai_addr, at->ai_addrlen) != 0 || listen(handle, 1) != 0) {
      bind_error = errno;
    }
    close(handle);
  }
  freeaddrinfo(found);
  if (bind_error == EADDRINUSE) {
    return {Reason::kPortTaken, "another program listens on " + endpoint.toString(),
            "stop it, or choose another port with --listen (port 0 picks a free one)"};
  }
  return bind_error == 0 ? Status() : refuse(std::strerror(bind_error));
}

}  // namespace moduli
