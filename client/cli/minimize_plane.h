#pragma once

#include "client/cli/chart.h"
#include "client/cpp/minimized_function.h"
#include "core/base/status.h"
#include "moduli/v1/optimize.pb.h"

namespace moduli::cli {

/// Draws a test function of two unknowns around the path of its minimization: level sets, whose
/// values above the least one are in geometric progression, the directions in which the method
/// would go (where it has one), and the path. The function is evaluated here. Fails as
/// makeObjective does.
Status drawPlane(Chart& chart, const v1::MinimizeRequest& request,
                 const MinimizedFunction& function);

}  // namespace moduli::cli
