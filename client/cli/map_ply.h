#pragma once

#include <string>

#include "client/cpp/parameterized_mesh.h"

namespace moduli::cli {

/// A parameterized surface as the bytes of a PLY file, little-endian binary: per vertex x, y, z as
/// doubles and its texture point as `s`, `t`, floats, which both MeshLab and Blender read (MeshLab
/// in no other type; lists per face `texcoord` are read by MeshLab alone). Vertices are split where
/// points differ: those of the input come first in their order, the others behind them; the faces
/// are in theirs. A vertex without a point has (0, 0). A map to the sphere has no `s`, `t`.
/// texture: name of a picture beside the file, which a comment tells as MeshLab has it; with it
/// points are in the unit square (fitUnitSquare). "": none, and points as they are. O(V + F).
std::string parameterizationPly(const ParameterizedMesh& mesh, const std::string& texture);

}  // namespace moduli::cli
