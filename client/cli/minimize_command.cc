#include <cctype>
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>

#include "client/cli/command.h"
#include "client/cli/file_writer.h"
#include "client/cli/mesh_argument.h"
#include "client/cli/minimize_picture.h"
#include "client/cli/minimize_report.h"
#include "client/cli/prepare_arguments.h"
#include "client/cli/session.h"
#include "core/base/text.h"
#include "core/optimize/named_objectives.h"

/// minimize.
namespace moduli::cli {
namespace {

constexpr std::string_view kRicci = "ricci";

bool isRicci(const Arguments& arguments) {
  return arguments.text("FUNCTION") == kRicci;
}

/// The value that a word names; the unspecified one for "".
template <typename Enum>
Enum valueOf(std::string word, bool (*parse)(google::protobuf::ConstStringParam, Enum*)) {
  for (char& c : word) c = c == '-' ? '_' : static_cast<char>(std::toupper(c));
  Enum value{};
  return parse(word, &value) ? value : Enum{};
}

/// "-1.2,1": finite numbers; nothing where they are not that.
std::optional<std::vector<double>> parseNumbers(std::string_view text) {
  std::vector<double> numbers;
  while (true) {
    const std::size_t comma = text.find(',');
    const std::optional<double> number = parseDouble(text.substr(0, comma));
    if (!number || !std::isfinite(*number)) return std::nullopt;
    numbers.push_back(*number);
    if (comma == std::string_view::npos) return numbers;
    text.remove_prefix(comma + 1);
  }
}

void addNumbers(const std::string& text, google::protobuf::RepeatedField<double>& field) {
  const std::vector<double> numbers = parseNumbers(text).value_or(std::vector<double>());
  field.Add(numbers.begin(), numbers.end());
}

void setOptions(const Arguments& arguments, v1::MinimizeRequest& request) {
  v1::MinimizeOptions& options = *request.mutable_options();
  options.set_method(valueOf(arguments.text("method"), v1::MinimizeOptions::Method_Parse));
  options.set_line_search(
      valueOf(arguments.text("line-search"), v1::MinimizeOptions::LineSearch_Parse));
  if (arguments.has("start")) addNumbers(arguments.text("start"), *options.mutable_start());
  if (arguments.has("tolerance")) options.set_tolerance(arguments.number("tolerance", 0));
  if (arguments.has("max-iterations")) {
    options.set_max_iterations(arguments.integer("max-iterations", 0));
  }
  if (arguments.has("direction-at")) {
    addNumbers(arguments.text("direction-at"), *request.mutable_direction_at());
  }
}

void setTest(const Arguments& arguments, v1::TestFunction& test) {
  test.set_name(arguments.text("FUNCTION"));
  if (arguments.has("dimension")) test.set_dimension(arguments.integer("dimension", 2));
  if (arguments.has("condition")) test.set_condition(arguments.number("condition", 100));
  if (arguments.has("seed")) test.set_seed(arguments.integer("seed", 1));
}

void setRicci(const Arguments& arguments, v1::RicciEnergy& energy) {
  *energy.mutable_prepare() = prepareOf(arguments);
  energy.set_scheme(valueOf(arguments.text("scheme"), v1::ParameterizationOptions::Scheme_Parse));
  if (arguments.has("initial-delaunay")) {
    energy.set_initial_delaunay(arguments.text("initial-delaunay") == "on");
  }
}

std::string pictureTitle(const v1::MinimizeRequest& request, const std::string& title) {
  if (!request.has_ricci()) return title;
  return "Ricci energy of " + std::filesystem::path(title).filename().string();
}

/// The files that a run writes.
class Outputs {
 public:
  explicit Outputs(const Arguments& arguments)
      : arguments_(arguments),
        trace_(arguments.text("trace"), true),
        picture_(arguments.text("picture"), true) {}

  /// Before the work, so that a place where nothing can be written is told in time.
  Status open() {
    if (arguments_.has("trace")) RETURN_IF_ERROR(trace_.open());
    return arguments_.has("picture") ? picture_.open() : Status();
  }

  Status write(const v1::MinimizeRequest& request, const std::string& title,
               const MinimizedFunction& function) {
    if (arguments_.has("picture")) {
      MinimizePicture picture{request, function, pictureTitle(request, title)};
      ASSIGN_OR_RETURN(picture.format, parsePictureFormat(arguments_.text("picture")));
      if (arguments_.has("size")) {
        ASSIGN_OR_RETURN(picture.size, parsePictureSize(arguments_.text("size")));
      }
      ASSIGN_OR_RETURN(const std::string bytes, drawMinimization(picture));
      RETURN_IF_ERROR(picture_.write(bytes));
      RETURN_IF_ERROR(picture_.commit());
    }
    if (!arguments_.has("trace")) return {};
    RETURN_IF_ERROR(trace_.write(traceText(function.trace)));
    return trace_.commit();
  }

