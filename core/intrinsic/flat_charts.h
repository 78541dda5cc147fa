#pragma once

#include <complex>
#include <vector>

#include "core/mesh/connectivity.h"

/// Triangles of a flat metric in the plane, each in a chart of its own.
namespace moduli {

/// Per halfedge h = 3 f + c the vector from corner c to the next one, in a chart of face f that
/// keeps orientation; the three of a face sum up to 0, and twins have one length.
using FlatCharts = std::vector<std::complex<double>>;

/// Charts of triangles. lengths, angles: per halfedge the length of it and the angle at its tail,
/// as SignedTriangles. The longest side is the sum of the other two, so that short ones keep their
/// digits. O(F).
FlatCharts chartsOfTriangles(const std::vector<double>& lengths, const std::vector<double>& angles);

/// Twice the signed area of face f.
double doubledArea(const FlatCharts& charts, Index f);

}  // namespace moduli
