#include "core/signature/conformal_vector.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/forms/energy_lattice.h"
#include "core/forms/modular.h"
#include "core/signature/conformal_block.h"

namespace moduli {
namespace {

const std::array<double, kThetaCount> kThetaTimes = {1, 1.5, 2, 3};

static_assert(kHyperbolicLength == 2 + kEnergySpectrumLength + kThetaCount + kFirstLengths);

/// log(value) / 2 of the first `count` values; 0 for those that are not there.
void appendLogs(const std::vector<double>& values, std::size_t count, std::vector<double>& result) {
  for (std::size_t i = 0; i < count; ++i) {
    result.push_back(i < values.size() ? std::log(values[i]) / 2 : 0.0);
  }
}

void appendThetas(const std::vector<double>& energies, std::vector<double>& result) {
  std::vector<double> features(kThetaCount, 0.0);
  if (!energies.empty()) {
    features = spectrumThetaFeatures(energies, {kThetaTimes.begin(), kThetaTimes.end()});
  }
  for (const double feature : features) result.push_back(feature / 2);
}

std::vector<double> hyperbolicVector(const ConformalBlock& block, const SignatureTopology& topology,
                                     const std::vector<double>& first_lengths) {
  if (block.energy_spectrum.empty() && first_lengths.empty() && block.boundary_lengths.empty()) {
    return {};
  }
  std::vector<double> result = {kTopologyStep * topology.genus,
                                kTopologyStep * topology.boundary_loops};
  appendLogs(block.energy_spectrum, kEnergySpectrumLength, result);
  appendThetas(block.energy_spectrum, result);
  appendLogs(first_lengths, kFirstLengths, result);
  if (block.type != ConformalType::kHyperbolic) {
    appendLogs(block.boundary_lengths, kBoundaryCount, result);
  }
  return result;
}

}  // namespace

std::vector<double> conformalVector(const ConformalBlock& block, const SignatureTopology& topology,
                                    const std::vector<double>& first_lengths) {
  switch (block.type) {
    case ConformalType::kSphere:
    case ConformalType::kDisk:
      return {0.0};  // An index needs a coordinate all the same.
    case ConformalType::kAnnulus:
      if (!block.modulus) return {};
      return {std::log(*block.modulus) / 2};
    case ConformalType::kTorus: {
      if (!block.tau) return {};
      const auto features = modularFeatures(*block.tau);
      return {features.begin(), features.end()};
    }
    case ConformalType::kCircleDomain:
    case ConformalType::kHyperbolic:
    case ConformalType::kBordered:
      break;
  }
  return hyperbolicVector(block, topology, first_lengths);
}

std::size_t conformalVectorLength(ConformalType type) {
  switch (type) {
    case ConformalType::kSphere:
    case ConformalType::kDisk:
    case ConformalType::kAnnulus:
      return 1;
    case ConformalType::kTorus:
      return modularFeatures({0, 1}).size();
    case ConformalType::kHyperbolic:
      return kHyperbolicLength;
    case ConformalType::kCircleDomain:
    case ConformalType::kBordered:
      break;
  }
  return kBorderedLength;
}

}  // namespace moduli
