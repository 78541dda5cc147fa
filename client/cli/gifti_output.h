#pragma once

#include <string>
#include <vector>

#include "client/cpp/parameterized_mesh.h"
#include "core/base/status.h"
#include "core/mesh/gifti.h"

/// Spheres and values of vertices as the files of neuroimaging programs.
namespace moduli::cli {

/// .gii and .gii.gz, in any case.
bool isGiftiFileName(const std::string& path);
/// Those and .txt.
bool isValuesFileName(const std::string& path);

/// The tags of a GIFTI surface; none for files of other formats, and where they cannot be read.
GiftiTags tagsOf(const std::string& bytes, const std::string& name);

/// A map to the sphere as a GIFTI surface of radius 1, gzipped if the path says so. tags: of the
/// input; its coordinate systems and structures stay, GeometricType becomes "Spherical".
/// Coordinates are FLOAT32, as the format has them, unless that would fold a face; then FLOAT64.
/// Fails as writeGiftiSurface does. O(V + F).
Result<std::string> sphereGifti(const ParameterizedMesh& mesh, GiftiTags tags,
                                const std::string& path);

/// One value a vertex: as a GIFTI shape, or as text, one a line. name: what the values are, for
/// GIFTI. tags: of the surface; AnatomicalStructurePrimary is taken from there. Fails as
/// writeGiftiShape does. O(V).
Result<std::string> valuesFile(const std::vector<double>& values, const std::string& name,
                               const GiftiTags& tags, const std::string& path);

}  // namespace moduli::cli
