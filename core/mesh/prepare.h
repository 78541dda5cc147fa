#pragma once

#include <string>
#include <vector>

#include "core/base/context.h"
#include "core/mesh/repair.h"
#include "core/mesh/triangle_mesh.h"

namespace moduli {

struct PrepareOptions {
  RepairOptions repair;
  /// "": the surface must be connected. "largest": most faces, the lower face index wins a tie. A
  /// number: components are counted from 0 by their lowest face. "all": no choice, for who treats
  /// each of them.
  std::string component;
};

/// A surface ready for computing, connected unless all components were asked for, and where its
/// elements came from.
struct PreparedMesh {
  TriangleMesh mesh;
  std::vector<Index> input_vertex;  ///< Per vertex of mesh; kNone for one that fills a hole.
  std::vector<Index> input_face;    ///< Per face of mesh; kNone for one that fills a hole.
  std::vector<RepairAction> actions;
  std::vector<std::string> warnings;  ///< "ZERO_AREA_FACE: ...", for the certificate.
};

/// Repairs if asked, refuses blocking defects by name, picks the component, drops isolated
/// vertices. Fails with the reason of the first blocking defect, kMultipleComponents (the message
/// lists the components with their faces and genus), kComponentNotFound, kInvalidOption. O(n log
/// n).
Result<PreparedMesh> prepareMesh(Context& context, const TriangleSoup& soup,
                                 const PrepareOptions& options);

}  // namespace moduli
