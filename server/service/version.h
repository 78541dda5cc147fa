#pragma once

#include <string_view>

namespace moduli {

/// Version of this build, from the build files.
inline constexpr std::string_view kVersion = MODULI_VERSION;

}  // namespace moduli
