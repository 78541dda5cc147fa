#include "tests/server/service/daemon_process.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdlib>

namespace moduli {
namespace {

std::string readToEnd(int& pipe) {
  std::string text;
  std::array<char, 4096> block;
  for (ssize_t n; (n = read(pipe, block.data(), block.size())) > 0;) {
    text.append(block.data(), static_cast<std::size_t>(n));
  }
  close(pipe);
  pipe = -1;
  return text;
}

}  // namespace

DaemonProcess::DaemonProcess(const std::vector<std::string>& arguments) {
  const std::string program = std::string(MODULI_BINARY_DIR) + "/bin/modulid";
  std::vector<char*> words = {const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments)
    words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  int output[2], error[2];
  if (pipe2(output, O_CLOEXEC) != 0 || pipe2(error, O_CLOEXEC) != 0) std::abort();
  // The child does nothing but exec: other threads of this process may hold locks.
  process_ = fork();
  if (process_ == 0) {
    dup2(output[1], STDOUT_FILENO);
    dup2(error[1], STDERR_FILENO);
    execv(program.c_str(), words.data());
    _exit(127);
  }
  close(output[1]);
  close(error[1]);
  output_pipe_ = output[0];
  error_pipe_ = error[0];
}

DaemonProcess::~DaemonProcess() {
  if (process_ > 0) {
    kill(process_, SIGKILL);
    wait();
  }
}

std::string DaemonProcess::waitUntilListening() {
  const std::string prefix = "moduli: listening on ";
  for (char c; read(output_pipe_, &c, 1) == 1;) {
    output_ += c;
    if (c == '\n') break;
  }
  if (!output_.starts_with(prefix) || !output_.ends_with('\n')) return "";
  return output_.substr(prefix.size(), output_.size() - prefix.size() - 1);
}

void DaemonProcess::signal(int number) const {
  kill(process_, number);
}

int DaemonProcess::wait() {
  if (process_ <= 0) return -1;
  output_ += readToEnd(output_pipe_);
  error_ += readToEnd(error_pipe_);
  int state = 0;
  waitpid(process_, &state, 0);
  process_ = -1;
  return WIFEXITED(state) ? WEXITSTATUS(state) : -WTERMSIG(state);
}

}  // namespace moduli
