#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/mesh/connectivity.h"
#include "core/parameterize/parameterization.h"
#include "core/spherical/curve_landmarks.h"
#include "core/spherical/field_alignment.h"
#include "core/spherical/landmark_map.h"

/// Laying the sphere of one surface onto that of another, such as the halves of a brain.
///
///   ASSIGN_OR_RETURN(const Parameterization a, parameterizeSphere(context, left, ...));
///   ASSIGN_OR_RETURN(const Parameterization b, parameterizeSphere(context, right, ...));
///   SphereRegistrationOptions options;
///   options.mirror = true;
///   ASSIGN_OR_RETURN(const SphereRegistration laid,
///                    registerSphere(context, {left, left_lengths, a, left_sulc},
///                                   {right, right_lengths, b, right_sulc}, options));
namespace moduli {

/// A surface with its map to the sphere. Refers to its parts, which must live as long.
struct MappedSphere {
  const Connectivity& surface;
  const std::vector<double>& lengths;  ///< Per edge of the surface, positive up to rounding.
  const Parameterization& map;         ///< To the sphere; may have finer faces than the surface.
  const std::vector<double>& field;    ///< Per vertex of the surface, finite; or empty.
};

/// A point and the one of the reference that it corresponds to.
struct SphereLandmark {
  SurfacePoint point, reference;    ///< On the surfaces as given, whose faces may have been cut.
  std::string name = "a landmark";  ///< For messages: "landmarks.txt:3".
};

/// Curves that correspond: `a` on the surface, `b` on the reference.
struct SphereCurve {
  CurvePair pair;
  std::string name = "a curve";
};

struct SphereRegistrationOptions {
  bool mirror = false;  ///< Register to the mirror image of the reference: x changes its sign.
  std::vector<SphereLandmark> landmarks = {};
  std::vector<SphereCurve> curves = {};
  FieldSearchOptions search = {};
  LandmarkMapOptions meeting = {};
};

/// What was compared.
enum class ComparedField : std::uint8_t { kNothing, kGiven, kAreaDistortion };

struct SphereRegistration {
  /// Per vertex of the map, the cut faces' new ones behind the surface's: its place on the sphere
  /// of the reference (its mirror image, if asked).
  Points3 points;
  MapQuality quality;  ///< From the surface's metric to the points; no face folded.
  int landmarks = 0;   ///< Pairs that were met, those of curves among them.
  std::optional<double> landmark_distance;  ///< The largest that is left, a chord.
  /// |mu| of the map from the sphere before to the sphere now. With landmarks.
  std::optional<double> mean_beltrami, max_beltrami;
  ComparedField field = ComparedField::kNothing;
  /// Of the fields, weighted by the areas of the first surface: without the registration, with it.
  std::optional<double> correlation_before, correlation_after;
  std::optional<double> mean_absolute_difference;  ///< In units of the fields, weighted likewise.
  /// Per vertex of the surface the reference's field there; empty where it has none.
  std::vector<double> carried;
};

/// A point of a surface in the pieces of its face: in the one that it is deepest in. refined: of
/// cut's faces. point: of `surface`. O(log F + pieces).
SurfacePoint pointInPieces(const Connectivity& surface, const Subdivision& cut,
                           const Connectivity& refined, const SurfacePoint& point);

/// The positions of a surface as its map to the sphere, if they are that: closed, of genus 0, all
/// of one distance from the origin to 1e-3 of it, and no face folded when seen from there, so that
/// it is covered once. O(F log F).
std::optional<Parameterization> asSphere(const Connectivity& surface,
                                         const std::vector<double>& lengths,
                                         const std::vector<Eigen::Vector3d>& positions);

/// log(area around a vertex / area of its image) per vertex: high on what stands out. points: a map
/// to the sphere without folds. O(F).
std::vector<double> areaDistortion(const Connectivity& surface, const std::vector<double>& lengths,
                                   const Points3& points);

/// Lays a sphere onto another. With landmarks or curves: by the Möbius map that brings them nearest
/// to their places and a map that meets them (meetLandmarks); the fields, where both have one, are
/// compared alone. Without any: by the rotation under which the fields are most alike (alignFields)
/// or, where neither has one, the logarithms of how much the maps change areas.
///
/// Fails with kInvalidOption (only one field and no landmarks, a field of another size; landmarks
/// and curves by name, as checkSurfacePoint, resampleCurve and meetLandmarks do),
/// kUnsupportedTopology (not closed), kFoldedMap (a given map folds, or every one that meets the
/// landmarks), and as SpdSolver. A few seconds for the rotation; meetLandmarks' time with
/// landmarks. Source: MATH 9.2, 10.
Result<SphereRegistration> registerSphere(Context& context, const MappedSphere& sphere,
                                          const MappedSphere& reference,
                                          const SphereRegistrationOptions& options = {});

}  // namespace moduli
