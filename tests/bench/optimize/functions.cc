#include "tests/bench/optimize/functions.h"

#include <utility>

namespace moduli {
namespace {

BenchFunction named(const std::string& name, Eigen::Index dimension, double condition = 1,
                    const std::string& label = "") {
  ObjectiveOptions options;
  options.dimension = dimension;
  options.condition = condition;
  return {label.empty() ? name : label, [=] { return makeObjective(name, options); }};
}

}  // namespace

std::vector<BenchFunction> benchFunctions() {
  return {named("quadratic", 10, 1e2, "quadratic, condition 1e2"),
          named("quadratic", 10, 1e8, "quadratic, condition 1e8"),
          named("quartic", 10),
          named("rosenbrock", 2),
          named("rosenbrock", 10),
          named("log-barrier", 10),
          named("log-sum-exp", 10),
          named("exp-sum", 2),
          named("exp-sum", 10),
          named("exp-sum", 50)};
}

}  // namespace moduli
