#include "tests/client/cli_test.h"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace moduli {
namespace {

namespace fs = std::filesystem;

const std::string kBinaries = std::string(MODULI_BINARY_DIR) + "/bin/";

}  // namespace

Daemon::Daemon(const std::string& data, const std::string& scratch,
               const std::vector<std::string>& more) {
  std::vector<std::string> words = {kBinaries + "modulid", "--listen", "127.0.0.1:0", "--data",
                                    data};
  words.insert(words.end(), more.begin(), more.end());
  Process::Options options;
  options.scratch = scratch;
  process_ = std::make_unique<Process>(words, options);
  const std::string ready = "moduli: listening on ";
  eventually([&] { return process_->outputSoFar().find('\n') != std::string::npos; });
  const std::string line = process_->outputSoFar();
  if (line.starts_with(ready)) {
    address_ = line.substr(ready.size(), line.find('\n') - ready.size());
  }
}

CliTest::CliTest() {
  std::string pattern = fs::temp_directory_path().string() + "/moduli_cli.XXXXXX";
  folder_ = ::mkdtemp(pattern.data());
}

CliTest::~CliTest() {
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

Process::Options CliTest::prepared(Process::Options options) const {
  for (const char* name : {"MODULI_SERVER", "MODULI_DATA", "MODULI_TOKEN", "MODULI_TLS_CA"}) {
    options.environment.try_emplace(name, "");
  }
  options.environment.try_emplace("HOME", folder_);
  options.environment.try_emplace("XDG_DATA_HOME", path("xdg"));
  options.scratch = folder_;
  if (options.folder.empty()) options.folder = folder_;
  return options;
}

std::unique_ptr<Process> CliTest::start(const std::vector<std::string>& words,
                                        Process::Options options) const {
  std::vector<std::string> all = {kBinaries + "moduli"};
  all.insert(all.end(), words.begin(), words.end());
  return std::make_unique<Process>(all, prepared(std::move(options)));
}

ProcessResult CliTest::run(const std::vector<std::string>& words, Process::Options options) const {
  return start(words, std::move(options))->wait();
}

Json CliTest::json(std::vector<std::string> words) const {
  words.emplace_back("--json");
  const ProcessResult result = run(words);
  EXPECT_THAT(result, Succeeds());
  return Json::parse(result.out);
}

void CliTest::expectRefusal(const std::vector<std::string>& words, const std::string& why) const {
  const ProcessResult result = run(words);
  EXPECT_THAT(result, FailsWithOneLine());
  EXPECT_THAT(result.err, testing::HasSubstr(why));
}

std::string CliTest::write(const std::string& name, const std::string& content) const {
  fs::create_directories(fs::path(path(name)).parent_path());
  std::ofstream(path(name), std::ios::binary) << content;
  return path(name);
}

std::string CliTest::read(const std::string& name) const {
  std::ifstream in(path(name), std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

bool CliTest::exists(const std::string& name) const {
  return fs::exists(path(name));
}

std::string CliTest::sample(const std::string& name, std::vector<std::string> kind) const {
  kind.insert(kind.begin(), "sample");
  kind.insert(kind.end(), {"-o", name});
  fs::create_directories(fs::path(path(name)).parent_path());
  EXPECT_EQ(run(kind).exit_code, 0);
  return path(name);
}

std::string icosahedronOff(double scale) {
  const double t = (1 + std::sqrt(5.0)) / 2;
  const double corners[12][3] = {{-1, t, 0}, {1, t, 0}, {-1, -t, 0}, {1, -t, 0},
                                 {0, -1, t}, {0, 1, t}, {0, -1, -t}, {0, 1, -t},
                                 {t, 0, -1}, {t, 0, 1}, {-t, 0, -1}, {-t, 0, 1}};
  const int faces[20][3] = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                            {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                            {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                            {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  std::ostringstream text;
  text.precision(17);
  text << "OFF\n12 20 0\n";
  for (const auto& corner : corners) {
    text << scale * corner[0] << ' ' << scale * corner[1] << ' ' << scale * corner[2] << '\n';
  }
  for (const auto& face : faces) {
    text << "3 " << face[0] << ' ' << face[1] << ' ' << face[2] << '\n';
  }
  return text.str();
}

}  // namespace moduli
