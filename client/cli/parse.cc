#include "client/cli/parse.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <map>
#include <memory>

namespace moduli::cli {
namespace {

// One command line option of CLI11 and the row of our table that it came from.
struct BoundOption {
  const OptionSpec* spec;
  CLI::Option* option;
};

struct BoundCommand {
  const CommandSpec* spec = nullptr;
  CLI::App* app = nullptr;
  std::vector<BoundOption> options;
  std::vector<std::pair<const ArgumentSpec*, CLI::Option*>> arguments;
};

class Parser {
 public:
  Parser() : root_("", "moduli") {
    prepare(root_);
    root_.require_subcommand(0, 1);
    root_.add_flag("--version");
    for (const CommandSpec& command : commands()) bind(command);
  }

  Request parse(std::vector<std::string> words) {
    std::reverse(words.begin(), words.end());  // CLI11 takes them from the back.
    Request request;
    try {
      root_.parse(std::move(words));
    } catch (const CLI::CallForHelp&) {
      request.kind = Request::Kind::kHelp;
      request.path = pathOf(deepest());
      return request;
    } catch (const CLI::ExtrasError&) {
      request.kind = Request::Kind::kUsageError;
      request.path = pathOf(deepest());
      request.complaint = tooMuch(*deepest());
      return request;
    } catch (const CLI::ParseError& error) {
      if (root_.count("--version") > 0) return versionRequest();
      request.kind = Request::Kind::kUsageError;
      request.path = pathOf(deepest());
      request.complaint = error.what();
      return request;
    }
    return collect();
  }

 private:
  // Global options belong to every level, so that they are known wherever they stand. CLI11's own
  // way, fallthrough(), would also let words fall out of a command's arguments.
  void prepare(CLI::App& app) {
    app.set_help_flag("-h,--help");
    app.allow_extras(false);
    for (const OptionSpec& spec : globalOptions()) globals_.push_back(bindOption(app, spec));
  }

  static BoundOption bindOption(CLI::App& app, const OptionSpec& spec) {
    CLI::Option* option = nullptr;
    if (spec.value.empty()) {
      option = app.add_flag(spec.names);
    } else if (spec.value.front() == '[') {
      option = app.add_flag(spec.names + "{" + spec.bare_value + "}");
    } else {
      // One word each time it is given: without this a list swallows the files that follow.
      option = app.add_option(spec.names)->type_size(1)->expected(1)->allow_extra_args(false);
    }
    option->multi_option_policy(spec.repeated ? CLI::MultiOptionPolicy::TakeAll
                                              : CLI::MultiOptionPolicy::TakeLast);
    option->required(spec.required);
    return {&spec, option};
  }

  void bind(const CommandSpec& command) {
    CLI::App* parent = &root_;
    std::string name = command.path;
    if (const std::size_t blank = name.find(' '); blank != std::string::npos) {
      parent = group(name.substr(0, blank));
      name = name.substr(blank + 1);
    }
    BoundCommand bound;
    bound.spec = &command;
    bound.app = parent->add_subcommand(name);
    if (command.passes_on) {
      bound.app->set_help_flag();
      bound.app->prefix_command();
    } else {
      prepare(*bound.app);
    }
    for (const OptionSpec& spec : command.options) {
      bound.options.push_back(bindOption(*bound.app, spec));
    }
    for (const ArgumentSpec& spec : command.arguments) {
      CLI::Option* option = bound.app->add_option(spec.name)->type_size(1);
      option->expected(std::max(spec.min, 1),
                       spec.max < 0 ? CLI::detail::expected_max_vector_size : spec.max);
      option->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
      // CLI11 2.1.2 fills a positional up to its least number only, unless told so.
      option->allow_extra_args(spec.max != 1);
      option->required(spec.min > 0);
      bound.arguments.emplace_back(&spec, option);
    }
    bound_.push_back(std::move(bound));
  }

