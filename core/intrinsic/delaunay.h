#pragma once

#include <cstddef>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/intrinsic/intrinsic_triangulation.h"

/// Intrinsic Delaunay triangulations by flips.
///
/// In half chords an edge is Delaunay in E2, H2 and S2 alike if cos A_k + cos A_l >= 0, with A_k,
/// A_l the angles opposite the edge in the two Euclidean triangles of half chords. Ties (cocircular
/// points, within rounding) count as Delaunay. Source: MATH 6.7; Springborn 2019, section 4.
namespace moduli {

/// cos A_k + cos A_l of two triangles with half chords (edge, a, b) and (edge, c, d); below 0 where
/// the edge is not Delaunay. Triangles need not satisfy the triangle inequality.
double delaunaySlack(double edge, double a, double b, double c, double d);

/// What rounding may do to a slack: 1e-12 and more in needles.
double slackTolerance(double edge, double a, double b, double c, double d);

/// Whether h is a boundary edge, has one face on both sides, or passes the test within rounding.
bool isDelaunay(const IntrinsicTriangulation& triangulation, Index h);

/// Flips until all edges are Delaunay, as the geometry of a Euclidean surface stands: the surface
/// remains the same, its edges become other geodesics. Half chords must be of proper triangles.
/// Returns the number of flips. Fails with kNoConvergence where rounding keeps it from ending,
/// kCancelled, kDeadlineExceeded. O(E) when few edges need it; finite always (Rivin 1994;
/// Indermitte et al. 2001).
Result<std::size_t> flipToDelaunayIsometric(Context& context,
                                            IntrinsicTriangulation& triangulation);

/// Flips by Ptolemy's relation until all edges are Delaunay for the half chords
/// x_ij * scale_i * scale_j, which is also how half chords of the new edges scale. Intermediate
/// triangles may break the triangle inequality; those of the result do not. scale: per vertex, > 0.
/// Returns and fails as above. Source: Gu, Luo, Sun and Wu 2018; Springborn 2019.
Result<std::size_t> flipToDelaunayPtolemy(Context& context, IntrinsicTriangulation& triangulation,
                                          const std::vector<double>& scale);

/// The same where only these edges (by a halfedge of each) may fail the test at first.
Result<std::size_t> flipToDelaunayPtolemy(Context& context, IntrinsicTriangulation& triangulation,
                                          const std::vector<double>& scale,
                                          std::vector<Index> suspects);

}  // namespace moduli
