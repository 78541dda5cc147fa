#pragma once

#include <vector>

#include "core/signature/surface_modes.h"

/// Descriptors of the metric alone, made of the eigenpairs of a surface scaled to area 1. Bending
/// keeps them. All are invariant under rotations among equal eigenvalues, and none sees where the
/// list of pairs ends (modeTaper).
namespace moduli {

/// log(mu_k / (4 pi k)), one per mode. Source: MATH 8.7; Reuter, Wolter, Peinecke 2006.
std::vector<double> logSpectrum(const SurfaceModes& modes);

/// Means of logSpectrum over kSpectrumBands bands of k, one each up to k = 7 and about a fifth of
/// their place wide from there, times the root of their width: the distance of two is nearly that
/// of the logarithms, in a third of the numbers.
inline constexpr int kSpectrumBands = 17;
std::vector<double> spectrumBands(const SurfaceModes& modes);

/// log of the heat trace 1 + sum exp(-mu t) at kHeatTimes times.
inline constexpr int kHeatTimes = 8;
std::vector<double> heatTrace(const SurfaceModes& modes);

/// tailedQuantileMeans by area of log of the heat kernel signature 1 + sum exp(-mu t) psi^2, for
/// each of kHeatTimes times, ascending. O(V kModeCount). Source: Sun, Ovsjanikov, Guibas 2009.
std::vector<std::vector<double>> heatKernelQuantiles(const SurfaceModes& modes);

/// The same of log(0.1 + the wave kernel signature): means of psi^2 over modes near each of
/// kWaveEnergies energies, ascending.
/// Source: Aubry, Schlickewei, Cremers 2011.
inline constexpr int kWaveEnergies = 8;
std::vector<std::vector<double>> waveKernelQuantiles(const SurfaceModes& modes);

}  // namespace moduli
