#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/base/context.h"
#include "core/intrinsic/geometry.h"
#include "core/intrinsic/overlay.h"
#include "core/mesh/connectivity.h"

namespace moduli {

/// A surface some of whose faces are cut into smaller ones.
struct Subdivision {
  /// A new vertex on an edge of the given surface.
  struct Vertex {
    Index halfedge = 0;   ///< The given edge's own halfedge (Connectivity::halfedge).
    double fraction = 0;  ///< From its tail, within (0, 1).
    Crossing crossing;  ///< With an edge of a final triangulation, where it comes from an overlay.
  };
  std::vector<Vertex> vertices;  ///< Numbered after the given vertices, in this order.
  /// Faces in the order of the given ones; pieces stand where their face stood.
  std::vector<Triangle> faces;
  std::vector<Index> parent;  ///< Per face the given face that it is (part of).
};

/// How good a triangle is in the image: positive where it keeps its orientation, larger is better.
/// Takes numbers of vertices; what Subdivision::Vertex says of new ones is passed to `locate`
/// first.
struct SubdivisionImage {
  std::function<void(const Subdivision::Vertex&)> locate;
  std::function<double(Index, Index, Index)> quality;
  /// Told of the face whose pieces `quality` is asked for next, if given: where an image is not one
  /// for all faces.
  std::function<void(Index)> enter = {};
};

/// Fails with kFoldedMap where a face has a vertex twice, which no cut can help. what: turned faces
/// over, for the message. O(F).
Status checkCuttable(const Connectivity& surface, const std::string& what);

/// Cuts given faces whose image is turned over, and as many of their neighbours as it takes, along
/// the final edges, where the image bends: the pieces of a face that is cut by all of them keep
/// their orientation under every map that is projective on the overlay. Neighbours of cut faces get
/// the new vertices on their sides, and are cut along all final edges only where the image of that
/// has no triangulation with the right orientation. faces: per face of overlay.given(), whether it
/// has to be cut. limit: faces from here on are left as they are, for the second half of a double.
/// Fails with kCancelled and kDeadlineExceeded. O(what is cut).
Result<Subdivision> subdivide(Context& context, const Overlay& overlay,
                              const std::vector<bool>& faces, Index limit,
                              const SubdivisionImage& image);

/// `count` new vertices on each of these edges of a surface, evenly.
std::vector<Subdivision::Vertex> evenVertices(const Connectivity& given,
                                              const std::vector<Index>& edges, int count);

/// Puts new vertices on edges and cuts the faces beside them accordingly. vertices: those of one
/// edge together, in the order from the tail of its halfedge; their crossings are not looked at,
/// and image.locate may be empty. Nothing where the image of some face has no triangulation with
/// the right orientation. O(F).
std::optional<Subdivision> splitEdges(const Connectivity& given,
                                      const std::vector<Subdivision::Vertex>& vertices,
                                      const SubdivisionImage& image);

/// The lengths of a subdivision's edges, within flat faces. surface: of its faces (all vertices
/// used); lengths: per edge of the given surface, proper triangles. Per edge of `surface`. O(F).
std::vector<double> subdividedLengths(const Connectivity& given, const std::vector<double>& lengths,
                                      const Subdivision& subdivision, const Connectivity& surface);

/// The edges of a subdivision that lie on these edges of the given surface, whose faces have three
/// different vertices. chosen: per edge of the given surface; surface: as in subdividedLengths. Per
/// edge of `surface`. O(F).
std::vector<bool> edgesAlong(const Connectivity& given, const std::vector<bool>& chosen,
                             const Subdivision& subdivision, const Connectivity& surface);

}  // namespace moduli
