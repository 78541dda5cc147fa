#include "client/cli/interrupts.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <string_view>

namespace moduli::cli {
namespace {

constexpr std::array kWatched = {SIGINT, SIGTERM, SIGHUP};

// The handler's way to our thread. Blocking the signals everywhere and waiting for them would not
// do: the BLAS library starts threads before main, and these would take them.
std::array<int, 2> pipe_ends = {-1, -1};

constexpr char kSignal = 's';
constexpr char kClose = 'c';

void forward(int) {
  const int saved = errno;
  [[maybe_unused]] const auto written = ::write(pipe_ends[1], &kSignal, 1);
  errno = saved;
}

}  // namespace

Interrupts::Interrupts() {
  if (::pipe2(pipe_ends.data(), O_CLOEXEC) != 0) return;  // Then signals do what they always do.
  thread_ = std::thread([this] { wait(); });
  for (const int signal : kWatched) {
    struct sigaction action {};
    ::sigaction(signal, nullptr, &action);
    if (action.sa_handler == SIG_IGN) continue;
    action.sa_handler = forward;
    action.sa_flags = SA_RESTART;
    ::sigaction(signal, &action, nullptr);
  }
}

Interrupts::~Interrupts() {
  if (!thread_.joinable()) return;
  for (const int signal : kWatched) {
    struct sigaction action {};
    ::sigaction(signal, nullptr, &action);
    if (action.sa_handler != forward) continue;
    action.sa_handler = SIG_DFL;
    ::sigaction(signal, &action, nullptr);
  }
  [[maybe_unused]] const auto written = ::write(pipe_ends[1], &kClose, 1);
  thread_.join();
  for (int& end : pipe_ends) {
    ::close(end);
    end = -1;
  }
}

void Interrupts::setHandler(std::function<void()> handler) {
  const std::lock_guard lock(mutex_);
  handler_ = std::move(handler);
}

bool Interrupts::interrupted() const {
  const std::lock_guard lock(mutex_);
  return interrupted_;
}

void Interrupts::wait() {
  while (true) {
    char message = 0;
    const ssize_t got = ::read(pipe_ends[0], &message, 1);
    if (got < 0 && errno == EINTR) continue;
    if (got != 1 || message == kClose) return;
    takeSignal();
  }
}

void Interrupts::takeSignal() {
  const std::lock_guard lock(mutex_);
  if (interrupted_ || !handler_) {
    constexpr std::string_view kLine = "moduli: error: interrupted (CANCELLED)\n";
    [[maybe_unused]] const auto written = ::write(STDERR_FILENO, kLine.data(), kLine.size());
    ::_exit(1);
  }
  interrupted_ = true;
  handler_();
}

}  // namespace moduli::cli
