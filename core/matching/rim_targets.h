#pragma once

#include <vector>

/// Targets of a closed curve on another one, put in order.
namespace moduli {

/// A map of a circle to a circle that goes round once and never back, near the given one: with the
/// least sum of distances, after values are counted on from turn to turn so that they are nearest
/// to the best rotation. from, to: per point, shares of the whole in [0, 1); `from` ascending.
/// Returns per point its new value in [0, 1). Points that are alone with their values do not draw
/// others: a sum of distances does not know how far they are off. O(n log n), and O(500 n). Source:
/// isotonic regression with a heap of values, Stout 2013.
std::vector<double> orderedAroundCircle(const std::vector<double>& from,
                                        const std::vector<double>& to);

}  // namespace moduli
