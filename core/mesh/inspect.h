#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/context.h"
#include "core/mesh/triangle_soup.h"

namespace moduli {

/// What can be wrong with a soup. Blocking kinds first; the rest only warn.
enum class DefectKind : std::uint8_t {
  kEmpty,
  kNonFiniteCoordinate,
  kDegenerateFace,           ///< A face repeats a vertex.
  kDuplicateFace,            ///< Same three vertices as an earlier face, in any order.
  kNonManifoldEdge,          ///< More than two faces.
  kNonOrientable,            ///< No choice of face directions agrees everywhere.
  kInconsistentOrientation,  ///< Both faces of an edge run through it in the same direction.
  kNonManifoldVertex,        ///< Several fans of faces meet at a vertex (pinched).
  kIsolatedVertex,           ///< No face uses it. Warning.
  kDuplicateVertex,          ///< Same coordinates as an earlier vertex. Warning.
  kZeroAreaFace,             ///< Three different vertices, no area. Warning.
  kMultipleComponents,       ///< Warning.
};

/// UPPER_SNAKE name, as in reports and error reasons.
std::string_view defectName(DefectKind kind);
bool isBlocking(DefectKind kind);

struct Defect {
  DefectKind kind;
  /// Of vertices, faces, edges, or components (kNonOrientable, kMultipleComponents).
  Index count = 0;
  /// The first 100, ascending: vertices, faces, the lowest face at each edge, or the lowest face of
  /// each component.
  std::vector<Index> elements;
  std::string message;  ///< One sentence for a person, with the remedy.
};

/// Counts over the whole soup. Components, loops and genus are counted after splitting pinched
/// vertices and summed over components. Isolated vertices count in `vertices` alone.
struct SurfaceCounts {
  Index vertices = 0;
  Index faces = 0;
  Index components = 0;
  Index boundary_loops = 0;
  /// V - E + F of the surface after splitting pinched vertices, without isolated vertices.
  Index euler_characteristic = 0;
  /// Face directions could agree at every edge with two faces.
  bool orientable = false;
  std::optional<Index>
      genus;        ///< Empty where an edge is non-manifold or the surface non-orientable.
  double area = 0;  ///< Sum over faces with finite coordinates.
};

struct Inspection {
  bool valid = false;  ///< Every component is an oriented manifold surface: no blocking defect.
  SurfaceCounts counts;
  std::vector<Defect> defects;  ///< In the order of DefectKind.
};

/// Reports every defect. Never fails but for kCancelled or kDeadlineExceeded. A zero-area face is
/// one whose area is below 1e-14 of its longest edge squared. O(V + F) but for sorting.
Result<Inspection> inspectSoup(Context& context, const TriangleSoup& soup);

/// The first blocking defect as an error; OK for a valid inspection.
Status blockingError(const Inspection& inspection);

}  // namespace moduli