 private:
  const Arguments& arguments_;
  FileWriter trace_, picture_;
};

Status notConverged(const std::string& title, const v1::Minimization& result) {
  return {Reason::kNoConvergence,
          title + ": not converged, " + reasonWords(result.reason()) + " after " +
              counted(result.iterations(), "iteration", "iterations"),
          result.reason() == v1::Minimization::MAX_ITERATIONS
              ? "allow more by --max-iterations"
              : "start elsewhere by --start, or take another --method"};
}

Status runDirection(Session& session, Client& client, const v1::MinimizeRequest& request,
                    const std::string& title) {
  const Result<v1::AffineDirection> direction = client.affineNormal(request);
  if (!direction.ok()) return session.explain(title, direction.status());
  if (session.json()) return session.printJson(*direction);
  return session.quiet() ? Status() : session.print(directionReport(title, *direction));
}

Status runWalk(Session& session, Client& client, v1::MinimizeRequest& request,
               const std::string& title, Outputs& outputs, const Arguments& arguments) {
  request.set_trace(session.talks() || arguments.has("trace") || arguments.has("picture"));
  request.set_path(arguments.has("picture") && drawsPlane(request));
  const Result<MinimizedFunction> function = client.minimize(request);
  if (!function.ok()) return session.explain(title, function.status());
  RETURN_IF_ERROR(outputs.write(request, title, *function));
  if (session.json()) {
    RETURN_IF_ERROR(session.printJson(function->result));
  } else if (session.talks()) {
    RETURN_IF_ERROR(session.print(minimizationReport(title, *function)));
  }
  return function->result.converged() ? Status() : notConverged(title, function->result);
}

Status runMinimize(Session& session, const Arguments& arguments) {
  v1::MinimizeRequest request;
  setOptions(arguments, request);
  std::string title = arguments.text("FUNCTION");
  std::optional<MeshArgument> mesh;
  if (isRicci(arguments)) {
    setRicci(arguments, *request.mutable_ricci());
    ASSIGN_OR_RETURN(mesh,
                     MeshArgument::open(session, arguments.text("MESH"), arguments.text("format")));
    title = mesh->name();
  } else {
    setTest(arguments, *request.mutable_test());
  }
  Outputs outputs(arguments);
  RETURN_IF_ERROR(outputs.open());
  ASSIGN_OR_RETURN(Client* const client, session.client(mesh ? mesh->need() : StoreNeed::kNone));
  if (mesh) {
    Result<v1::MeshSource> source = mesh->source(*client);
    if (!source.ok()) return session.explain(title, source.status());
    *request.mutable_ricci()->mutable_source() = *std::move(source);
  }
  if (arguments.has("direction-at")) return runDirection(session, *client, request, title);
  return runWalk(session, *client, request, title, outputs, arguments);
}

std::string functionNames() {
  std::string names;
  for (const std::string& name : objectiveNames()) names += name + ", ";
  return names + "or ricci with a MESH";
}

/// Options that the function does not look at were meant for another one.
std::optional<std::string> checkFunction(const Arguments& arguments) {
  const std::string name = arguments.text("FUNCTION");
  if (!isRicci(arguments) && !checkObjective(name, {}).ok()) {
    return "there is no function '" + name + "'; it is " + functionNames();
  }
  if (isRicci(arguments) != arguments.has("MESH")) {
    return isRicci(arguments) ? std::string("ricci needs a MESH")
                              : "a MESH is that of ricci, not of " + name;
  }
  if (isRicci(arguments)) {
    for (const char* option : {"dimension", "condition", "seed"}) {
      if (arguments.has(option)) return "--" + std::string(option) + " is not for ricci";
    }
    return std::nullopt;
  }
  for (const char* option :
       {"scheme", "initial-delaunay", "repair", "fill-holes", "component", "format"}) {
    if (arguments.has(option)) return "--" + std::string(option) + " is for ricci MESH";
  }
  return std::nullopt;
}

std::optional<std::string> checkPoints(const Arguments& arguments) {
  for (const char* option : {"start", "direction-at"}) {
    if (arguments.has(option) && !parseNumbers(arguments.text(option))) {
      return "--" + std::string(option) + " takes finite numbers such as -1.2,1, not '" +
             arguments.text(option) + "'";
    }
  }
  if (!arguments.has("direction-at")) return std::nullopt;
  for (const char* option :
       {"method", "line-search", "start", "tolerance", "max-iterations", "trace", "picture"}) {
    if (arguments.has(option)) {
      return "--" + std::string(option) + " is for minimizing, which --direction-at does not";
    }
  }
  return std::nullopt;
}

std::optional<std::string> checkArguments(const Arguments& arguments) {
  if (auto complaint = checkFunction(arguments)) return complaint;
  if (auto complaint = checkPoints(arguments)) return complaint;
  if (arguments.has("trace") && arguments.text("trace") == arguments.text("picture")) {
    return "--trace and --picture name the same file";
  }
  if (!arguments.has("picture")) {
    return arguments.has("size") ? std::optional<std::string>("--size is that of a --picture")
                                 : std::nullopt;
  }
  Status status = parsePictureFormat(arguments.text("picture")).status();
  if (status.ok() && arguments.has("size")) {
    status = parsePictureSize(arguments.text("size")).status();
  }
  if (status.ok()) return std::nullopt;
  return status.hint().empty() ? status.message() : status.message() + "; " + status.hint();
}

std::optional<std::string> isCount(const std::string& value) {
  const auto number = parseInteger(value);
  if (number && *number >= 0 && *number <= std::numeric_limits<int>::max()) return std::nullopt;
  return "must be 0 or a positive integer";
}

std::vector<OptionSpec> functionOptions() {
  return {{.names = "--dimension",
           .value = "N",
           .help = "Unknowns of a test function (as many as --start or --direction-at gives; 2)",
           .check = isPositiveInteger},
          {.names = "--condition",
           .value = "C",
           .help = "quadratic: the largest eigenvalue, the least being 1 (100)",
           .check = isPositiveNumber},
          {.names = "--seed",
           .value = "N",
           .help = "Of random coefficients: quadratic, log-sum-exp, exp-sum (1)",
           .check = isCount},
          {.names = "--scheme",
           .value = "SCHEME",
           .help = "ricci: how lengths change (vertex-scaling)",
           .choices = {"vertex-scaling", "thurston", "tangential", "inversive-distance"}}};
}

std::vector<OptionSpec> minimizeOptions() {
  std::vector<OptionSpec> options = {
      {.names = "--method",
       .value = "METHOD",
       .help = "Along affine normals of level sets (affine-normal, the default), by Newton's "
               "method, limited-memory BFGS, or steepest descent",
       .choices = {"affine-normal", "newton", "lbfgs", "gradient"}},
      {.names = "--line-search",
       .value = "SEARCH",
       .help = "The first step that goes down enough (backtracking), or to the minimum along the "
               "line (exact)",
       .choices = {"backtracking", "exact"}},
      {.names = "--start",
       .value = "X,Y,...",
       .help = "Where to start, one number for each unknown; by default where the function is "
               "usually started"},
      {.names = "--tolerance",
       .value = "X",
       .help = "Enough where the norm of the gradient is no more than this (1e-10)",
       .check = isDistance},
      {.names = "--max-iterations",
       .value = "N",
       .help = "Give up after so many, at most 1000000 (1000)",
       .check = isCount},
      {.names = "--direction-at",
       .value = "X,Y,...",
       .help = "Only the affine normal at this point: the direction against which the method would "
               "go on from there"},
      {.names = "--trace",
       .value = "FILE.csv",
       .help = "Write a line for each iteration: iteration, value, gradient_norm, step, decrease, "
               "evaluations, factorizations",
       .completion = Completion::kFile},
      {.names = "--picture",
       .value = "FILE",
       .help = "Draw, as PNG or SVG: of two unknowns the level sets, the method's directions and "
               "the path, otherwise the gradient and the value against the iterations",
       .completion = Completion::kFile},
      {.names = "--size", .value = "WxH", .help = "Of the picture, in pixels (900x720)"}};
  for (OptionSpec& option : functionOptions()) options.push_back(std::move(option));
  options.push_back(initialDelaunayOption());
  for (OptionSpec& option : prepareOptions()) options.push_back(std::move(option));
  options.push_back(formatOption());
  return options;
}

std::vector<std::string> functionChoices() {
  std::vector<std::string> names = objectiveNames();
  names.emplace_back(kRicci);
  return names;
}

}  // namespace

std::vector<CommandSpec> minimizeCommands() {
  return {
      {.path = "minimize",
       .summary = "Minimize a function along the affine normals of its level sets",
       .details =
           "FUNCTION is a test function: quadratic, quartic (the sum of x_i^4), rosenbrock, "
           "log-barrier, log-sum-exp, exp-sum; or ricci: the energy of a surface whose minimizer "
           "is its metric of constant curvature, flat for a torus or a ring, hyperbolic with more "
           "handles or holes. Affine normals point to the centres of the level sets: on a "
           "quadratic, whatever its condition, to the minimizer; the path is the same in all "
           "affine coordinates and for all functions with the same level sets. Newton's method, "
           "limited-memory BFGS and steepest descent are there to compare with. A search that "
           "does not converge prints its last point all the same, and the exit status is 1, with "
           "the reason on standard error.",
       .arguments = {{.name = "FUNCTION",
                      .help = "A test function, or ricci",
                      .completion = Completion::kNothing,
                      .choices = functionChoices()},
                     {.name = "MESH",
                      .help = "With ricci: a file, '-' for standard input, or COLLECTION/SHAPE of "
                              "the store; an existing file wins, store:COLLECTION/SHAPE names the "
                              "store in any case",
                      .min = 0}},
       .options = minimizeOptions(),
       .check = checkArguments,
       .run = runMinimize,
       .examples = "moduli minimize rosenbrock --start -1.2,1 --picture path.png --trace path.csv\n"
                   "moduli minimize quadratic --dimension 100 --condition 1e6 --method lbfgs\n"
                   "moduli minimize quartic --direction-at 1,0.7 --json\n"
                   "moduli minimize ricci pretzel.off --method newton"}};
}

}  // namespace moduli::cli
