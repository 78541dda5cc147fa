/// modulid: the server. See --help.
#include <signal.h>

#include <CLI/CLI.hpp>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <iostream>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "core/base/log.h"
#include "core/signature/signature.h"
#include "server/daemon/end_signals.h"
#include "server/daemon/settings.h"
#include "server/server.h"

namespace moduli {
namespace {

constexpr int kFailed = 1;
constexpr int kWrongUsage = 2;

/// What the command line says.
struct CommandLine {
  std::string config;
  bool print_config = false;
  bool check_config = false;
  SettingTexts flags;
};

int complain(const std::string& what, const Status& status) {
  std::cerr << "moduli: error: " << what << ": " << status.message()
            << (status.hint().empty() ? "" : "; ") << status.hint() << std::endl;
  return kFailed;
}

int complainUsage(const std::string& why) {
  std::cerr << "moduli: error: wrong usage: " << why << "; see modulid --help" << std::endl;
  return kWrongUsage;
}

std::string versionText() {
  return "modulid " MODULI_VERSION " (descriptor version " + std::to_string(kDescriptorVersion) +
         ")";
}

/// An exit code if the program is to end now.
std::optional<int> parseCommandLine(int argc, char** argv, CommandLine& line) {
  CLI::App app(
      "Serves geometry signatures, matching and a catalogue of surfaces over gRPC.\n"
      "Every option also has an environment variable (--max-faces: MODULI_MAX_FACES) and\n"
      "a key of the TOML file (max_faces). Options win over the environment, that over\n"
      "the file.",
      "modulid");
  std::map<std::string, std::string> texts;
  bool insecure = false;
  for (const Setting& setting : daemonSettings()) {
    if (setting.metavar.empty()) {
      app.add_flag("--" + setting.name, insecure, setting.help);
    } else {
      app.add_option("--" + setting.name, texts[setting.name], setting.help)
          ->type_name(setting.metavar);
    }
  }
  app.add_option("--config", line.config, "TOML file")->type_name("FILE");
  app.add_flag("--print-config", line.print_config, "print all settings as TOML and exit");
  app.add_flag("--check-config", line.check_config, "check all settings and exit");
  app.set_version_flag("--version", versionText());
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    return app.exit(success);
  } catch (const CLI::Error& error) {
    return complainUsage(error.what());
  }
  for (const auto& [name, text] : texts) {
    if (app.count("--" + name) > 0) line.flags[name] = text;
  }
  if (insecure) line.flags["insecure"] = "true";
  return {};
}

/// Defaults, then the file, then the environment.
Result<DaemonOptions> readOptions(const CommandLine& line) {
  DaemonOptions options;
  options.server.data_dir = defaultDataFolder();
  if (!line.config.empty()) {
    std::ifstream file(line.config, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    if (!file.is_open() || file.bad()) {
      return Status(Reason::kInvalidConfiguration, "cannot read " + line.config,
                    "check path and rights");
    }
    ASSIGN_OR_RETURN(const SettingTexts texts, parseToml(text, line.config));
    RETURN_IF_ERROR(applySettings(texts, line.config, options));
  }
  RETURN_IF_ERROR(applySettings(readEnvironment(), "environment", options));
  return options;
}

void logToStderr(LogLevel least) {
  setLogSink([least](LogLevel level, std::string_view message) {
    if (level < least) return;
    constexpr std::array kNames = {"debug", "info", "warning", "error"};
    const std::time_t now = std::time(nullptr);
    std::tm utc{};
    gmtime_r(&now, &utc);
    char stamp[32];
    std::strftime(stamp, sizeof stamp, "%Y-%m-%dT%H:%M:%SZ", &utc);
    std::fprintf(stderr, "%s %s %.*s\n", stamp, kNames[static_cast<std::size_t>(level)],
                 static_cast<int>(message.size()), message.data());
  });
}

/// Drains; a further signal meanwhile cancels what runs.
void drainUnderWatch(Server& server, const EndSignals& signals) {
  std::atomic<bool> done = false;
  std::thread watch([&] {
    constexpr int kPauseMs = 50;
    while (!done) {
      if (signals.wait(kPauseMs)) server.cancelAll();
    }
  });
  server.drain();
  done = true;
  watch.join();
}

int serve(const ServerOptions& options) {
  const EndSignals signals;
  signal(SIGPIPE, SIG_IGN);

  Result<std::unique_ptr<Server>> server = Server::start(options);
  if (!server.ok()) return complain("cannot start", server.status());
  std::cout << "moduli: listening on " << (*server)->address() << std::endl;
  signals.wait(-1);
  drainUnderWatch(**server, signals);
  return 0;
}

int run(int argc, char** argv) {
  CommandLine line;
  if (const auto code = parseCommandLine(argc, argv, line)) return *code;
  Result<DaemonOptions> options = readOptions(line);
  if (!options.ok()) return complain("configuration", options.status());
  if (const Status status = applySettings(line.flags, "command line", *options); !status.ok()) {
    return complainUsage(status.message());
  }
  if (line.print_config) {
    std::cout << printSettings(*options);
    return 0;
  }
  if (line.check_config) {
    const Status status = Server::check(options->server);
    if (!status.ok()) return complain("configuration", status);
    std::cout << "moduli: the configuration is sound" << std::endl;
    return 0;
  }
  if (options->server.listen.empty() || options->server.data_dir.empty()) {
    return complainUsage("--listen and --data must not be empty");
  }
  logToStderr(options->log_level);
  return serve(options->server);
}

}  // namespace
}  // namespace moduli

int main(int argc, char** argv) {
  return moduli::run(argc, argv);
}
