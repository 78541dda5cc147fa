#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/matching/spectral_surface.h"

/// Maps between surfaces as matrices between their modes, and their refinement.
///
/// A functional map of k modes from a to b is a k x k matrix C with functions_a(i) C close to
/// functions_b(j) where vertex i of a corresponds to vertex j of b (rows). Isometries have
/// orthogonal ones.
/// Source: Ovsjanikov et al. 2012; Melzi et al. 2019 (spectral upsampling); MATH 9.5.
namespace moduli {

/// The modes at the samples of a surface.
struct SampledModes {
  Eigen::MatrixXd functions;  ///< modes x samples.
  Eigen::VectorXd weights;    ///< Per sample, sum 1.
};
SampledModes sampleModes(const SpectralSurface& surface, const MatchSamples& samples);

/// Which sample corresponds to which, both ways.
struct SampleMaps {
  std::vector<Index> there;  ///< Per sample of a the number of one of b.
  std::vector<Index> back;   ///< Per sample of b the number of one of a.
};

/// The matrix that fits both maps best in the least squares, weighted by the areas of the samples.
/// Both ways at once: a map one way alone may collapse, and nothing draws it apart again.
/// k: at least 1, at most the modes of either. O(samples k^2).
Eigen::MatrixXd fitFunctionalMap(const SampledModes& a, const SampledModes& b,
                                 const SampleMaps& maps, Eigen::Index k);

/// Samples that are nearest to each other among the rows functions_a C and functions_b, as far as
/// floats tell distances apart; the first of several.
/// O(samples_a samples_b k).
SampleMaps nearestSamples(const SampledModes& a, const SampledModes& b,
                          const Eigen::MatrixXd& functional);

/// |C^T C - 1|^2 / k in Frobenius's norm: 0 for isometries.
double orthogonalityDefect(const Eigen::MatrixXd& functional);

/// Tells whether functional maps to one surface keep orientation, by the sense in which the images
/// of small triangles run, seen from outside.
class OrientationTest {
 public:
  /// modes: of the functional maps that will be asked about; at most those of either surface.
  OrientationTest(const SpectralSurface& a, const SpectralSurface& b, Eigen::Index modes);

  /// From -1, a mirror image everywhere, to 1. functional: of at most so many modes. maps: of the
  /// coarse samples.
  double operator()(const Eigen::MatrixXd& functional, const SampleMaps& maps) const;

 private:
  Eigen::MatrixXd first_, second_;        ///< samples of a x modes: along two sides of a face.
  Eigen::MatrixXd coordinates_;           ///< modes x 3: of b.
  std::vector<Eigen::Vector3d> normals_;  ///< Per sample of b, of the surface of those modes.
  Eigen::VectorXd weights_;
};

}  // namespace moduli
