#include <algorithm>
#include <map>
#include <thread>
#include <vector>

#include "client/cli/command.h"
#include "client/cli/ingest_files.h"
#include "client/cli/mesh_argument.h"
#include "client/cli/prepare_arguments.h"
#include "client/cli/session.h"

/// add: bulk ingest.
namespace moduli::cli {
namespace {

using Outcome = v1::IngestShapesResponse;

struct AddResult {
  bool answered = false;
  IngestOutcome outcome;
};

/// The outcomes of a run, one for each file in the order of the command line.
class Summary {
 public:
  Summary(std::string collection, const std::vector<IngestFile>& files)
      : collection_(std::move(collection)), files_(files), results_(files.size()) {}

  void set(std::size_t file, IngestOutcome outcome) {
    ++counts_[outcome.outcome];
    ++answered_;
    results_[file] = {true, std::move(outcome)};
  }

  int count(Outcome::Outcome outcome) const {
    const auto found = counts_.find(outcome);
    return found == counts_.end() ? 0 : found->second;
  }
  std::size_t answered() const { return answered_; }
  std::size_t total() const { return files_.size(); }

  std::string counts() const {
    std::string text = std::to_string(count(Outcome::ADDED)) + " added, ";
    if (count(Outcome::REPLACED) > 0) {
      text += std::to_string(count(Outcome::REPLACED)) + " replaced, ";
    }
    return text + std::to_string(count(Outcome::SKIPPED)) + " skipped, " +
           std::to_string(count(Outcome::FAILED)) + " failed";
  }

  std::string report() const {
    std::string text = collection_ + ": " + counts() + "\n";
    for (std::size_t i = 0; i < results_.size(); ++i) {
      if (!failed(i)) continue;
      const IngestOutcome& outcome = results_[i].outcome;
      text += "  failed " + safe(named(i)) + " (" + safe(outcome.reason) + ")";
      text += (outcome.hint.empty() ? "" : "; " + safe(outcome.hint)) + "\n";
    }
    return text;
  }

  std::string json() const {
    JsonWriter json;
    json.open("{").key("added").number(count(Outcome::ADDED));
    json.key("replaced").number(count(Outcome::REPLACED));
    json.key("skipped").number(count(Outcome::SKIPPED));
    json.key("failed").number(count(Outcome::FAILED));
    json.key("results").open("[");
    for (std::size_t i = 0; i < results_.size(); ++i) {
      const AddResult& result = results_[i];
      if (!result.answered) continue;
      json.open("{").key("file").string(files_[i].path);
      json.key("name").string(files_[i].shape_id);
      json.key("outcome").string(Outcome::Outcome_Name(result.outcome.outcome));
      json.key("reason").string(result.outcome.reason);
      json.key("message").string(result.outcome.message);
      json.key("hint").string(result.outcome.hint).close("}");
    }
    json.close("]").close("}");
    return json.finish();
  }

  /// The failure that stands for all of them; OK if no file failed.
  Status failure() const {
    const int failures = count(Outcome::FAILED);
    for (std::size_t i = 0; i < results_.size(); ++i) {
      if (!failed(i)) continue;
      const IngestOutcome& outcome = results_[i].outcome;
      std::string message = named(i);
      if (failures > 1 || answered_ > 1) {
        message = std::to_string(failures) + " of " +
                  counted(static_cast<long long>(answered_), "file", "files") +
                  " failed: " + message;
      }
      return {reasonFromName(outcome.reason), message, outcome.hint};
    }
    return {};
  }

 private:
  bool failed(std::size_t i) const {
    return results_[i].answered && results_[i].outcome.outcome == Outcome::FAILED;
  }
  // The failure's message, which names the file by the path that was given.
  std::string named(std::size_t i) const {
    const std::string& path = files_[i].path;
    std::string message = results_[i].outcome.message;
    const std::string file_name = path.substr(path.rfind('/') + 1);
    if (message.starts_with(path)) return message;
    if (message.starts_with(file_name + ":")) return path + message.substr(file_name.size());
    return path + ": " + message;
  }

