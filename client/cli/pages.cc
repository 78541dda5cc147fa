#include "client/cli/pages.h"

#include <algorithm>
#include <vector>

#include "client/cli/command.h"

namespace moduli::cli {
namespace {

constexpr std::size_t kPageWidth = 80;
constexpr std::size_t kLabelWidth = 26;

constexpr const char* kAbout =
    "moduli computes the conformal structure of triangle meshes, turns it into signatures, keeps "
    "signatures in searchable collections, and compares surfaces. It works on an embedded store, "
    "or talks to a modulid.";
constexpr const char* kExit =
    "0 on success, 1 when the operation failed, 2 on wrong usage. A failure is one line on "
    "standard error: what failed, why, and what to do.";

std::vector<const CommandSpec*> commandsBelow(const std::string& path) {
  std::vector<const CommandSpec*> found;
  for (const CommandSpec& command : commands()) {
    if (command.path == path || command.path.starts_with(path + " ")) found.push_back(&command);
  }
  return found;
}

std::string wrapped(const std::string& text, std::size_t indent) {
  std::string result;
  std::size_t column = indent;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    const std::string word = text.substr(begin, end - begin);
    if (column > indent && column + 1 + word.size() > kPageWidth) {
      result += "\n" + std::string(indent, ' ');
      column = indent;
    } else if (column > indent) {
      result += " ";
      ++column;
    }
    result += word;
    column += word.size();
    begin = end + 1;
  }
  return result;
}

// Paragraphs are wrapped; lines that are set out already (a list) stay as they are.
std::string paragraphs(const std::string& text) {
  if (text.find('\n') == std::string::npos) return wrapped(text, 0) + "\n";
  return text.ends_with('\n') ? text : text + "\n";
}

std::string entry(const std::string& label, const std::string& text) {
  std::string line = "  " + label;
  if (line.size() + 2 > kLabelWidth) {
    line += "\n" + std::string(kLabelWidth, ' ');
  } else {
    line.resize(kLabelWidth, ' ');
  }
  return line + wrapped(text, kLabelWidth) + "\n";
}

std::string optionLabel(const OptionSpec& option) {
  std::string label = option.names;
  std::replace(label.begin(), label.end(), ',', ' ');
  if (const std::size_t blank = label.find(' '); blank != std::string::npos) {
    label.replace(blank, 1, ", ");
  }
  if (option.value.empty()) return label;
  if (option.value.front() == '[') return label + "[=" + option.value.substr(1);
  return label + " " + option.value;
}

std::string optionText(const OptionSpec& option) {
  std::string text = option.help;
  if (!option.choices.empty()) {
    text += ":";
    for (const std::string& choice : option.choices) text += " " + choice;
  }
  return text;
}

std::string usage(const CommandSpec& command) {
  std::string line = "moduli " + command.path;
  for (const OptionSpec& option : command.options) {
    if (option.required)
      line += " " + option.names.substr(0, option.names.find(',')) + " " + option.value;
  }
  for (const ArgumentSpec& argument : command.arguments) {
    const std::string word = argument.name + (argument.max < 0 || argument.max > 1 ? "..." : "");
    line += argument.min == 0 ? " [" + word + "]" : " " + word;
  }
  return command.passes_on ? line + " [modulid's options]" : line + " [options]";
}

std::string groupHelp(const std::string& path) {
  const bool root = path.empty();
  std::string text = "Usage: moduli " + (root ? "" : path + " ") + "COMMAND ...\n\n";
  if (root) text += wrapped(kAbout, 0) + "\n\n";
  text += "Commands:\n";
  for (const CommandSpec& command : commands()) {
    const bool below = root || command.path.starts_with(path + " ");
    if (below) text += entry(command.path, command.summary);
  }
  text += "\nOptions of all commands, before and after them:\n";
  for (const OptionSpec& option : globalOptions()) {
    text += entry(optionLabel(option), optionText(option));
  }
  text += entry("-h, --help", "Help on the program or on a command");
  return root ? text + "\n" + wrapped(std::string("Exit code: ") + kExit, 0) + "\n" : text;
}

std::string commandHelp(const CommandSpec& command) {
  std::string text =
      "Usage: " + usage(command) + "\n\n" + command.summary + ".\n\n" + paragraphs(command.details);
  if (!command.arguments.empty()) text += "\nArguments:\n";
  for (const ArgumentSpec& argument : command.arguments) {
    text += entry(argument.name, argument.help);
  }
  if (!command.options.empty()) text += "\nOptions:\n";
  for (const OptionSpec& option : command.options) {
    text += entry(optionLabel(option), optionText(option));
  }
  if (!command.examples.empty()) text += "\nExamples:\n";
  for (std::size_t begin = 0; begin < command.examples.size();) {
    const std::size_t end = std::min(command.examples.find('\n', begin), command.examples.size());
    text += "  " + command.examples.substr(begin, end - begin) + "\n";
    begin = end + 1;
  }
  return text + "\n'moduli --help' tells the options of all commands.\n";
}

// Roff: a dash is a hyphen unless escaped, and a line must not start with "." or "'".
std::string roff(const std::string& text) {
  std::string result;
  for (const char c : text) {
    const bool at_start = result.empty() || result.back() == '\n';
    if (at_start && (c == '.' || c == '\'')) result += "\\&";
    if (c == '-') {
      result += "\\-";
    } else if (c == '\\') {
      result += "\\e";
    } else {
      result += c;
    }
  }
  return result;
}

std::string roffOptions(const std::vector<OptionSpec>& options) {
  std::string text;
  for (const OptionSpec& option : options) {
    text += ".TP\n.B " + roff(optionLabel(option)) + "\n" + roff(optionText(option)) + "\n";
  }
  return text;
}

// Text that is set out in lines keeps them.
std::string roffParagraphs(const std::string& text) {
  if (text.find('\n') == std::string::npos) return roff(text) + "\n";
  return ".nf\n" + roff(text) + (text.ends_with('\n') ? "" : "\n") + ".fi\n";
}

std::string commandManual(const CommandSpec& command, const std::string& heading) {
  std::string text = heading.empty() ? "" : "." + heading + " " + roff(command.path) + "\n";
  text += ".B " + roff(usage(command)) + "\n.PP\n" + roff(command.summary) + ".\n.PP\n" +
          roffParagraphs(command.details);
  for (const ArgumentSpec& argument : command.arguments) {
    text += ".TP\n.I " + roff(argument.name) + "\n" + roff(argument.help) + "\n";
  }
  text += roffOptions(command.options);
  if (!command.examples.empty()) {
    text += ".PP\nExamples:\n.PP\n.nf\n" + roff(command.examples) + "\n.fi\n";
  }
  return text;
}

std::string heading(const std::string& path, const std::string& summary) {
  std::string name = path.empty() ? "moduli" : "moduli-" + path;
  std::replace(name.begin(), name.end(), ' ', '-');
  std::string upper = name;
  std::transform(upper.begin(), upper.end(), upper.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return ".TH " + roff(upper) + " 1 \"\" \"moduli " MODULI_VERSION "\" \"User Commands\"\n" +
         ".SH NAME\n" + roff(name) + " \\- " + roff(summary) + "\n.SH DESCRIPTION\n";
}

std::string rootManual() {
  std::string text =
      heading("", "signatures of surfaces, and search by them") + roff(kAbout) + "\n.SH COMMANDS\n";
  for (const CommandSpec& command : commands()) text += commandManual(command, "SS");
  return text + ".SH OPTIONS OF ALL COMMANDS\n" + roffOptions(globalOptions()) +
         ".SH EXIT STATUS\n" + roff(kExit) + "\n";
}

}  // namespace

std::string helpPage(const std::string& path) {
  const CommandSpec* command = findCommand(path);
  return command == nullptr ? groupHelp(path) : commandHelp(*command);
}

std::string manualPage(const std::string& path) {
  if (path.empty()) return rootManual();
  const auto below = commandsBelow(path);
  if (below.empty()) return "";
  const bool single = below.front()->path == path;
  std::string text = heading(path, single ? below.front()->summary : "work on " + path + "s");
  for (const CommandSpec* command : below) text += commandManual(*command, single ? "" : "SS");
  return text + ".SH OPTIONS OF ALL COMMANDS\n" + roffOptions(globalOptions()) +
         ".SH EXIT STATUS\n" + roff(kExit) + "\n.SH SEE ALSO\n.BR moduli (1)\n";
}

}  // namespace moduli::cli
