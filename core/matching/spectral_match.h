#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/context.h"
#include "core/matching/functional_map.h"
#include "core/matching/spectral_surface.h"
#include "core/spherical/surface_point.h"

namespace moduli {

struct SpectralMatchOptions {
  bool mirror = false;         ///< Maps that turn orientation over instead of those that keep it.
  std::size_t triplets = 100;  ///< Of features, that maps are started from.
  std::size_t finalists = 8;   ///< Different maps that are refined to the end.
  double enough = 0;  ///< Maps of less defect are kept, however much better the best one is.
};

/// A map between surfaces that bending leaves nearly as it was.
struct SpectralMatch {
  /// See functional_map.h. Of the best match of all modes, of others of the first 60:
  /// withAllModes.
  Eigen::MatrixXd functional;
  /// orthogonalityDefect of its first 60 modes: some hundredths for near isometries of a sort that
  /// limbs turning in their joints are, a third and more for maps that are none.
  double defect = 0;
  double orientation = 0;  ///< As OrientationTest has it.
};

/// Maps from a to b, best first, each far from all better ones; more than one of nearly the same
/// defect where a surface is nearly symmetric. Empty where no start leads to a map of the wanted
/// orientation.
///
/// Starts: triplets of features whose distances from each other agree within a quarter, those of
/// the most similar wave kernel signatures first; and the lowest modes with all signs. Each is
/// refined on the coarse samples to 20 modes from 4, 6, 10 and 14: low modes alone may draw a map
/// to a mirror image in thin parts. On the way mirror images and all but the best 32 different maps
/// are left out, three times. The best different ones go on on the fine samples to 60 modes,
/// without those of 4 times the least defect halfway, and the best of these to all. Fails with
/// kCancelled and kDeadlineExceeded. A tenth of a second whatever the size. Stages: "align",
/// "refine". Source: MATH 9.5; the refinement is Melzi et al. 2019, both ways at once.
Result<std::vector<SpectralMatch>> matchSpectra(Context& context, const SpectralSurface& a,
                                                const SpectralSurface& b,
                                                const SpectralMatchOptions& options = {});

/// The match with the functional map of all modes, refined from the one it has. Fails with
/// kCancelled and kDeadlineExceeded. Stage: "refine".
Result<SpectralMatch> withAllModes(Context& context, const SpectralSurface& a,
                                   const SpectralSurface& b, SpectralMatch match);

/// The point of b that each vertex of a goes to: where the surface that b's modes make of it in as
/// many dimensions is nearest to the image of the vertex' own. From the nearest fine sample
/// downhill, then the nearest point of the faces around the vertex found. O(V modes (samples +
/// 20)).
Result<std::vector<SurfacePoint>> correspondingPoints(Context& context, const SpectralSurface& a,
                                                      const SpectralSurface& b,
                                                      const Eigen::MatrixXd& functional);

}  // namespace moduli
