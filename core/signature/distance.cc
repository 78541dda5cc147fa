#include "core/signature/distance.h"

#include <cmath>

#include "core/forms/modular.h"
#include "core/signature/amplitudes.h"

namespace moduli {
namespace {

std::optional<double> conformalDistance(const Signature& a, const Signature& b) {
  if (!a.conformal || !b.conformal || a.conformal->type != b.conformal->type) return std::nullopt;
  switch (a.conformal->type) {
    case ConformalType::kSphere:
      return 0.0;  // All spheres are conformally one.
    case ConformalType::kTorus:
      if (!a.conformal->tau || !b.conformal->tau) return std::nullopt;
      if (*a.conformal->tau == *b.conformal->tau) return 0.0;
      return teichmullerDistance(*a.conformal->tau, *b.conformal->tau);
    case ConformalType::kDisk:
    case ConformalType::kAnnulus:
    case ConformalType::kCircleDomain:
    case ConformalType::kHyperbolic:
    case ConformalType::kBordered:
      return std::nullopt;
  }
  return std::nullopt;
}

std::optional<double> amplitudeDistance(const Signature& a, const Signature& b, Space space) {
  const auto x = amplitudes(a, space);
  const auto y = amplitudes(b, space);
  if (!x || !y || x->size() != y->size()) return std::nullopt;
  double sum = 0;
  for (std::size_t i = 0; i < x->size(); ++i) {
    const double difference = (*x)[i] - (*y)[i];
    sum += difference * difference;
  }
  return std::sqrt(sum);
}

}  // namespace

std::optional<double> signatureDistance(const Signature& a, const Signature& b, Space space) {
  if (a.descriptor_version != b.descriptor_version) return std::nullopt;
  return space == Space::kConformal ? conformalDistance(a, b) : amplitudeDistance(a, b, space);
}

SignatureDistances signatureDistances(const Signature& a, const Signature& b) {
  return {signatureDistance(a, b, Space::kConformal), signatureDistance(a, b, Space::kMetric),
          signatureDistance(a, b, Space::kShape)};
}

}  // namespace moduli
