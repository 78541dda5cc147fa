#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/ricci/curvature_model.h"

/// The discrete Ricci flow du/dt = target - K, the gradient descent of a model's convex energy.
///
///   ASSIGN_OR_RETURN(const FlowResult flow, ricciFlow(context, model, target, model.initial(),
///   {})); use(flow.u);
namespace moduli {

/// How the flow is followed in time.
enum class FlowSteps : std::uint8_t {
  /// du = dt (target - K): the founding paper's own method; dt at most 1 over the largest row sum
  /// of |H|, half of what is stable. Some (largest eigenvalue / smallest) steps a digit.
  kExplicit,
  /// (1 / dt + H) du = target - K, the linearized backward step, stable for every dt: it starts
  /// near the explicit one and grows until the steps are those of Newton. Some 10 to 15 steps.
  kSemiImplicit,
};

struct FlowOptions {
  FlowSteps steps = FlowSteps::kSemiImplicit;
  double tolerance = 1e-11;  ///< Of the residual, radians; above 0. Rounding leaves some 1e-14.
  /// Per unknown: keep u as it is at the start, and ask for no curvature. Empty: none.
  std::vector<bool> fixed = {};
  int max_steps = 10000;  ///< At least 0; steps taken back because they were too long count.
};

/// Where the flow was after a step.
struct FlowPoint {
  double time = 0;
  double residual = 0;
};

struct FlowResult {
  Eigen::VectorXd u;  ///< The model has been moved there.
  double residual = 0;
  /// The start and every step that was taken, in order.
  std::vector<FlowPoint> history;
  int rejected_steps = 0;
  /// The largest change of an unknown in the last step. With semi-implicit steps it is tiny at a
  /// metric (below 1e-5 for the default tolerance). Where it is not, u runs away while the residual
  /// falls: the target is at the border of what the triangles allow (equality in Thurston's
  /// condition), and circles shrink to points.
  double last_change = 0;
};

/// Follows the flow from `start` until max |target - K| <= tolerance; in the Euclidean plane less
/// the mean of target - K, which no u can change (it is the target's own error in Gauss and
/// Bonnet); there u keeps its mean. target, start: model.size() entries.
///
/// A step is halved (explicit) or quartered (semi-implicit) where the norm of target - K grows or
/// the model cannot be moved there. The energy being convex, the norm falls along the flow, as
/// e^{-ct} in the end, to zero if there is a metric of this curvature.
///
/// Fails with kInvalidOption (sizes, options), kNoConvergence (after max_steps, or where even the
/// smallest step does not help: the message says how far it came), and as the model and the solver
/// do. Stages "analyse", "factorize", "solve"; reports "flow".
/// Source: Chow and Luo 2003; Jin, Kim, Luo and Gu 2008, "Discrete surface Ricci flow"; MATH 6.6.
Result<FlowResult> ricciFlow(Context& context, CurvatureModel& model, const Eigen::VectorXd& target,
                             const Eigen::VectorXd& start, const FlowOptions& options);

}  // namespace moduli
