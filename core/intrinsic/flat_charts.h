#pragma once

#include <complex>
#include <vector>

#include "core/intrinsic/intrinsic_triangulation.h"

/// Triangles of a flat metric in the plane, each in a chart of its own.
namespace moduli {

/// Per halfedge h = 3 f + c the vector from corner c to the next one, in a chart of face f that
/// keeps orientation; the three of a face sum up to 0, and twins have one length.
using FlatCharts = std::vector<std::complex<double>>;

/// Charts of proper triangles. lengths, angles: per halfedge the length of it and the angle at its
/// tail. The longest side is the sum of the other two, so that short ones keep their digits. O(F).
FlatCharts chartsOfTriangles(const std::vector<double>& lengths, const std::vector<double>& angles);

/// Undoes the flips of a triangulation and carries its charts along: the faces that it had at first
/// get the straight edges between their corners in the unfolded metric, whatever kind of flip was
/// done. Faces that the metric turns over come out with a negative area. `triangulation` is a copy
/// that loses its history. O(flips).
FlatCharts undoFlips(IntrinsicTriangulation triangulation, FlatCharts charts);

/// Twice the signed area of face f.
double doubledArea(const FlatCharts& charts, Index f);

}  // namespace moduli
