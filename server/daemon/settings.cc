#include "server/daemon/settings.h"

#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <limits>
#include <optional>
#include <sstream>

#include "core/base/text.h"

namespace moduli {
namespace {

constexpr std::array<std::string_view, 4> kLevels = {"debug", "info", "warning", "error"};

Status wrongValue(std::string_view text, const std::string& wanted) {
  return {Reason::kInvalidConfiguration, std::string(text) + " is not " + wanted};
}

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += c;
  }
  return result + '"';
}

Setting textSetting(std::string name, std::string metavar, std::string help,
                    std::string ServerOptions::*member) {
  return {std::move(name), std::move(metavar), std::move(help),
          [member](DaemonOptions& options, std::string_view text) -> Status {
            if (!text.empty() && !isPrintableUtf8(text)) return wrongValue(text, "printable text");
            options.server.*member = text;
            return {};
          },
          [member](const DaemonOptions& options) { return quoted(options.server.*member); }};
}

Status parseCount(std::string_view text, long long minimum, long long maximum, long long& value) {
  const auto number = parseInteger(text);
  if (!number || *number < minimum || *number > maximum) {
    return wrongValue(
        text, "a whole number from " + std::to_string(minimum) + " to " + std::to_string(maximum));
  }
  value = *number;
  return {};
}

template <typename Number>
Setting countSetting(std::string name, std::string help, Number ServerOptions::*member,
                     long long minimum, long long maximum) {
  return {std::move(name), "N", std::move(help),
          [=](DaemonOptions& options, std::string_view text) -> Status {
            long long value = 0;
            RETURN_IF_ERROR(parseCount(text, minimum, maximum, value));
            options.server.*member = static_cast<Number>(value);
            return {};
          },
          [=](const DaemonOptions& options) { return std::to_string(options.server.*member); }};
}

Setting secondsSetting(std::string name, std::string help,
                       std::chrono::seconds ServerOptions::*member) {
  constexpr long long kYear = 366LL * 24 * 3600;
  return {std::move(name), "SECONDS", std::move(help),
          [=](DaemonOptions& options, std::string_view text) -> Status {
            long long value = 0;
            RETURN_IF_ERROR(parseCount(text, 0, kYear, value));
            options.server.*member = std::chrono::seconds(value);
            return {};
          },
          [=](const DaemonOptions& options) {
            return std::to_string((options.server.*member).count());
          }};
}

Setting insecureSetting() {
  return {"insecure", "", "allow plain text on an address that is not loopback",
          [](DaemonOptions& options, std::string_view text) -> Status {
            if (text != "true" && text != "false") return wrongValue(text, "true or false");
            options.server.insecure = text == "true";
            return {};
          },
          [](const DaemonOptions& options) {
            return std::string(options.server.insecure ? "true" : "false");
          }};
}

Setting logLevelSetting() {
  return {"log-level", "LEVEL", "debug, info, warning or error",
          [](DaemonOptions& options, std::string_view text) -> Status {
            const auto found = std::find(kLevels.begin(), kLevels.end(), text);
            if (found == kLevels.end()) return wrongValue(text, "debug, info, warning or error");
            options.log_level = static_cast<LogLevel>(found - kLevels.begin());
            return {};
          },
          [](const DaemonOptions& options) {
            return quoted(std::string(kLevels[static_cast<std::size_t>(options.log_level)]));
          }};
}

/// The text of a plain TOML value.
std::optional<std::string> plainText(const toml::node& node) {
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* number = node.as_integer()) return std::to_string(number->get());
  if (const auto* truth = node.as_boolean()) return truth->get() ? "true" : "false";
  return {};
}

}  // namespace

std::string Setting::environmentName() const {
  std::string result = "MODULI_";
  for (const char c : name) result += c == '-' ? '_' : static_cast<char>(c - 'a' + 'A');
  return result;
}

