#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "client/cli/command.h"
#include "client/cli/interrupts.h"
#include "client/cli/output.h"
#include "client/cli/progress_bar.h"
#include "client/cpp/client.h"
#include "core/base/status.h"

namespace moduli {
class Server;
}

namespace moduli::cli {

/// What a command needs of the embedded store. A server always has one.
enum class StoreNeed {
  kNone,      ///< Computes; neither makes nor locks the store.
  kExisting,  ///< Reads or removes; a store that is not there has nothing.
  kCreate,    ///< Writes; makes the store.
};

/// One run of the program: its options, its way to the services, its output. Single-threaded.
class Session {
 public:
  Session(const Arguments& globals, Interrupts& interrupts);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  bool json() const { return json_; }
  bool quiet() const { return quiet_; }
  /// Text for people is wanted on standard output.
  bool talks() const { return !json_ && !quiet_; }
  bool interrupted() const { return interrupts_.interrupted(); }

  /// The services: of the server that was named, or in this process. Connects at the first call;
  /// the need of that call counts. Fails with kInvalidConfiguration and the store's reasons;
  /// kCollectionNotFound for kExisting where there is no store.
  Result<Client*> client(StoreNeed need);
  /// "" without one.
  const std::string& server() const { return server_; }
  bool serverNamed() const { return server_named_; }
  /// Folder of the embedded store; "" if no place for one can be told.
  const std::string& dataFolder() const { return data_dir_; }
  /// There is a server, or an embedded store to open.
  bool hasStore() const;

  /// Failures of the way to the server speak of it, others of `what`.
  Status explain(const std::string& what, const Status& status) const;

  /// Writes to standard output. A reader that has gone is remembered.
  Status print(std::string_view text);
  Status printJson(const google::protobuf::Message& message);
  bool readerGone() const { return reader_gone_; }

  ProgressBar& progress() { return *progress_; }
  void endProgress() { progress_.reset(); }

 private:
  Status startServer(StoreNeed need);

  Interrupts& interrupts_;
  bool json_ = false;
  bool quiet_ = false;
  bool reader_gone_ = false;
  std::optional<std::chrono::steady_clock::time_point> deadline_;
  Arguments globals_;
  std::string server_;
  std::string token_;
  bool server_named_ = false;
  std::string data_dir_;
  std::unique_ptr<ProgressBar> progress_;
  std::unique_ptr<Server> hosted_;
  std::unique_ptr<Client> client_;
};

}  // namespace moduli::cli
