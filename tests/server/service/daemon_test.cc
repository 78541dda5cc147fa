#include <signal.h>

#include <algorithm>
#include <cstdlib>

#include "tests/server/service/daemon_process.h"
#include "tests/server/service/fixture.h"

namespace moduli {
namespace {

struct Ended {
  int code = 0;
  std::string output, error;
};

Ended run(const std::vector<std::string>& arguments) {
  DaemonProcess daemon(arguments);
  const int code = daemon.wait();
  return {code, daemon.standardOutput(), daemon.standardError()};
}

void expectOneErrorLine(const Ended& ended) {
  EXPECT_EQ(ended.output, "");
  EXPECT_TRUE(ended.error.starts_with("moduli: error: ")) << ended.error;
  EXPECT_EQ(std::count(ended.error.begin(), ended.error.end(), '\n'), 1) << ended.error;
}

TEST(Daemon, HelpAndVersionAreNoFailures) {
  const Ended help = run({"--help"});
  EXPECT_EQ(help.code, 0);
  for (const char* flag : {"--listen", "--data", "--config", "--threads", "--max-faces",
                           "--insecure", "--print-config"}) {
    EXPECT_THAT(help.output, testing::HasSubstr(flag));
  }
  const Ended version = run({"--version"});
  EXPECT_EQ(version.code, 0);
  EXPECT_TRUE(version.output.starts_with("modulid "));
}

TEST(Daemon, WrongUsageExitsWithTwo) {
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"--nonsense"}, {"--threads", "many"}, {"--threads"}, {"extra"}}) {
    const Ended ended = run(arguments);
    EXPECT_EQ(ended.code, 2) << arguments[0];
    expectOneErrorLine(ended);
  }
}

TEST(Daemon, FlagsWinOverTheEnvironmentAndThatOverTheFile) {
  const TemporaryFolder folder;
  const std::string config = folder.file("m.toml", "threads = 2\nqueue_limit = 2\nmax_faces = 2\n");
  setenv("MODULI_QUEUE_LIMIT", "3", 1);
  setenv("MODULI_MAX_FACES", "3", 1);
  const Ended ended = run({"--config", config, "--max-faces", "4", "--print-config"});
  unsetenv("MODULI_QUEUE_LIMIT");
  unsetenv("MODULI_MAX_FACES");
  EXPECT_EQ(ended.code, 0);
  EXPECT_THAT(ended.output, testing::HasSubstr("\nthreads = 2\n"));
  EXPECT_THAT(ended.output, testing::HasSubstr("\nqueue_limit = 3\n"));
  EXPECT_THAT(ended.output, testing::HasSubstr("\nmax_faces = 4\n"));
}

TEST(Daemon, CheckConfigFindsFaultsWithoutStarting) {
  const TemporaryFolder folder;
  EXPECT_EQ(run({"--check-config", "--data", folder.path() + "/none"}).code, 0);
  const Ended unknown = run({"--check-config", "--config", folder.file("m.toml", "colour = 1\n")});
  EXPECT_EQ(unknown.code, 1);
  expectOneErrorLine(unknown);
  EXPECT_THAT(unknown.error, testing::HasSubstr("colour"));
  const Ended open = run({"--check-config", "--listen", "0.0.0.0:7447"});
  EXPECT_EQ(open.code, 1);
  EXPECT_THAT(open.error, testing::HasSubstr("--insecure"));
}

TEST(Daemon, ItServesUntilATermSignalAndExitsWithZero) {
  for (const int number : {SIGTERM, SIGINT}) {
    const TemporaryFolder folder;
    DaemonProcess daemon({"--listen", "127.0.0.1:0", "--data", folder.path() + "/store"});
    const std::string address = daemon.waitUntilListening();
    ASSERT_NE(address, "");
    Peer peer = Peer::at(address);
    EXPECT_OK(peer.createCollection("c"));
    daemon.signal(number);
    EXPECT_EQ(daemon.wait(), 0);
    EXPECT_EQ(daemon.standardOutput(), "moduli: listening on " + address + "\n");
    EXPECT_EQ(daemon.standardError(), "");
  }
}

TEST(Daemon, ATakenPortOrStoreIsSaidInOneLine) {
  const TemporaryFolder folder;
  DaemonProcess first({"--listen", "127.0.0.1:0", "--data", folder.path() + "/a"});
  const std::string address = first.waitUntilListening();
  ASSERT_NE(address, "");
  const Ended port = run({"--listen", address, "--data", folder.path() + "/b"});
  EXPECT_EQ(port.code, 1);
  expectOneErrorLine(port);
  EXPECT_THAT(port.error, testing::HasSubstr(address));
  const Ended store = run({"--listen", "127.0.0.1:0", "--data", folder.path() + "/a"});
  EXPECT_EQ(store.code, 1);
  expectOneErrorLine(store);
}

}  // namespace
}  // namespace moduli
