#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace moduli {

/// A real modulid in a process of its own, killed with the object if it still runs.
class DaemonProcess {
 public:
  explicit DaemonProcess(const std::vector<std::string>& arguments);
  ~DaemonProcess();
  DaemonProcess(const DaemonProcess&) = delete;
  DaemonProcess& operator=(const DaemonProcess&) = delete;

  /// HOST:PORT from its first line of output; "" if it ends without one.
  std::string waitUntilListening();
  void signal(int number) const;
  /// Waits for its end: the exit code, or minus the signal that ended it.
  int wait();
  /// All that it has written, after wait().
  const std::string& standardOutput() const { return output_; }
  const std::string& standardError() const { return error_; }

 private:
  pid_t process_ = -1;
  int output_pipe_ = -1, error_pipe_ = -1;
  std::string output_, error_;
};

}  // namespace moduli
