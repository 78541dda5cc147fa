#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "core/mesh/triangle_soup.h"

namespace moduli {

/// What an OBJ file says of the looks of its surface, for whoever writes it again. Triangles are
/// those of readMesh: polygons as fans, in the order of the file.
struct ObjStatements {
  struct Before {
    Index face = 0;    ///< The statement holds from this triangle on.
    std::string text;  ///< "usemtl red", without blanks around it.
  };
  std::vector<Before> statements;  ///< g, o, s, mg, usemtl, mtllib, in their order.
  std::vector<std::string> texture_points,
      normals;  ///< The numbers of `vt` and `vn` as they stand.
  /// Per triangle and corner a row of these; kNone where the file names none that is there.
  std::vector<Triangle> texture, normal;
};

/// Reads these of a file that readMesh takes; of another one, whatever can be understood. O(bytes).
ObjStatements readObjStatements(std::string_view bytes);

}  // namespace moduli
