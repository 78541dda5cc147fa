#include "client/cli/command.h"

#include <limits>

#include "core/base/text.h"

namespace moduli::cli {

std::string OptionSpec::key() const {
  const std::size_t dashes = names.rfind("--");
  if (dashes != std::string::npos) return names.substr(dashes + 2);
  return names.substr(names.rfind('-') + 1);
}

std::string Arguments::text(const std::string& key, const std::string& otherwise) const {
  const auto found = values_.find(key);
  return found == values_.end() ? otherwise : found->second.back();
}

std::vector<std::string> Arguments::all(const std::string& key) const {
  const auto found = values_.find(key);
  return found == values_.end() ? std::vector<std::string>() : found->second;
}

int Arguments::integer(const std::string& key, int otherwise) const {
  const auto value = parseInteger(text(key));
  return value ? static_cast<int>(*value) : otherwise;
}

double Arguments::number(const std::string& key, double otherwise) const {
  return parseDouble(text(key)).value_or(otherwise);
}

void Arguments::add(const std::string& key, std::string value) {
  values_[key].push_back(std::move(value));
}

const std::vector<CommandSpec>& commands() {
  static const std::vector<CommandSpec> all = [] {
    std::vector<CommandSpec> list;
    for (auto group : {computeCommands, parameterizeCommands, matchCommands, minimizeCommands,
                       collectionCommands, addCommands, shapeCommands, searchCommands,
                       evaluateCommands, sampleCommands, aboutCommands}) {
      for (CommandSpec& command : group()) list.push_back(std::move(command));
    }
    return list;
  }();
  return all;
}

const std::vector<OptionSpec>& globalOptions() {
  static const std::vector<OptionSpec> options = {
      {.names = "--json", .value = "", .help = "Print one JSON document instead of text"},
      {.names = "--quiet", .value = "", .help = "Print nothing but errors and JSON"},
      {.names = "--timeout",
       .value = "SECONDS",
       .help = "Give up after this time",
       .check = isPositiveNumber},
      {.names = "--server",
       .value = "HOST:PORT",
       .help = "Talk to this modulid (or $MODULI_SERVER); otherwise work in this process"},
      {.names = "--data",
       .value = "DIR",
       .help = "Folder of the embedded store (or $MODULI_DATA; default: "
               "$XDG_DATA_HOME/moduli or ~/.local/share/moduli)",
       .completion = Completion::kFolder},
      {.names = "--token",
       .value = "TOKEN",
       .help = "Access token of the server (better in $MODULI_TOKEN, where no one sees it)"},
      {.names = "--tls", .value = "", .help = "Encrypt, trusting the system's authorities"},
      {.names = "--tls-ca",
       .value = "FILE",
       .help = "Encrypt, trusting the authorities of this PEM file (or $MODULI_TLS_CA)",
       .completion = Completion::kFile},
      {.names = "--tls-cert",
       .value = "FILE",
       .help = "Own certificate to show to the server, PEM",
       .completion = Completion::kFile},
      {.names = "--tls-key",
       .value = "FILE",
       .help = "Key of the own certificate, PEM",
       .completion = Completion::kFile},
      {.names = "--insecure",
       .value = "",
       .help = "Send the token unencrypted to another machine all the same"},
  };
  return options;
}

const CommandSpec* findCommand(const std::string& path) {
  for (const CommandSpec& command : commands()) {
    if (command.path == path) return &command;
  }
  return nullptr;
}

OptionSpec collectionOption() {
  return {.names = "-c,--collection", .value = "NAME", .help = "The collection", .required = true};
}

OptionSpec formatOption() {
  return {.names = "--format",
          .value = "FORMAT",
          .help = "Format of the mesh; by default its content tells, then its extension",
          .choices = {"obj", "off", "ply", "stl", "json", "gifti", "freesurfer"}};
}

OptionSpec initialDelaunayOption() {
  return {.names = "--initial-delaunay",
          .value = "on|off",
          .help =
              "Vertex scaling: start from the intrinsic Delaunay triangulation (on, the "
              "default), or from the mesh's own edges, whose class no Möbius map of space "
              "changes",
          .choices = {"on", "off"}};
}

OptionSpec spaceOption(const std::string& help) {
  return {.names = "--space",
          .value = "SPACE",
          .help = help,
          .choices = {"conformal", "metric", "shape"}};
}

namespace {

std::optional<std::string> isComponent(const std::string& value) {
  const auto number = parseInteger(value);
  if (value == "largest" || value == "all" || (number && *number >= 0)) return std::nullopt;
  return "must be 'largest', 'all' or a number counted from 0";
}

}  // namespace

std::vector<OptionSpec> prepareOptions() {
  return {{.names = "--repair",
           .value = "",
           .help = "Weld equal vertices, drop what carries nothing, re-orient, split pinched "
                   "vertices first"},
          {.names = "--fill-holes",
           .value = "[FRACTION]",
           .help = "Close boundary loops shorter than this fraction of the square root of the area "
                   "(0.5)",
           .check = isPositiveNumber,
           .bare_value = "0.5"},
          {.names = "--component",
           .value = "largest|N",
           .help = "Take one component of several, counted from 0; 'all' lays each out with "
                   "parameterize --to flat",
           .check = isComponent}};
}

std::optional<std::string> isPositiveInteger(const std::string& value) {
  const auto number = parseInteger(value);
  if (number && *number > 0 && *number <= std::numeric_limits<int>::max()) return std::nullopt;
  return "must be a positive integer";
}

std::optional<std::string> isPositiveNumber(const std::string& value) {
  const auto number = parseDouble(value);
  if (number && *number > 0 && *number <= std::numeric_limits<double>::max()) return std::nullopt;
  return "must be a positive number";
}

std::optional<std::string> isDistance(const std::string& value) {
  const auto number = parseDouble(value);
  if (number && *number >= 0 && *number <= std::numeric_limits<double>::max()) return std::nullopt;
  return "must be 0 or a positive number";
}

std::optional<std::string> isKeyValue(const std::string& value) {
  const std::size_t sign = value.find('=');
  if (sign != std::string::npos && sign > 0) return std::nullopt;
  return "must look like KEY=VALUE";
}

}  // namespace moduli::cli
