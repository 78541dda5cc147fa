#pragma once

#include <optional>

#include "core/signature/signature.h"

namespace moduli {

/// Distances of two signatures; a space where none is defined is empty.
struct SignatureDistances {
  /// Spheres: 0. Tori: the Teichmüller distance. Different types: empty.
  std::optional<double> conformal;
  std::optional<double> metric;  ///< Euclidean distance of the amplitude spectra.
  std::optional<double> shape;
};

SignatureDistances signatureDistances(const Signature& a, const Signature& b);

/// One of them.
std::optional<double> signatureDistance(const Signature& a, const Signature& b, Space space);

}  // namespace moduli
