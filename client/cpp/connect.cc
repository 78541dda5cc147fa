#include "client/cpp/connect.h"

#include <grpcpp/create_channel.h>
#include <grpcpp/security/credentials.h>

#include "client/cpp/mesh_bytes.h"

namespace moduli {
namespace {

constexpr int kMessageLimit = 8 << 20;

Result<std::string> readPem(const std::string& path) {
  if (path.empty()) return std::string();
  ASSIGN_OR_RETURN(const MeshBytes file, MeshBytes::ofFile(path));
  return file.read(0, static_cast<std::size_t>(file.size()));
}

bool isGrpcTarget(const std::string& server) {
  for (const char* scheme : {"dns:", "ipv4:", "ipv6:", "unix:", "unix-abstract:", "xds:"}) {
    if (server.starts_with(scheme)) return true;
  }
  return false;
}

bool isLoopback(const std::string& server) {
  for (const char* prefix : {"localhost", "127.", "[::1]", "unix:", "unix-abstract:"}) {
    if (server.starts_with(prefix)) return true;
  }
  return false;
}

Result<std::shared_ptr<grpc::ChannelCredentials>> credentials(const ConnectOptions& options) {
  const bool tls = options.tls || !options.ca_file.empty() || !options.cert_file.empty();
  if (options.cert_file.empty() != options.key_file.empty()) {
    return Status(Reason::kInvalidConfiguration, "a client certificate and its key belong together",
                  "give both --tls-cert and --tls-key");
  }
  if (!tls && options.carries_token && !options.insecure && !isLoopback(options.server)) {
    return Status(Reason::kInvalidConfiguration,
                  "the token would travel unencrypted to " + options.server,
                  "use --tls-ca or --tls, or --insecure if the way there is safe");
  }
  if (!tls) return grpc::InsecureChannelCredentials();
  grpc::SslCredentialsOptions ssl;
  ASSIGN_OR_RETURN(ssl.pem_root_certs, readPem(options.ca_file));
  ASSIGN_OR_RETURN(ssl.pem_cert_chain, readPem(options.cert_file));
  ASSIGN_OR_RETURN(ssl.pem_private_key, readPem(options.key_file));
  return grpc::SslCredentials(ssl);
}

}  // namespace

std::string serverTarget(const std::string& server) {
  if (isGrpcTarget(server)) return server;
  const std::size_t bracket = server.rfind(']');
  const std::size_t colon = server.find(':', bracket == std::string::npos ? 0 : bracket);
  return colon == std::string::npos ? server + ":" + std::to_string(kDefaultPort) : server;
}

Result<std::shared_ptr<grpc::Channel>> connectTo(const ConnectOptions& options) {
  ASSIGN_OR_RETURN(const auto channel_credentials, credentials(options));
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(kMessageLimit);
  arguments.SetMaxSendMessageSize(kMessageLimit);
  arguments.SetLoadBalancingPolicyName("round_robin");
  // Without these a refused connection is not tried again within the first second, and a silent
  // address holds the first call for twenty.
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, 50);
  arguments.SetInt(GRPC_ARG_MIN_RECONNECT_BACKOFF_MS, 5000);
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, 2000);
  if (isLoopback(options.server)) arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);
  return grpc::CreateCustomChannel(serverTarget(options.server), channel_credentials, arguments);
}

}  // namespace moduli
