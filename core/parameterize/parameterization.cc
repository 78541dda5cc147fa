#include "core/parameterize/parameterization.h"

namespace moduli {

std::string methodName(MapMethod method) {
  switch (method) {
    case MapMethod::kAuto:
      return "auto";
    case MapMethod::kHeatFlow:
      return "heat-flow";
    case MapMethod::kLinear:
      return "linear";
    case MapMethod::kRobust:
      return "robust";
  }
  return "";
}

}  // namespace moduli
