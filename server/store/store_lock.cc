#include "server/store/store_lock.h"

#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <ctime>
#include <string>
#include <utility>

namespace moduli {
namespace {

std::string hostName() {
  std::array<char, 256> name = {};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "unknown host";
}

std::string utcNow() {
  const std::time_t now = std::time(nullptr);
  std::tm parts = {};
  ::gmtime_r(&now, &parts);
  std::array<char, 32> text = {};
  std::strftime(text.data(), text.size(), "%Y-%m-%d %H:%M:%S UTC", &parts);
  return text.data();
}

}  // namespace

Result<StoreLock> StoreLock::acquire(const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / "lock";
  ASSIGN_OR_RETURN(File file, File::open(path, File::Mode::kAppend));
  if (::flock(file.descriptor(), LOCK_EX | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK) return systemFailure(path, "cannot be locked");
    Result<std::string> holder = file.read(1024);
    const bool known = holder.ok() && !holder->empty();
    return Status(Reason::kStoreLocked,
                  "the store in " + folder.string() + " is in use by " +
                      (known ? *holder : std::string("another process")),
                  "talk to that process with --server, wait for it, or choose another --data");
  }
  RETURN_IF_ERROR(file.truncate(0));
  RETURN_IF_ERROR(file.write("process " + std::to_string(::getpid()) + " on " + hostName() +
                             " since " + utcNow()));
  return StoreLock(std::move(file));
}

}  // namespace moduli
