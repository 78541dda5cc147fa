#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/base/context.h"
#include "core/intrinsic/edge_graph.h"
#include "core/mesh/triangle_mesh.h"

namespace moduli {

/// What lengths a surface is matched by.
enum class MatchMetric : std::uint8_t {
  kOwn,  ///< Its own: bending keeps it.
  /// Its own times the difference of the principal curvatures: Möbius maps of space keep it. (The
  /// stiffness of the modes is that of the own metric, which no conformal factor changes; the area
  /// of a vertex is what Willmore's energy has there.)
  kMobius
};

/// Vertices that stand for a surface.
struct MatchSamples {
  std::vector<Index> vertices;
  Eigen::VectorXd weights;  ///< Share of the area that is nearest to each, sum 1.
};

/// A surface with what near-isometric matching looks at: all of it made of lengths alone, but for
/// the normals, which tell orientation. Lengths are in units of the root of the area.
struct SpectralSurface {
  const TriangleMesh& mesh;  ///< Must live as long.
  std::vector<double> lengths;
  std::vector<double> areas;             ///< Per vertex, sum 1.
  std::vector<Eigen::Vector3d> normals;  ///< Per vertex, of length 1 or 0.
  Eigen::VectorXd values;                ///< Of the Laplace-Beltrami operator, the 0 among them.
  Eigen::MatrixXd functions;             ///< V x values, orthonormal by areas.
  Eigen::MatrixXd waves;                 ///< V x kWaveBands: the wave kernel signature.
  Eigen::VectorXd centrality;  ///< Per vertex, mean 1: large at tips. See feature_points.h.
  EdgeGraph graph;
  std::vector<Index> features;    ///< Points that stand out, most telling first.
  Eigen::MatrixXd from_features;  ///< V x features: distances along edges.
  MatchSamples coarse, fine;      ///< The features first, then evenly spread.
};

/// Modes that surfaces are matched by, the constant among them: fewer on surfaces of fewer
/// vertices.
inline constexpr Eigen::Index kMatchModes = 120;
inline constexpr Eigen::Index kWaveBands = 30;
inline constexpr Index kCoarseSamples = 200, kFineSamples = 1000;

/// Willmore's energy around every vertex, the integral of H^2 - K = (k1 - k2)^2 / 4 (no unit).
/// Fails as mollify does. O(F).
Result<std::vector<double>> willmoreEnergies(const TriangleMesh& mesh);

/// Makes one of a connected mesh. Fails as mollify and smallestEigenpairs do. About 30 F at 20,000
/// faces, most of it in the modes. Stages as theirs, and "features".
/// energies: of kMobius, per vertex, those of a finer mesh that this one stands for; if empty,
/// willmoreEnergies. Source of the signature: Aubry, Schlickewei, Cremers 2011.
Result<SpectralSurface> makeSpectralSurface(Context& context, const TriangleMesh& mesh,
                                            MatchMetric metric = MatchMetric::kOwn,
                                            std::vector<double> energies = {});

}  // namespace moduli
