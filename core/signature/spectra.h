#pragma once

#include <complex>
#include <vector>

#include "core/base/context.h"
#include "core/mesh/connectivity.h"
#include "core/signature/quadrature.h"
#include "core/spherical/mobius.h"

/// Power spectra of fields on a canonical domain of area 4 pi: the unit sphere, or the flat torus
/// C / (Z + tau Z) scaled.
namespace moduli {

/// Frequencies 1 to this are kept; as many for every topology. On the sphere the frequency is the
/// degree l of the harmonics, with Laplace eigenvalue l (l + 1). On the torus a plane wave of
/// eigenvalue mu has frequency d = sqrt(mu + 1/4) - 1/2, so that mu = d (d + 1) as well, and shares
/// its power between the two integers next to d, linearly (all to 1 if d < 1).
inline constexpr int kSpectrumBins = 32;

/// Sums per frequency over its modes, index 0 for frequency 1. The mean of a field is not in them.
struct FieldSpectra {
  std::vector<double> first;   ///< |a|^2 of the first field.
  std::vector<double> second;  ///< |b|^2 of the second, empty if there is none.
  std::vector<double> cross;   ///< Re(a conj b), empty likewise.
};

/// Spectra of one or two fields given at the vertices of a fold-free map to the unit sphere.
/// Invariant under rotations of the points. Where faces have no area fields may be anything finite.
/// About 1 microsecond per edge and core; memory of a few doubles per edge. Source: MATH 8.3.
Result<FieldSpectra> sphereSpectra(Context& context, const Connectivity& surface,
                                   const Points3& points, const VertexFields& fields);

/// The same on a torus. corners: per halfedge the coordinate of its tail in C / (Z + tau Z), as
/// layOutTorus gives it. The areas of folded faces count as positive. Invariant under translation
/// and under SL(2, Z). Source: MATH 8.4.
Result<FieldSpectra> torusSpectra(Context& context, const Connectivity& surface,
                                  const std::vector<std::complex<double>>& corners,
                                  std::complex<double> tau, const VertexFields& fields);

}  // namespace moduli
