#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "client/cpp/array_pieces.h"
#include "core/base/status.h"
#include "moduli/v1/parameterization.pb.h"

namespace moduli {

/// A surface with its map to the plane. The arrays are empty where the request omitted them.
struct ParameterizedMesh {
  v1::Parameterization result;
  std::vector<double> positions;      ///< x y z of every vertex.
  std::vector<std::int32_t> faces;    ///< Three vertices of every face, counted from 0.
  std::vector<double> points;         ///< u v of every point of the plane.
  std::vector<std::int32_t> corners;  ///< Three points of every face; -1 where it is not mapped.
  /// Where faces were cut, the face of the file that each is (part of), ascending. Empty: each its
  /// own, or a server that does not tell.
  std::vector<std::int32_t> parents;
  /// Per vertex of the input the field of the reference; empty where there is none.
  std::vector<double> carried;
  /// Seven numbers of every point of the closed geodesics of a hyperbolic domain (ArrayChunk).
  std::vector<double> geodesics;
  std::string atlas;  ///< An affine atlas as JSON (ArrayChunk); or empty.
};

/// Puts the arrays of a parameterization together from their chunks, and judges them. Not
/// thread-safe.
class ArrayAssembler {
 public:
  ArrayAssembler();

  /// As ArrayPieces::take.
  Status take(const v1::ArrayChunk& chunk) { return pieces_.take(chunk); }

  /// The arrays, without their result. Fails with kInternal where one is missing (CARRIED,
  /// GEODESICS, PARENTS and ATLAS_JSON may be) or incomplete, where the shapes do not fit each
  /// other, on an index out of range, a face that is mapped in part, and a number of the others
  /// that is not finite.
  Result<ParameterizedMesh> finish();

 private:
  Status checkParents() const;

  ArrayPieces pieces_;
};

/// Fails with kInternal where a geodesic of the result has points that are not there. mesh: with
/// its arrays.
Status checkGeodesics(const ParameterizedMesh& mesh);

}  // namespace moduli
