#pragma once

#include <vector>

#include "core/base/context.h"
#include "core/linalg/spd_solver.h"
#include "core/mesh/connectivity.h"

/// The Laplacian of the double of a bordered surface, restricted to functions that its mirror keeps
/// or changes in sign: half the unknowns. Internal to this room.
namespace moduli::spherical {

enum class Parity {
  kEven,  ///< Equal on both copies: natural boundary conditions.
  kOdd,   ///< Opposite on both copies: 0 on the boundary.
};

/// Edges between vertices of the surface with the weights of the intrinsic Delaunay triangulation
/// of the double, halved. The double may flip boundary edges that the surface alone could not; what
/// comes of them crosses from a vertex to the mirror image of one.
class MirrorLaplacian {
 public:
  struct Edge {
    Index tail, head;
    double weight;
    bool crosses;
  };

  /// lengths: per edge, proper triangles. Fails as doubleCover and flipToDelaunayIsometric do.
  static Result<MirrorLaplacian> make(Context& context, const Connectivity& surface,
                                      const std::vector<double>& lengths);

  const std::vector<Edge>& edges() const { return edges_; }
  std::size_t flips() const { return flips_; }

 private:
  std::vector<Edge> edges_;
  std::size_t flips_ = 0;
};

/// Harmonic functions of one parity with some vertices held. One factorization, any number of
/// solves.
class MirrorSystem {
 public:
  /// moves: per vertex; must not hold for boundary vertices of odd functions. Fails as SpdSolver.
  static Result<MirrorSystem> make(Context& context, const MirrorLaplacian& laplacian,
                                   Parity parity, const std::vector<bool>& moves);

  /// values: per vertex; those of held vertices are kept, the others replaced by what the held ones
  /// and `source` (per vertex, or empty for none) make of them.
  Result<std::vector<double>> solve(Context& context, std::vector<double> values,
                                    const std::vector<double>& source = {}) const;

 private:
  struct Pull {
    Index row, held;
    double weight;
  };
  MirrorSystem(std::vector<Index> moving, std::vector<Pull> pulls, SpdSolver solver)
      : moving_(std::move(moving)), pulls_(std::move(pulls)), solver_(std::move(solver)) {}

  std::vector<Index> moving_;  ///< Per row its vertex.
  std::vector<Pull> pulls_;
  SpdSolver solver_;
};

}  // namespace moduli::spherical
