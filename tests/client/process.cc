#include "tests/client/process.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>

namespace moduli {
namespace {

std::string slurp(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

std::string scratchFile(const std::string& folder, const std::string& content) {
  std::string path = folder + "/stream.XXXXXX";
  const int descriptor = ::mkstemp(path.data());
  ::close(descriptor);
  std::ofstream(path, std::ios::binary) << content;
  return path;
}

// A pipe's writing end whose reading end is closed.
int deadPipe() {
  int ends[2];
  if (::pipe(ends) != 0) return -1;
  ::close(ends[0]);
  return ends[1];
}

}  // namespace

Process::Process(const std::vector<std::string>& words, const Options& options) {
  in_path_ = options.input_file ? *options.input_file : scratchFile(options.scratch, options.input);
  own_output_ = !options.output_file;
  out_path_ = options.output_file ? *options.output_file : scratchFile(options.scratch, "");
  err_path_ = scratchFile(options.scratch, "");
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);

  id_ = ::fork();
  if (id_ != 0) return;
  if (!options.folder.empty() && ::chdir(options.folder.c_str()) != 0) ::_exit(126);
  for (const auto& [name, value] : options.environment) {
    if (value.empty()) {
      ::unsetenv(name.c_str());
    } else {
      ::setenv(name.c_str(), value.c_str(), 1);
    }
  }
  ::dup2(::open(in_path_.c_str(), O_RDONLY), 0);
  ::dup2(options.closed_pipe_output ? deadPipe()
                                    : ::open(out_path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644),
         1);
  ::dup2(::open(err_path_.c_str(), O_WRONLY | O_TRUNC), 2);
  ::closefrom(3);
  ::execv(arguments[0], arguments.data());
  ::_exit(127);
}

Process::~Process() {
  if (id_ > 0) {
    ::kill(id_, SIGKILL);
    ::waitpid(id_, nullptr, 0);
  }
  for (const std::string& path : {err_path_, own_output_ ? out_path_ : "", in_path_}) {
    if (path.find("/stream.") != std::string::npos) ::unlink(path.c_str());
  }
}

void Process::signal(int number) const {
  ::kill(id_, number);
}

std::string Process::outputSoFar() const {
  return slurp(out_path_);
}

ProcessResult Process::wait(std::chrono::milliseconds limit) {
  ProcessResult result;
  const int descriptor = static_cast<int>(::syscall(SYS_pidfd_open, id_, 0));
  pollfd wanted{descriptor, POLLIN, 0};
  if (::poll(&wanted, 1, static_cast<int>(limit.count())) == 0) {
    result.timed_out = true;
    ::kill(id_, SIGKILL);
  }
  ::close(descriptor);
  int status = 0;
  rusage usage{};
  ::wait4(id_, &status, 0, &usage);
  id_ = -1;
  if (WIFEXITED(status)) result.exit_code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) result.signal = WTERMSIG(status);
  result.peak_kib = usage.ru_maxrss;
  if (own_output_) result.out = slurp(out_path_);
  result.err = slurp(err_path_);
  return result;
}

}  // namespace moduli
