#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/context.h"
#include "core/matching/cover_map.h"
#include "core/matching/relaxation.h"
#include "core/matching/sphere_domain.h"
#include "core/mesh/triangle_mesh.h"

/// From a map near an isometry to one of least distortion: all vertices move together, by
/// IsometricStep, as long as that helps; none folds a face.
///
/// Why: the errors of places that modes tell are alike over the length of the waves, so that no
/// pull towards them evens them out, while the distortion of a near isometry is least hard by the
/// right map. Vertices that move one by one come to rest long before it.
namespace moduli {

struct SettlingOptions {
  double pull = 4;          ///< Of the attractions, as Relaxation::setPull,
  double scale = 0.05;      ///< and their scale.
  int steps = 12;           ///< At most.
  double tolerance = 0.02;  ///< Of the excess, by which a step must lower it for another one.
};

/// map: of all vertices of `surface` to the domain's sphere, no face folded; stays so, and its
/// excess under these pulls does not rise. attractions: per vertex, in the domain's unit. Fails as
/// SpdSolver does. One factorization of 2 V unknowns and a few sweeps a step. Stages: "settle",
/// SpdSolver's.
Status settle(Context& context, const Connectivity& surface, const SphereDomain& domain,
              const std::vector<Attraction>& attractions, Relaxation& map,
              const SettlingOptions& options = {});

/// The same for surfaces with handles. map: of a to the cover of b, no face folded; stays so, and
/// within its homotopy class. targets: per vertex of a.
Status settle(Context& context, const TriangleMesh& a, const TriangleMesh& b,
              const CoverSurface& cover, const std::vector<SurfacePoint>& targets, CoverMap& map,
              const SettlingOptions& options = {});

}  // namespace moduli
