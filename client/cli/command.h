#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/status.h"

/// The one table that the parser, --help, the manual pages and the completion are made of.
namespace moduli::cli {

class Session;

/// What a shell may offer for a value.
enum class Completion { kNothing, kFile, kFolder };

/// Judges a value: a complaint such as "must be a positive integer", or nothing.
using ValueCheck = std::optional<std::string> (*)(const std::string& value);

struct OptionSpec {
  std::string names;  ///< "-o,--output" or "--repair".
  std::string value;  ///< "FILE"; "" for a flag; "[FRACTION]" where "=FRACTION" may follow.
  std::string help;
  std::vector<std::string> choices = {};  ///< All values there are; empty: any.
  ValueCheck check = nullptr;
  bool required = false;
  bool repeated = false;        ///< May be given several times; otherwise the last one counts.
  std::string bare_value = {};  ///< Of "[FRACTION]" where nothing follows.
  Completion completion = Completion::kNothing;

  /// "output" of "-o,--output": the key of its value in Arguments.
  std::string key() const;
};

struct ArgumentSpec {
  std::string name;  ///< "MESH": also the key of its values in Arguments.
  std::string help;
  int min = 1;
  int max = 1;  ///< -1: any number.
  Completion completion = Completion::kFile;
  std::vector<std::string> choices = {};
};

/// What the user gave.
class Arguments {
 public:
  bool has(const std::string& key) const { return values_.contains(key); }
  /// The last value given, or `otherwise`.
  std::string text(const std::string& key, const std::string& otherwise = "") const;
  std::vector<std::string> all(const std::string& key) const;
  /// Of values that have passed their check.
  int integer(const std::string& key, int otherwise) const;
  double number(const std::string& key, double otherwise) const;

  void add(const std::string& key, std::string value);

 private:
  std::map<std::string, std::vector<std::string>> values_;
};

struct CommandSpec {
  std::string path;     ///< "inspect", "collection create".
  std::string summary;  ///< One line without a full stop.
  std::string details;  ///< Paragraphs, for --help and the manual.
  std::vector<ArgumentSpec> arguments;
  std::vector<OptionSpec> options;
  /// What the values are wrong together for, as a complaint; nothing if all is well.
  std::optional<std::string> (*check)(const Arguments&) = nullptr;
  Status (*run)(Session&, const Arguments&) = nullptr;
  std::string examples = {};
  /// Everything that follows is handed on unread; there is no --help of its own.
  bool passes_on = false;
};

/// All commands in the order in which --help lists them.
const std::vector<CommandSpec>& commands();
/// Accepted by every command, before and after it.
const std::vector<OptionSpec>& globalOptions();
/// By path; null if there is none.
const CommandSpec* findCommand(const std::string& path);

/// One file each.
std::vector<CommandSpec> computeCommands();
std::vector<CommandSpec> parameterizeCommands();
std::vector<CommandSpec> matchCommands();
std::vector<CommandSpec> minimizeCommands();
std::vector<CommandSpec> collectionCommands();
std::vector<CommandSpec> addCommands();
std::vector<CommandSpec> shapeCommands();
std::vector<CommandSpec> searchCommands();
std::vector<CommandSpec> evaluateCommands();
std::vector<CommandSpec> sampleCommands();
std::vector<CommandSpec> aboutCommands();

// Options that several commands share.
OptionSpec collectionOption();
OptionSpec formatOption();
OptionSpec initialDelaunayOption();
OptionSpec spaceOption(const std::string& help);
std::vector<OptionSpec> prepareOptions();

// Checks.
std::optional<std::string> isPositiveInteger(const std::string& value);
std::optional<std::string> isPositiveNumber(const std::string& value);
/// 0 counts.
std::optional<std::string> isDistance(const std::string& value);
std::optional<std::string> isKeyValue(const std::string& value);

}  // namespace moduli::cli
