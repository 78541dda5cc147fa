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
  std::vector<double> first_lengths;  ///< As firstLengths; empty where they are not known.
  double relation_residual = 0;
  std::optional<PantsCoordinates> pants;
  Status geodesics;     ///< Why lengths are missing, if they are.
  Status pants_curves;  ///< Why pants are missing where lengths are there.
};

/// The group of a closed surface of genus 2 or more and its closed geodesics: up to `length`, as
/// far as a million elements of the group tell; without it up to kSpectrumReach systoles and to
/// kLeastReach at least, as far as some ten thousand do. Its first lengths are the same with it and
/// without. Fails as computeFuchsianGroup does; where the geodesics alone fail, as
/// orbitPolygon and systoles do, the rest stands. Source: MATH 7.
Result<HyperbolicInvariants> hyperbolicInvariants(Context& context, const DiscreteMetric& metric,
                                                  std::optional<double> length = {});

/// Lengths of the geodesics that the boundary loops of a uniformized surface become, ascending.
std::vector<double> geodesicBoundaryLengths(const Connectivity& surface,
                                            const Uniformization& uniformization);

inline constexpr double kSpectrumReach = 1.5;
/// Signatures list geodesics up to this length in any case: a surface with one very short geodesic
/// is known by others.
inline constexpr double kLeastReach = 4;
/// Elements of the group that are listed for a spectrum, at most: some 0.06 s. Real surfaces need
/// some hundred up to kSpectrumReach systoles and up to ten thousand for kLeastReach.
inline constexpr std::size_t kSignatureElements = 40'000;

/// The spectrum of it: the shortest geodesics, and those up to kSpectrumReach of them and up to
/// `least_reach` where that is not too much, or as far as that goes. Fails as systoles does.
Result<LengthSpectrum> shortGeodesics(Context& context, const OrbitPolygon& polygon,
                                      double least_reach = 0);

inline constexpr std::size_t kFirstLengths = 12;

/// The kFirstLengths smallest lengths, each cut off at the larger one of kLeastReach and
/// kSpectrumReach systoles, which stands for those that are missing as well. Every one of them is
/// continuous in the surface: the i-th smallest length is, for every i, and so is the cut; and a
/// map of dilatation K changes it by a factor between 1/K and K, as it does lengths. Where the
/// spectrum does not go as far, it is cut off at spectrum.complete_to.
/// spectrum: ascending, of one length at least.
std::vector<double> firstLengths(const LengthSpectrum& spectrum);

}  // namespace moduli
