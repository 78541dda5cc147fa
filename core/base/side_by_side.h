#pragma once

#include <functional>

#include "core/base/context.h"

namespace moduli {

/// Calls first(context) on this thread and second(a silent copy of it) on another. Only the time of
/// the first is counted. Neither may throw.
void sideBySide(Context& context, const std::function<void(Context&)>& first,
                const std::function<void(Context&)>& second);

}  // namespace moduli
