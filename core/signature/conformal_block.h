#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/context.h"
#include "core/mesh/connectivity.h"
#include "core/signature/signature.h"

namespace moduli {

/// Surfaces of a larger genus (with boundary: whose double has a larger one) get no conformal
/// block: it grows with the square of the genus and the work with its cube.
inline constexpr Index kMaxPeriodGenus = 128;
/// Energies in a spectrum.
inline constexpr std::size_t kEnergySpectrumLength = 32;

/// The type of a connected surface by its topology.
ConformalType conformalTypeOf(Index genus, Index boundary_loops);

/// A conformal block and what judges it.
struct CertifiedConformalBlock {
  std::optional<ConformalBlock> block;  ///< Empty beyond kMaxPeriodGenus; a warning says so.
  std::optional<double> riemann_bilinear_residual;
  std::optional<double> period_symmetry_residual;
  std::vector<std::string> warnings;
};

/// The conformal block of a connected surface of any type but TORUS, whose block comes with its
/// flat layout (compute.cc). lengths: per edge, proper triangles. Fails as computePeriods and
/// computeBorderedPeriods. Closed: about 1.3 F and 2 g back-substitutions; with boundary about 2 F.
/// Stages as theirs, and "lattice". Source: MATH 4, 5.
Result<CertifiedConformalBlock> computeConformalBlock(Context& context, const Connectivity& surface,
                                                      const SignatureTopology& topology,
                                                      const std::vector<double>& lengths);

/// Puts the spectrum of a lattice with a symplectic energy form into a block: spread as in
/// PeriodMatrix. Returns a warning, or nothing, where the enumeration takes too long and the
/// spectrum is left out. Fails as shortestEnergies does otherwise.
Result<std::optional<std::string>> addEnergySpectrum(Context& context,
                                                     const Eigen::MatrixXd& energy, double spread,
                                                     ConformalBlock& block);

}  // namespace moduli
