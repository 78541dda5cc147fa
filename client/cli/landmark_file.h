#pragma once

#include <string>

#include "core/base/status.h"
#include "moduli/v1/parameterization.pb.h"

namespace moduli::cli {

/// Reads a side file of landmarks, with one of these a line:
///
///   vertexA vertexB
///   faceA b0 b1 b2 faceB b0 b1 b2
///   curve COUNT: a1 a2 a3 ... : b1 b2 b3 ...
///
/// Vertices and faces are counted from 0; b0, b1 and b2 are the weights of a face's corners, of sum
/// 1 up to 0.001. A curve is a path of vertices on each surface, and gives COUNT pairs.
/// Returns a registration with these landmarks and curves, which are named by file and line. Fails
/// as readSideFile and, naming file and line, with kSyntaxError, kIndexOutOfRange (a vertex or face
/// below 0 or beyond 32 bits) and kInvalidOption (weights); kEmpty where there is no landmark.
Result<v1::SphereRegistration> readLandmarks(const std::string& path);

}  // namespace moduli::cli
