#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/hyperbolic/bounded_su11.h"
#include "core/hyperbolic/wide_su11.h"

/// Handles of a surface's group, how long they are, and moves that make them shorter.
namespace moduli {

/// Two elements whose commutators multiply to 1, in order: prod [a_k, b_k] = 1.
template <typename Element>
struct HandleOf {
  Element a, b;
};
using GroupHandle = HandleOf<WideSu11>;

/// A move that gains less is none.
inline constexpr double kLeastGain = 1e-6;

/// A lower bound in doubles, the length itself in 113 bits.
inline double lengthOf(const BoundedSu11& g) {
  return leastDisplacement(g);
}

inline double lengthOf(const WideSu11& g) {
  return displacement(rounded(g));
}

template <typename Element>
Element conjugate(const Element& by, const Element& g) {
  return by * g * inverse(by);
}

template <typename Element>
Element commutator(const HandleOf<Element>& h) {
  return h.a * h.b * inverse(h.a) * inverse(h.b);
}

template <typename Element>
HandleOf<Element> conjugate(const Element& by, const HandleOf<Element>& h) {
  return {conjugate(by, h.a), conjugate(by, h.b)};
}

template <typename Element>
double lengthOf(const HandleOf<Element>& h) {
  return lengthOf(h.a) + lengthOf(h.b);
}

/// The lengths of a handle's generators and of the corners a, a b, a b a^-1, .. of the polygon
/// whose sides they are, which begins at `corner` and is left there at its end.
template <typename Element>
double lengthFrom(Element& corner, const HandleOf<Element>& h, double corner_weight) {
  double total = lengthOf(h);
  for (const Element& side : {h.a, h.b, inverse(h.a), inverse(h.b)}) {
    corner = corner * side;
    total += corner_weight * lengthOf(corner);
  }
  return total;
}

/// What takes the place of as many handles from `first` on.
struct HandleReplacement {
  std::size_t first = 0;
  std::vector<GroupHandle> handles;
  double gain = 0;  ///< Of the sum of lengths.
};

/// The move that makes the sum of lengths smaller by the most, if any does by more than kLeastGain:
/// twists along a_k, along b_k, along the loops that link neighbouring handles and along those
/// around several handles, and exchanges of neighbours. Moves that are seen to gain nothing in
/// doubles, with a bound of their error, are not looked at in 113 bits. O(g^3).
std::optional<HandleReplacement> bestMove(const std::vector<GroupHandle>& handles,
                                          double corner_weight);

}  // namespace moduli
