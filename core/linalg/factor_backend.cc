#include "core/linalg/factor_backend.h"

#include <string>

namespace moduli {

#ifdef MODULI_WITH_CHOLMOD
const std::vector<BackendKind>& availableBackends() {
  static const std::vector<BackendKind> kinds{BackendKind::kCholmod, BackendKind::kEigen};
  return kinds;
}

std::unique_ptr<FactorBackend> makeBackend(BackendKind kind) {
  return kind == BackendKind::kCholmod ? makeCholmodBackend() : makeEigenBackend();
}
#else
const std::vector<BackendKind>& availableBackends() {
  static const std::vector<BackendKind> kinds{BackendKind::kEigen};
  return kinds;
}

std::unique_ptr<FactorBackend> makeBackend(BackendKind) {
  return makeEigenBackend();
}
#endif

Status notPositiveDefinite(Eigen::Index column) {
  return {Reason::kNotPositiveDefinite,
          "the matrix is not positive definite at column " + std::to_string(column)};
}

Status outOfMemory() {
  return {Reason::kMeshTooLarge, "the factorization does not fit into memory",
          "use a coarser mesh or a machine with more memory"};
}

}  // namespace moduli
