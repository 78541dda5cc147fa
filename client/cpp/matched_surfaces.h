#pragma once

#include <cstdint>
#include <vector>

#include "client/cpp/array_pieces.h"
#include "core/base/status.h"
#include "moduli/v1/matching.pb.h"

namespace moduli {

/// Where the vertices of a surface's file are on another surface, in the numbers of its file.
struct VertexMap {
  std::vector<std::int32_t> faces;  ///< -1 for vertices of no face that is mapped.
  std::vector<double> weights;      ///< Three a vertex, of the face's corners; 0 beside a face -1.
};

/// A match of two surfaces. The maps are empty where the request did not want them.
struct MatchedSurfaces {
  v1::SurfaceMatch result;
  VertexMap map;      ///< From the first surface to the second.
  VertexMap inverse;  ///< Back.
};

/// Puts the arrays of a match together from their chunks, and judges them. Not thread-safe.
class MatchAssembler {
 public:
  explicit MatchAssembler(bool inverse);

  /// As ArrayPieces::take.
  Status take(const v1::ArrayChunk& chunk) { return pieces_.take(chunk); }

  /// The maps, without their result. Fails with kInternal where an array is missing or incomplete,
  /// where two do not fit each other, on a face below -1, and on weights that are none.
  Result<MatchedSurfaces> finish();

 private:
  const bool inverse_;
  ArrayPieces pieces_;
};

}  // namespace moduli
