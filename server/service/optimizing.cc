#include "server/service/optimizing.h"

#include <string>
#include <utility>

#include "core/optimize/affine_normal.h"
#include "core/ricci/uniformization_energy.h"
#include "server/rpc/convert_optimize.h"
#include "server/service/array_chunks.h"
#include "server/service/subject.h"

namespace moduli {
namespace {

/// What a result holds itself; below kMaxChunkBytes.
constexpr Eigen::Index kMostEntries = 65536;
/// Directions where the Hessian is not positive definite take dense algebra.
constexpr Eigen::Index kMostDense = 1000;

/// The function of a request with its start.
struct Function {
  std::unique_ptr<Objective> test;
  std::unique_ptr<UniformizationEnergy> energy;
  Eigen::VectorXd start;
  std::vector<std::string> warnings;

  Objective& objective() const { return test ? *test : energy->objective(); }
};

Eigen::VectorXd vectorOf(const google::protobuf::RepeatedField<double>& numbers) {
  return Eigen::Map<const Eigen::VectorXd>(numbers.data(), numbers.size());
}

Result<Function> surfaceFunction(Context& context, const Backend& backend,
                                 const v1::RicciEnergy& request) {
  ASSIGN_OR_RETURN(const Subject subject,
                   loadSubject(context, backend, request.source(), request.prepare()));
  const Context::Stage stage(context, "energy");
  UniformizationEnergyOptions options;
  options.scheme = fromProto(request.scheme());
  if (request.has_initial_delaunay()) options.initial_delaunay = request.initial_delaunay();
  Function function;
  ASSIGN_OR_RETURN(function.energy, UniformizationEnergy::make(context, subject.surface(),
                                                               subject.lengths, options));
  function.start = function.energy->start();
  function.warnings = subject.warnings;
  return function;
}

Result<Function> functionOf(Context& context, const Backend& backend,
                            const v1::MinimizeRequest& request) {
  if (request.has_ricci()) return surfaceFunction(context, backend, request.ricci());
  ASSIGN_OR_RETURN(NamedObjective named,
                   makeObjective(request.test().name(), objectiveOptions(request)));
  Function function;
  function.test = std::move(named.objective);
  function.start = std::move(named.start);
  return function;
}

/// Puts entries into the result, or where they are too many, beside it.
void putEntries(const Eigen::VectorXd& entries, google::protobuf::RepeatedField<double>& field,
                std::vector<double>& beside) {
  if (entries.size() > kMostEntries) {
    beside.assign(entries.begin(), entries.end());
  } else {
    field.Add(entries.begin(), entries.end());
  }
}

Result<AffineNormal> normalAt(Context& context, Objective& objective, const Eigen::VectorXd& x) {
  const Context::Stage stage(context, "direction");
  AffineNormalOptions options;
  Result<AffineNormal> normal = affineNormal(context, objective, x, options);
  const bool indefinite = normal.status().reason() == Reason::kNotPositiveDefinite;
  if (!indefinite || objective.dimension() > kMostDense) return normal;
  options.form = AffineForm::kBordered;
  return affineNormal(context, objective, x, options);
}

template <typename Message>
void addRemarks(const Context& context, const Function& function, const Eigen::VectorXd& x,
                Message& message) {
  message.mutable_warnings()->Add(function.warnings.begin(), function.warnings.end());
  if (function.energy) {
    const std::vector<std::string> remarks = function.energy->remarks(x);
    message.mutable_warnings()->Add(remarks.begin(), remarks.end());
  }
  message.mutable_timing()->insert(context.timing().begin(), context.timing().end());
}

Result<Optimized> direct(Context& context, const Function& function, const Eigen::VectorXd& x) {
  ASSIGN_OR_RETURN(const AffineNormal normal, normalAt(context, function.objective(), x));
  Optimized result;
  v1::AffineDirection& message = result.direction.emplace();
  putEntries(normal.direction, *message.mutable_direction(), result.entries);
  message.set_decrease(normal.decrease);
  message.set_convex(normal.convex);
  addRemarks(context, function, x, message);
  return result;
}

Result<Optimized> walk(Context& context, const Function& function,
                       const v1::MinimizeRequest& request) {
  MinimizeOptions options = fromProto(request.options());
  options.keep_path = request.path();
  const auto& given = request.options().start();
  ASSIGN_OR_RETURN(Minimum minimum,
                   minimize(context, function.objective(),
                            given.empty() ? function.start : vectorOf(given), options));
  if (function.objective().constantsInKernel()) minimum.x.array() -= minimum.x.mean();
  Optimized result;
  result.minimization = toProto(minimum);
  result.minimization.set_method(toProto(options.method));
  putEntries(minimum.x, *result.minimization.mutable_x(), result.entries);
  if (request.trace()) {
    for (const MinimizeStep& step : minimum.trace) {
      result.trace.push_back({static_cast<double>(step.iteration), step.value, step.gradient_norm,
                              step.step, step.decrease, static_cast<double>(step.evaluations),
                              static_cast<double>(step.factorizations)});
    }
  }
  for (const Eigen::VectorXd& point : minimum.path) result.path.push_back({point[0], point[1]});
  addRemarks(context, function, minimum.x, result.minimization);
  return result;
}

std::vector<ArrayView> arraysOf(const Optimized& optimized) {
  std::vector<ArrayView> arrays;
  if (!optimized.entries.empty()) {
    arrays.push_back(
        viewOf(optimized.direction ? v1::ArrayChunk::DIRECTION : v1::ArrayChunk::MINIMIZER, 1,
               optimized.entries));
  }
  if (!optimized.trace.empty()) {
    arrays.push_back(viewOf(v1::ArrayChunk::TRACE, 7, optimized.trace));
  }
  if (!optimized.path.empty()) {
    arrays.push_back(viewOf(v1::ArrayChunk::PATH, 2, optimized.path));
  }
  return arrays;
}

}  // namespace

Result<Optimized> optimizeFunction(Context& context, const Backend& backend,
                                   const v1::MinimizeRequest& request) {
  ASSIGN_OR_RETURN(const Function function, functionOf(context, backend, request));
  if (request.direction_at().empty()) return walk(context, function, request);
  return direct(context, function, vectorOf(request.direction_at()));
}

std::function<std::optional<v1::MinimizeResponse>()> optimizationParts(
    std::shared_ptr<const Optimized> optimized) {
  auto arrays = arraysOf(*optimized);
  return inParts<v1::MinimizeResponse>(
      std::move(arrays), [optimized = std::move(optimized)](v1::MinimizeResponse& response) {
        if (optimized->direction) {
          *response.mutable_direction() = *optimized->direction;
        } else {
          *response.mutable_minimization() = optimized->minimization;
        }
      });
}

}  // namespace moduli
