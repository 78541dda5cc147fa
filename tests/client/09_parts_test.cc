#include <filesystem>
#include <fstream>

#include "client/cli/gifti_output.h"
#include "client/cli/output.h"
#include "client/cli/parse.h"
#include "client/cpp/connect.h"
#include "client/cpp/mesh_bytes.h"
#include "client/cpp/paging.h"
#include "client/cpp/retry.h"
#include "core/base/digest.h"
#include "tests/core/testing.h"

/// Parts of the client that need no server.
namespace moduli {
namespace {

using cli::JsonWriter;
using std::chrono::milliseconds;

TEST(Backoff, DoublesWithJitterInTheUpperHalfUpToItsLimit) {
  const RetryPolicy policy{
      .max_attempts = 7, .first_wait = milliseconds(100), .longest_wait = milliseconds(1000)};
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    Backoff backoff(policy, seed);
    for (const int full : {100, 200, 400, 800, 1000, 1000}) {
      ASSERT_TRUE(backoff.another());
      const milliseconds wait = backoff.wait(milliseconds(0));
      EXPECT_GE(wait.count(), full / 2);
      EXPECT_LE(wait.count(), full);
    }
    EXPECT_FALSE(backoff.another());
    backoff.reset();
    EXPECT_TRUE(backoff.another());
  }
}

TEST(Backoff, NeverComesBackBeforeTheServerSaidSo) {
  Backoff backoff({}, 1);
  ASSERT_TRUE(backoff.another());
  EXPECT_GE(backoff.wait(milliseconds(3000)), milliseconds(3000));
}

TEST(Pager, WalksAllPagesAndAsksForNoneTooMany) {
  std::vector<std::string> asked;
  Pager<int> pager([&](const std::string& token) -> Result<ListPage<int>> {
    asked.push_back(token);
    if (token.empty()) return ListPage<int>{{1, 2}, "b"};
    if (token == "b") return ListPage<int>{{}, "c"};  // A page may be empty.
    return ListPage<int>{{3}, ""};
  });
  std::vector<int> all;
  while (true) {
    const auto next = pager.next();
    ASSERT_OK(next);
    if (!*next) break;
    all.push_back(**next);
  }
  EXPECT_THAT(all, testing::ElementsAre(1, 2, 3));
  EXPECT_THAT(asked, testing::ElementsAre("", "b", "c"));
}

TEST(MeshBytes, ReadPiecesAndNoticeAFileThatShrinks) {
  std::string path = std::filesystem::temp_directory_path().string() + "/moduli_bytes.XXXXXX";
  ASSERT_GE(::mkstemp(path.data()), 0);
  std::ofstream(path) << "0123456789";
  const auto bytes = MeshBytes::ofFile(path);
  ASSERT_OK(bytes);
  EXPECT_EQ(bytes->size(), 10U);
  EXPECT_EQ(*bytes->read(3, 4), "3456");
  EXPECT_THAT(bytes->read(8, 4), FailsWith(Reason::kFileUnreadable));
  EXPECT_EQ(*bytes->digest(), sha256Hex("0123456789"));
  std::filesystem::resize_file(path, 5);
  EXPECT_THAT(bytes->digest(), FailsWith(Reason::kFileUnreadable));
  std::filesystem::remove(path);
  EXPECT_THAT(MeshBytes::ofFile(path), FailsWith(Reason::kFileNotFound));
}

TEST(ServerTarget, HasTheDefaultPortWhereNoneIsNamed) {
  EXPECT_EQ(serverTarget("host"), "host:7447");
  EXPECT_EQ(serverTarget("host:1"), "host:1");
  EXPECT_EQ(serverTarget("[::1]"), "[::1]:7447");
  EXPECT_EQ(serverTarget("[::1]:1"), "[::1]:1");
  EXPECT_EQ(serverTarget("ipv4:1.2.3.4:1,5.6.7.8:1"), "ipv4:1.2.3.4:1,5.6.7.8:1");
}

TEST(JsonWriter, EscapesWhatJsonCannotHold) {
  JsonWriter json;
  json.open("{").key("a").string("q\" b\\ n\n x\x01 \xC3\xA9 \xFF");
  json.key("b").open("[").number(1).number(0.1).close("]");
  json.key("c").open("[").close("]").close("}");
  EXPECT_EQ(json.finish(),
            "{\n \"a\": \"q\\\" b\\\\ n\\u000a x\\u0001 \xC3\xA9 \xEF\xBF\xBD\",\n"
            " \"b\": [\n  1,\n  0.1\n ],\n \"c\": []\n}\n");
}

TEST(SafeText, LosesControlCharactersAndBrokenUtf8) {
  EXPECT_EQ(cli::safe("a\x1b[31mb\xC3\xA9\xC2\x9B\xFF\n"), "a?[31mb\xC3\xA9???\?");
}

TEST(AlignedTable, AlignsNumbersRightAndTextLeft) {
  EXPECT_EQ(cli::alignedTable({"name", "n"}, {{"\xC3\xA9", "5"}, {"long", "123"}}),
            "name    n\n\xC3\xA9       5\nlong  123\n");
}

TEST(Parse, AnOptionMayStandAnywhereAndTheLastOneCounts) {
  const cli::Request request =
      cli::parse({"--timeout", "1", "add", "a", "-c", "x", "--tag", "k=v", "b", "--tag=l=w", "c",
                  "--timeout", "2", "--fill-holes", "d"});
  ASSERT_EQ(request.kind, cli::Request::Kind::kRun) << request.complaint;
  EXPECT_THAT(request.arguments.all("PATHS"), testing::ElementsAre("a", "b", "c", "d"));
  EXPECT_THAT(request.arguments.all("tag"), testing::ElementsAre("k=v", "l=w"));
  EXPECT_EQ(request.globals.text("timeout"), "2");
  EXPECT_EQ(request.arguments.text("fill-holes"), "0.5");
}

TEST(Parse, AHundredThousandPathsAreNoTrouble) {
  std::vector<std::string> words = {"add", "-c", "x"};
  for (int i = 0; i < 100000; ++i) words.push_back("meshes/" + std::to_string(i) + ".off");
  const cli::Request request = cli::parse(words);
  EXPECT_EQ(request.arguments.all("PATHS").size(), 100000U);
}

TEST(SphereGifti, TakesDoublesWhereFloatsWouldFoldAFace) {
  ParameterizedMesh mesh;
  mesh.positions = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  mesh.faces = {0, 1, 2};
  const auto coarse = cli::sphereGifti(mesh, {}, "a.gii");
  ASSERT_OK(coarse);
  EXPECT_THAT(*coarse, testing::HasSubstr("NIFTI_TYPE_FLOAT32"));
  // Two corners that float32 does not tell apart.
  mesh.positions = {1, 0, 0, 0, 1, 0, 0, 1, 1e-50};
  const auto fine = cli::sphereGifti(mesh, {}, "a.gii");
  ASSERT_OK(fine);
  EXPECT_THAT(*fine, testing::HasSubstr("NIFTI_TYPE_FLOAT64"));
  EXPECT_THAT(*fine, testing::Not(testing::HasSubstr("NIFTI_TYPE_FLOAT32")));
}

}  // namespace
}  // namespace moduli
