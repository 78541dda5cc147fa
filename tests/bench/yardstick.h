#pragma once

#include "core/base/status.h"
#include "core/mesh/triangle_mesh.h"

namespace moduli {

/// F: the time of one CHOLMOD supernodal analyse + factorize + solve of the mesh's shifted cotan
/// Laplacian, straight through CHOLMOD's own interface with its default ordering and its own OpenMP
/// threads, as it is packaged; BLAS on one thread. Seconds, median of five runs.
struct Yardstick {
  double analyse = 0;
  double factorize = 0;
  double solve = 0;
  double factor_bytes = 0;  ///< Of the factor's numbers and their pattern.
  double alone = 0;         ///< All three without OpenMP threads, as SpdSolver has it: often less.
  double total() const { return analyse + factorize + solve; }
};

Result<Yardstick> measureYardstick(const TriangleMesh& mesh);

}  // namespace moduli
