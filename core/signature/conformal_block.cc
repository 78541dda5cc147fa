#include "core/signature/conformal_block.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/text.h"
#include "core/forms/bordered_period.h"
#include "core/forms/energy_lattice.h"
#include "core/forms/period_matrix.h"

namespace moduli {
namespace {

/// Relative uncertainties above this are worth a word.
constexpr double kTellingSpread = 0.1;
/// About a second; real surfaces take some thousands.
constexpr std::int64_t kSpectrumNodes = 10'000'000;

/// The genus of the surface itself, or of its double.
Index periodGenus(const SignatureTopology& topology) {
  if (topology.boundary_loops == 0) return topology.genus;
  return 2 * topology.genus + topology.boundary_loops - 1;
}

std::string tooManyPeriods(const SignatureTopology& topology) {
  return "PERIODS_OMITTED: the conformal block is left out, as " +
         std::string(topology.boundary_loops == 0 ? "the surface" : "the double of the surface") +
         " has genus " + std::to_string(periodGenus(topology)) + " where " +
         std::to_string(kMaxPeriodGenus) + " is the limit; --fill-holes closes small holes";
}

void addPeriodMatrix(const PeriodMatrix& periods, ConformalBlock& block) {
  const Eigen::MatrixXcd& period = periods.period;
  PeriodEntries entries;
  entries.size = static_cast<Index>(period.rows());
  for (Eigen::Index j = 0; j < period.rows(); ++j) {
    // No negative zeros.
    for (Eigen::Index k = 0; k < period.cols(); ++k) entries.values.push_back(period(j, k) + 0.0);
  }
  block.period_matrix = std::move(entries);
  block.period_error = periods.error;
}

Result<CertifiedConformalBlock> describe(Context& context, ConformalBlock block,
                                         const PeriodMatrix& periods) {
  CertifiedConformalBlock result;
  result.riemann_bilinear_residual = periods.riemann_residual;
  result.period_symmetry_residual = periods.symmetry_residual;
  ASSIGN_OR_RETURN(const std::optional<std::string> warning,
                   addEnergySpectrum(context, periods.energy, periods.spread, block));
  if (warning) result.warnings.push_back(*warning);
  if (std::expm1(periods.spread) > kTellingSpread) {
    result.warnings.push_back("COARSE_MESH: the energies of the periods are certain only to " +
                              shortestDouble(std::expm1(periods.spread)) + " of their size");
  }
  result.block = std::move(block);
  return result;
}

}  // namespace

ConformalType conformalTypeOf(Index genus, Index boundary_loops) {
  if (boundary_loops == 0) {
    if (genus == 0) return ConformalType::kSphere;
    return genus == 1 ? ConformalType::kTorus : ConformalType::kHyperbolic;
  }
  if (genus > 0) return ConformalType::kBordered;
  if (boundary_loops == 1) return ConformalType::kDisk;
  return boundary_loops == 2 ? ConformalType::kAnnulus : ConformalType::kCircleDomain;
}

Result<std::optional<std::string>> addEnergySpectrum(Context& context,
                                                     const Eigen::MatrixXd& energy, double spread,
                                                     ConformalBlock& block) {
  const Context::Stage stage(context, "lattice");
  auto spectrum = shortestEnergies(context, energy, kEnergySpectrumLength, kSpectrumNodes);
  if (spectrum.ok()) {
    block.energy_spectrum = *std::move(spectrum);
    block.energy_spectrum_error = std::expm1(spread);
    return std::optional<std::string>();
  }
  if (spectrum.status().reason() != Reason::kNoConvergence) return spectrum.status();
  return std::optional("ENERGY_SPECTRUM_OMITTED: " + spectrum.status().message());
}

Result<CertifiedConformalBlock> computeConformalBlock(Context& context, const Connectivity& surface,
                                                      const SignatureTopology& topology,
                                                      const std::vector<double>& lengths) {
  ConformalBlock block;
  block.type = conformalTypeOf(topology.genus, topology.boundary_loops);
  CertifiedConformalBlock without_periods;
  if (periodGenus(topology) > kMaxPeriodGenus) {
    without_periods.warnings.push_back(tooManyPeriods(topology));
    return without_periods;
  }
  if (block.type == ConformalType::kSphere || block.type == ConformalType::kDisk) {
    without_periods.block = std::move(block);
    return without_periods;
  }
  if (topology.boundary_loops == 0) {
    ASSIGN_OR_RETURN(const ClosedPeriods closed, computePeriods(context, surface, lengths));
    addPeriodMatrix(closed.periods, block);
    return describe(context, std::move(block), closed.periods);
  }
  ASSIGN_OR_RETURN(const BorderedPeriods bordered,
                   computeBorderedPeriods(context, surface, lengths));
  if (bordered.modulus) {
    const BoundedNumber& modulus = *bordered.modulus;
    block.modulus = modulus.value;
    block.modulus_error = std::max(modulus.upper - modulus.value, modulus.value - modulus.lower);
  } else {
    addPeriodMatrix(bordered.periods, block);
  }
  return describe(context, std::move(block), bordered.periods);
}

}  // namespace moduli
