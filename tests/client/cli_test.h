#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "tests/client/json.h"
#include "tests/client/process.h"
#include "tests/core/testing.h"

/// What the black-box tests share: a folder of their own and the built binaries.
namespace moduli {

/// A modulid on a port of its choice.
class Daemon {
 public:
  /// Waits until it listens; address() is "" if it does not come up.
  Daemon(const std::string& data, const std::string& scratch,
         const std::vector<std::string>& more = {});

  const std::string& address() const { return address_; }
  Process& process() { return *process_; }

 private:
  std::unique_ptr<Process> process_;
  std::string address_;
};

/// Each test runs in an empty folder, which is its home, too.
class CliTest : public testing::Test {
 protected:
  CliTest();
  ~CliTest() override;

  /// Runs moduli here. MODULI_* are taken out of the environment first.
  ProcessResult run(const std::vector<std::string>& words, Process::Options options = {}) const;
  /// The one document that moduli prints with --json.
  Json json(std::vector<std::string> words) const;
  /// moduli fails with one line that tells why.
  void expectRefusal(const std::vector<std::string>& words, const std::string& why) const;
  std::unique_ptr<Process> start(const std::vector<std::string>& words,
                                 Process::Options options = {}) const;

  std::string path(const std::string& name) const { return folder_ + "/" + name; }
  /// Writes a file here and returns its path.
  std::string write(const std::string& name, const std::string& content) const;
  std::string read(const std::string& name) const;
  bool exists(const std::string& name) const;
  /// Writes a sample surface here: sample("torus.off", {"torus", "R=3"}).
  std::string sample(const std::string& name, std::vector<std::string> kind) const;

  /// The folder that the store is in unless --data is given.
  std::string store() const { return path("xdg/moduli"); }

 private:
  Process::Options prepared(Process::Options options) const;

  std::string folder_;
};

/// An icosahedron as a file, with coordinates times `scale`.
std::string icosahedronOff(double scale = 1);

/// The failure of an operation: exit 1, one line, nothing on standard output.
MATCHER(FailsWithOneLine, "exits 1 with one line 'moduli: error: ...' and an empty output") {
  *result_listener << "exit " << arg.exit_code << ", signal " << arg.signal << "\nout: " << arg.out
                   << "\nerr: " << arg.err;
  const bool one_line = arg.err.starts_with("moduli: error: ") && arg.err.ends_with("\n") &&
                        arg.err.find('\n') + 1 == arg.err.size();
  return arg.exit_code == 1 && arg.out.empty() && one_line;
}

MATCHER(IsUsageError, "exits 2 with one line that points to --help and an empty output") {
  *result_listener << "exit " << arg.exit_code << "\nout: " << arg.out << "\nerr: " << arg.err;
  return arg.exit_code == 2 && arg.out.empty() && arg.err.starts_with("moduli: error: usage") &&
         arg.err.find("--help'\n") != std::string::npos && arg.err.find('\n') + 1 == arg.err.size();
}

MATCHER(Succeeds, "exits 0 with nothing on standard error") {
  *result_listener << "exit " << arg.exit_code << ", signal " << arg.signal << "\nout: " << arg.out
                   << "\nerr: " << arg.err;
  return arg.exit_code == 0 && arg.err.empty();
}

}  // namespace moduli
