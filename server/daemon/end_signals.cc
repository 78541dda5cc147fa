#include "server/daemon/end_signals.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>

namespace moduli {
namespace {

int write_end = -1;

void remember(int /*signal*/) {
  const int kept_errno = errno;
  const char byte = 0;
  // A full pipe holds signals enough.
  [[maybe_unused]] const ssize_t written = ::write(write_end, &byte, 1);
  errno = kept_errno;
}

}  // namespace

EndSignals::EndSignals() {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC | O_NONBLOCK) != 0) std::abort();
  read_end_ = ends[0];
  write_end = ends[1];
  struct sigaction action {};
  action.sa_handler = remember;
  action.sa_flags = SA_RESTART;
  ::sigaction(SIGTERM, &action, nullptr);
  ::sigaction(SIGINT, &action, nullptr);
}

bool EndSignals::wait(int timeout_ms) const {
  for (;;) {
    pollfd ready{.fd = read_end_, .events = POLLIN, .revents = 0};
    const int count = ::poll(&ready, 1, timeout_ms);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    char byte = 0;
    if (::read(read_end_, &byte, 1) == 1) return true;
  }
}

}  // namespace moduli
