#include "tests/bench/retrieval/descriptors.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/mesh/sample_tools.h"
#include "core/signature/compute.h"

namespace moduli {
namespace {

using Vectors = std::vector<std::optional<DescriptorVector>>;

DescriptorVector vectorOf(const std::vector<float>& values, std::string domain) {
  return {std::move(domain), std::vector<double>(values.begin(), values.end())};
}

Result<Vectors> signatureVectors(Context& context, const PreparedMesh& prepared) {
  ASSIGN_OR_RETURN(const Signature signature, computeSignature(context, prepared));
  Vectors vectors(3);
  if (signature.conformal) {
    const std::string topology = std::to_string(static_cast<int>(signature.conformal->type)) + '/' +
                                 std::to_string(signature.topology.genus) + '/' +
                                 std::to_string(signature.topology.boundary_loops);
    vectors[0] = vectorOf(signature.vectors.conformal, topology);
  }
  if (!signature.vectors.metric.empty()) vectors[1] = vectorOf(signature.vectors.metric, "");
  if (!signature.vectors.shape.empty()) vectors[2] = vectorOf(signature.vectors.shape, "");
  return vectors;
}

// Random points, evenly over the area.
class SurfacePoints {
 public:
  explicit SurfacePoints(const TriangleMesh& mesh) : mesh_(mesh), sums_(mesh.faceAreas()) {
    for (std::size_t f = 1; f < sums_.size(); ++f) sums_[f] += sums_[f - 1];
  }

  Eigen::Vector3d draw(SampleRandom& random) const {
    const double target = random.uniform() * sums_.back();
    const auto place = std::upper_bound(sums_.begin(), sums_.end() - 1, target) - sums_.begin();
    const Triangle& t = mesh_.connectivity().face(static_cast<Index>(place));
    const double root = std::sqrt(random.uniform()), side = random.uniform();
    const auto& p = mesh_.positions();
    return (1 - root) * p[t[0]] + root * (1 - side) * p[t[1]] + root * side * p[t[2]];
  }

 private:
  const TriangleMesh& mesh_;
  std::vector<double> sums_;
};

Result<Vectors> d2Vectors(Context& context, const PreparedMesh& prepared) {
  constexpr std::size_t kPairs = 1U << 19U, kBins = 64;
  constexpr double kRange = 3;
  RETURN_IF_ERROR(context.check());
  const SurfacePoints points(prepared.mesh);
  SampleRandom random(1);
  std::vector<double> distances(kPairs);
  double mean = 0;
  for (double& distance : distances) {
    distance = (points.draw(random) - points.draw(random)).norm();
    mean += distance / kPairs;
  }
  DescriptorVector cumulative{"", std::vector<double>(kBins, 0)};
  for (const double distance : distances) {
    const double bin = distance / mean / kRange * kBins;
    if (bin < kBins) cumulative.values[static_cast<std::size_t>(bin)] += 1.0 / kPairs;
  }
  for (std::size_t i = 1; i < kBins; ++i) cumulative.values[i] += cumulative.values[i - 1];
  for (double& value : cumulative.values) value *= kRange / kBins;
  return Vectors{cumulative};
}

Result<Vectors> laplaceVectors(Context& context, const PreparedMesh& prepared) {
  ASSIGN_OR_RETURN(std::vector<double> spectrum, laplaceSpectrum(context, prepared.mesh, 50));
  return Vectors{DescriptorVector{"", std::move(spectrum)}};
}

}  // namespace

double descriptorDistance(const std::optional<DescriptorVector>& a,
                          const std::optional<DescriptorVector>& b) {
  if (!a || !b || a->domain != b->domain || a->values.size() != b->values.size()) {
    return std::numeric_limits<double>::infinity();
  }
  double sum = 0;
  for (std::size_t i = 0; i < a->values.size(); ++i) {
    sum += (a->values[i] - b->values[i]) * (a->values[i] - b->values[i]);
  }
  return std::sqrt(sum);
}

Descriptor moduliDescriptor() {
  return {{"conformal", "metric", "shape"}, signatureVectors};
}

Descriptor d2Descriptor() {
  return {{"D2"}, d2Vectors};
}

Descriptor laplaceDescriptor() {
  return {{"LB"}, laplaceVectors};
}

}  // namespace moduli
