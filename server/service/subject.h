#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "core/base/context.h"
#include "core/intrinsic/intrinsic_surface.h"
#include "core/mesh/input_corners.h"
#include "core/mesh/prepare.h"
#include "moduli/v1/mesh.pb.h"
#include "server/service/backend.h"

namespace moduli {

/// The surface of a request, ready to be mapped, and how the file numbers it. Either a mesh (`soup`
/// as read, `prepared` from it) or an intrinsic triangulation, which has no other numbers.
struct Subject {
  TriangleSoup soup;
  std::optional<PreparedMesh> prepared;
  std::optional<IntrinsicSurface> intrinsic;
  std::vector<Index> input_corners;  ///< Of `prepared`.
  std::vector<double> lengths;
  VertexPlaces places;
  std::vector<std::string> warnings;

  const Connectivity& surface() const {
    return prepared ? prepared->mesh.connectivity() : intrinsic->connectivity;
  }
  /// Per vertex of the surface; none of an intrinsic triangulation.
  const std::vector<Eigen::Vector3d>& positions() const;
  /// The vertex of the file that a vertex of the surface is; kNone for one that fills a hole.
  Index inputVertex(Index v) const { return prepared ? prepared->input_vertex[v] : v; }
  /// Vertices of the file.
  std::size_t inputVertexCount() const { return places.place.size(); }
};

/// Loads, parses and prepares the surface of a checked source. Fails as loadMesh, parseSurface and
/// prepareMesh do.
Result<Subject> loadSubject(Context& context, const Backend& backend, const v1::MeshSource& source,
                            const v1::PrepareOptions& prepare);

/// What messages call a surface: its file or its stored shape, or `otherwise`.
std::string sourceName(const v1::MeshSource& source, const std::string& otherwise);

/// `status` with a surface's name before its message, unless it begins so; who has to stop is told
/// nothing of files.
Status aboutSurface(const std::string& name, const Status& status);

}  // namespace moduli
