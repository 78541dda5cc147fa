#include "server/rpc/convert_optimize.h"

namespace moduli {
namespace {

using Options = v1::MinimizeOptions;
using Minimization = v1::Minimization;

static_assert(static_cast<int>(MinimizeMethod::kAffineNormal) + 1 == Options::AFFINE_NORMAL);
static_assert(static_cast<int>(MinimizeMethod::kGradient) + 1 == Options::GRADIENT);
static_assert(static_cast<int>(LineSearchKind::kBacktracking) + 1 == Options::BACKTRACKING);
static_assert(static_cast<int>(LineSearchKind::kExact) + 1 == Options::EXACT);
static_assert(static_cast<int>(StopReason::kConverged) + 1 == Minimization::CONVERGED);
static_assert(static_cast<int>(StopReason::kSaddle) + 1 == Minimization::SADDLE);
static_assert(static_cast<int>(StopReason::kLineSearchStuck) + 1 ==
              Minimization::LINE_SEARCH_STUCK);
static_assert(static_cast<int>(Scheme::kVertexScaling) + 1 ==
              v1::ParameterizationOptions::VERTEX_SCALING);

/// Both enums name the same things, ours from 0 and the message's from 1; 0 is the default there.
template <typename Core, typename Message>
Core shifted(Message value, Core otherwise) {
  return value == 0 ? otherwise : static_cast<Core>(static_cast<int>(value) - 1);
}

}  // namespace

MinimizeOptions fromProto(const v1::MinimizeOptions& message) {
  MinimizeOptions options;
  options.method = shifted(message.method(), options.method);
  options.line_search = shifted(message.line_search(), options.line_search);
  if (message.has_tolerance()) options.gradient_tolerance = message.tolerance();
  if (message.has_max_iterations()) options.max_iterations = message.max_iterations();
  return options;
}

ObjectiveOptions objectiveOptions(const v1::MinimizeRequest& request) {
  const v1::TestFunction& function = request.test();
  ObjectiveOptions options;
  if (function.has_dimension()) {
    options.dimension = function.dimension();
  } else if (!request.direction_at().empty()) {
    options.dimension = request.direction_at_size();
  } else if (!request.options().start().empty()) {
    options.dimension = request.options().start_size();
  }
  if (function.has_condition()) options.condition = function.condition();
  if (function.has_seed()) options.seed = static_cast<std::uint64_t>(function.seed());
  return options;
}

Scheme fromProto(v1::ParameterizationOptions::Scheme scheme) {
  return shifted(scheme, Scheme::kVertexScaling);
}

v1::MinimizeOptions::Method toProto(MinimizeMethod method) {
  return static_cast<Options::Method>(static_cast<int>(method) + 1);
}

v1::Minimization toProto(const Minimum& minimum) {
  v1::Minimization message;
  message.set_value(minimum.value);
  message.set_gradient_norm(minimum.gradient_norm);
  message.set_iterations(minimum.iterations);
  message.set_evaluations(minimum.evaluations);
  message.set_factorizations(minimum.factorizations);
  message.set_converged(minimum.converged);
  message.set_reason(static_cast<Minimization::Reason>(static_cast<int>(minimum.reason) + 1));
  return message;
}

}  // namespace moduli
