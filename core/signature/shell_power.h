#pragma once

#include <vector>

#include "core/base/context.h"
#include "core/signature/surface_points.h"

namespace moduli {

/// Degrees l = 0 .. kShellDegree of spherical harmonics, and shells about the centroid.
inline constexpr int kShellDegree = 4;
inline constexpr int kShellCount = 4;
inline constexpr int kShellPowerLength = (kShellDegree + 1) * kShellCount * (kShellCount + 1) / 2;

/// What rotations and reflections keep of how a surface, and the solid that it bounds, lie on soft
/// concentric shells. a_l is the kShellCount x (2 l + 1) matrix of harmonic coefficients of degree
/// l on all shells; a rotation multiplies it by an orthogonal matrix from the right, and keeps
/// s_l = (a_l a_l^T)^(1/2), which knows how the shells are turned against each other, too. As
/// |s - s'| <= sqrt(2) min |a - a' R|, it is Lipschitz in the densities. Strong parts are pressed
/// by the matrix function sqrt(s + 0.01) - 0.1.
/// Per degree the upper triangle of the matrix row by row, entries off the diagonal times sqrt(2):
/// kShellPowerLength numbers each.
struct ShellPower {
  std::vector<double> surface;  ///< Of the share of area.
  std::vector<double> solid;  ///< Of the indicator function: inside positive where faces look out.
};

/// Shells are trapezoids in |x| / (radius of gyration) that sum to 1 from 0.4 to 2.7. The solid is
/// integrated by the divergence theorem over cones from the centroid, so that surfaces with
/// boundary have one as well. Fails with kCancelled, kDeadlineExceeded. O(points degree^2), about
/// 1 F. Source: Kazhdan, Funkhouser, Rusinkiewicz 2003, with the shells' relative rotations kept.
Result<ShellPower> shellPower(Context& context, const SurfacePoints& points);

}  // namespace moduli
