#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string_view>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/optimize/objective.h"

namespace moduli {

enum class LineSearchKind : std::uint8_t {
  kBacktracking,  ///< The first step that gives 1e-4 of what the slope promises.
  kExact,         ///< To where the slope along the line vanishes, by slopes alone.
};

/// "backtracking", "exact".
std::string_view lineSearchName(LineSearchKind kind);
/// kInvalidOption naming the known ones for another name.
Result<LineSearchKind> lineSearchFromName(std::string_view name);

struct LineSearchOptions {
  LineSearchKind kind = LineSearchKind::kBacktracking;
  double first_step = 1;
  /// Exact: the slope at the end, in shares of that at the start.
  double slope_tolerance = 1e-6;
  /// Backtracking: also lengthens the step while the slope at its end is above 9/10 of that at its
  /// start (weak Wolfe conditions). For directions whose length means nothing.
  bool lengthen = false;
};

enum class LineSearchEnd : std::uint8_t { kFound, kStuck, kUnbounded, kNotANumber };

struct LineStep {
  LineSearchEnd end = LineSearchEnd::kStuck;
  double step = 0;
  Eigen::VectorXd x;         ///< x - step * direction.
  Eigen::VectorXd gradient;  ///< There.
  double value = 0;          ///< There.
  int evaluations = 0;
};

/// Looks for a step against `direction` from x, where the objective is; gradient . direction > 0.
/// kFound: the objective is at the end of the step. kStuck: no step goes down; it is anywhere.
/// kUnbounded: the value falls to -infinity, or goes on falling 1e100 away. kNotANumber: NaN.
///
/// Where the gain is below 1e-10 of the value, or 1e-15, rounding may hide it: then a step counts
/// whose slope has turned by no more than a tenth. Steps to where the value is infinite, or the
/// objective fails with kNoConvergence, are too long. Fails as moveTo does otherwise. Source:
/// MATH 11.6.
Result<LineStep> searchLine(Context& context, Objective& objective, const Eigen::VectorXd& x,
                            const Eigen::VectorXd& direction, const LineSearchOptions& options);

}  // namespace moduli
