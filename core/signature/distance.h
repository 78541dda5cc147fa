#pragma once

#include <optional>

#include "core/signature/signature.h"

namespace moduli {

/// Distances of two signatures; a space where none is defined is empty.
struct SignatureDistances {
  /// Spheres, disks: 0. Tori, annuli: the Teichmüller distance. Other types: the lower bound of it
  /// that the energy spectra give, the largest |log(energy_1 / energy_2)| / 2, up to their errors.
  /// Different types, genera or numbers of boundary loops: empty.
  std::optional<double> conformal;
  /// Euclidean distances of the vectors, for any two surfaces whatever their topologies.
  std::optional<double> metric;
  std::optional<double> shape;
};

SignatureDistances signatureDistances(const Signature& a, const Signature& b);

/// One of them.
std::optional<double> signatureDistance(const Signature& a, const Signature& b, Space space);

}  // namespace moduli
