#include "server/daemon/settings.h"

#include <cstdlib>

#include "tests/core/testing.h"

namespace moduli {
namespace {

TEST(Settings, WhatIsPrintedReadsBackAsTheSame) {
  DaemonOptions options;
  ASSERT_OK(applySettings({{"listen", "[::1]:0"},
                           {"data", "/a \"b\"\\c"},
                           {"threads", "3"},
                           {"drain-timeout", "7"},
                           {"insecure", "true"},
                           {"log-level", "debug"}},
                          "test", options));
  const std::string printed = printSettings(options);
  const Result<SettingTexts> texts = parseToml(printed, "printed");
  ASSERT_OK(texts);
  EXPECT_EQ(texts->size(), daemonSettings().size());
  DaemonOptions back;
  ASSERT_OK(applySettings(*texts, "printed", back));
  EXPECT_EQ(printSettings(back), printed);
  EXPECT_EQ(back.server.data_dir, "/a \"b\"\\c");
  EXPECT_EQ(back.server.drain_timeout, std::chrono::seconds(7));
  EXPECT_TRUE(back.server.insecure);
}

TEST(Settings, UnknownKeysWrongTypesAndBadSyntaxNameTheirLine) {
  for (const char* text : {"threads = 2\nthread = 2", "threads = 2\nmax-faces = 2",
                           "threads = 2\nlisten = [1]", "threads = 2\nlisten = 1.5",
                           "threads = 2\nlisten = ", "threads = 2\n[server]\nlisten = \"a\""}) {
    const Result<SettingTexts> texts = parseToml(text, "m.toml");
    EXPECT_THAT(texts, FailsWith(Reason::kInvalidConfiguration)) << text;
    EXPECT_THAT(texts.status().message(), testing::HasSubstr("m.toml:2")) << text;
  }
}

TEST(Settings, ValuesOutOfRangeAreRefusedByName) {
  for (const auto& [name, text] : SettingTexts{{"threads", "-1"},
                                               {"queue-limit", "0"},
                                               {"max-faces", "1e6"},
                                               {"insecure", "yes"},
                                               {"log-level", "loud"},
                                               {"upload-ttl", ""}}) {
    DaemonOptions options;
    const Status status = applySettings({{name, text}}, "m.toml", options);
    EXPECT_THAT(status, FailsWith(Reason::kInvalidConfiguration)) << name;
    EXPECT_THAT(status.message(), testing::HasSubstr("m.toml: " + name));
  }
}

TEST(Settings, TheEnvironmentSpeaksForItsSettings) {
  setenv("MODULI_MAX_FACES", "1234", 1);
  setenv("MODULI_LISTEN", "", 1);
  const SettingTexts texts = readEnvironment();
  unsetenv("MODULI_MAX_FACES");
  unsetenv("MODULI_LISTEN");
  EXPECT_EQ(texts.at("max-faces"), "1234");
  EXPECT_FALSE(texts.contains("listen")) << "an empty variable says nothing";
}

}  // namespace
}  // namespace moduli
