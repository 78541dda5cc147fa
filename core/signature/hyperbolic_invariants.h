#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/base/context.h"
#include "core/hyperbolic/length_spectrum.h"
#include "core/ricci/uniformize.h"
#include "core/signature/signature.h"

namespace moduli {

/// What a hyperbolic surface has beside its metric.
struct HyperbolicInvariants {
  std::vector<DiskIsometry> generators;
  std::vector<double> lengths;  ///< Primitive closed geodesics, ascending.
  double complete_to = 0;       ///< All geodesics up to this length are there; 0: none was found.
  double relation_residual = 0;
  std::optional<PantsCoordinates> pants;
  Status geodesics;     ///< Why lengths are missing, if they are.
  Status pants_curves;  ///< Why pants are missing where lengths are there.
};

/// The group of a closed surface of genus 2 or more and its closed geodesics: up to `length`, as
/// far as a million elements of the group tell; without it up to kSpectrumReach systoles, as far as
/// some ten thousand do. Fails as computeFuchsianGroup does; where the geodesics alone fail, as
/// orbitPolygon and systoles do, the rest stands. Source: MATH 7.
Result<HyperbolicInvariants> hyperbolicInvariants(Context& context, const DiscreteMetric& metric,
                                                  std::optional<double> length = {});

/// Lengths of the geodesics that the boundary loops of a uniformized surface become, ascending.
std::vector<double> geodesicBoundaryLengths(const Connectivity& surface,
                                            const Uniformization& uniformization);

inline constexpr double kSpectrumReach = 1.5;
/// Elements of the group that are listed for a spectrum, at most: some 0.06 s. Real surfaces need
/// some hundred.
inline constexpr std::size_t kSignatureElements = 40'000;

/// The spectrum of it: the shortest geodesics, and those up to kSpectrumReach of them where that is
/// not too much. Fails as systoles does.
Result<LengthSpectrum> shortGeodesics(Context& context, const OrbitPolygon& polygon);

}  // namespace moduli
