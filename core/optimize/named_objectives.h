#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/status.h"
#include "core/optimize/objective.h"

namespace moduli {

/// Which of a family of test functions.
struct ObjectiveOptions {
  Eigen::Index dimension = 2;
  /// Of "quadratic": the ratio of the largest eigenvalue to the least, which is 1.
  double condition = 100;
  /// Of the functions with random coefficients; the same on every machine.
  std::uint64_t seed = 1;
};

/// A function by its name, with the customary start and the minimizer where it is known in closed
/// form.
struct NamedObjective {
  std::unique_ptr<Objective> objective;
  Eigen::VectorXd start;
  std::optional<Eigen::VectorXd> minimizer;
};

/// "quadratic", "quartic", "rosenbrock", "log-barrier", "log-sum-exp", "exp-sum".
const std::vector<std::string>& objectiveNames();

/// Whether there is such a function: what makeObjective refuses. O(1).
Status checkObjective(std::string_view name, const ObjectiveOptions& options);

/// quadratic: (x - c)^T A (x - c) / 2, eigenvalues of A from 1 to `condition` in geometric
/// progression in a random orthonormal basis, c random. quartic: sum x_i^4. rosenbrock: chained,
/// sum 100 (x_{i+1} - x_i^2)^2 + (1 - x_i)^2, at least 2 unknowns. log-barrier: c.x - sum log x_i,
/// c_i = i / n for i = 1..n. log-sum-exp: log sum_k exp(a_k.x + b_k), and exp-sum:
/// sum_k exp(a_k.x + b_k), with 4 n random a_k of sum 0, so that there is a minimizer. All have
/// third derivatives.
///
/// Fails with kInvalidOption: an unknown name (naming the known ones), a dimension below 1 (or 2)
/// or above 1000 (10000 for quartic, rosenbrock and log-barrier), a condition below 1 or not
/// finite.
Result<NamedObjective> makeObjective(std::string_view name, const ObjectiveOptions& options);

}  // namespace moduli
