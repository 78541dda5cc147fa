#include <csignal>

#include "tests/client/cli_test.h"
#include "tests/client/fake_server.h"

/// moduli against a modulid, and against servers that cannot do what is asked.
namespace moduli {
namespace {

using testing::HasSubstr;

class Remote : public CliTest {
 protected:
  // The failure of signing a mesh at a server.
  std::string failureAt(const std::string& address, const std::string& timeout = "20") const {
    write("a.off", icosahedronOff());
    const ProcessResult result =
        run({"signature", "a.off", "--server", address, "--timeout", timeout});
    EXPECT_THAT(result, FailsWithOneLine());
    EXPECT_THAT(result.err, HasSubstr("server " + address + ": "));
    return result.err;
  }
};

TEST_F(Remote, TheSameCommandsGiveTheSameAnswersAsInProcess) {
  Daemon daemon(path("served"), path("."));
  ASSERT_NE(daemon.address(), "");
  sample("t.off", {"torus", "resolution=12"});
  write("s.off", icosahedronOff());
  // What is computed is the same to the last bit; only the times differ.
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"inspect", "t.off"}, {"distance", "t.off", "s.off"}}) {
    std::vector<std::string> remote = words;
    remote.insert(remote.end(), {"--json", "--server", daemon.address()});
    std::vector<std::string> local = words;
    local.push_back("--json");
    EXPECT_EQ(run(remote).out, run(local).out);
  }
  EXPECT_EQ(
      json({"add", "-c", "demo", "t.off", "s.off", "--server", daemon.address()})["added"].number(),
      2);
  EXPECT_EQ(json({"search", "-c", "demo", "t.off", "--server", daemon.address()})["hits"]
                .at(0)["name"]
                .string(),
            "t");
  EXPECT_FALSE(exists("xdg")) << "the client made a store of its own";
  EXPECT_EQ(json({"version", "--server", daemon.address()})["server"]["address"].string(),
            daemon.address());
}

TEST_F(Remote, TheEnvironmentNamesAServerAndAFolderOnTheCommandLineOverrulesIt) {
  Daemon daemon(path("served"), path("."));
  ASSERT_NE(daemon.address(), "");
  write("a.off", icosahedronOff());
  Process::Options options;
  options.environment["MODULI_SERVER"] = daemon.address();
  EXPECT_THAT(run({"add", "-c", "there", "a.off"}, options), Succeeds());
  EXPECT_THAT(run({"list", "-c", "there"}, options), Succeeds());
  EXPECT_THAT(run({"add", "-c", "here", "a.off", "--data", "mine"}, options), Succeeds());
  EXPECT_THAT(run({"list", "-c", "here"}, options).err, HasSubstr("COLLECTION_NOT_FOUND"));
}

TEST_F(Remote, ALargeMeshTravelsInPieces) {
  Daemon daemon(path("served"), path("."));
  ASSERT_NE(daemon.address(), "");
  const std::string large = icosahedronOff() + std::string(9 << 20, '\n');
  write("large.off", large);
  EXPECT_TRUE(json({"inspect", "large.off", "--server", daemon.address()})["valid"].boolean());
  EXPECT_EQ(json({"add", "-c", "d", "large.off", "--server", daemon.address()})["added"].number(),
            1);
  EXPECT_TRUE(run({"get", "-c", "d", "large", "-o", "-", "--server", daemon.address()}).out ==
              large);
}

TEST_F(Remote, AServerThatIsNotThereIsToldFromOneThatIsOldFullOrDraining) {
  const std::string unreachable = failureAt("127.0.0.1:1");
  EXPECT_THAT(unreachable, HasSubstr("cannot be reached: Connection refused (SERVER_UNREACHABLE)"));

  const FakeServer old({.knows_nothing = true});
  EXPECT_THAT(failureAt(old.address()), HasSubstr("too old"));

  const std::vector<Status> full(20, Status(Reason::kQueueFull, "64 jobs wait already"));
  const FakeServer busy({.refusals = full});
  // The server asks for a second's patience, more than there is.
  EXPECT_THAT(failureAt(busy.address(), "0.9"), HasSubstr("its queue is full (QUEUE_FULL)"));

  const std::vector<Status> draining(20, Status(Reason::kServerDraining, "shutting down"));
  const FakeServer leaving({.refusals = draining});
  EXPECT_THAT(failureAt(leaving.address()), HasSubstr("is shutting down"));
}

TEST_F(Remote, AServerThatHangsIsLeftAtTheTimeout) {
  const FakeServer hanging({.hang = true});
  write("a.off", icosahedronOff());
  const ProcessResult result =
      run({"signature", "a.off", "--server", hanging.address(), "--timeout", "0.3"});
  EXPECT_THAT(result, FailsWithOneLine());
  EXPECT_THAT(result.err, HasSubstr("DEADLINE_EXCEEDED"));
}

TEST_F(Remote, CtrlCEndsACallAtOnce) {
  const FakeServer hanging({.hang = true});
  write("a.off", icosahedronOff());
  const auto running = start({"signature", "a.off", "--server", hanging.address()});
  ASSERT_TRUE(eventually([&] { return hanging.record().signature_calls == 1; }));
  running->signal(SIGINT);
  const ProcessResult result = running->wait(std::chrono::seconds(10));
  EXPECT_FALSE(result.timed_out);
  EXPECT_THAT(result, FailsWithOneLine());
  EXPECT_THAT(result.err, HasSubstr("interrupted (CANCELLED)"));
}

TEST_F(Remote, ATokenTravelsButNotInTheClearToAnotherMachine) {
  const FakeServer server({});
  write("a.off", icosahedronOff());
  Process::Options options;
  options.environment["MODULI_TOKEN"] = "sesame";
  EXPECT_THAT(run({"signature", "a.off", "--server", server.address()}, options), Succeeds());
  EXPECT_EQ(server.record().token, "Bearer sesame");
  const ProcessResult refused =
      run({"signature", "a.off", "--server", "example.invalid:7447"}, options);
  EXPECT_THAT(refused, FailsWithOneLine());
  EXPECT_THAT(refused.err, HasSubstr("unencrypted"));
}

TEST_F(Remote, ADrainedServerKeepsWhatItAcknowledged) {
  write("a.off", icosahedronOff());
  {
    Daemon daemon(path("served"), path("."));
    ASSERT_NE(daemon.address(), "");
    EXPECT_THAT(run({"add", "-c", "demo", "a.off", "--server", daemon.address()}), Succeeds());
    daemon.process().signal(SIGTERM);
    EXPECT_EQ(daemon.process().wait().exit_code, 0);
    EXPECT_THAT(failureAt(daemon.address()), HasSubstr("SERVER_UNREACHABLE"));
  }
  EXPECT_THAT(run({"show", "-c", "demo", "a", "--data", "served"}), Succeeds());
}

}  // namespace
}  // namespace moduli
