#pragma once

#include <optional>

#include "core/signature/signature.h"

namespace moduli {

/// Distances of two signatures; a space where none is defined is empty.
struct SignatureDistances {
  /// Spheres, disks: 0. Tori, annuli: the Teichmüller distance. Other types: the largest one of its
  /// lower bounds by energies, closed geodesics and boundary geodesics (conformalBounds) that both
  /// signatures know, up to their errors; it is 0 for mirror images, and where one of three
  /// surfaces knows less than the others, the triangle inequality may fail. Different types, genera
  /// or numbers of boundary loops, and nothing that both know: empty.
  std::optional<double> conformal;
  /// Euclidean distances of the vectors, for any two surfaces whatever their topologies.
  std::optional<double> metric;
  std::optional<double> shape;
};

SignatureDistances signatureDistances(const Signature& a, const Signature& b);

/// One of them.
std::optional<double> signatureDistance(const Signature& a, const Signature& b, Space space);

}  // namespace moduli
