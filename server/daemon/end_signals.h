#pragma once

namespace moduli {

/// SIGTERM and SIGINT as something to wait for. Libraries (OpenBLAS) start threads before main with
/// every signal open, so that blocking the signals and waiting for them would leave their default
/// action, sudden death, to those threads. A handler works whichever thread runs it. One object per
/// process; never destroyed before the process ends.
class EndSignals {
 public:
  /// Installs the handlers.
  EndSignals();

  /// Waits for the next signal. timeout_ms: -1 for ever. False when the time is over.
  bool wait(int timeout_ms) const;

 private:
  int read_end_ = -1;
};

}  // namespace moduli
