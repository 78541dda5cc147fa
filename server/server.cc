#include "server/server.h"

#include <grpc/grpc.h>
#include <grpc/support/log.h>
#include <grpcpp/ext/proto_server_reflection_plugin.h>
#include <grpcpp/grpcpp.h>
#include <grpcpp/health_check_service_interface.h>
#include <grpcpp/impl/service_type.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/log.h"
#include "server/service/backend.h"
#include "server/service/endpoint.h"
#include "server/service/housekeeper.h"
#include "server/service/services.h"

namespace moduli {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kMaxStreamsPerConnection = 256;
constexpr int kKeepaliveMs = 60'000;
constexpr int kKeepaliveTimeoutMs = 20'000;
constexpr int kMinPingIntervalMs = 10'000;

Result<std::string> readWhole(const std::string& path, std::string_view what) {
  std::ifstream file(path, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(file), {}};
  if (!file.is_open() || file.bad()) {
    return Status(Reason::kInvalidConfiguration,
                  "cannot read the " + std::string(what) + " " + path, "check path and rights");
  }
  return bytes;
}

Result<AccessList> loadAccess(const ServerOptions& options) {
  if (options.token_file.empty()) return AccessList();
  ASSIGN_OR_RETURN(const std::string text, readWhole(options.token_file, "token file"));
  return AccessList::parse(text, options.token_file);
}

Result<std::shared_ptr<grpc::ServerCredentials>> makeCredentials(const ServerOptions& options,
                                                                 const Endpoint& endpoint) {
  const bool tls = !options.tls_certificate_file.empty();
  if (tls != !options.tls_key_file.empty() || (!tls && !options.tls_client_ca_file.empty())) {
    return Status(Reason::kInvalidConfiguration, "TLS needs a certificate and its key",
                  "give --tls-cert and --tls-key together");
  }
  if (!tls) {
    if (!endpoint.isLoopback() && !options.insecure) {
      return Status(Reason::kInvalidConfiguration,
                    "plain text on " + endpoint.toString() + " could be read and changed by others",
                    "give --tls-cert and --tls-key, or allow it with --insecure");
    }
    return grpc::InsecureServerCredentials();
  }
  const bool client_certificates = !options.tls_client_ca_file.empty();
  grpc::SslServerCredentialsOptions ssl(
      client_certificates ? GRPC_SSL_REQUEST_AND_REQUIRE_CLIENT_CERTIFICATE_AND_VERIFY
                          : GRPC_SSL_DONT_REQUEST_CLIENT_CERTIFICATE);
  grpc::SslServerCredentialsOptions::PemKeyCertPair pair;
  ASSIGN_OR_RETURN(pair.cert_chain, readWhole(options.tls_certificate_file, "certificate"));
  ASSIGN_OR_RETURN(pair.private_key, readWhole(options.tls_key_file, "key"));
  ssl.pem_key_cert_pairs.push_back(std::move(pair));
  if (client_certificates) {
    ASSIGN_OR_RETURN(ssl.pem_root_certs, readWhole(options.tls_client_ca_file, "client CA"));
  }
  return grpc::SslServerCredentials(ssl);
}

/// Once per process. gRPC writes to stderr by itself; what it says is for those who look for faults
/// in it. And it is kept initialized for good: its own last end may wait 10 s for a poller that a
/// large write has left behind, after everything of ours is closed.
void prepareGrpc() {
  static const bool done = [] {
    gpr_set_log_function([](gpr_log_func_args* line) { log(LogLevel::kDebug, line->message); });
    grpc_init();
    return true;
  }();
  static_cast<void>(done);
}

Result<std::unique_ptr<Backend>> makeBackend(const ServerOptions& options) {
  ASSIGN_OR_RETURN(AccessList access, loadAccess(options));
  const StoreOptions store_options{
      .folder = options.data_dir,
      .max_upload_bytes = static_cast<std::int64_t>(options.max_upload_bytes),
      .upload_ttl = options.upload_ttl};
  ASSIGN_OR_RETURN(std::unique_ptr<Store> store, options.data_dir.empty()
                                                     ? Store::openTemporary(store_options)
                                                     : Store::open(store_options));
  auto backend = std::make_unique<Backend>(
      Executor::Options{.threads = options.threads, .queue_limit = options.queue_limit},
      Backend::Limits{.max_faces = options.max_faces, .max_upload_bytes = options.max_upload_bytes},
      std::move(access), std::move(store));
  if (const Catalog* catalog = backend->store->catalog()) {
    Context context;
    ASSIGN_OR_RETURN(backend->indexes, IndexKeeper::open(context, *catalog, {}));
  }
  // In-process callers report their failures themselves.
  backend->log_calls = !options.listen.empty();
  return backend;
}

class GrpcServer final : public Server {
 public:
  GrpcServer(const ServerOptions& options, std::unique_ptr<Backend> backend)
      : options_(options), backend_(std::move(backend)) {
    services_.push_back(makeGeometryService(*backend_));
    services_.push_back(makeCatalogService(*backend_));
    services_.push_back(makeOptimizeService(*backend_));
  }

  ~GrpcServer() override {
    cancelAll();
    drain();
  }

