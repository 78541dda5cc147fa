#pragma once

#include <cstddef>
#include <vector>

#include "core/signature/hyperbolic_invariants.h"
#include "core/signature/signature.h"

/// The vector of the conformal space: one length for each type, for an index. It is a continuous
/// stand-in for the conformal distance, which is never computed from it.
namespace moduli {

inline constexpr std::size_t kThetaCount = 4;
/// Of types with negative Euler characteristic, those without a boundary and those with one.
inline constexpr std::size_t kHyperbolicLength = 2 + 32 + kThetaCount + kFirstLengths;
inline constexpr std::size_t kBoundaryCount = 8;
inline constexpr std::size_t kBorderedLength = kHyperbolicLength + kBoundaryCount;
/// How far apart are surfaces whose genera or numbers of loops differ by 1: farther than others,
/// for their distance is none.
inline constexpr double kTopologyStep = 16;

/// The numbers that an index stores for a block.
///
/// Spheres and disks, which are one class each: 0. Annuli: log(modulus) / 2. Tori: modularFeatures.
/// Others, in this order:
///   2   kTopologyStep times the genus and the number of boundary loops;
///   32  log(energy) / 2 of the energy spectrum;
///   4   spectrumThetaFeatures of it at t = 1, 3/2, 2, 3, halved;
///   12  log(length) / 2 of the first lengths (firstLengths) of closed geodesics;
///   8   with a boundary: log(length) / 2 of the shortest geodesics that the loops become.
/// Each is continuous in the surface, and the logarithms change by no more than the Teichmüller
/// distance. What is missing is 0, as if the energy or length were 1: the spectra where they could
/// not be found, and the boundary lengths of fewer than 8 loops. So a surface whose geodesics are
/// not known keeps its place by its energies. (Surfaces jump there, but the distance that hits are
/// ordered by is that of what both have.) first_lengths: kFirstLengths, or none.
///
/// Empty where the block has no such number.
std::vector<double> conformalVector(const ConformalBlock& block, const SignatureTopology& topology,
                                    const std::vector<double>& first_lengths);

/// How many numbers those of a type are, where there are any.
std::size_t conformalVectorLength(ConformalType type);

}  // namespace moduli
