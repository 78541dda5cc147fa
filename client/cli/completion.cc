#include <algorithm>
#include <set>
#include <string>

#include "client/cli/command.h"
#include "client/cli/pages.h"

namespace moduli::cli {
namespace {

// "-o --output" of "-o,--output".
std::string words(const OptionSpec& option) {
  std::string text = option.names;
  std::replace(text.begin(), text.end(), ',', ' ');
  return text;
}

std::string patterns(const OptionSpec& option) {
  std::string text = option.names;
  std::replace(text.begin(), text.end(), ',', '|');
  return text;
}

std::string joined(const std::vector<std::string>& list) {
  std::string text;
  for (const std::string& word : list) text += (text.empty() ? "" : " ") + word;
  return text;
}

bool takesNextWord(const OptionSpec& option) {
  return !option.value.empty() && option.value.front() != '[';
}

// What follows an option that takes a value, as a case of the script.
std::string valueCase(const std::string& path, const OptionSpec& option) {
  if (!takesNextWord(option)) return "";
  std::string pattern;
  for (std::string rest = patterns(option); !rest.empty();) {
    const std::size_t bar = std::min(rest.find('|'), rest.size());
    pattern += (pattern.empty() ? "\"" : "|\"") + path + ":" + rest.substr(0, bar) + "\"";
    rest.erase(0, std::min(bar + 1, rest.size()));
  }
  std::string action = "return";
  if (!option.choices.empty()) {
    action = "COMPREPLY=($(compgen -W \"" + joined(option.choices) + "\" -- \"$current\")); return";
  } else if (option.completion == Completion::kFile) {
    action = "COMPREPLY=($(compgen -f -- \"$current\")); return";
  } else if (option.completion == Completion::kFolder) {
    action = "COMPREPLY=($(compgen -d -- \"$current\")); return";
  }
  return "    " + pattern + ") " + action + " ;;\n";
}

std::string commandCase(const CommandSpec& command) {
  std::string options, choices;
  for (const OptionSpec& option : command.options) options += words(option) + " ";
  bool files = false;
  for (const ArgumentSpec& argument : command.arguments) {
    files = files || argument.completion == Completion::kFile;
    if (!argument.choices.empty()) choices = joined(argument.choices);
  }
  return "    \"" + command.path + "\") options=\"" + options + "\"; words=\"" + choices +
         "\"; files=" + (files ? "yes" : "no") + " ;;\n";
}

// Which words may follow the words of a command so far: "" -> inspect ..., collection -> create ...
std::string nextWords(const std::string& path) {
  std::set<std::string> next;
  for (const CommandSpec& command : commands()) {
    const std::string prefix = path.empty() ? "" : path + " ";
    if (!command.path.starts_with(prefix)) continue;
    const std::string rest = command.path.substr(prefix.size());
    next.insert(rest.substr(0, rest.find(' ')));
  }
  return joined({next.begin(), next.end()});
}

std::set<std::string> groups() {
  std::set<std::string> names;
  for (const CommandSpec& command : commands()) {
    const std::size_t blank = command.path.find(' ');
    if (blank != std::string::npos) names.insert(command.path.substr(0, blank));
  }
  return names;
}

}  // namespace

std::string bashCompletion() {
  std::string globals, values, cases, taking;
  for (const OptionSpec& option : globalOptions()) {
    globals += words(option) + " ";
    values += valueCase("*", option);
    if (takesNextWord(option)) taking += (taking.empty() ? "" : "|") + patterns(option);
  }
  // A global option is known in every command: "*:--data" as a pattern, without quotes.
  for (std::size_t at = 0; (at = values.find("\"*:", at)) != std::string::npos; ++at) {
    values.replace(at, 3, "*\":");
  }
  for (const CommandSpec& command : commands()) {
    for (const OptionSpec& option : command.options) values += valueCase(command.path, option);
    cases += commandCase(command);
  }
  std::string levels;
  for (const std::string& group : groups()) {
    cases += "    \"" + group + "\") words=\"" + nextWords(group) + "\" ;;\n";
    levels += " " + group;
  }
  return "# Completion of moduli for bash: source it, or put it into\n"
         "# ~/.local/share/bash-completion/completions/moduli\n"
         "_moduli() {\n"
         "  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD-1]}\n"
         "  local path=\"\" options=\"\" words=\"\" files=no i\n"
         "  COMPREPLY=()\n"
         "  for ((i = 1; i < COMP_CWORD; i++)); do\n"
         "    case \"${COMP_WORDS[i]}\" in\n"
         "      " +
         taking +
         ") ((i++)) ;;\n"
         "      -*) ;;\n"
         "      *)\n"
         "        if [[ -z $path ]]; then path=${COMP_WORDS[i]}\n"
         "        elif [[ \"" +
         levels +
         " \" == *\" $path \"* ]]; then path+=\" ${COMP_WORDS[i]}\"\n"
         "        else break; fi ;;\n"
         "    esac\n"
         "  done\n"
         "  case \"$path:$previous\" in\n" +
         values +
         "  esac\n"
         "  case \"$path\" in\n"
         "    \"\") words=\"" +
         nextWords("") + "\" ;;\n" + cases +
         "  esac\n"
         "  if [[ $current == -* ]]; then\n"
         "    COMPREPLY=($(compgen -W \"$options " +
         globals +
         "--help\" -- \"$current\"))\n"
         "    return\n"
         "  fi\n"
         "  COMPREPLY=($(compgen -W \"$words\" -- \"$current\"))\n"
         "  if [[ $files == yes ]]; then COMPREPLY+=($(compgen -f -- \"$current\")); fi\n"
         "}\n"
         "complete -o filenames -F _moduli moduli\n";
}

}  // namespace moduli::cli
