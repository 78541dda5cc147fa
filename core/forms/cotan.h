#pragma once

#include <vector>

#include "core/linalg/spd_solver.h"
#include "core/mesh/connectivity.h"

/// The cotan operators of a discrete metric, by stable formulas. A metric is one length per edge
/// that satisfies the strict triangle inequality in every face (see core/intrinsic/mollify.h).
namespace moduli {

/// The exponent k with the longest length between 2^(k-1) and 2^k. lengths: finite, not all 0.
int lengthExponent(const std::vector<double>& lengths);

/// The lengths times 2^-lengthExponent, the power of two that brings the longest between 1/2 and 1:
/// no digit changes, and areas neither overflow nor vanish, whatever the units of a model. For what
/// is free of scale. lengths: finite, >= 0, not all 0. O(E).
std::vector<double> unitLengths(const std::vector<double>& lengths);

/// Area of every face by Kahan's ordering of Heron's formula. lengths: per edge. O(F).
std::vector<double> faceAreas(const Connectivity& surface, const std::vector<double>& lengths);

/// Per halfedge h = 3 f + c the cotangent of the angle opposite to h in its face. O(F).
std::vector<double> oppositeCotangents(const Connectivity& surface,
                                       const std::vector<double>& lengths);

/// Weight of every edge: half the sum of the opposite cotangents (one term on the boundary). May be
/// negative; the stiffness matrix is positive semidefinite all the same. O(F). Source: MATH 0.
std::vector<double> cotanWeights(const Connectivity& surface, const std::vector<double>& lengths);

/// Stiffness L = d0^T W d0 (V x V), lower triangle; constants are its kernel on each component.
SparseMatrix stiffnessMatrix(const Connectivity& surface, const std::vector<double>& weights);

/// The stiffness matrix without the row and column of vertex `pinned` ((V - 1) x (V - 1)): positive
/// definite on a connected surface. Vertex v > pinned becomes row v - 1.
SparseMatrix pinnedStiffness(const Connectivity& surface, const std::vector<double>& weights,
                             Index pinned);

/// One third of the area of the faces around each vertex.
std::vector<double> vertexAreas(const Connectivity& surface, const std::vector<double>& lengths);

}  // namespace moduli
