#include "server/service/optimize_request.h"

#include <cmath>
#include <string>

#include "core/base/text.h"
#include "core/optimize/named_objectives.h"
#include "server/rpc/convert_optimize.h"
#include "server/service/request.h"

namespace moduli {
namespace {

using Numbers = google::protobuf::RepeatedField<double>;

/// Rows of a trace are kept in memory until they are sent: some 60 MB.
constexpr int kMostIterations = 1'000'000;

Refusal refuse(const std::string& message, const std::string& hint, const std::string& field) {
  return {{Reason::kInvalidOption, message, hint}, field};
}

/// unknowns: -1 where they are not known yet.
Refusal checkPoint(const Numbers& point, Eigen::Index unknowns, const std::string& what,
                   const std::string& field) {
  for (int i = 0; i < point.size(); ++i) {
    if (std::isfinite(point[i])) continue;
    return refuse("entry " + std::to_string(i) + " of " + what + " is " + shortestDouble(point[i]),
                  "give finite numbers", field + "[" + std::to_string(i) + "]");
  }
  if (point.empty() || unknowns < 0 || point.size() == unknowns) return {};
  return refuse(what + " has " + std::to_string(point.size()) + " entries, the function has " +
                    std::to_string(unknowns) + " unknowns",
                "give one entry for each unknown", field);
}

Refusal checkTest(const v1::MinimizeRequest& request) {
  const v1::TestFunction& function = request.test();
  const Status name = checkObjective(function.name(), {});
  if (!name.ok()) return {name, "test.name"};
  const ObjectiveOptions options = objectiveOptions(request);
  ObjectiveOptions sized;
  sized.dimension = options.dimension;
  if (const Status size = checkObjective(function.name(), sized); !size.ok()) {
    return {size, "test.dimension"};
  }
  if (const Status status = checkObjective(function.name(), options); !status.ok()) {
    return {status, "test.condition"};
  }
  if (function.has_seed() && function.seed() < 0) {
    return refuse("seed is " + std::to_string(function.seed()) + ", below 0", "give 0 or more",
                  "test.seed");
  }
  return {};
}

Refusal checkRicci(const v1::RicciEnergy& energy) {
  Refusal refusal = firstOf(checkSource(energy.source(), "ricci.source"),
                            checkPrepare(energy.prepare(), "ricci.prepare"));
  if (!refusal.ok()) return refusal;
  if (v1::ParameterizationOptions::Scheme_IsValid(energy.scheme())) return {};
  return refuse("scheme " + std::to_string(energy.scheme()) + " is none of ours",
                "give one that parameterization.proto lists", "ricci.scheme");
}

Refusal checkFunction(const v1::MinimizeRequest& request) {
  switch (request.function_case()) {
    case v1::MinimizeRequest::kTest:
      return checkTest(request);
    case v1::MinimizeRequest::kRicci:
      return checkRicci(request.ricci());
    case v1::MinimizeRequest::FUNCTION_NOT_SET:
      break;
  }
  return {{Reason::kInvalidRequest, "no function is given", "set test or ricci"}, "function"};
}

Refusal checkOptions(const v1::MinimizeOptions& options) {
  if (!v1::MinimizeOptions::Method_IsValid(options.method())) {
    return refuse("method " + std::to_string(options.method()) + " is none of ours",
                  "give one that optimize.proto lists", "options.method");
  }
  if (!v1::MinimizeOptions::LineSearch_IsValid(options.line_search())) {
    return refuse("line_search " + std::to_string(options.line_search()) + " is none of ours",
                  "give one that optimize.proto lists", "options.line_search");
  }
  if (options.has_tolerance() &&
      !(std::isfinite(options.tolerance()) && options.tolerance() >= 0)) {
    return refuse("tolerance is " + shortestDouble(options.tolerance()) +
                      ", a number of at least 0 is needed",
                  "1e-10 serves most", "options.tolerance");
  }
  if (options.has_max_iterations() &&
      (options.max_iterations() < 0 || options.max_iterations() > kMostIterations)) {
    return refuse("max_iterations is " + std::to_string(options.max_iterations()) + ", not 0 to " +
                      std::to_string(kMostIterations),
                  "1000 serves most", "options.max_iterations");
  }
  return {};
}

Refusal checkAnswer(const v1::MinimizeRequest& request) {
  const bool minimizes = request.direction_at().empty();
  if (!minimizes && (request.trace() || request.path())) {
    return refuse("a direction at a point has no trace and no path", "leave them out",
                  request.trace() ? "trace" : "path");
  }
  const bool in_plane = request.has_test() && objectiveOptions(request).dimension == 2;
  if (request.path() && !in_plane) {
    return refuse("a path is that of a test function of two unknowns", "leave it out", "path");
  }
  return {};
}

}  // namespace

Refusal checkMinimize(const v1::MinimizeRequest& request) {
  const Refusal refusal = firstOf(checkFunction(request), checkOptions(request.options()));
  if (!refusal.ok()) return refusal;
  const Eigen::Index unknowns = request.has_test() ? objectiveOptions(request).dimension : -1;
  return firstOf(
      checkPoint(request.options().start(), unknowns, "the start", "options.start"),
      checkPoint(request.direction_at(), unknowns, "the point of the direction", "direction_at"),
      checkAnswer(request));
}

}  // namespace moduli
