#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/base/context.h"
#include "core/matching/cover_surface.h"
#include "core/matching/map_report.h"
#include "core/matching/space_mobius.h"
#include "core/mesh/triangle_mesh.h"
#include "core/spherical/sphere_locator.h"
#include "core/spherical/surface_point.h"

/// Tells the right one of several answers between surfaces that are nearly symmetric. Internal to
/// this room.
namespace moduli {

/// A map without folds of few vertices.
struct CoarseMap {
  ShapeChange change;
  std::vector<Eigen::Vector3d> places;  ///< On b, of the same vertices of a for all maps.
};

/// Maps without folds of few vertices, and how much they change the shape.
///
/// Why: of an answer the modes tell places to some hundredths of the surface's width, and its
/// functional map is as near to orthogonal as these are right. That is more than what tells a
/// nearly symmetric body from its symmetric image. A map that has settled at little distortion
/// (settling.h) is ten times nearer to the truth even if it has few vertices, and then its
/// distortion is that of the answer: of the right one what the meshes are rough, of a symmetric
/// copy what the body lacks of symmetry.
class CoarseFit {
 public:
  /// a, b: closed, connected, of one genus; must live as long. initial_delaunay: as in
  /// mapToSphereRobust. Fails as thinSurface, conformalSphere and straightCover do.
  static Result<CoarseFit> make(Context& context, const TriangleMesh& a, const TriangleMesh& b,
                                bool initial_delaunay);

  /// points: per vertex of a its point of b, near a map that keeps orientation. mobius: but for the
  /// Möbius map of space nearest to them, which a is taken through before. Fails with
  /// kNoConvergence (no such map is near), and as fitHomeomorphism, matchHarmonically and settle
  /// do: then the points tell no map, or none on so few vertices. Several threads may ask at once.
  /// As long as the fit of 1200 vertices; some times that with a Möbius map.
  Result<CoarseMap> operator()(Context& context, const std::vector<SurfacePoint>& points,
                               bool mobius = false) const;

 private:
  CoarseFit(const TriangleMesh& a, const TriangleMesh& b) : a_(a), b_(b) {}

  Result<std::vector<SurfacePoint>> fitted(Context& context, const TriangleMesh& from,
                                           const std::vector<SurfacePoint>& targets) const;
  Result<std::vector<SurfacePoint>> fittedSphere(Context& context, const TriangleMesh& from,
                                                 const std::vector<SurfacePoint>& targets) const;
  Result<std::vector<SurfacePoint>> settled(Context& context, const TriangleMesh& from,
                                            const std::vector<SurfacePoint>& targets,
                                            const Points3& points) const;

  Result<SpaceMobius> mobiusNear(const TriangleMesh& from,
                                 const std::vector<SurfacePoint>& images) const;
  CoarseMap mapOf(const std::vector<Eigen::Vector3d>& whole,
                  const std::vector<SurfacePoint>& images) const;

  const TriangleMesh& a_;
  const TriangleMesh& b_;
  std::optional<TriangleMesh> thin_;        ///< Of a; absent where a has few vertices.
  std::vector<Index> vertices_;             ///< Of a: those of the thinned surface.
  std::vector<Eigen::Vector3d> normals_b_;  ///< Per vertex.
  std::optional<CoverSurface> cover_;       ///< Of b, with handles; else
  Points3 sphere_a_;                        ///< of the thinned surface,
  std::optional<SphereLocator> sphere_b_;   ///< and of b.
};

}  // namespace moduli
