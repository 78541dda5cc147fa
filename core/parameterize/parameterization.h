#pragma once

#include <Eigen/Core>
#include <array>
#include <complex>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/forms/holomorphic.h"
#include "core/hyperbolic/su11.h"
#include "core/intrinsic/subdivide.h"
#include "core/parameterize/affine_atlas.h"
#include "core/ricci/target_curvature.h"
#include "core/spherical/circle.h"
#include "core/spherical/map_quality.h"

/// What all maps of this room have in common.
namespace moduli {

/// How a map of a surface of genus 0 is found.
enum class MapMethod : std::uint8_t {
  kAuto,      ///< Robust; linear where needles keep that from its end.
  kHeatFlow,  ///< Harmonic map by heat flow from the Gauss map.
  kLinear,    ///< Linear solves alone: fast, may fold.
  kRobust,    ///< Vertex scaling with flips, a vertex at infinity; finer faces where it folds.
};
/// "auto", "heat-flow", "linear" or "robust".
std::string methodName(MapMethod method);

/// What judges a map; computed from the final numbers. Absent where it does not apply.
struct MapCertificate {
  MapQuality quality;                           ///< Of the faces that are returned.
  std::optional<double> curvature_residual;     ///< max |K - target|, radians.
  std::optional<double> gauss_bonnet_residual;  ///< |sum K - 2 pi chi|, radians.
  std::optional<double> layout_closure;  ///< Largest gap of the layout, in lengths of its edge.
  std::optional<double> max_link_angle;  ///< Of the polygon around infinity; at most pi, radians.
  std::optional<double> smallest_angle;  ///< Of the final metric's triangulation, radians.
  /// Distance of the images' mean from the centre of the sphere or disk.
  std::optional<double> centering_residual;
  /// Largest distance of a boundary vertex from its circle or side, over the size of the whole.
  std::optional<double> boundary_deviation;
  std::optional<double> clamped_fraction;  ///< Edges whose intersection angle was clamped.
  std::optional<int> newton_iterations;
  std::optional<int> flips;
  std::optional<int> sweeps;               ///< Of the iteration that makes loops round.
  std::optional<double> convergence_rate;  ///< By which a sweep shrinks what is left.
  /// Hyperbolic: of the products around vertices from the identity, of the relation from 1.
  std::optional<double> cycle_residual, relation_residual;
  std::optional<double> spectrum_complete_to;  ///< Of closed geodesics.
  /// Torus: the largest distance of a face's sides from what the lattice makes of them, in square
  /// roots of the area. Cones: of the turning around a handle from a multiple of a quarter,
  /// radians.
  std::optional<double> holonomy_residual;
  std::optional<int> islands;  ///< Connected parts of the image, none of which meets another.
  double mollification = 0;
  std::vector<std::string> warnings;
};

/// A closed geodesic, face by face.
struct GeodesicPath {
  /// The way through a face.
  struct Step {
    Index entry = 0;      ///< Halfedge of the face through which it comes in,
    double fraction = 0;  ///< and where, from its tail.
    /// Images of the two ends of the way, as parts of this face.
    std::complex<double> from, to;
  };
  double length = 0;
  std::vector<Step> steps;
};

/// What belongs to a hyperbolic surface that is cut open in the Poincaré disk.
struct HyperbolicDomain {
  std::vector<Su11> generators;  ///< Of a closed surface, as FuchsianGroup.
  /// The deck transformations that carry the image to the copies beside it, with their inverses.
  std::vector<Su11> neighbours;
  double radius = 0;                     ///< The largest distance of an image from 0.
  std::vector<GeodesicPath> geodesics;   ///< The shortest ones inside, ascending.
  std::vector<double> boundary_lengths;  ///< Per boundary loop.
};

/// What belongs to a torus that is cut open in the plane.
struct TorusDomain {
  /// a > 0 and b, whose multiples carry the image to the copies that fill the plane with it; the
  /// cell that they span has the area 1.
  std::array<std::complex<double>, 2> generators;
  std::complex<double> tau;  ///< b / a, in the fundamental domain of SL(2, Z).
  /// The marking: closed walks along halfedges of the faces whose images go from 0 to a and to b.
  /// The cuts, from one vertex, where `is_parallelogram`; otherwise empty.
  std::array<std::vector<Index>, 2> walks;
  /// Whether the image has four corners 0, a, b, a + b and between them two sides and their
  /// translates. Other cuts (of triangulations of a few faces) are some cut graph.
  bool is_parallelogram = false;
};

/// What belongs to a flat surface with cones that is cut open in the plane.
struct ConeDomain {
  std::vector<Cone> cones;  ///< At vertices of the surface.
  /// How directions turn around the handles of a closed surface: see handleTurns.
  std::vector<double> handle_turns;
  /// Of cones that were chosen, as in ChosenCones.
  std::optional<double> spread, spread_before;
};

/// What belongs to an integral of a closed form whose periods are Gaussian integers.
struct QuadDomain {
  std::vector<FormZero> zeros;  ///< Of its real part, see zerosOfForm: the indices sum to chi.
  std::vector<std::complex<double>> periods;  ///< Of the classes alpha_1 .. beta_g, whole numbers.
  double squares = 0;  ///< Area of the image, counted as often as it covers: a whole number.
  /// How far the form is from a holomorphic one: sqrt(2 (energy - area) / area), where the energy
  /// is the mean of those of its two parts.
  double misfit = 0;
};

/// A map of the faces of a surface to the plane, continuous but for seams, or to the sphere.
struct Parameterization {
  /// The faces that are mapped, where they are not those of the surface.
  std::optional<Subdivision> subdivision;
  /// To the sphere: per vertex its image of length 1, the new vertices behind the surface's.
  std::vector<Eigen::Vector3d> sphere;
  /// To the plane: the images of corners, each as often as seams cut it.
  std::vector<std::complex<double>> points;
  std::vector<Index> corner;  ///< Per halfedge h of the faces: the point of tail(h) in its face.
  /// Width over height of a rectangle; log(outer / inner radius) / 2 pi of an annulus.
  std::optional<double> modulus;
  std::vector<Circle> circles;  ///< Of the boundary loops of a circle domain, the outer first.
  std::optional<HyperbolicDomain> hyperbolic;  ///< Of a map to the Poincaré disk.
  std::optional<TorusDomain> torus;            ///< Of a torus, cut open.
  std::optional<ConeDomain> cones;             ///< Of a flat metric with cones.
  std::optional<AffineAtlas> atlas;            ///< Of its faces and vertices, cones left out.
  std::optional<QuadDomain> quads;             ///< Of a form with whole periods.
  MapMethod method = MapMethod::kAuto;         ///< What was done.
  MapCertificate certificate;
};

}  // namespace moduli