  CLI::App* group(const std::string& name) {
    CLI::App*& app = groups_[name];
    if (app == nullptr) {
      app = root_.add_subcommand(name);
      prepare(*app);
      app->require_subcommand(1);
    }
    return app;
  }

  const CLI::App* deepest() const {
    const CLI::App* app = &root_;
    while (!app->get_subcommands().empty()) app = app->get_subcommands().front();
    return app;
  }

  std::string pathOf(const CLI::App* app) const {
    if (app == &root_) return "";
    const std::string above = pathOf(app->get_parent());
    return above.empty() ? app->get_name() : above + " " + app->get_name();
  }

  // The first word that has no place.
  static std::string tooMuch(const CLI::App& app) {
    const std::vector<std::string> words = app.remaining();
    if (words.empty()) return "there are too many words";
    const std::string word = "'" + words.front() + "'";
    if (words.front().starts_with('-')) return "there is no option " + word;
    if (!app.get_subcommands(nullptr).empty()) return "there is no command " + word;
    return word + " is one word too many";
  }

  Request versionRequest() const {
    Request request;
    request.command = findCommand("version");
    request.path = "version";
    for (const BoundOption& bound : globals_) take(bound, request.globals);
    return request;
  }

  Request collect() {
    if (root_.count("--version") > 0) return versionRequest();
    Request request;
    request.path = pathOf(deepest());
    const auto found = std::find_if(bound_.begin(), bound_.end(),
                                    [&](const auto& bound) { return bound.app == deepest(); });
    if (found == bound_.end()) return complain(request, "a command is required");
    request.command = found->spec;
    if (found->spec->passes_on) request.passed_on = found->app->remaining();
    for (const BoundOption& bound : globals_) take(bound, request.globals);
    for (const BoundOption& bound : found->options) take(bound, request.arguments);
    for (const auto& [spec, option] : found->arguments) {
      for (const std::string& value : option->results()) request.arguments.add(spec->name, value);
    }
    if (auto complaint = judge(*found)) return complain(request, *complaint);
    if (found->spec->check != nullptr) {
      if (auto complaint = found->spec->check(request.arguments)) {
        return complain(request, *complaint);
      }
    }
    return request;
  }

  static Request complain(Request request, const std::string& complaint) {
    request.kind = Request::Kind::kUsageError;
    request.complaint = complaint;
    return request;
  }

  static void take(const BoundOption& bound, Arguments& arguments) {
    const bool flag = bound.spec->value.empty();
    for (const std::string& value : bound.option->results()) {
      if (!flag || value == "true") arguments.add(bound.spec->key(), value);
    }
  }

  // Judges every value by its row of the table.
  std::optional<std::string> judge(const BoundCommand& command) const {
    for (const auto* list : {&command.options, &globals_}) {
      for (const BoundOption& bound : *list) {
        for (const std::string& value : bound.option->results()) {
          if (auto complaint = judgeValue(*bound.spec, value)) {
            return "--" + bound.spec->key() + " " + *complaint + ", not '" + value + "'";
          }
        }
      }
    }
    return std::nullopt;
  }

  static std::optional<std::string> judgeValue(const OptionSpec& spec, const std::string& value) {
    if (spec.value.empty()) {
      return value == "true" ? std::nullopt : std::optional<std::string>("takes no value");
    }
    if (!spec.choices.empty() &&
        std::find(spec.choices.begin(), spec.choices.end(), value) == spec.choices.end()) {
      std::string list;
      for (const std::string& choice : spec.choices) list += (list.empty() ? "" : ", ") + choice;
      return "must be one of " + list;
    }
    return spec.check == nullptr ? std::nullopt : spec.check(value);
  }

  CLI::App root_;
  std::map<std::string, CLI::App*> groups_;
  std::vector<BoundCommand> bound_;
  std::vector<BoundOption> globals_;
};

}  // namespace

Request parse(std::vector<std::string> words) {
  Parser parser;
  return parser.parse(std::move(words));
}

}  // namespace moduli::cli
