#include "tests/client/cli_test.h"

/// Wrong usage, help, and where global options may stand.
namespace moduli {
namespace {

using testing::HasSubstr;

class Usage : public CliTest {};

TEST_F(Usage, EveryWrongWordExitsTwoWithOneLineAndNoOutput) {
  const std::vector<std::vector<std::string>> wrong = {
      {},
      {"frobnicate"},
      {"inspect"},
      {"inspect", "a", "b"},
      {"inspect", "a", "--bogus"},
      {"signature", "a", "--space", "nope"},
      {"signature", "a", "--fill-holes=much"},
      {"signature", "a", "--component", "-1"},
      {"signature", "a", "--timeout", "0"},
      {"signature", "a", "--timeout", "soon"},
      {"signature", "a", "--format", "gif"},
      {"signature", "a", "--initial-delaunay", "maybe"},
      {"distance", "a"},
      {"distance", "-", "-"},
      {"parameterize", "--to", "flat"},
      {"parameterize", "a"},
      {"parameterize", "a", "b", "--to", "flat"},
      {"parameterize", "a", "--to", "flat", "-o", "a.stl"},
      {"parameterize", "a", "--to", "flat", "-o", "obj"},
      {"parameterize", "a", "--to", "flat", "-o", "-"},
      {"parameterize", "a", "--to", "flat", "--scheme", "squeeze"},
      {"parameterize", "a", "--to", "flat", "--solver", "NEWTON"},
      {"parameterize", "a", "--to", "flat", "--initial-delaunay", "maybe"},
      {"parameterize", "a", "--to", "flat", "--boundary", ""},
      {"parameterize", "a", "--to", "flat", "--cones"},
      {"collection"},
      {"collection", "frobnicate"},
      {"collection", "create"},
      {"add", "a"},
      {"add", "-c", "x"},
      {"add", "-c", "x", "a", "--tag", "no-sign"},
      {"add", "-c", "x", "a", "--jobs", "0"},
      {"add", "-c", "x", "a", "--on-exists", "shrug"},
      {"list"},
      {"remove", "-c", "x"},
      {"get", "-c", "x"},
      {"search", "-c", "x"},
      {"search", "-c", "x", "a", "--id", "b"},
      {"search", "-c", "x", "a", "-k", "0"},
      {"search", "-c", "x", "a", "-k", "-1"},
      {"search", "-c", "x", "--all", "a"},
      {"search", "-c", "x", "--all", "--id", "a"},
      {"search", "-c", "x", "--from-file", "list", "--id", "a"},
      {"search", "-c", "x", "--all", "--picture", "out.png"},
      {"search", "-c", "x", "a", "b", "--picture", "out.png"},
      {"collection", "create", "x", "--approximate=1"},
      {"collection", "create", "x", "--approximate=none"},
      {"collection", "edit", "x"},
      {"collection", "edit", "x", "--exact", "--approximate"},
      {"sample"},
      {"sample", "dodo", "-o", "a.off"},
      {"sample", "torus"},
      {"sample", "torus", "-o", "a.gif"},
      {"sample", "torus", "Q=1", "-o", "a.off"},
      {"sample", "torus", "R", "-o", "a.off"},
      {"sample", "torus", "R=long", "-o", "a.off"},
      {"completion"},
      {"man", "frobnicate"},
      // Abilities that this build does not have are no words of it.
      {"parameterize", "a", "--to", "moon"},
      {"parameterize", "a", "--to", "rectangle"},
      {"parameterize", "a", "--to", "disk", "--corners", "1,2,3,4"},
      {"parameterize", "a", "--to", "rectangle", "--corners", "1,2,3"},
      {"parameterize", "a", "--to", "rectangle", "--corners", "1,2,3,x"},
      {"parameterize", "a", "--to", "disk", "--mobius", "1,0,0"},
      {"parameterize", "a", "--to", "disk", "--mobius", "1,0,0,i2"},
      {"parameterize", "a", "--to", "flat", "--picture", "a.gif"},
      {"parameterize", "a", "--to", "flat", "--picture", "a.png", "--size", "3x3"},
      {"parameterize", "a", "--to", "flat", "--picture", "a.png", "--view", "aside"},
      {"parameterize", "a", "--to", "flat", "--size", "300x300"}};
  for (const auto& words : wrong) {
    SCOPED_TRACE(testing::PrintToString(words));
    EXPECT_THAT(run(words), IsUsageError());
  }
}

TEST_F(Usage, EveryCommandHasHelpAndAManualPage) {
  const std::vector<std::vector<std::string>> commands = {{},
                                                          {"inspect"},
                                                          {"signature"},
                                                          {"distance"},
                                                          {"parameterize"},
                                                          {"collection"},
                                                          {"collection", "create"},
                                                          {"add"},
                                                          {"list"},
                                                          {"show"},
                                                          {"remove"},
                                                          {"get"},
                                                          {"search"},
                                                          {"sample"},
                                                          {"version"},
                                                          {"man"},
                                                          {"completion"}};
  for (const auto& command : commands) {
    SCOPED_TRACE(testing::PrintToString(command));
    std::vector<std::string> help = command;
    help.push_back("--help");
    const ProcessResult page = run(help);
    EXPECT_THAT(page, Succeeds());
    EXPECT_THAT(page.out, HasSubstr("Usage: moduli"));
    std::vector<std::string> manual = command;
    manual.insert(manual.begin(), "man");
    const ProcessResult roff = run(manual);
    EXPECT_THAT(roff, Succeeds());
    EXPECT_TRUE(roff.out.starts_with(".TH "));
  }
}

TEST_F(Usage, GlobalOptionsCountBeforeAndAfterTheCommandAndItsFiles) {
  write("a.off", icosahedronOff());
  const std::string wanted = run({"inspect", "a.off", "--json"}).out;
  ASSERT_THAT(wanted, HasSubstr("\"valid\": true"));
  EXPECT_EQ(run({"--json", "inspect", "a.off"}).out, wanted);
  EXPECT_EQ(run({"inspect", "--json", "a.off"}).out, wanted);
  EXPECT_EQ(run({"--timeout", "60", "inspect", "a.off", "--json", "--data", "x"}).out, wanted);
  EXPECT_EQ(run({"--json", "--data", "one", "collection", "--quiet", "list", "--data", "two"}).out,
            run({"collection", "list", "--json"}).out);
}

TEST_F(Usage, AFileMayBeNamedLikeACommandOrAnOption) {
  write("list", icosahedronOff());
  write("--json", icosahedronOff());
  EXPECT_THAT(run({"inspect", "list"}), Succeeds());
  EXPECT_THAT(run({"inspect", "--", "--json"}).out, HasSubstr("--json: valid"));
}

TEST_F(Usage, QuietPrintsNothing) {
  write("a.off", icosahedronOff());
  for (const std::vector<std::string>& words : {std::vector<std::string>{"inspect", "a.off"},
                                                {"signature", "a.off"},
                                                {"distance", "a.off", "a.off"},
                                                {"add", "-c", "x", "a.off"},
                                                {"list", "-c", "x"}}) {
    std::vector<std::string> quiet = words;
    quiet.push_back("--quiet");
    const ProcessResult result = run(quiet);
    EXPECT_THAT(result, Succeeds());
    EXPECT_EQ(result.out, "");
  }
}

TEST_F(Usage, CompletionOffersCommandsOptionsAndChoices) {
  write("complete.sh", run({"completion", "bash"}).out + R"(
offer() { COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _moduli; echo "${COMPREPLY[*]}"; }
offer moduli sig
offer moduli collection ''
offer moduli --data x signature --space ''
offer moduli add -c x --tag k=v --lab
)");
  Process::Options options;
  options.scratch = path(".");
  Process bash({"/bin/bash", path("complete.sh")}, options);
  EXPECT_EQ(bash.wait().out,
            "signature\ncreate delete edit list show\nconformal metric shape\n--label-from\n");
}

TEST_F(Usage, ServeHandsItsOptionsToModulid) {
  const ProcessResult help = run({"serve", "--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_THAT(help.out, HasSubstr("--listen"));
  EXPECT_NE(run({"serve", "--frobnicate"}).exit_code, 0);
}

}  // namespace
}  // namespace moduli
