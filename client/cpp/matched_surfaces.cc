#include "client/cpp/matched_surfaces.h"

#include <cmath>

namespace moduli {
namespace {

using Chunk = v1::ArrayChunk;
using Number = ArrayKind::Number;

// Three weights of a face, of sum 1 but for rounding; zeros where there is none.
bool areWeights(const double* weights, bool has_face) {
  double sum = 0;
  for (int c = 0; c < 3; ++c) {
    if (!(weights[c] >= 0)) return false;
    sum += weights[c];
  }
  return has_face ? std::abs(sum - 1) <= 1e-9 : sum == 0;
}

Result<VertexMap> mapOf(ArrayPieces& pieces, Chunk::Array faces, Chunk::Array weights) {
  if (pieces.rows(faces) != pieces.rows(weights)) {
    return brokenArray(Chunk::Array_Name(weights), "has not as many rows as there are faces");
  }
  VertexMap map{pieces.takeIntegers(faces), pieces.takeDoubles(weights)};
  for (std::size_t v = 0; v < map.faces.size(); ++v) {
    if (map.faces[v] < -1) return brokenArray(Chunk::Array_Name(faces), "names no face");
    if (!areWeights(&map.weights[3 * v], map.faces[v] >= 0)) {
      return brokenArray(Chunk::Array_Name(weights), "has weights that are none");
    }
  }
  return map;
}

}  // namespace

MatchAssembler::MatchAssembler(bool inverse)
    : inverse_(inverse),
      pieces_({{Chunk::IMAGE_FACES, 1, Number::kInt32, true},
               {Chunk::IMAGE_WEIGHTS, 3, Number::kDouble, true},
               {Chunk::INVERSE_FACES, 1, Number::kInt32, inverse},
               {Chunk::INVERSE_WEIGHTS, 3, Number::kDouble, inverse}}) {}

Result<MatchedSurfaces> MatchAssembler::finish() {
  RETURN_IF_ERROR(pieces_.checkComplete());
  MatchedSurfaces match;
  ASSIGN_OR_RETURN(match.map, mapOf(pieces_, Chunk::IMAGE_FACES, Chunk::IMAGE_WEIGHTS));
  if (inverse_) {
    ASSIGN_OR_RETURN(match.inverse, mapOf(pieces_, Chunk::INVERSE_FACES, Chunk::INVERSE_WEIGHTS));
  }
  return match;
}

}  // namespace moduli
