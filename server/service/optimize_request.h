#pragma once

#include "moduli/v1/optimize.pb.h"
#include "server/service/call.h"

namespace moduli {

/// What a minimization is refused for before it takes a place in the queue: no function or an
/// unknown one, numbers out of range, points with another number of entries than the function has
/// unknowns (of a surface: known when it is loaded), choices that are none. O(entries).
Refusal checkMinimize(const v1::MinimizeRequest& request);

}  // namespace moduli
