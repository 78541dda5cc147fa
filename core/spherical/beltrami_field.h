#pragma once

#include <array>
#include <complex>
#include <vector>

#include "core/base/context.h"
#include "core/linalg/spd_solver.h"
#include "core/mesh/connectivity.h"
#include "core/spherical/face_frame.h"
#include "core/spherical/mobius.h"

/// Beltrami coefficients of maps of a polyhedral sphere. Internal to this room.
namespace moduli::spherical {

/// Per face one coefficient, in the frame of the face: its first edge is the real axis.
using BeltramiCoefficients = std::vector<std::complex<double>>;

/// The affine map of a face's frame, z -> along z + across conj(z) + constant.
struct FaceMap {
  std::complex<double> along, across;

  static FaceMap between(const FaceFrame& from, std::complex<double> side01,
                         std::complex<double> side02);
  std::complex<double> beltrami() const { return across / along; }
};

/// Frame of a triangle in space.
FaceFrame chordFrame(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c);

/// The sphere that maps start from: flat faces over given points. Safe to read from several
/// threads.
class BeltramiField {
 public:
  /// points: per vertex on the unit sphere, no face folded. smoothing: radians. Fails as SpdSolver.
  static Result<BeltramiField> make(Context& context, const Connectivity& surface,
                                    const Points3& points, double smoothing, double damping);

  const std::vector<FaceFrame>& frames() const { return frames_; }

  /// The coefficients of the map from the flat faces to those over other points of the sphere.
  BeltramiCoefficients measure(const Points3& points) const;

  /// The field nu that minimizes sum A |nu - mu|^2 + damping |nu|^2 + smoothing^2 |grad nu|^2, with
  /// |nu| <= bound. Coefficients of neighbours are compared along their common edge: mu / d^2 is
  /// the same for all frames if d is the edge's direction. 2 F unknowns.
  Result<BeltramiCoefficients> smooth(Context& context, const BeltramiCoefficients& mu,
                                      double bound) const;

 private:
  BeltramiField(const Connectivity& surface, std::vector<FaceFrame> frames, SpdSolver solver)
      : surface_(surface), frames_(std::move(frames)), solver_(std::move(solver)) {}

  const Connectivity& surface_;
  std::vector<FaceFrame> frames_;
  SpdSolver solver_;
};

/// Half the cotangents opposite to the three edges of a face whose frame is bent by z -> z + nu
/// conj(z): the generalized Laplace operator of the linear Beltrami system with coefficient nu is
/// the Laplace operator of the bent faces. |nu| < 1. Entry c belongs to the edge from corner c to
/// corner c + 1.
std::array<double, 3> bentWeights(const FaceFrame& frame, std::complex<double> nu);

}  // namespace moduli::spherical
