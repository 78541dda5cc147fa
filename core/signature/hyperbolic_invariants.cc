#include "core/signature/hyperbolic_invariants.h"

#include <utility>

#include "core/hyperbolic/dirichlet_domain.h"
#include "core/hyperbolic/fuchsian_group.h"
#include "core/hyperbolic/length_spectrum.h"

namespace moduli {
namespace {

/// Some 0.2 s.
constexpr std::size_t kElements = 40'000;

/// The shortest geodesics, and those up to kSpectrumReach of them where that is not too much.
Result<LengthSpectrum> shortGeodesics(Context& context, const FuchsianGroup& group) {
  ASSIGN_OR_RETURN(const OrbitPolygon polygon, orbitPolygon(context, group));
  SpectrumOptions options;
  options.most_elements = kElements;
  ASSIGN_OR_RETURN(LengthSpectrum shortest, systoles(context, polygon, options));
  const double reach = kSpectrumReach * shortest.geodesics.front().length;
  ASSIGN_OR_RETURN(LengthSpectrum spectrum, lengthSpectrum(context, polygon, reach, options));
  return spectrum.complete_to < shortest.complete_to ? std::move(shortest) : std::move(spectrum);
}

}  // namespace

Result<HyperbolicInvariants> hyperbolicInvariants(Context& context, const DiscreteMetric& metric) {
  ASSIGN_OR_RETURN(const HyperbolicTriangles triangles, hyperbolicTriangles(metric));
  ASSIGN_OR_RETURN(const FuchsianGroup group, computeFuchsianGroup(context, triangles));
  HyperbolicInvariants result;
  for (const Su11& generator : group.generators) {
    result.generators.push_back({generator.a, generator.b});
  }
  result.relation_residual = group.certificate.relation_residual;
  const Result<LengthSpectrum> spectrum = shortGeodesics(context, group);
  const Reason reason = spectrum.status().reason();
  if (reason == Reason::kCancelled || reason == Reason::kDeadlineExceeded) return spectrum.status();
  result.geodesics = spectrum.status();
  if (!spectrum.ok()) return result;
  for (const ClosedGeodesic& geodesic : spectrum->geodesics) {
    result.lengths.push_back(geodesic.length);
  }
  result.complete_to = spectrum->complete_to;
  return result;
}

}  // namespace moduli
