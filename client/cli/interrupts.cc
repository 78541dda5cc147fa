#include "client/cli/interrupts.h"

#include <pthread.h>
#include <unistd.h>

#include <csignal>
#include <string_view>

namespace moduli::cli {
namespace {

// SIGUSR2 comes from our own destructor: it wakes the thread for its end.
constexpr int kWake = SIGUSR2;

sigset_t watchedSignals() {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, kWake}) sigaddset(&set, signal);
  return set;
}

}  // namespace

Interrupts::Interrupts() {
  const sigset_t set = watchedSignals();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  thread_ = std::thread([this] { wait(); });
}

Interrupts::~Interrupts() {
  {
    const std::lock_guard lock(mutex_);
    closing_ = true;
  }
  pthread_kill(thread_.native_handle(), kWake);
  thread_.join();
}

void Interrupts::setHandler(std::function<void()> handler) {
  const std::lock_guard lock(mutex_);
  handler_ = std::move(handler);
}

bool Interrupts::interrupted() const {
  const std::lock_guard lock(mutex_);
  return interrupted_;
}

void Interrupts::unblock() {
  const sigset_t set = watchedSignals();
  pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
}

void Interrupts::wait() {
  const sigset_t set = watchedSignals();
  while (true) {
    int signal = 0;
    if (sigwait(&set, &signal) != 0) continue;
    const std::lock_guard lock(mutex_);
    if (closing_) return;
    if (signal == kWake) continue;
    if (interrupted_ || !handler_) {
      constexpr std::string_view kLine = "moduli: error: interrupted (CANCELLED)\n";
      [[maybe_unused]] const auto written = ::write(STDERR_FILENO, kLine.data(), kLine.size());
      ::_exit(1);
    }
    interrupted_ = true;
    handler_();
  }
}

}  // namespace moduli::cli
