#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

#include "core/intrinsic/intrinsic_surface.h"
#include "core/mesh/prepare.h"
#include "core/mesh/triangle_soup.h"
#include "core/parameterize/parameterization.h"

/// From maps of prepared surfaces back to the numbering of the input.
namespace moduli {

/// The arrays of a parameterization, as ArrayChunk describes them.
struct MappedFaces {
  std::vector<Eigen::Vector3d> positions;
  std::vector<Triangle> faces;
  std::vector<std::complex<double>> points;
  std::vector<Triangle> corners;  ///< Per face its points; kNone, three times, where not mapped.
  std::vector<Index> parents;     ///< Where faces were cut: per face that of the input.
};

/// All vertices and faces of the input in their order, with the map of those that were mapped.
/// Faces that were cut are replaced by their pieces, the vertices on their edges follow those of
/// the input. A map to the sphere moves the vertices themselves; where repair has split one of
/// them, its further images follow the input's vertices, too. input_corners: of inputCorners.
/// O(V + F).
MappedFaces mapInputFaces(TriangleSoup soup, const PreparedMesh& prepared,
                          const std::vector<Index>& input_corners, const Parameterization& map);

/// A surface without positions is what its map makes of it: a vertex for every point of the plane,
/// or the points of the sphere.
MappedFaces imageAlone(const Connectivity& surface, const Parameterization& map);

}  // namespace moduli