  const std::string collection_;
  const std::vector<IngestFile>& files_;
  std::vector<AddResult> results_;
  std::map<int, int> counts_;
  std::size_t answered_ = 0;
};

IngestOutcome outcomeOf(const Status& status) {
  IngestOutcome outcome;
  outcome.reason = reasonName(status.reason());
  outcome.message = status.message();
  outcome.hint = status.hint();
  return outcome;
}

std::map<std::string, std::string> tagsOf(const Arguments& arguments) {
  std::map<std::string, std::string> tags;
  for (const std::string& word : arguments.all("tag")) {
    const std::size_t sign = word.find('=');
    tags[word.substr(0, sign)] = word.substr(sign + 1);
  }
  return tags;
}

IngestOptions ingestOptions(const std::string& collection, const Arguments& arguments) {
  IngestOptions options;
  options.header.set_parent(collectionName(collection));
  options.header.set_create_collection(true);
  *options.header.mutable_prepare() = prepareOf(arguments);
  const std::string on_exists = arguments.text("on-exists", "skip");
  options.header.set_on_exists(on_exists == "replace" ? v1::IngestShapesRequest::REPLACE
                               : on_exists == "error" ? v1::IngestShapesRequest::ERROR
                                                      : v1::IngestShapesRequest::SKIP);
  // Two for each processor: one is signed while the next one is on its way.
  const int processors = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  options.jobs = static_cast<std::size_t>(arguments.integer("jobs", 2 * processors));
  return options;
}

// Feeds the files to the client and gathers what becomes of them.
Status ingest(Session& session, Client& client, const IngestOptions& options,
              const std::vector<IngestFile>& files, const Arguments& arguments, Summary& summary) {
  const auto tags = tagsOf(arguments);
  const auto format = protoFormat(arguments.text("format"));
  std::size_t next = 0;
  const IngestSource source = [&]() -> std::optional<IngestItem> {
    while (next < files.size() && !files[next].status.ok()) ++next;
    if (next == files.size()) return std::nullopt;
    const IngestFile& file = files[next];
    return IngestItem{next++, file.path, file.shape_id, file.label, tags, format};
  };
  return client.ingest(options, source, [&](const IngestItem& item, const IngestOutcome& outcome) {
    summary.set(item.order, outcome);
    const double share =
        static_cast<double>(summary.answered()) / static_cast<double>(summary.total());
    session.progress().update(summary.counts(), share);
  });
}

Status stopped(const std::string& collection, const Summary& summary, const Status& status) {
  const std::string words = " after " + std::to_string(summary.answered()) + " of " +
                            counted(static_cast<long long>(summary.total()), "file", "files");
  if (status.reason() == Reason::kCancelled) {
    return {status.reason(), collection + ": interrupted" + words,
            "run the same command again to do the rest"};
  }
  if (summary.answered() == 0) return status;
  return {status.reason(), status.message() + words, status.hint()};
}

Status runAdd(Session& session, const Arguments& arguments) {
  const std::string collection = arguments.text("collection");
  std::vector<std::string> paths = arguments.all("PATHS");
  if (arguments.has("from-file")) {
    ASSIGN_OR_RETURN(const std::vector<std::string> more,
                     readPathList(arguments.text("from-file")));
    paths.insert(paths.end(), more.begin(), more.end());
  }
  const std::vector<IngestFile> files =
      ingestFiles(paths, {.recursive = arguments.has("recursive"),
                          .label_from_dir = arguments.text("label-from") == "dir",
                          .name_from_path = arguments.text("name-from") == "path"});
  Summary summary(collection, files);
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (!files[i].status.ok()) summary.set(i, outcomeOf(files[i].status));
  }
  Status status;
  Result<Client*> client = session.client(StoreNeed::kCreate);
  if (!client.ok()) return client.status();
  status = session.explain(
      collection,
      ingest(session, **client, ingestOptions(collection, arguments), files, arguments, summary));
  if (session.json()) {
    RETURN_IF_ERROR(session.print(summary.json()));
  } else if (session.talks()) {
    RETURN_IF_ERROR(session.print(summary.report()));
  }
  return status.ok() ? summary.failure() : stopped(collection, summary, status);
}

std::optional<std::string> checkAdd(const Arguments& arguments) {
  if (arguments.has("PATHS") || arguments.has("from-file")) return std::nullopt;
  return "PATHS or --from-file LIST is missing";
}

std::vector<OptionSpec> addOptions() {
  std::vector<OptionSpec> options = {
      collectionOption(),
      {.names = "--from-file",
       .value = "LIST",
       .help = "Also add the paths in this file, one a line; '-' for standard input",
       .completion = Completion::kFile},
      {.names = "--recursive", .value = "", .help = "Take folders with all folders in them"},
      {.names = "--label-from",
       .value = "WHAT",
       .help = "Label each shape with the name of its file's folder, or not at all (none)",
       .choices = {"dir", "none"}},
      {.names = "--tag",
       .value = "KEY=VALUE",
       .help = "Tag each shape; may be repeated",
       .check = isKeyValue,
       .repeated = true},
      {.names = "--name-from",
       .value = "WHAT",
       .help = "Name each shape by its file's stem, or by its path with ':' for '/' (stem)",
       .choices = {"stem", "path"}},
      {.names = "--on-exists",
       .value = "WHAT",
       .help = "What to do where another file is stored under the name (skip)",
       .choices = {"skip", "replace", "error"}},
      {.names = "--jobs",
       .value = "N",
       .help = "Files under way at a time (two for each processor)",
       .check = isPositiveInteger}};
  for (OptionSpec& option : prepareOptions()) options.push_back(std::move(option));
  options.push_back(formatOption());
  return options;
}

}  // namespace

std::vector<CommandSpec> addCommands() {
  return {{.path = "add",
           .summary = "Sign files and store them in a collection",
           .details =
               "Any number of files and folders; of a folder its mesh files count, by their "
               "extension, and those JSON files that say they are intrinsic triangulations. A "
               "collection that is not there is made. A file that fails does not stop "
               "the others; what is stored already is skipped without being sent, so that a run "
               "that was broken off is finished by the same command. Ends with a summary, and with "
               "exit code 1 if any file failed.",
           .arguments = {{.name = "PATHS", .help = "Files and folders", .min = 0, .max = -1}},
           .options = addOptions(),
           .check = checkAdd,
           .run = runAdd,
           .examples =
               "moduli add -c demo meshes/*.off\nfind . -name '*.ply' | moduli add -c scans "
               "--from-file - --name-from path --label-from dir"}};
}

}  // namespace moduli::cli
