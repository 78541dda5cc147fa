#pragma once

#include <functional>
#include <mutex>
#include <thread>

namespace moduli::cli {

/// Ctrl-C and its kin. From construction on SIGINT, SIGTERM and SIGHUP come to a thread of ours.
/// The first calls the handler, or ends the process (exit 1) if there is none; the second always
/// ends it. A signal that was ignored before (nohup) stays so. At most one at a time.
class Interrupts {
 public:
  Interrupts();
  ~Interrupts();
  Interrupts(const Interrupts&) = delete;
  Interrupts& operator=(const Interrupts&) = delete;

  /// Called from the signal thread; an empty one takes the handler away, after which it does not
  /// run any more.
  void setHandler(std::function<void()> handler);

  bool interrupted() const;

 private:
  void takeSignal();
  void wait();

  mutable std::mutex mutex_;
  std::function<void()> handler_;
  bool interrupted_ = false;
  std::thread thread_;
};

}  // namespace moduli::cli
