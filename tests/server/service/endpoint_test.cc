#include "server/service/endpoint.h"

#include "tests/core/testing.h"

namespace moduli {
namespace {

TEST(Endpoint, HostsAndPortsAreReadAndWrittenBack) {
  for (const char* text : {"127.0.0.1:7447", "localhost:0", "[::1]:80", "0.0.0.0:65535"}) {
    const Result<Endpoint> endpoint = parseEndpoint(text);
    ASSERT_OK(endpoint);
    EXPECT_EQ(endpoint->toString(), text);
  }
}

TEST(Endpoint, OtherTextsAreRefused) {
  for (const char* text : {"", "7447", ":7447", "localhost", "localhost:", "localhost:-1",
                           "localhost:65536", "localhost:7x", "::1:80", "a\nb:80"}) {
    EXPECT_THAT(parseEndpoint(text), FailsWith(Reason::kInvalidConfiguration)) << text;
  }
}

TEST(Endpoint, LoopbackIsToldFromTheRest) {
  for (const char* text : {"127.0.0.1:1", "127.8.9.10:1", "localhost:1", "[::1]:1"}) {
    EXPECT_TRUE(parseEndpoint(text)->isLoopback()) << text;
  }
  for (const char* text :
       {"0.0.0.0:1", "[::]:1", "192.168.1.1:1", "127.evil.example:1", "localhost.example:1"}) {
    EXPECT_FALSE(parseEndpoint(text)->isLoopback()) << text;
  }
}

TEST(Endpoint, AnAddressThatIsNotOursCannotBeBound) {
  // 192.0.2.0/24 is reserved for documentation.
  EXPECT_THAT(tryToBind(*parseEndpoint("192.0.2.1:0")), FailsWith(Reason::kInvalidConfiguration));
  EXPECT_OK(tryToBind(*parseEndpoint("127.0.0.1:0")));
}

}  // namespace
}  // namespace moduli
