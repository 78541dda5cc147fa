#include <csignal>
#include <filesystem>

#include "tests/client/cli_test.h"

/// add: folders, names, clashes, repeated and broken-off runs.
namespace moduli {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class Ingest : public CliTest {
 protected:
  Json add(std::vector<std::string> words, int exit_code = 0, Process::Options options = {}) const {
    words.insert(words.begin(), {"add", "-c", "demo", "--json"});
    const ProcessResult result = run(words, std::move(options));
    EXPECT_EQ(result.exit_code, exit_code) << result.err;
    return Json::parse(result.out);
  }

  std::vector<std::string> names() const {
    const ProcessResult result = run({"list", "-c", "demo", "--json"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    const Json shapes = Json::parse(result.out)["shapes"];
    std::vector<std::string> all;
    for (int i = 0; i < shapes.size(); ++i) {
      const std::string name = shapes.at(i)["name"].string();
      all.push_back(name.substr(name.rfind('/') + 1));
    }
    return all;
  }
};

TEST_F(Ingest, AFolderGivesItsMeshFilesAndRecursivelyAllOfThem) {
  write("m/a.off", icosahedronOff(1));
  write("m/B.OFF", icosahedronOff(2));
  write("m/readme.txt", "no mesh");
  write("m/deep/c.off", icosahedronOff(3));
  EXPECT_EQ(add({"m"})["added"].number(), 2);
  const Json again = add({"m", "--recursive"});
  EXPECT_EQ(again["added"].number(), 1);
  EXPECT_EQ(again["skipped"].number(), 2);
  EXPECT_THAT(names(), testing::UnorderedElementsAre("B", "a", "c"));
}

TEST_F(Ingest, ANamedFileThatIsNoMeshFailsAndTheOthersAreStored) {
  write("a.off", icosahedronOff(1));
  write("readme.txt", "no mesh");
  write("z.off", icosahedronOff(2));
  const Json summary = add({"readme.txt", "a.off", "none.off", "z.off"}, 1);
  EXPECT_EQ(summary["added"].number(), 2);
  EXPECT_EQ(summary["failed"].number(), 2);
  EXPECT_EQ(summary["results"].at(0)["reason"].string(), "UNKNOWN_FORMAT");
  EXPECT_EQ(summary["results"].at(2)["reason"].string(), "FILE_NOT_FOUND");
}

TEST_F(Ingest, PathsComeFromAListOrFromStandardInput) {
  write("a.off", icosahedronOff(1));
  write("b.off", icosahedronOff(2));
  write("c.off", icosahedronOff(3));
  write("list.txt", "a.off\r\n\nb.off");
  EXPECT_EQ(add({"--from-file", "list.txt"})["added"].number(), 2);
  Process::Options options;
  options.input = "b.off\nc.off\n";
  const Json summary = add({"--from-file", "-", "a.off"}, 0, options);
  EXPECT_EQ(summary["added"].number(), 1);
  EXPECT_EQ(summary["skipped"].number(), 2);
}

TEST_F(Ingest, TwoFilesOfOneNameAreBothNamedAndNeitherIsStored) {
  write("one/cup.off", icosahedronOff(1));
  write("two/cup.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  write("two/pot.off", icosahedronOff(2));
  const ProcessResult result = run({"add", "-c", "demo", "one/cup.off", "two"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("one/cup.off"));
  EXPECT_THAT(result.err, HasSubstr("two/cup.obj"));
  EXPECT_THAT(result.err, HasSubstr("NAME_CLASH"));
  EXPECT_THAT(names(), ElementsAre("pot"));
  EXPECT_EQ(add({"one/cup.off", "two", "--name-from", "path"})["added"].number(), 3);
  EXPECT_THAT(names(), testing::IsSupersetOf({"one:cup.off", "two:cup.obj", "two:pot.off", "pot"}));
}

TEST_F(Ingest, AFileNamedTwiceCountsOnce) {
  write("a.off", icosahedronOff());
  std::filesystem::create_symlink("a.off", path("link.off"));
  std::filesystem::create_directory(path("d"));
  std::filesystem::create_symlink("../a.off", path("d/a.off"));
  EXPECT_EQ(add({"a.off", "./a.off", "d/a.off"})["results"].size(), 1);
}

TEST_F(Ingest, LabelsAreParentFoldersAsGivenAndLinksAreNotResolved) {
  write("real/a.off", icosahedronOff());
  std::filesystem::create_directory_symlink("real", path("alias"));
  EXPECT_EQ(add({"alias/a.off", "--label-from", "dir"})["added"].number(), 1);
  const ProcessResult shown = run({"show", "-c", "demo", "a", "--json"});
  EXPECT_EQ(Json::parse(shown.out)["label"].string(), "alias");
}

TEST_F(Ingest, AnExistingNameIsSkippedReplacedOrAnError) {
  write("v1/a.off", icosahedronOff(1));
  write("v2/a.off", icosahedronOff(2));
  add({"v1/a.off"});
  EXPECT_EQ(add({"v2/a.off"})["skipped"].number(), 1);
  EXPECT_EQ(add({"v2/a.off", "--on-exists", "error"}, 1)["failed"].number(), 1);
  EXPECT_EQ(add({"v2/a.off", "--on-exists", "replace"})["replaced"].number(), 1);
  EXPECT_EQ(run({"get", "-c", "demo", "a", "-o", "-"}).out, icosahedronOff(2));
}

TEST_F(Ingest, ALargeFileGoesThroughAnUploadAndComesBackTheSame) {
  // Past the 4 MiB that fit into a message.
  const std::string large = icosahedronOff() + std::string(5 << 20, '\n');
  write("large.off", large);
  EXPECT_EQ(add({"large.off"})["added"].number(), 1);
  EXPECT_EQ(add({"large.off"})["skipped"].number(), 1);
  ASSERT_THAT(run({"get", "-c", "demo", "large", "-o", "back.off"}), Succeeds());
  EXPECT_TRUE(read("back.off") == large);
}

TEST_F(Ingest, TheSummaryIsTheSameWhateverTheNumberOfJobs) {
  std::vector<std::string> words;
  for (int i = 0; i < 12; ++i) {
    words.push_back("f" + std::to_string(i) + ".off");
    write(words.back(), i % 4 == 3 ? "no mesh" : icosahedronOff(1 + i));
  }
  std::vector<std::string> one = words, many = words;
  one.insert(one.end(), {"--jobs", "1", "--data", "s1"});
  many.insert(many.end(), {"--jobs", "8", "--data", "s2"});
  one.insert(one.begin(), {"add", "-c", "demo", "--json"});
  many.insert(many.begin(), {"add", "-c", "demo", "--json"});
  EXPECT_EQ(run(one).out, run(many).out);
}

TEST_F(Ingest, AnInterruptedRunLeavesAConsistentStoreAndTheSameCommandFinishesIt) {
  constexpr int kFiles = 24;
  sample("base.off", {"torus", "resolution=40"});
  const std::string base = read("base.off");
  std::vector<std::string> words = {"add", "-c", "demo", "--json", "--jobs", "1", "meshes"};
  // A comment makes each a file of its own.
  for (int i = 0; i < kFiles; ++i) {
    write("meshes/m" + std::to_string(i) + ".off", base + "# " + std::to_string(i) + "\n");
  }
  const auto running = start(words);
  namespace fs = std::filesystem;
  const auto stored = [&] {
    // The first mesh in the store's folder: the run is in its midst.
    std::error_code ignored;
    int files = 0;
    for (const auto& entry : fs::recursive_directory_iterator(store(), ignored)) {
      const std::string name = entry.path().filename().string();
      if (entry.is_regular_file(ignored) && name.size() >= 60) ++files;
    }
    return files >= 2;
  };
  ASSERT_TRUE(eventually(stored));
  running->signal(SIGINT);
  const ProcessResult interrupted = running->wait();
  EXPECT_EQ(interrupted.exit_code, 1);
  EXPECT_THAT(interrupted.err, HasSubstr("interrupted"));
  EXPECT_THAT(interrupted.err, HasSubstr("run the same command again"));
  const Json summary = Json::parse(interrupted.out);
  // Meshes arrive before they are signed: a slow run may have added none yet.
  EXPECT_LT(summary["added"].number(), kFiles);

  // Everything that was acknowledged is there, with nothing half done beside it.
  const std::vector<std::string> kept = names();
  EXPECT_GE(static_cast<double>(kept.size()), summary["added"].number());
  for (const std::string& name : kept) {
    const ProcessResult back = run({"get", "-c", "demo", name, "-o", "-"});
    EXPECT_TRUE(back.out == read("meshes/" + name + ".off")) << name;
  }

  const ProcessResult finished = run(words);
  ASSERT_THAT(finished, Succeeds());
  const Json rest = Json::parse(finished.out);
  EXPECT_EQ(rest["skipped"].number(), static_cast<double>(kept.size()));
  EXPECT_EQ(rest["added"].number() + rest["skipped"].number(), kFiles);
  EXPECT_EQ(names().size(), static_cast<std::size_t>(kFiles));
}

}  // namespace
}  // namespace moduli
