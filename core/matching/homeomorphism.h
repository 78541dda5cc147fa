#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/base/context.h"
#include "core/matching/map_report.h"
#include "core/spherical/sphere_locator.h"
#include "core/spherical/surface_point.h"

/// From places that are only nearly right to a map that is one to one.
///
///   // start: per vertex of A on the sphere of B, without folds, such as a Möbius map of A's own
///   // sphere map; targets: where vertices of A ought to go on B, wrong ones among them.
///   ASSIGN_OR_RETURN(const SphereLocator sphere, SphereLocator::make(b, sphere_of_b));
///   ASSIGN_OR_RETURN(const Homeomorphism map,
///                    fitHomeomorphism(context, {a, positions_a, start}, {sphere, positions_b},
///                                     targets));
namespace moduli {

/// A vertex whose target is met to the last bit; on a disk's boundary with a target there.
struct ExactVertex {
  Index vertex = 0;
  std::string name = "an exact vertex";  ///< For messages.
};

/// A surface of genus 0 in space with a map of it to a sphere. Refers to its parts.
///
/// Disks: the surface is closed by a cap, a last vertex (the pole, at the south pole of the sphere
/// in all maps, anywhere in space) that faces behind all others join to the boundary; the
/// boundary is on the equator, with heights 0 to the last bit. It stays there.
struct SphericalSource {
  const Connectivity& surface;
  const std::vector<Eigen::Vector3d>& positions;  ///< Per vertex.
  const Points3& start;                           ///< Per vertex, unit vectors; no face folded.
  Index pole = kNone;                             ///< Of a disk; of both or of none.
  std::vector<ExactVertex> exact = {};
};

struct SphericalTarget {
  const SphereLocator& sphere;                    ///< The surface and its own map to the sphere.
  const std::vector<Eigen::Vector3d>& positions;  ///< Per vertex.
  Index pole = kNone;
};

/// Where a vertex ought to go.
struct VertexTarget {
  Index vertex = 0;
  SurfacePoint point;  ///< Of the other surface.
  double weight = 1;   ///< >= 0; only ratios count.
};

/// Lengths are shares of the square root of the surface's area.
struct HomeomorphismOptions {
  /// Errors of the targets are evened out over this length: the longer, the more nearly isometric
  /// the map and the farther from the targets.
  double smoothing = 0.07;
  /// The same for the final map, all of whose vertices move together (settling.h): errors of
  /// targets are alike over long distances, and near isometry tells the better where most of the
  /// surface agrees. Not longer than `smoothing`: there is no such step; nor for disks.
  double last_smoothing = 1;
  /// A target much farther away than this does not count: it is wrong.
  double outlier = 0.05;
  Index coarse_vertices = 200;  ///< Where the coarse mesh begins to be refined.
  int coarse_sweeps = 200;      ///< At most, over the coarse mesh; less over finer ones, in
                                ///< proportion,
  int sweeps = 12;              ///< but as many as this.
  double tolerance = 2e-3;      ///< Of the distortion, by which a sweep must lower it to go on.
};

struct Homeomorphism {
  Points3 points;                    ///< Per vertex of A on the sphere of B; no face folded.
  std::vector<SurfacePoint> images;  ///< The same as points of B.
  MapReport report;
  double mean_distance = 0;       ///< From the targets' places to the images, in space; weighted.
  bool began_at_targets = false;  ///< Else at the start.
};

/// A map A -> B without a folded face, near the targets and nearly isometric where they leave it
/// free: it minimizes the symmetric Dirichlet energy of A's faces onto the triangles of their
/// images in space (scaled to one area), with a robust pull to the targets, vertex by vertex on a
/// hierarchy of meshes. Two coarse meshes are tried, and the better one is refined: one whose
/// vertices are at their targets, without the vertices that fold it, and one whose vertices are
/// where the start has them. A vertex is put back into the kernel of its ring, so that no face ever
/// folds. Then the whole map of a sphere settles at less distortion, with hardly a pull; where that
/// leaves faces stretched by 2.4 or more, stuck in a crumple, it is made coarse and refined again.
///
/// Disks are mapped boundary onto boundary. Targets of boundary vertices are taken to the boundary
/// first, if they are not there, by the sphere. The images are SurfacePoints on edges of the
/// boundary, with one weight of 0. Reports do not look at the cap.
///
/// Faces are those of great circles on the sphere of B. Does not depend on the numbering but for
/// ties and rounding, nor on the scale of either surface. Fails with kUnsupportedTopology (not
/// closed, doubled edges, as RingMesh has it), kInvalidOption (sizes; an option out of its range; a
/// target that is not on the surfaces or of negative weight, by its number), kFoldedMap (the start
/// folds, a vertex finds no place among doubles, or one that is exact does not come to its target:
/// the message names it), as SpdSolver does. O(V log V), a few sweeps and ten or more
/// factorizations of 2 V unknowns; memory O(V). Stages: "coarse", "refine", "settle", SpdSolver's.
/// Source: MATH 9.5; Hormann and Greiner 2000 and Smith and Schaefer 2015 (energy); Schreiner et
/// al. 2004 and Shen et al. 2019 (refinement into kernels).
Result<Homeomorphism> fitHomeomorphism(Context& context, const SphericalSource& a,
                                       const SphericalTarget& b,
                                       const std::vector<VertexTarget>& targets,
                                       const HomeomorphismOptions& options = {});

/// Per vertex of B the point of A that goes there. map: A's final points. Safe for any fold-free
/// map; exact sides. O(V log V).
Result<std::vector<SurfacePoint>> invertHomeomorphism(Context& context, const Connectivity& a,
                                                      const Points3& map, const SphereLocator& b);

}  // namespace moduli
