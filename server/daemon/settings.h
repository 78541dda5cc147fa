#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/log.h"
#include "core/base/status.h"
#include "server/server.h"

namespace moduli {

/// All that modulid can be told.
struct DaemonOptions {
  ServerOptions server;
  LogLevel log_level = LogLevel::kWarning;
};

/// One thing that modulid can be told, by a flag --name, by an environment variable MODULI_NAME, or
/// by a key name of the TOML file (with "_" for "-").
struct Setting {
  std::string name;
  std::string metavar;  ///< "" for a switch.
  std::string help;
  /// Fails with kInvalidConfiguration.
  std::function<Status(DaemonOptions&, std::string_view text)> set;
  std::function<std::string(const DaemonOptions&)> get;  ///< As TOML writes it.

  std::string environmentName() const;
  std::string tomlKey() const;
};

const std::vector<Setting>& daemonSettings();

/// Value texts by setting name.
using SettingTexts = std::map<std::string, std::string>;

/// From the text of a TOML file. name: of the file, for messages. Fails with kInvalidConfiguration
/// on bad syntax, unknown keys, and values that are not a string, number or boolean.
Result<SettingTexts> parseToml(std::string_view text, const std::string& name);

/// What the environment says.
SettingTexts readEnvironment();

/// Overwrites what `texts` speak of. source: where they come from, for messages.
Status applySettings(const SettingTexts& texts, const std::string& source, DaemonOptions& options);

/// All settings as a TOML file that gives the same options.
std::string printSettings(const DaemonOptions& options);

}  // namespace moduli
