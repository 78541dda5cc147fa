#pragma once

#include <sys/types.h>

#include <chrono>
#include <map>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace moduli {

/// What a program did.
struct ProcessResult {
  int exit_code = -1;  ///< -1: ended by a signal.
  int signal = 0;      ///< That signal.
  bool timed_out = false;
  std::string out, err;
  long peak_kib = 0;  ///< Largest resident size.
};

/// A running program with its standard streams in files, so that no pipe can fill up.
class Process {
 public:
  struct Options {
    std::string input;                               ///< Its standard input.
    std::optional<std::string> input_file;           ///< Instead, from this file.
    std::optional<std::string> output_file;          ///< Standard output goes here.
    std::map<std::string, std::string> environment;  ///< "" takes a variable away.
    std::string folder;                              ///< Where it runs; "": here.
    std::string scratch = "/tmp";                    ///< Folder for the streams' files.
    bool closed_pipe_output = false;  ///< Standard output is a pipe that nobody reads.
  };

  Process(const std::vector<std::string>& words, const Options& options);
  /// Kills what still runs.
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  /// Waits for its end; after `limit` it is killed.
  ProcessResult wait(std::chrono::milliseconds limit = std::chrono::seconds(60));
  void signal(int number) const;
  pid_t id() const { return id_; }
  /// What it has written to standard output so far.
  std::string outputSoFar() const;

 private:
  pid_t id_ = -1;
  std::string out_path_, err_path_, in_path_;
  bool own_output_ = true;
};

/// Tries `done` every few milliseconds until it is true or `limit` has passed.
template <typename Condition>
bool eventually(Condition done, std::chrono::milliseconds limit = std::chrono::seconds(30)) {
  const auto end = std::chrono::steady_clock::now() + limit;
  while (!done()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

}  // namespace moduli
