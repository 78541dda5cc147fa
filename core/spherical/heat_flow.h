#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/context.h"
#include "core/mesh/connectivity.h"
#include "core/spherical/sphere_map.h"

namespace moduli {

struct HeatFlowOptions {
  /// Time of one step, for a surface scaled to the area 4 pi of the sphere. Stable for any.
  double step = 100;
  double tangent_tolerance = 1e-9;  ///< Largest tangential Laplacian of a vertex when it is done.
  double energy_tolerance = 1e-13;  ///< Or the relative decrease of the energy in one step.
  int max_steps = 1000;
  bool accept_folds = false;  ///< Return a folded map, which its quality tells, and do not fail.
};

struct HeatFlowMap {
  Points3 points;  ///< Per vertex, on the unit sphere, centred, outward orientation kept.
  MapQuality quality;
  /// Dirichlet energy 1/2 sum w |phi_i - phi_j|^2 at the start and after each step, falling
  /// strictly; 4 pi for a conformal map of a smooth surface.
  std::vector<double> energies;
  double tangent_residual = 0;  ///< What is left of the largest tangential Laplacian.
  double centering_residual = 0;
  bool from_gauss_map = false;  ///< Otherwise from Tutte's map.
  std::size_t flips = 0;        ///< Of edges, to weights that are not negative.
};

/// Conformal map of a closed connected genus-0 surface to the sphere by the heat flow of harmonic
/// maps. It starts at the Gauss map or, where that folds or there are no positions, at Tutte's map,
/// and descends by semi-implicit steps
///
///   (A + eps L) phi' = A phi + eps <L phi, phi> phi,
///
/// whose fixed points are the harmonic maps for any eps (without the last term they are so for
/// small eps alone), projected back to the sphere and centred by a Möbius map with the vertex areas
/// A. What would only undo that centring is taken out of each step; so the flow ends at the map of
/// least energy among the centred ones. L has the cotan weights of the surface or, where some are
/// negative, of its intrinsic Delaunay triangulation.
///
/// lengths: per edge, proper triangles. positions: per vertex, or empty. Up to a rotation the map
/// depends on the lengths alone, as far as the minimum does not depend on the start. Fails with
/// kUnsupportedTopology, kInvalidOption (number of positions, options), kFoldedMap (with the number
/// of flipped faces), kNoConvergence, and as SpdSolver and centerByMobius do. One factorization
/// (Tutte: two) and one solve a step: about 2 F and 0.2 F a step, 15 to 60 steps. Source: Gu et
/// al.; MATH 2.1, 2.2, 2.7.
Result<HeatFlowMap> mapToSphereHeatFlow(Context& context, const Connectivity& surface,
                                        const std::vector<double>& lengths,
                                        const std::vector<Eigen::Vector3d>& positions,
                                        const HeatFlowOptions& options = {});

}  // namespace moduli
