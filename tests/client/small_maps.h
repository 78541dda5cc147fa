#pragma once

#include "client/cpp/parameterized_mesh.h"

/// Maps that are known by construction, for tests.
namespace moduli {

/// The unit square in 2 n^2 faces, to the plane by the identity; in space it is tilted to z = x/2.
/// torn: each face has points of its own.
ParameterizedMesh gridMap(int n, bool torn);

/// The unit disk in 6 n^2 faces, to itself.
ParameterizedMesh diskMap(int n);

/// The unit sphere in n bands of 2 n faces and their halves, to itself.
ParameterizedMesh ballMap(int n);

}  // namespace moduli
