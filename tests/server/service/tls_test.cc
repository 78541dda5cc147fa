#include <cstdlib>
#include <fstream>
#include <iterator>

#include "tests/server/service/fixture.h"

namespace moduli {
namespace {

std::string content(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// A server with a certificate of its own making that asks clients for one, too.
class TlsTest : public ServiceTest {
 protected:
  void SetUp() override {
    const std::string command =
        "openssl req -x509 -newkey rsa:2048 -nodes -days 2 -subj /CN=localhost "
        "-addext subjectAltName=DNS:localhost,IP:127.0.0.1 -keyout '" +
        folder_.path() + "/key.pem' -out '" + folder_.path() + "/cert.pem' 2>/dev/null";
    if (std::system(command.c_str()) != 0) {
      GTEST_SKIP() << "needs the openssl program to make a certificate";
    }
    ServiceTest::SetUp();
  }

  void configure(ServerOptions& options) override {
    options.tls_certificate_file = folder_.path() + "/cert.pem";
    options.tls_key_file = folder_.path() + "/key.pem";
    options.tls_client_ca_file = options.tls_certificate_file;
  }

  Status call(const std::shared_ptr<grpc::ChannelCredentials>& credentials) {
    Peer peer(grpc::CreateChannel(server_->address(), credentials));
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(10));
    v1::ServerInfo info;
    return fromGrpcStatus(peer.geometry().GetServerInfo(&context, {}, &info));
  }
};

TEST_F(TlsTest, OnlyClientsWithACertificateOfTheCaGetIn) {
  grpc::SslCredentialsOptions options;
  options.pem_root_certs = content(folder_.path() + "/cert.pem");
  EXPECT_THAT(call(grpc::SslCredentials(options)), FailsWith(Reason::kServerUnreachable));
  EXPECT_THAT(call(grpc::InsecureChannelCredentials()), FailsWith(Reason::kServerUnreachable));
  options.pem_cert_chain = options.pem_root_certs;
  options.pem_private_key = content(folder_.path() + "/key.pem");
  EXPECT_OK(call(grpc::SslCredentials(options)));
}

TEST_F(TlsTest, WithTlsAnyAddressMayBeServed) {
  ServerOptions options = options_;
  options.data_dir.clear();
  options.listen = "0.0.0.0:0";
  EXPECT_OK(Server::start(options));
}

}  // namespace
}  // namespace moduli
