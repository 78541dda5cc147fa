#pragma once

#include <cstddef>
#include <vector>

#include "core/base/context.h"
#include "core/hyperbolic/orbit_polygon.h"

/// The closed geodesics of a hyperbolic surface, shortest first.
///
///   ASSIGN_OR_RETURN(const OrbitPolygon polygon, orbitPolygon(context, generators, genus));
///   ASSIGN_OR_RETURN(const LengthSpectrum shortest, systoles(context, polygon));
///   const double length = 1.5 * shortest.geodesics[0].length;
///   ASSIGN_OR_RETURN(const LengthSpectrum spectrum, lengthSpectrum(context, polygon, length));
namespace moduli {

/// A primitive closed geodesic, whichever way it is run through.
struct ClosedGeodesic {
  double length = 0;
  /// An element whose axis lies over it, in the polygon's coordinates; its axis passes the polygon.
  Su11 element;
  /// A word in the generators with inGivenCoordinates(element) as its product, up to sign.
  Word word;
};

struct SpectrumOptions {
  /// How many elements of the group may be listed. A million take some 5 s and 100 MB.
  std::size_t most_elements = 1'000'000;
};

struct LengthSpectrum {
  std::vector<ClosedGeodesic> geodesics;  ///< Ascending by length.
  /// All primitive closed geodesics up to this length are there, and none longer: the length that
  /// was asked for, or less where most_elements did not suffice.
  double complete_to = 0;
  std::size_t elements = 0;  ///< Elements of the group that were listed.
};

/// All primitive unoriented closed geodesics of length <= `length` (1 + 1e-9), one entry each: one
/// for a conjugacy class and that of the inverses, none for powers.
///
/// Complete: a geodesic of length l passes the polygon of circumradius rho, so that an element over
/// it moves 0 by at most 2 asinh(cosh rho sinh(l / 2)), and all of these are listed. Elements are
/// conjugate just if a chain of pairings carries one axis to the other along the polygon's copies
/// that it passes: every class is followed along all of its axes through the polygon. Rounding:
/// lengths to some 1e-15 e^{radius + length / 2}. Fails with kInvalidOption for lengths that are
/// not positive and finite. About e^{2 rho + length} / (32 genus - 32) elements.
/// Source: MATH 7.4 and 7.5.
Result<LengthSpectrum> lengthSpectrum(Context& context, const OrbitPolygon& polygon, double length,
                                      const SpectrumOptions& options = {});

/// The shortest closed geodesics, all of those that are as short to 1e-9 relative. Fails with
/// kNoConvergence where most_elements do not suffice to know them.
Result<LengthSpectrum> systoles(Context& context, const OrbitPolygon& polygon,
                                const SpectrumOptions& options = {});

/// All conjugates of an element whose axes pass the polygon at a sinh of distance of at most
/// `slack`; element: with an axis that does. The axes are the lifts to the polygon of one directed
/// closed geodesic. O(n p) for n conjugates and p pairings.
std::vector<Su11> conjugatesAcross(const OrbitPolygon& polygon, const Su11& element, double slack);

}  // namespace moduli
