#include "server/service/duplicates.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <optional>
#include <string>
#include <vector>

#include "core/base/parallel.h"
#include "core/retrieval/clusters.h"
#include "core/signature/distance.h"
#include "server/rpc/convert.h"
#include "server/service/collection_signatures.h"
#include "server/service/request.h"

namespace moduli {
namespace {

/// Rounding: what a mesh is from its renumbered or moved copy.
constexpr double kDefaultThreshold = 1e-6;

/// As far as distances look at it, the signature of the mirror image: spectra, energies and moduli
/// stay, the lattice of a torus is mirrored.
Signature mirrored(Signature signature) {
  if (signature.conformal && signature.conformal->tau) {
    std::complex<double>& tau = *signature.conformal->tau;
    tau = {-tau.real(), tau.imag()};
  }
  return signature;
}

class Comparison {
 public:
  Comparison(const std::vector<SignedShape>& shapes, const v1::FindDuplicatesRequest& request)
      : shapes_(shapes),
        space_(fromProto(request.space()).value_or(Space::kShape)),
        threshold_(request.has_threshold() ? request.threshold() : kDefaultThreshold),
        mirror_(request.mirror()),
        same_scale_(request.same_scale()) {}

  double threshold() const { return threshold_; }

  /// The pairs of a shape with later ones within the threshold.
  std::vector<ItemPair> pairsOf(std::size_t a) const {
    std::vector<ItemPair> pairs;
    const Signature& own = shapes_[a].signature;
    const std::optional<Signature> mirror = mirror_ ? std::optional(mirrored(own)) : std::nullopt;
    for (std::size_t b = a + 1; b < shapes_.size(); ++b) {
      const Signature& other = shapes_[b].signature;
      if (same_scale_ && !(sizeDifference(own, other) <= threshold_)) continue;
      std::optional<double> distance = signatureDistance(own, other, space_);
      if (distance && mirror) {
        distance =
            std::min(*distance, signatureDistance(*mirror, other, space_).value_or(*distance));
      }
      if (distance && *distance <= threshold_) pairs.push_back({a, b, *distance});
    }
    return pairs;
  }

 private:
  /// |log| of the ratio of lengths.
  static double sizeDifference(const Signature& a, const Signature& b) {
    return std::abs(std::log(a.topology.area / b.topology.area)) / 2;
  }

  const std::vector<SignedShape>& shapes_;
  const Space space_;
  const double threshold_;
  const bool mirror_, same_scale_;
};

}  // namespace

Result<v1::Duplicates> findDuplicates(Context& context, const Backend& backend,
                                      const v1::FindDuplicatesRequest& request) {
  ASSIGN_OR_RETURN(const Catalog* catalog, backend.catalog());
  ASSIGN_OR_RETURN(const std::string collection, parseCollectionName(request.parent()));
  ASSIGN_OR_RETURN(const Filter filter, Filter::parse(request.filter()));
  ASSIGN_OR_RETURN(std::vector<SignedShape> shapes,
                   signaturesOf(context, *catalog, collection, filter));
  std::sort(shapes.begin(), shapes.end(),
            [](const SignedShape& a, const SignedShape& b) { return a.name < b.name; });
  const Context::Stage stage(context, "compare");
  const Comparison comparison(shapes, request);
  std::vector<std::vector<ItemPair>> found(shapes.size());
  parallelBlocks(shapes.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t a = begin; a < end && context.check().ok(); ++a) {
      found[a] = comparison.pairsOf(a);
    }
  });
  RETURN_IF_ERROR(context.check());
  std::vector<ItemPair> pairs;
  for (const std::vector<ItemPair>& some : found) {
    pairs.insert(pairs.end(), some.begin(), some.end());
  }
  ASSIGN_OR_RETURN(const std::vector<Cluster> clusters,
                   clusterPairs(shapes.size(), pairs, comparison.threshold()));
  v1::Duplicates message;
  message.set_shapes(static_cast<std::int32_t>(shapes.size()));
  for (const Cluster& cluster : clusters) {
    v1::DuplicateCluster& one = *message.add_clusters();
    for (const std::size_t member : cluster.members) one.add_names(shapes[member].name);
    one.set_linkage(cluster.linkage);
  }
  return message;
}

}  // namespace moduli
