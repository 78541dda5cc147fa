#include <fcntl.h>
#include <google/protobuf/stubs/logging.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "client/cli/output.h"
#include "client/cli/pages.h"
#include "client/cli/parse.h"
#include "client/cli/session.h"
#include "core/base/log.h"

namespace {

using moduli::Reason;
using moduli::Status;
using moduli::cli::Request;

constexpr int kSuccess = 0;
constexpr int kFailure = 1;
constexpr int kUsage = 2;

int fail(const Status& status) {
  (void)moduli::cli::writeAll(STDERR_FILENO, moduli::cli::errorLine(status));
  return kFailure;
}

// A line that cannot be written for want of a reader is no failure: the reader had enough.
int printed(const Status& status) {
  return status.ok() || status.hint().empty() ? kSuccess : fail(status);
}

int complain(const Request& request) {
  std::string words = request.complaint;
  for (char& c : words) {
    if (c == '\n') c = ' ';
  }
  const std::string command = request.path.empty() ? "" : " " + request.path;
  (void)moduli::cli::writeAll(STDERR_FILENO, "moduli: error: usage" + command + ": " +
                                                 moduli::cli::safe(words) + "; see 'moduli" +
                                                 command + " --help'\n");
  return kUsage;
}

// Becomes modulid, which stands beside this program.
int serve(const Request& request) {
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::string program = (self.parent_path() / "modulid").string();
  std::vector<std::string> words = {program};
  if (request.globals.has("data")) {
    words.insert(words.end(), {"--data", request.globals.text("data")});
  }
  words.insert(words.end(), request.passed_on.begin(), request.passed_on.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  std::signal(SIGPIPE, SIG_DFL);
  ::execv(program.c_str(), pointers.data());
  return fail(
      {Reason::kFileNotFound, program + ": cannot be started", "install modulid beside moduli"});
}

int run(const Request& request, moduli::cli::Interrupts& interrupts) {
  moduli::cli::Session session(request.globals, interrupts);
  const Status status = request.command->run(session, request.arguments);
  session.endProgress();
  if (status.ok()) return kSuccess;
  if (session.readerGone() && status.reason() == Reason::kFileUnwritable) return kSuccess;
  return fail(status);
}

// The lowest descriptors must not be taken by files that later writes to 1 and 2 would hit.
void openStandardStreams() {
  for (const int descriptor : {0, 1, 2}) {
    if (::fcntl(descriptor, F_GETFD) < 0)
      ::open("/dev/null", descriptor == 0 ? O_RDONLY : O_WRONLY);
  }
}

}  // namespace

int main(int argc, char** argv) {
  openStandardStreams();
  std::signal(SIGPIPE, SIG_IGN);
  // Failures are told once, by us: the libraries below keep quiet.
  ::setenv("GRPC_VERBOSITY", "NONE", 0);
  google::protobuf::SetLogHandler(nullptr);
  moduli::setLogSink([](moduli::LogLevel, std::string_view) {});

  const Request request = moduli::cli::parse({argv + 1, argv + argc});
  switch (request.kind) {
    case Request::Kind::kHelp:
      return printed(moduli::cli::writeAll(STDOUT_FILENO, moduli::cli::helpPage(request.path)));
    case Request::Kind::kUsageError:
      return complain(request);
    case Request::Kind::kRun:
      break;
  }
  if (request.command->passes_on) return serve(request);
  moduli::cli::Interrupts interrupts;
  return run(request, interrupts);
}
