#pragma once

#include <cstdint>

namespace moduli {

/// How one number per vertex changes the lengths of edges.
enum class Scheme : std::uint8_t {
  kVertexScaling,      ///< Half chords times e^{(u_i + u_j) / 2}; with flips, always solvable.
  kThurston,           ///< Circles that meet at fixed angles in [0, pi/2].
  kTangential,         ///< Circles that touch.
  kInversiveDistance,  ///< Circles at fixed inversive distance; reproduces the given lengths.
};

/// How a metric of the wanted curvature is found.
enum class RicciSolver : std::uint8_t {
  kNewton,  ///< Newton's method on the convex energy.
  kFlow,    ///< The Ricci flow itself, semi-implicit in time.
  /// Along the affine normals of the energy's level sets, with third derivatives. About as many
  /// steps as Newton's method takes, each of them dearer: a demonstration and a cross-check.
  kAffineNormal,
  kLbfgs,  ///< Limited-memory BFGS: gradients alone, some hundred cheap steps.
};

}  // namespace moduli
