#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/base/status.h"
#include "core/optimize/named_objectives.h"

namespace moduli {

/// One function of the table. Others, such as the energies of meshes, are further entries.
struct BenchFunction {
  std::string name;
  std::function<Result<NamedObjective>()> make;
  /// Whether the columns of changed variables and values make sense: they have dense Hessians.
  bool changeable = true;
};

/// All of the table, in its order.
std::vector<BenchFunction> benchFunctions();

}  // namespace moduli
