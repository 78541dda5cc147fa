#include "client/cpp/parameterized_mesh.h"

#include <algorithm>
#include <cmath>

namespace moduli {
namespace {

using Chunk = v1::ArrayChunk;
using Number = ArrayKind::Number;

bool inRange(const std::vector<std::int32_t>& indices, std::int32_t lowest, std::int32_t end) {
  return std::all_of(indices.begin(), indices.end(),
                     [=](std::int32_t index) { return index >= lowest && index < end; });
}

bool areFinite(const std::vector<double>& numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](double x) { return std::isfinite(x); });
}

// Each face has three points or none.
bool isWhole(const std::vector<std::int32_t>& corners) {
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
    const bool mapped = corners[i] >= 0;
    if ((corners[i + 1] >= 0) != mapped || (corners[i + 2] >= 0) != mapped) return false;
  }
  return true;
}

}  // namespace

ArrayAssembler::ArrayAssembler()
    : pieces_({{Chunk::POSITIONS, 3, Number::kDouble, true},
               {Chunk::FACES, 3, Number::kInt32, true},
               {Chunk::POINTS, 2, Number::kDouble, true},
               {Chunk::CORNERS, 3, Number::kInt32, true},
               {Chunk::CARRIED, 1, Number::kDouble, false},
               {Chunk::GEODESICS, 7, Number::kDouble, false},
               {Chunk::ATLAS_JSON, 1, Number::kByte, false},
               {Chunk::PARENTS, 1, Number::kInt32, false}}) {}

Result<ParameterizedMesh> ArrayAssembler::finish() {
  RETURN_IF_ERROR(pieces_.checkComplete());
  if (pieces_.rows(Chunk::FACES) != pieces_.rows(Chunk::CORNERS)) {
    return brokenArray("CORNERS", "has not as many rows as there are faces");
  }
  const std::vector<std::int32_t>& corners = pieces_.integers(Chunk::CORNERS);
  if (!inRange(pieces_.integers(Chunk::FACES), 0, pieces_.rows(Chunk::POSITIONS))) {
    return brokenArray("FACES", "names a vertex that is not there");
  }
  if (!inRange(corners, -1, pieces_.rows(Chunk::POINTS))) {
    return brokenArray("CORNERS", "names a point that is not there");
  }
  if (!isWhole(corners)) return brokenArray("CORNERS", "maps a face in part");
  if (pieces_.rows(Chunk::CARRIED) > pieces_.rows(Chunk::POSITIONS)) {
    return brokenArray("CARRIED", "has more rows than there are vertices");
  }
  if (pieces_.rows(Chunk::PARENTS) >= 0) RETURN_IF_ERROR(checkParents());
  for (const Chunk::Array array : {Chunk::POINTS, Chunk::CARRIED, Chunk::GEODESICS}) {
    if (!areFinite(pieces_.doubles(array))) {
      return brokenArray(Chunk::Array_Name(array), "has a number that is not finite");
    }
  }
  ParameterizedMesh mesh;
  mesh.positions = pieces_.takeDoubles(Chunk::POSITIONS);
  mesh.faces = pieces_.takeIntegers(Chunk::FACES);
  mesh.points = pieces_.takeDoubles(Chunk::POINTS);
  mesh.corners = pieces_.takeIntegers(Chunk::CORNERS);
  mesh.carried = pieces_.takeDoubles(Chunk::CARRIED);
  mesh.geodesics = pieces_.takeDoubles(Chunk::GEODESICS);
  mesh.atlas = pieces_.takeBytes(Chunk::ATLAS_JSON);
  mesh.parents = pieces_.takeIntegers(Chunk::PARENTS);
  return mesh;
}

// Every face of the file has its pieces, in its place.
Status ArrayAssembler::checkParents() const {
  if (pieces_.rows(Chunk::PARENTS) != pieces_.rows(Chunk::FACES)) {
    return brokenArray("PARENTS", "has not as many rows as there are faces");
  }
  std::int32_t last = -1;
  for (const std::int32_t parent : pieces_.integers(Chunk::PARENTS)) {
    if (parent < 0 || (parent != last && parent != last + 1)) {
      return brokenArray("PARENTS", "leaves faces out, or is not ascending");
    }
    last = parent;
  }
  return {};
}

Status checkGeodesics(const ParameterizedMesh& mesh) {
  const auto rows = static_cast<std::int64_t>(mesh.geodesics.size() / 7);
  for (const v1::ClosedGeodesic& geodesic : mesh.result.hyperbolic().geodesics()) {
    const std::int64_t first = geodesic.first_point(), points = geodesic.points();
    if (first < 0 || points < 1 || first + points > rows) {
      return brokenArray("GEODESICS", "has not the points that the result names");
    }
  }
  return {};
}

}  // namespace moduli
