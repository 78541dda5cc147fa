#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/context.h"
#include "core/matching/map_report.h"
#include "core/mesh/triangle_mesh.h"
#include "core/spherical/surface_point.h"

/// Dense correspondences of two surfaces.
///
///   ASSIGN_OR_RETURN(const SurfaceMatch match, matchSurfaces(context, a, b));
///   const SurfacePoint where = match.images[17];  // Vertex 17 of a is there on b.
namespace moduli {

/// A point of a and the one of b that it corresponds to.
struct MatchLandmark {
  SurfacePoint a, b;
  std::string name = "a landmark";  ///< For messages: "landmarks.txt:3".
};

struct MatchOptions {
  /// Matches a to the mirror image of b: the map turns orientation over.
  bool mirror = false;
  /// Points that are met exactly.
  std::vector<MatchLandmark> landmarks = {};
  /// Points that the map is drawn to, more than to anything else near them, but may miss.
  std::vector<MatchLandmark> soft_landmarks = {};
  /// Whether two meshes that differ by the numbering and the places of their vertices alone
  /// correspond by their triangulation. Without, only the surfaces count.
  bool same_triangulation = true;
  /// As in mapToSphereRobust.
  bool initial_delaunay = true;
  /// Which answer: 0 is the best, k > 0 the k-th of the alternatives that it tells of.
  int alternative = 0;
};

/// What the map was found by.
enum class MatchMethod : std::uint8_t {
  kSameTriangulation,  ///< The meshes differ by numbering and places of vertices.
  kNearIsometry,       ///< By the surfaces' own metrics: bending changes little.
  kMobius,             ///< By what Möbius maps of space keep: nothing but angles agrees.
  kShape,              ///< By where they are in space, the finer relief of one smoothed away.
};

/// Another answer that is nearly as good, as symmetric surfaces have them.
struct MatchAlternative {
  MatchMethod method = MatchMethod::kNearIsometry;
  double defect = 0;  ///< As SpectralMatch has it.
};

struct SurfaceMatch {
  std::vector<SurfacePoint> images;   ///< Per vertex of a its point of b.
  std::vector<SurfacePoint> inverse;  ///< Per vertex of b the point of a that goes there.
  MatchMethod method = MatchMethod::kNearIsometry;
  /// No face is folded. On disks faces with all corners on the boundary, and those at edges inside
  /// that join two such, count by their parts: see matchDisks.
  MapReport report;
  /// How far the map is from one that keeps all lengths but for one scale: the root mean square, by
  /// area, of the logarithms of both singular values of its faces, less their mean. No unit; 0 for
  /// similar surfaces.
  double distance = 0;
  double cycle_error = 0;                ///< cycleError over the root of the area of a.
  std::optional<double> defect;          ///< Of the spectral match that the map began with.
  std::optional<double> landmark_error;  ///< Largest distance left, over the root of b's area.
  /// Of tori: half the logarithm of the least dilatation that a map of the homotopy class has
  /// (TorusMap::distance).
  std::optional<double> teichmuller_distance;
  std::optional<double> soft_landmark_error;  ///< Of the soft ones.
  /// The other answers, best first, whose defects are less than twice that of the best.
  std::vector<MatchAlternative> alternatives;
};

/// A map from a onto b that is one to one and folds no face. Surfaces that differ by bending are
/// matched by their metrics, surfaces that a Möbius map of space carries to each other by what it
/// keeps, whichever agrees better; where such a map is near the match, the first surface is taken
/// through it and the rest is a near isometry. Closed surfaces that are neither, but lie on each
/// other once the relief of one is smoothed away, are matched by that (shape_alignment.h). Of
/// several matches that are nearly as good, as nearly symmetric surfaces have them, those are taken
/// whose boundaries meet, and of closed surfaces the one that changes the shape least. Closed
/// surfaces of many vertices (7500 and more) are thinned first: what is smooth is found on 5000 of
/// them, and the map then comes back to all.
///
/// a, b: connected, of one genus and number of boundary loops. Boundaries are mapped onto each
/// other: images of their vertices have a weight of 0 on an edge of the boundary, or 1 at a vertex
/// of it. Landmarks on the boundary of one surface are on that of the other, and tell which loops
/// correspond; exact ones of disks are met by vertices that are put there. Fails with
/// kUnsupportedTopology (naming both topologies), kNoConvergence (no correspondence), kFoldedMap
/// (naming landmarks that contradict each other), kInvalidOption (naming a landmark), as
/// makeSpectralSurface, fitHomeomorphism, matchHandles, matchDisks and matchBordered do. Some
/// seconds at 50,000 vertices. Source: MATH 9.
Result<SurfaceMatch> matchSurfaces(Context& context, const TriangleMesh& a, const TriangleMesh& b,
                                   const MatchOptions& options = {});

}  // namespace moduli
