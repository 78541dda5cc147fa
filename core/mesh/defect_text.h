#pragma once

#include <string>

#include "core/mesh/inspect.h"

namespace moduli {

/// What is wrong, from kind, count and elements: "3 faces have no area (12, 15, 80)".
std::string findingOf(const Defect& defect);

/// What to do about it: "--repair drops them".
std::string remedyOf(const Defect& defect);

/// The finding and the remedy in one sentence.
std::string sentenceOf(const Defect& defect);

}  // namespace moduli
