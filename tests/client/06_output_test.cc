#include "tests/client/cli_test.h"

/// Where output goes: standard input and output, closed pipes, full disks, terminals.
namespace moduli {
namespace {

using testing::HasSubstr;
using testing::Not;

class Output : public CliTest {};

TEST_F(Output, StandardInputIsAMesh) {
  Process::Options options;
  options.input = icosahedronOff();
  EXPECT_THAT(run({"inspect", "-"}, options).out, HasSubstr("standard input: valid"));
  options.input = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  const ProcessResult obj = run({"inspect", "-", "--format", "obj", "--json"}, options);
  ASSERT_THAT(obj, Succeeds());
  EXPECT_EQ(Json::parse(obj.out)["topology"]["boundary_loops"].number(), 1);
  options.input = "no mesh";
  EXPECT_THAT(run({"signature", "-"}, options), FailsWithOneLine());
}

TEST_F(Output, ASampleGoesToStandardOutputInEveryFormat) {
  for (const char* format : {"obj", "off", "ply", "stl", "gifti"}) {
    SCOPED_TRACE(format);
    const ProcessResult made =
        run({"sample", "sphere", "resolution=4", "-o", "-", "--format", format});
    ASSERT_THAT(made, Succeeds());
    Process::Options options;
    options.input = made.out;
    const ProcessResult read_back = run({"inspect", "-", "--format", format, "--json"}, options);
    ASSERT_THAT(read_back, Succeeds());
    EXPECT_EQ(Json::parse(read_back.out)["topology"]["genus"].number(), 0);
  }
}

TEST_F(Output, BrainSurfacesAreReadUnderTheirUsualNames) {
  ASSERT_THAT(run({"sample", "sphere", "resolution=4", "-o", "lh.surf.gii"}), Succeeds());
  ASSERT_THAT(run({"sample", "sphere", "resolution=4", "-o", "b.gii.gz", "--binary"}), Succeeds());
  EXPECT_TRUE(read("lh.surf.gii").starts_with("<?xml"));
  EXPECT_TRUE(read("b.gii.gz").starts_with("\x1F\x8B"));
  // A tetrahedron as FreeSurfer writes it: counts, points and triangles, big-endian.
  std::string pial(
      "\xFF\xFF\xFE"
      "by hand\n\n\0\0\0\4\0\0\0\4",
      20);
  for (const int axis : {-1, 0, 1, 2}) {
    for (int i = 0; i < 3; ++i) {
      pial += i == axis ? std::string("\x3F\x80\0\0", 4) : std::string(4, '\0');
    }
  }
  for (const char corner : std::string("\0\2\1\0\1\3\1\2\3\2\0\3", 12)) {
    pial += std::string(3, '\0') + corner;
  }
  write("lh.pial", pial);
  for (const char* name : {"lh.surf.gii", "b.gii.gz", "lh.pial"}) {
    SCOPED_TRACE(name);
    const ProcessResult result = run({"inspect", name, "--json"});
    ASSERT_THAT(result, Succeeds());
    EXPECT_EQ(Json::parse(result.out)["topology"]["genus"].number(), 0);
    EXPECT_THAT(run({"signature", name}), Succeeds());
  }
  EXPECT_THAT(run({"inspect", "lh.pial", "--format", "freesurfer"}), Succeeds());
  EXPECT_THAT(run({"inspect", "lh.pial", "--format", "gifti"}), FailsWithOneLine());
  EXPECT_EQ(run({"sample", "sphere", "-o", "lh.sphere"}).exit_code, 1);
}

TEST_F(Output, AReaderThatHasHadEnoughIsNoFailure) {
  write("a.off", icosahedronOff());
  Process::Options options;
  options.closed_pipe_output = true;
  for (const std::vector<std::string>& words : {std::vector<std::string>{"inspect", "a.off"},
                                                {"--help"},
                                                {"sample", "--list"},
                                                {"man"},
                                                {"signature", "a.off", "--json"}}) {
    const ProcessResult result = run(words, options);
    EXPECT_EQ(result.signal, 0);
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_EQ(result.err, "");
  }
}

TEST_F(Output, AFullDiskIsAFailure) {
  write("a.off", icosahedronOff());
  Process::Options options;
  options.output_file = "/dev/full";
  const ProcessResult result = run({"inspect", "a.off"}, options);
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("standard output"));
  EXPECT_EQ(run({"--version"}, options).exit_code, 1);
}

TEST_F(Output, ATextFromElsewhereCannotSteerATerminal) {
  // A label with an escape sequence in it.
  write("\x1b[31mred/a.off", icosahedronOff());
  const ProcessResult added =
      run({"add", "-c", "demo", path("\x1b[31mred/a.off"), "--label-from", "dir"});
  EXPECT_EQ(added.exit_code, 1);  // Such a label is refused; its name is shown without the escape.
  EXPECT_THAT(added.out + added.err, Not(HasSubstr("\x1b")));
  const ProcessResult missing = run({"inspect", "no\x1b[2Jsuch\nfile"});
  EXPECT_THAT(missing, FailsWithOneLine());
  EXPECT_THAT(missing.err, Not(HasSubstr("\x1b")));
}

TEST_F(Output, NoProgressIsDrawnWhereThereIsNoTerminal) {
  sample("t.off", {"torus", "resolution=60"});
  EXPECT_EQ(run({"signature", "t.off"}).err, "");
}

TEST_F(Output, ATimeoutEndsTheWork) {
  sample("t.ply", {"torus", "resolution=200"});
  const auto begin = std::chrono::steady_clock::now();
  const ProcessResult result = run({"signature", "t.ply", "--timeout", "0.05"});
  EXPECT_THAT(result, FailsWithOneLine());
  EXPECT_THAT(result.err, HasSubstr("DEADLINE_EXCEEDED"));
  EXPECT_THAT(result.err, HasSubstr("--timeout"));
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(20));
}

}  // namespace
}  // namespace moduli