  Status listen();

  std::shared_ptr<grpc::Channel> inProcessChannel() override;
  std::string address() const override { return address_; }
  void drain() override {
    std::call_once(drained_, [this] { drainOnce(); });
  }
  void cancelAll() override {
    backend_->calls.stopAll({Reason::kServerDraining, "the server is shutting down",
                             "retry against another server, or when it is back"});
  }

 private:
  void drainOnce();

  const ServerOptions options_;
  const std::unique_ptr<Backend> backend_;
  std::vector<std::unique_ptr<grpc::Service>> services_;
  std::string address_;
  std::unique_ptr<grpc::Server> grpc_;
  std::optional<Housekeeper> housekeeper_;
  std::once_flag drained_;
};

Status GrpcServer::listen() {
  prepareGrpc();
  grpc::EnableDefaultHealthCheckService(true);
  grpc::reflection::InitProtoReflectionServerBuilderPlugin();
  grpc::ServerBuilder builder;
  for (const auto& service : services_) builder.RegisterService(service.get());
  builder.SetMaxReceiveMessageSize(kMaxMessageBytes);
  builder.SetMaxSendMessageSize(kMaxMessageBytes);
  // Otherwise a second server on the port would get half of the calls.
  builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);
  builder.AddChannelArgument(GRPC_ARG_MAX_CONCURRENT_STREAMS, kMaxStreamsPerConnection);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, kKeepaliveMs);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, kKeepaliveTimeoutMs);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS,
                             kMinPingIntervalMs);
  Endpoint endpoint;
  int port = 0;
  if (!options_.listen.empty()) {
    ASSIGN_OR_RETURN(endpoint, parseEndpoint(options_.listen));
    ASSIGN_OR_RETURN(const auto credentials, makeCredentials(options_, endpoint));
    if (endpoint.port != 0) RETURN_IF_ERROR(tryToBind(endpoint));
    builder.AddListeningPort(endpoint.toString(), credentials, &port);
  }
  grpc_ = builder.BuildAndStart();
  if (grpc_ == nullptr || (!options_.listen.empty() && port == 0)) {
    RETURN_IF_ERROR(tryToBind(endpoint));
    return {Reason::kInvalidConfiguration, "cannot serve on " + endpoint.toString(),
            "check the TLS certificate and key"};
  }
  if (!options_.listen.empty()) {
    endpoint.port = static_cast<std::uint16_t>(port);
    address_ = endpoint.toString();
  }
  for (const char* name :
       {"moduli.v1.GeometryService", "moduli.v1.CatalogService", "moduli.v1.OptimizeService"}) {
    grpc_->GetHealthCheckService()->SetServingStatus(name, true);
  }
  const auto hour = std::chrono::seconds(3600);
  housekeeper_.emplace(*backend_, std::clamp(options_.upload_ttl, std::chrono::seconds(1), hour));
  return {};
}

std::shared_ptr<grpc::Channel> GrpcServer::inProcessChannel() {
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(kMaxMessageBytes);
  return grpc_->InProcessChannel(arguments);
}

void GrpcServer::drainOnce() {
  if (grpc_ != nullptr) grpc_->GetHealthCheckService()->SetServingStatus(false);
  backend_->calls.close();
  if (!backend_->calls.waitUntilEmpty(Clock::now() + options_.drain_timeout)) {
    cancelAll();
    // Every call answers at once; its answer is on its way when its reactor is done.
    backend_->calls.waitUntilEmpty(Clock::now() + std::chrono::seconds(5));
  }
  housekeeper_.reset();
  if (grpc_ != nullptr) {
    // All calls are done. What is left are the last bytes on their way, and health watches and idle
    // connections, which would wait for ever.
    grpc_->Shutdown(std::chrono::system_clock::now() + std::chrono::milliseconds(200));
    grpc_->Wait();
  }
  backend_->compute.shutdown();
  backend_->io.shutdown();
  backend_->indexes.reset();
  backend_->store.reset();
}

}  // namespace

std::string defaultDataFolder() {
  if (const char* data = std::getenv("XDG_DATA_HOME"); data != nullptr && *data == '/') {
    return std::string(data) + "/moduli";
  }
  const char* home = std::getenv("HOME");
  return home == nullptr || *home == '\0' ? "" : std::string(home) + "/.local/share/moduli";
}

Status Server::check(const ServerOptions& options) {
  RETURN_IF_ERROR(loadAccess(options).status());
  if (options.listen.empty()) return {};
  ASSIGN_OR_RETURN(const Endpoint endpoint, parseEndpoint(options.listen));
  return makeCredentials(options, endpoint).status();
}

Result<std::unique_ptr<Server>> Server::start(const ServerOptions& options) {
  // Before the store is touched, so that a wrong option leaves no trace.
  RETURN_IF_ERROR(check(options));
  ASSIGN_OR_RETURN(std::unique_ptr<Backend> backend, makeBackend(options));
  auto server = std::make_unique<GrpcServer>(options, std::move(backend));
  RETURN_IF_ERROR(server->listen());
  return std::unique_ptr<Server>(std::move(server));
}

}  // namespace moduli
