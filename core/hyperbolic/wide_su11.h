#pragma once

#include <array>
#include <cfloat>
#include <complex>
#include <vector>

#include "core/hyperbolic/su11.h"
#include "core/topology/homotopy_basis.h"

/// SU(1, 1) in 113 bits: words of dozens of letters are multiplied without loss, and what is
/// rounded to doubles in the end is right to the last bit.
namespace moduli {

#if LDBL_MANT_DIG >= 113
using Wide = long double;
#else
using Wide = __float128;
#endif

using WideComplex = std::complex<Wide>;

/// As Su11.
struct WideSu11 {
  WideComplex a = Wide{1};
  WideComplex b = Wide{0};
};

inline WideSu11 operator*(const WideSu11& g, const WideSu11& h) {
  return {g.a * h.a + g.b * std::conj(h.b), g.a * h.b + g.b * std::conj(h.a)};
}

inline WideSu11 inverse(const WideSu11& g) {
  return {std::conj(g.a), -g.b};
}

/// The nearest doubles.
Su11 rounded(const WideSu11& g);
/// The same element, of determinant 1 to 113 bits: the direction of a and b itself are kept.
WideSu11 widened(const Su11& g);

/// The product of letters: k + 1 stands for letters[k], -(k + 1) for its inverse. O(n).
WideSu11 evaluate(const std::vector<WideSu11>& letters, const Word& word);

/// How far a word is from one of 1 and -1.
double relationResidual(const std::vector<WideSu11>& letters, const Word& word);

/// What moving elements by little makes of a relation.
struct RelationCorrection {
  std::vector<WideSu11> letters;
  double residual_before = 0, residual = 0;  ///< Of the word, from +-1.
  /// The largest move of a letter X -> X exp(m): the length of the translation and the angle of the
  /// rotation in exp(m), as the hypotenuse of both.
  double moved = 0;
};

/// Moves the letters until the word is +-1 to some 100 bits; of all such moves the smallest, in the
/// sum of the squares of their lengths. Newton's method, for words that are nearly +-1: two or
/// three steps of O(n). Fails with kResidualTooLarge where the word is further than 1e-3 from +-1,
/// and with kNoConvergence.
Result<RelationCorrection> correctRelation(const std::vector<Su11>& letters, const Word& word);

}  // namespace moduli
