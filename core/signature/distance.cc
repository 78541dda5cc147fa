#include "core/signature/distance.h"

#include <cmath>
#include <vector>

#include "core/forms/modular.h"
#include "core/signature/conformal_bounds.h"

namespace moduli {
namespace {

bool sameTopology(const Signature& a, const Signature& b) {
  return a.conformal->type == b.conformal->type && a.topology.genus == b.topology.genus &&
         a.topology.boundary_loops == b.topology.boundary_loops;
}

std::optional<double> torusDistance(const ConformalBlock& a, const ConformalBlock& b) {
  if (!a.tau || !b.tau) return std::nullopt;
  return *a.tau == *b.tau ? 0.0 : teichmullerDistance(*a.tau, *b.tau);
}

std::optional<double> annulusDistance(const ConformalBlock& a, const ConformalBlock& b) {
  if (!a.modulus || !b.modulus) return std::nullopt;
  return std::abs(std::log(*a.modulus) - std::log(*b.modulus)) / 2;
}

std::optional<double> conformalDistance(const Signature& a, const Signature& b) {
  if (!a.conformal || !b.conformal || !sameTopology(a, b)) return std::nullopt;
  switch (a.conformal->type) {
    case ConformalType::kSphere:
    case ConformalType::kDisk:
      return 0.0;
    case ConformalType::kTorus:
      return torusDistance(*a.conformal, *b.conformal);
    case ConformalType::kAnnulus:
      return annulusDistance(*a.conformal, *b.conformal);
    case ConformalType::kCircleDomain:
    case ConformalType::kHyperbolic:
    case ConformalType::kBordered:
      break;
  }
  return conformalBounds(a, b).largest();
}

/// Of the vectors, in double precision: what is indexed is what counts.
std::optional<double> vectorDistance(const std::vector<float>& x, const std::vector<float>& y) {
  if (x.empty() || x.size() != y.size()) return std::nullopt;
  double sum = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double difference = static_cast<double>(x[i]) - static_cast<double>(y[i]);
    sum += difference * difference;
  }
  return std::sqrt(sum);
}

}  // namespace

std::optional<double> signatureDistance(const Signature& a, const Signature& b, Space space) {
  if (a.descriptor_version != b.descriptor_version) return std::nullopt;
  switch (space) {
    case Space::kConformal:
      return conformalDistance(a, b);
    case Space::kMetric:
      return vectorDistance(a.vectors.metric, b.vectors.metric);
    case Space::kShape:
      break;
  }
  return vectorDistance(a.vectors.shape, b.vectors.shape);
}

SignatureDistances signatureDistances(const Signature& a, const Signature& b) {
  return {signatureDistance(a, b, Space::kConformal), signatureDistance(a, b, Space::kMetric),
          signatureDistance(a, b, Space::kShape)};
}

}  // namespace moduli
