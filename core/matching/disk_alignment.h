#pragma once

#include <complex>
#include <vector>

#include "core/base/status.h"
#include "core/spherical/mobius_map.h"

namespace moduli {

/// Where a point of the unit disk ought to go on another unit disk; both of modulus at most 1.
struct DiskPair {
  std::complex<double> source, target;
};

/// The automorphism of the disk that takes the sources nearest to their targets: with the least sum
/// of squared distances on the half of the sphere over the disk (diskToSphere), beside the mean of
/// which stands `rotation_preference` times 2 (cosh d - 1), d being the hyperbolic distance by
/// which it moves the centre. Of the maps that take a pair inside exactly and turn the others as
/// well as can be, the best one is improved by Newton's method of Gauss. Commutes with rotations of
/// either disk. pairs: at least one. Fails with kInvalidOption (no pairs, points outside). O(n^2).
/// Source: MATH 9.2.
Result<MobiusMap> alignDisks(const std::vector<DiskPair>& pairs, double rotation_preference);

}  // namespace moduli
