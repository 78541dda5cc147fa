#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/context.h"
#include "core/mesh/connectivity.h"

/// The vibrations of a surface: eigenpairs of its Laplace-Beltrami operator. They are made of
/// lengths alone, so that bending keeps them, and there are as many for every topology.
namespace moduli {

/// Pairs that descriptors use, the constant one left out.
inline constexpr Eigen::Index kModeCount = 50;

/// Edges of the finer triangulation that the wavelength of the last mode is long at least.
inline constexpr double kEdgesPerWave = 12;

/// Eigenpairs of a surface scaled to area 1; a boundary is free (Neumann's condition).
struct SurfaceModes {
  Eigen::VectorXd values;       ///< kModeCount, ascending, positive; tend to 4 pi k (Weyl).
  Eigen::MatrixXd functions;    ///< Vertices x kModeCount, orthonormal by `areas`.
  std::vector<double> areas;    ///< Per vertex its share of the area, sum 1.
  double largest_residual = 0;  ///< As EigenPairs has it.
};

/// They belong to the polyhedral surface and not to its mesh: functions are linear on an intrinsic
/// Delaunay triangulation none of whose edges is longer than the wavelength of the last mode by
/// Weyl's law over edges_per_wave, so that nearly nothing is left of what a coarse mesh or one of
/// needles would do to them. Its vertices are the given ones and then new ones. Where rounding
/// keeps flips from ending, the given triangulation stands; where there are so many needles that
/// cutting them would add some ten thousand faces, they are cut less.
///
/// Masses are lumped, whose values are too small: on equilateral faces with sides h by the part
/// mu h^2 / 16, which is what a mass matrix halfway to the consistent one would give back. That
/// part is given back to each value by the first order of perturbation, in the mean over values
/// within some percent of it, so that multiplets and the end of the list do not matter: fourth
/// order on equilateral triangulations, and most of the error gone on others. With 8 edges a wave
/// right isosceles faces keep 1 % of the last value, those of a sphere 0.1 %; with 12 half as much.
///
/// lengths: per edge, proper triangles, a connected surface. Functions are known up to sign, and up
/// to rotations among equal values: only what such rotations keep may enter a descriptor. A surface
/// of fewer than kModeCount + 1 vertices gets its missing modes as values of Weyl's law after the
/// last one and functions 0. Fails as smallestEigenpairs does. Stages: "refine" and its. 13 to 18 F
/// on 20,000 faces, some 0.1 s on few.
Result<SurfaceModes> surfaceModes(Context& context, const Connectivity& surface,
                                  const std::vector<double>& lengths,
                                  double edges_per_wave = kEdgesPerWave);

/// 1 for values well below the last one known, falling smoothly to 0 there: with it a sum over
/// modes does not see where the list ends, not even within a multiplet.
double modeTaper(double value, double last);

}  // namespace moduli
