#pragma once

#include <functional>
#include <mutex>
#include <thread>

namespace moduli::cli {

/// Ctrl-C and its kin. From construction on SIGINT, SIGTERM and SIGHUP are blocked in this and all
/// later threads and taken by one of our own. The first calls the handler, or ends the process
/// (exit 1) if there is none; the second always ends it. Make one at the start of main, before any
/// other thread.
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

  /// Undoes the blocking for a program that takes this one's place.
  static void unblock();

 private:
  void wait();

  mutable std::mutex mutex_;
  std::function<void()> handler_;
  bool interrupted_ = false;
  bool closing_ = false;
  std::thread thread_;
};

}  // namespace moduli::cli
