#include <Eigen/SVD>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "core/base/text.h"
#include "core/optimize/changed_objective.h"
#include "core/optimize/minimize.h"
#include "core/optimize/normal_deviates.h"
#include "tests/bench/optimize/functions.h"

/// moduli_optimize_bench [--functions NAME,...] [--max-iterations N]
///
/// Prints a table of what each method takes on each function: iterations, evaluations of value and
/// gradient, factorizations, milliseconds and the value reached; then the iterations on f (B x), B
/// random of condition 100, and on log (1 + f). A number in brackets: not converged, with the
/// reason.
namespace moduli {
namespace {

constexpr double kCondition = 100;

struct Settings {
  std::string functions;
  int max_iterations = 2000;
};

struct Outcome {
  Minimum minimum;
  double milliseconds = 0;
};

Result<Outcome> timed(Objective& objective, const Eigen::VectorXd& start,
                      const MinimizeOptions& options) {
  Context context;
  const auto begin = std::chrono::steady_clock::now();
  ASSIGN_OR_RETURN(Minimum minimum, minimize(context, objective, start, options));
  const std::chrono::duration<double, std::milli> span = std::chrono::steady_clock::now() - begin;
  return Outcome{std::move(minimum), span.count()};
}

std::string iterations(const Minimum& minimum) {
  const std::string count = std::to_string(minimum.iterations);
  if (minimum.converged) return count;
  return "(" + count + ", " + std::string(stopReasonName(minimum.reason)) + ")";
}

/// A map of singular values from 1 / 10 to 10 between random bases.
Eigen::MatrixXd randomMap(Eigen::Index n) {
  NormalDeviates deviates(12);
  const Eigen::BDCSVD<Eigen::MatrixXd> svd(deviates.matrix(n, n),
                                           Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::VectorXd values(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double share = n == 1 ? 0.5 : static_cast<double>(i) / static_cast<double>(n - 1);
    values[i] = std::pow(kCondition, share - 0.5);
  }
  return svd.matrixU() * values.asDiagonal() * svd.matrixV().transpose();
}

Result<std::string> affineColumn(const BenchFunction& function, const MinimizeOptions& options) {
  ASSIGN_OR_RETURN(NamedObjective f, function.make());
  const Eigen::Index n = f.objective->dimension();
  AffineChange changed(std::move(f.objective), randomMap(n), Eigen::VectorXd::Zero(n));
  ASSIGN_OR_RETURN(const Outcome outcome, timed(changed, changed.backward(f.start), options));
  return iterations(outcome.minimum);
}

Result<std::string> logarithmColumn(const BenchFunction& function, const MinimizeOptions& options) {
  ASSIGN_OR_RETURN(NamedObjective f, function.make());
  MonotoneTransform changed(std::move(f.objective), MonotoneTransform::Kind::kLogarithm);
  ASSIGN_OR_RETURN(const Outcome outcome, timed(changed, f.start, options));
  return iterations(outcome.minimum);
}

Status row(const BenchFunction& function, const MinimizeOptions& options) {
  ASSIGN_OR_RETURN(const NamedObjective f, function.make());
  ASSIGN_OR_RETURN(const Outcome plain, timed(*f.objective, f.start, options));
  std::string affine = "-", logarithm = "-";
  if (function.changeable) {
    ASSIGN_OR_RETURN(affine, affineColumn(function, options));
    ASSIGN_OR_RETURN(logarithm, logarithmColumn(function, options));
  }
  std::printf(
      "| %s | %d | %s | %s | %s | %d | %d | %.2f | %.6g | %s | %s |\n", function.name.c_str(),
      static_cast<int>(f.objective->dimension()), std::string(methodName(options.method)).c_str(),
      std::string(lineSearchName(options.line_search)).c_str(), iterations(plain.minimum).c_str(),
      plain.minimum.evaluations, plain.minimum.factorizations, plain.milliseconds,
      plain.minimum.value, affine.c_str(), logarithm.c_str());
  return {};
}

Status table(const Settings& settings) {
  std::printf(
      "| function | n | method | line search | iterations | evaluations | factorizations | ms | "
      "value | iterations on f(Bx) | on log(1+f) "
      "|\n|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const BenchFunction& function : benchFunctions()) {
    const std::string name = function.name.substr(0, function.name.find(','));
    if (!settings.functions.empty() &&
        ("," + settings.functions + ",").find("," + name + ",") == std::string::npos) {
      continue;
    }
    for (const MinimizeMethod method : {MinimizeMethod::kAffineNormal, MinimizeMethod::kNewton,
                                        MinimizeMethod::kLbfgs, MinimizeMethod::kGradient}) {
      for (const LineSearchKind search : {LineSearchKind::kBacktracking, LineSearchKind::kExact}) {
        MinimizeOptions options;
        options.method = method;
        options.line_search = search;
        options.max_iterations = settings.max_iterations;
        RETURN_IF_ERROR(row(function, options).withContext(function.name));
      }
    }
  }
  return {};
}

Status take(const std::string& option, const std::string& value, Settings& settings) {
  if (option == "--functions") {
    settings.functions = value;
    return {};
  }
  const auto count = parseInteger(value);
  if (option != "--max-iterations" || !count || *count < 0 || *count > 1000000) {
    return {Reason::kInvalidOption, "'" + option + " " + value + "' is unknown or wrong",
            "options are --functions NAME,... and --max-iterations N"};
  }
  settings.max_iterations = static_cast<int>(*count);
  return {};
}

Result<Settings> parse(const std::vector<std::string>& arguments) {
  Settings settings;
  for (std::size_t i = 0; i < arguments.size(); i += 2) {
    const std::string value = i + 1 < arguments.size() ? arguments[i + 1] : "";
    RETURN_IF_ERROR(take(arguments[i], value, settings));
  }
  return settings;
}

Status run(const std::vector<std::string>& arguments) {
  ASSIGN_OR_RETURN(const Settings settings, parse(arguments));
  return table(settings);
}

}  // namespace
}  // namespace moduli

int main(int argc, char** argv) {
  const moduli::Status status = moduli::run({argv + 1, argv + argc});
  if (status.ok()) return EXIT_SUCCESS;
  std::fprintf(stderr, "moduli_optimize_bench: %s\n", status.toString().c_str());
  return EXIT_FAILURE;
}
