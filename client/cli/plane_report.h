#pragma once

#include <string>

#include "moduli/v1/parameterization.pb.h"

namespace moduli::cli {

/// What a map to the plane has of its own, in lines of a report: its lattice, cones, zeros and
/// charts.
std::string planeLines(const v1::Parameterization& result);

}  // namespace moduli::cli
