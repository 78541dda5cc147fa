#pragma once

#include <vector>

#include "core/mesh/connectivity.h"
#include "core/topology/integer_matrix.h"

namespace moduli {

/// The value of a cochain on an edge, along the edge's direction.
struct CochainTerm {
  Index edge = kNone;
  Integer value = 0;
  bool operator==(const CochainTerm&) const = default;
};

/// A 1-cochain with whole values, of which only those other than 0 are kept, ascending by edge: the
/// loops that carry the topology of a surface cross few of its edges.
using Cochain = std::vector<CochainTerm>;

/// Sorts terms by edge, adds up those of one edge and drops zeros.
Cochain gatherTerms(std::vector<CochainTerm> terms);

/// Values of combinations stay within this, so that intersection numbers never overflow.
inline constexpr Integer kLargestCochainValue = Integer{1} << 30;

/// Sum of coefficients(row, k) * cochains[k]. Fails with kOverflow where a value is larger than
/// kLargestCochainValue. O(n log n) for n terms.
Result<Cochain> combineCochains(const std::vector<Cochain>& cochains,
                                const IntegerMatrix& coefficients, Eigen::Index row);

/// Intersection numbers of closed cochains: entry (i, k) is the integral of a[i] ^ b[k]. On a
/// surface with boundary the a or the b must vanish on the boundary's edges. No value of an a times
/// one of a b is larger than kLargestCochainValue. O(E + |a| n) for n terms of b in all. Source:
/// MATH 1 (wedge product of Whitney forms).
IntegerMatrix intersectionMatrix(const Connectivity& surface, const std::vector<Cochain>& a,
                                 const std::vector<Cochain>& b);

}  // namespace moduli
