#include "core/signature/hyperbolic_invariants.h"

#include <algorithm>
#include <utility>

#include "core/hyperbolic/dirichlet_domain.h"
#include "core/hyperbolic/fuchsian_group.h"
#include "core/hyperbolic/length_spectrum.h"
#include "core/hyperbolic/pants.h"
#include "core/hyperbolic/straight_faces.h"

namespace moduli {
namespace {

bool stops(const Status& status) {
  return status.reason() == Reason::kCancelled || status.reason() == Reason::kDeadlineExceeded;
}

double reachOf(double systole) {
  return kSpectrumReach * systole;
}

/// What the polygon tells beside the generators. Pants may take too long to find, and are left out
/// then.
Status addGeodesics(Context& context, const FuchsianGroup& group, std::optional<double> length,
                    HyperbolicInvariants& result) {
  ASSIGN_OR_RETURN(const OrbitPolygon polygon, orbitPolygon(context, group));
  const Result<LengthSpectrum> first = shortGeodesics(context, polygon, kLeastReach);
  if (stops(first.status())) return first.status();
  if (first.ok()) result.first_lengths = firstLengths(*first);
  ASSIGN_OR_RETURN(const LengthSpectrum spectrum,
                   length ? lengthSpectrum(context, polygon, *length) : first);
  for (const ClosedGeodesic& geodesic : spectrum.geodesics) {
    result.lengths.push_back(geodesic.length);
  }
  result.complete_to = spectrum.complete_to;
  const Result<PantsDecomposition> pants = pantsDecomposition(context, polygon);
  if (stops(pants.status())) return pants.status();
  result.pants_curves = pants.status();
  if (pants.ok()) result.pants = {pants->coordinates.lengths, pants->coordinates.twists};
  return {};
}

}  // namespace

Result<LengthSpectrum> shortGeodesics(Context& context, const OrbitPolygon& polygon,
                                      double least_reach) {
  SpectrumOptions options;
  options.most_elements = kSignatureElements;
  ASSIGN_OR_RETURN(LengthSpectrum shortest, systoles(context, polygon, options));
  const double reach = std::max(least_reach, reachOf(shortest.geodesics.front().length));
  ASSIGN_OR_RETURN(LengthSpectrum spectrum, lengthSpectrum(context, polygon, reach, options));
  return spectrum.complete_to < shortest.complete_to ? std::move(shortest) : std::move(spectrum);
}

std::vector<double> firstLengths(const LengthSpectrum& spectrum) {
  const double cut = std::min(spectrum.complete_to,
                              std::max(kLeastReach, reachOf(spectrum.geodesics.front().length)));
  std::vector<double> lengths(kFirstLengths, cut);
  for (std::size_t i = 0; i < std::min(kFirstLengths, spectrum.geodesics.size()); ++i) {
    lengths[i] = std::min(cut, spectrum.geodesics[i].length);
  }
  return lengths;
}

Result<HyperbolicInvariants> hyperbolicInvariants(Context& context, const DiscreteMetric& metric,
                                                  std::optional<double> length) {
  ASSIGN_OR_RETURN(const HyperbolicTriangles triangles, hyperbolicTriangles(metric));
  ASSIGN_OR_RETURN(const FuchsianGroup group, computeFuchsianGroup(context, triangles));
  HyperbolicInvariants result;
  for (const Su11& generator : group.generators) {
    result.generators.push_back({generator.a, generator.b});
  }
  result.relation_residual = group.certificate.relation_residual;
  result.geodesics = addGeodesics(context, group, length, result);
  if (stops(result.geodesics)) return result.geodesics;
  return result;
}

std::vector<double> geodesicBoundaryLengths(const Connectivity& surface,
                                            const Uniformization& uniformization) {
  std::vector<double> lengths =
      boundaryLengths(surface, straightFaces(uniformization.metric).lengths);
  std::sort(lengths.begin(), lengths.end());
  return lengths;
}

}  // namespace moduli
