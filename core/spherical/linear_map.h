#pragma once

#include <array>
#include <complex>
#include <vector>

#include "core/base/context.h"
#include "core/forms/cotan.h"
#include "core/linalg/spd_solver.h"
#include "core/mesh/connectivity.h"
#include "core/spherical/face_frame.h"
#include "core/spherical/mobius.h"

/// Steps of the linear map to the sphere. Internal to this room.
namespace moduli::spherical {

using PlanePoints = std::vector<std::complex<double>>;

/// The harmonic maps to the plane of a metric on a closed genus-0 surface, each with its pole in
/// one face. One factorization for all poles.
class DipoleMap {
 public:
  static Result<DipoleMap> make(Context& context, const Connectivity& surface,
                                const std::vector<double>& lengths);

  /// Per vertex the harmonic function with a dipole at face `pole`, made conformal in the mean: it
  /// turns the surface's orientation, so that the lift to the sphere faces outwards.
  /// All faces but `pole` fill a bounded region; the pole's face covers its outside.
  Result<PlanePoints> solve(Context& context, Index pole) const;

  const std::vector<FaceFrame>& frames() const { return frames_; }
  const std::vector<double>& weights() const { return weights_; }

 private:
  DipoleMap(const Connectivity& surface, std::vector<FaceFrame> frames, std::vector<double> weights,
            SpdSolver solver)
      : surface_(surface),
        frames_(std::move(frames)),
        weights_(std::move(weights)),
        solver_(std::move(solver)) {}

  const Connectivity& surface_;
  std::vector<FaceFrame> frames_;
  std::vector<double> weights_;
  SpdSolver solver_;
};

/// A large, well-shaped face: where to put the first pole. Among equals the lowest index.
Index largestFace(const std::vector<FaceFrame>& frames);

/// A well-shaped face in the region that a given map to the sphere enlarges most, which is the
/// trunk of the surface and not a limb: a pole there leaves no part of the surface exponentially
/// small in the plane. Depends on lengths alone; among equals (symmetric surfaces) the lowest
/// index.
Index centralFace(const Connectivity& surface, const std::vector<FaceFrame>& frames,
                  const Points3& points);

/// Harmonic relaxation of a map to the sphere in the chart around a pole: the vertices nearer to it
/// than `reach` in the chart (the stereographic projection from the opposite point, equator on the
/// unit circle) move, the others are held. One factorization, any number of relaxations.
class ChartRelaxation {
 public:
  /// weights: per edge. points: where the vertices are now, which decides who moves.
  /// pole: unit vector. Fails as SpdSolver does.
  static Result<ChartRelaxation> make(Context& context, const Connectivity& surface,
                                      const std::vector<double>& weights, const Points3& points,
                                      const Eigen::Vector3d& pole, double reach);

  /// False where fewer than three vertices move or are held: nothing useful can come of it.
  bool isSound() const { return moving_.size() >= 3 && held_count_ >= 3; }

  /// The points with the moving vertices where the held ones pull them.
  Result<Points3> relax(Context& context, Points3 points) const;

 private:
  struct Pull {
    Index row, held;
    double weight;
  };
  ChartRelaxation(std::array<Eigen::Vector3d, 3> axes, std::vector<Index> moving,
                  std::size_t held_count, std::vector<Pull> pulls, SpdSolver solver)
      : axes_(axes),
        moving_(std::move(moving)),
        held_count_(held_count),
        pulls_(std::move(pulls)),
        solver_(std::move(solver)) {}

  std::array<Eigen::Vector3d, 3> axes_;  ///< Two of the chart, then the pole.
  std::vector<Index> moving_;            ///< Per row its vertex.
  std::size_t held_count_;
  std::vector<Pull> pulls_;  ///< Edges between a moving and a held vertex.
  SpdSolver solver_;
};

}  // namespace moduli::spherical
