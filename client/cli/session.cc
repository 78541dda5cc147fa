#include "client/cli/session.h"

#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "client/cpp/connect.h"
#include "server/server.h"

namespace moduli::cli {
namespace {

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

std::string defaultDataFolder() {
  if (const std::string given = environment("MODULI_DATA"); !given.empty()) return given;
  // The XDG specification has relative paths ignored.
  if (const std::string xdg = environment("XDG_DATA_HOME"); xdg.starts_with('/')) {
    return xdg + "/moduli";
  }
  const std::string home = environment("HOME");
  return home.empty() ? "" : home + "/.local/share/moduli";
}

// The last and most telling part of gRPC's chain of causes: "Connection refused".
std::string lastCause(const Status& status) {
  std::string words = status.message();
  if (words.ends_with(')')) words.pop_back();
  const std::size_t colon = words.rfind(": ");
  return colon == std::string::npos ? words : words.substr(colon + 2);
}

// Far enough for everyone, and still a time that clocks can hold.
constexpr double kLongestTimeout = 1e8;

}  // namespace

Session::Session(const Arguments& globals, Interrupts& interrupts)
    : interrupts_(interrupts), globals_(globals) {
  json_ = globals.has("json");
  quiet_ = globals.has("quiet");
  if (globals.has("timeout")) {
    const double seconds = std::fmin(globals.number("timeout", 0), kLongestTimeout);
    deadline_ = std::chrono::steady_clock::now() +
                std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                    std::chrono::duration<double>(seconds));
  }
  server_named_ = globals.has("server");
  // A store named on the command line counts for more than a server from the environment.
  server_ = globals.text("server", globals.has("data") ? "" : environment("MODULI_SERVER"));
  token_ = globals.text("token", environment("MODULI_TOKEN"));
  data_dir_ = globals.text("data", defaultDataFolder());
  progress_ = std::make_unique<ProgressBar>(!quiet_);
}

Session::~Session() {
  interrupts_.setHandler({});
  if (hosted_ && interrupted()) hosted_->cancelAll();
  if (hosted_) hosted_->drain();
}

bool Session::hasStore() const {
  std::error_code ignored;
  return !server_.empty() || (!data_dir_.empty() && std::filesystem::exists(data_dir_, ignored));
}

Result<Client*> Session::client(StoreNeed need) {
  if (client_) return client_.get();
  ClientOptions options;
  options.deadline = deadline_;
  options.token = token_;
  options.progress = [this](const v1::Progress& progress) {
    if (progress_) progress_->update(progress.stage(), progress.fraction());
  };
  if (server_.empty()) {
    RETURN_IF_ERROR(startServer(need));
    client_ = std::make_unique<Client>(hosted_->inProcessChannel(), options);
  } else {
    ConnectOptions connect;
    connect.server = server_;
    connect.tls = globals_.has("tls");
    connect.ca_file = globals_.text("tls-ca", environment("MODULI_TLS_CA"));
    connect.cert_file = globals_.text("tls-cert");
    connect.key_file = globals_.text("tls-key");
    connect.carries_token = !token_.empty();
    connect.insecure = globals_.has("insecure");
    ASSIGN_OR_RETURN(auto channel, connectTo(connect));
    client_ = std::make_unique<Client>(std::move(channel), options);
  }
  interrupts_.setHandler([this] { client_->cancel(); });
  return client_.get();
}

Status Session::startServer(StoreNeed need) {
  ServerOptions options;
  options.listen = "";
  if (need == StoreNeed::kExisting && !hasStore()) {
    return {Reason::kCollectionNotFound,
            data_dir_.empty() ? "there is no store" : data_dir_ + ": there is no store yet",
            "'moduli add -c NAME FILES' makes one; --data or --server tell of another"};
  }
  if (need != StoreNeed::kNone) {
    if (data_dir_.empty()) {
      return {Reason::kInvalidConfiguration, "there is no place for a store: HOME is not set",
              "name a folder with --data"};
    }
    options.data_dir = data_dir_;
  }
  ASSIGN_OR_RETURN(hosted_, Server::start(options));
  return {};
}

Status Session::explain(const std::string& what, const Status& status) const {
  switch (status.reason()) {
    case Reason::kOk:
      return status;
    case Reason::kServerUnreachable:
      return {status.reason(), "server " + server_ + ": cannot be reached: " + lastCause(status),
              "start one there with 'moduli serve', or leave --server out to work without"};
    case Reason::kServerTooOld:
      return {status.reason(), "server " + server_ + ": is too old: it does not know this request",
              "update modulid there, or use a client of its version"};
    case Reason::kServerDraining:
      return {status.reason(), "server " + server_ + ": is shutting down and takes no more work",
              "try again when it is back, or name another one with --server"};
    case Reason::kQueueFull:
      return {status.reason(), "server " + server_ + ": has no room: its queue is full",
              "try again in a while, or start it with a longer --queue-limit"};
    case Reason::kUnauthenticated:
    case Reason::kPermissionDenied:
      return status.withContext("server " + server_);
    default:
      return about(what, status);
  }
}

Status Session::print(std::string_view text) {
  endProgress();
  const Status status = writeAll(STDOUT_FILENO, text);
  if (!status.ok() && status.hint().empty()) reader_gone_ = true;
  return status;
}

Status Session::printJson(const google::protobuf::Message& message) {
  ASSIGN_OR_RETURN(const std::string text, toJson(message));
  return print(text);
}

}  // namespace moduli::cli