std::string Setting::tomlKey() const {
  std::string result = name;
  std::replace(result.begin(), result.end(), '-', '_');
  return result;
}

const std::vector<Setting>& daemonSettings() {
  constexpr long long kMaxCount = std::numeric_limits<std::int32_t>::max();
  static const std::vector<Setting> settings = {
      textSetting("listen", "HOST:PORT", "address to listen on; port 0 picks a free one",
                  &ServerOptions::listen),
      textSetting("data", "DIR", "folder of the store, made if missing", &ServerOptions::data_dir),
      countSetting("threads", "computing threads; 0: one per processor", &ServerOptions::threads, 0,
                   4096),
      countSetting("queue-limit", "jobs that may wait; more are refused",
                   &ServerOptions::queue_limit, 1, 1'000'000),
      countSetting("max-faces", "faces of the largest mesh", &ServerOptions::max_faces, 1,
                   kMaxCount / 3),
      countSetting("max-upload-bytes", "size of the largest mesh file",
                   &ServerOptions::max_upload_bytes, 1, 1LL << 50),
      secondsSetting("upload-ttl", "how long an upload that no shape keeps is there",
                     &ServerOptions::upload_ttl),
      secondsSetting("drain-timeout", "how long running work may go on after SIGTERM",
                     &ServerOptions::drain_timeout),
      insecureSetting(),
      textSetting("tls-cert", "FILE", "certificate chain of the server, PEM",
                  &ServerOptions::tls_certificate_file),
      textSetting("tls-key", "FILE", "its private key, PEM", &ServerOptions::tls_key_file),
      textSetting("tls-client-ca", "FILE", "clients must show a certificate of this CA, PEM",
                  &ServerOptions::tls_client_ca_file),
      textSetting("token-file", "FILE", "API tokens, lines \"SHA256-OF-TOKEN reader|writer|admin\"",
                  &ServerOptions::token_file),
      logLevelSetting(),
  };
  return settings;
}

Result<SettingTexts> parseToml(std::string_view text, const std::string& name) {
  const auto refuse = [&](std::size_t line, const std::string& why) {
    return Status(Reason::kInvalidConfiguration, name + ":" + std::to_string(line) + ": " + why,
                  "modulid --print-config shows all keys");
  };
  try {
    const toml::table table = toml::parse(text, name);
    SettingTexts texts;
    for (const auto& [key, node] : table) {
      const auto& all = daemonSettings();
      const auto setting = std::find_if(all.begin(), all.end(), [&key = key](const Setting& s) {
        return s.tomlKey() == key.str();
      });
      if (setting == all.end()) {
        return refuse(key.source().begin.line, "unknown key " + std::string(key.str()));
      }
      const auto value = plainText(node);
      if (!value) {
        return refuse(key.source().begin.line,
                      std::string(key.str()) + " is not a string, whole number or boolean");
      }
      texts[setting->name] = *value;
    }
    return texts;
  } catch (const toml::parse_error& error) {
    return refuse(error.source().begin.line, std::string(error.description()));
  }
}

SettingTexts readEnvironment() {
  SettingTexts texts;
  for (const Setting& setting : daemonSettings()) {
    const char* value = std::getenv(setting.environmentName().c_str());
    if (value != nullptr && *value != '\0') texts[setting.name] = value;
  }
  return texts;
}

Status applySettings(const SettingTexts& texts, const std::string& source, DaemonOptions& options) {
  for (const Setting& setting : daemonSettings()) {
    const auto found = texts.find(setting.name);
    if (found == texts.end()) continue;
    RETURN_IF_ERROR(setting.set(options, found->second).withContext(source + ": " + setting.name));
  }
  return {};
}

std::string printSettings(const DaemonOptions& options) {
  std::ostringstream out;
  for (const Setting& setting : daemonSettings()) {
    out << "# " << setting.help << "\n"
        << setting.tomlKey() << " = " << setting.get(options) << "\n";
  }
  return out.str();
}

}  // namespace moduli
