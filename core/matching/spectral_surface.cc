#include "core/matching/spectral_surface.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "core/forms/cotan.h"
#include "core/intrinsic/mollify.h"
#include "core/linalg/generalized_eigen.h"
#include "core/matching/feature_points.h"
#include "core/mesh/vertex_normals.h"
#include "core/signature/mean_curvature.h"

namespace moduli {
namespace {

// The functions span a space and are compared in it: their own error is that of the mesh.
constexpr double kTolerance = 1e-4;
constexpr double kShift = 12.5;
// Of a band's width in log value, of the distance between bands (Aubry, Schlickewei, Cremers).
constexpr double kBandWidth = 7;
constexpr double kEnergyFloor = 0.01;

/// Spheres and planes have no energy of their own.
void floorEnergies(std::vector<double>& energies) {
  const double total = std::accumulate(energies.begin(), energies.end(), 0.0);
  const double floor = kEnergyFloor * std::max(total, 1.0) / static_cast<double>(energies.size());
  for (double& energy : energies) energy += floor;
}

/// Energies evenly spread in log value; each row of squares times a Gaussian around one.
Eigen::MatrixXd waveKernel(const Eigen::VectorXd& values, const Eigen::MatrixXd& functions) {
  const Eigen::Index modes = values.size() - 1;
  const Eigen::VectorXd energy = values.tail(modes).array().log();
  const double first = energy[0], step = (energy[modes - 1] / 1.02 - first) / (kWaveBands - 1);
  Eigen::MatrixXd weights(modes, kWaveBands);
  for (Eigen::Index band = 0; band < kWaveBands; ++band) {
    const double width = kBandWidth * std::max(step, 1e-9);
    weights.col(band) = (-(energy.array() - first - step * static_cast<double>(band)).square() /
                         (2 * width * width))
                            .exp();
    weights.col(band) /= weights.col(band).sum();
  }
  return functions.rightCols(modes).cwiseAbs2() * weights;
}

MatchSamples samplesOf(const EdgeGraph& graph, const std::vector<Index>& begin, Index count,
                       const std::vector<double>& areas) {
  VertexSamples spread = graph.farthestSamples(begin, std::min<Index>(count, graph.vertexCount()));
  MatchSamples samples;
  samples.weights = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(spread.vertices.size()));
  for (std::size_t v = 0; v < areas.size(); ++v) samples.weights[spread.nearest[v]] += areas[v];
  samples.vertices = std::move(spread.vertices);
  return samples;
}

}  // namespace

Result<std::vector<double>> willmoreEnergies(const TriangleMesh& mesh) {
  const Connectivity& surface = mesh.connectivity();
  ASSIGN_OR_RETURN(const MollifiedLengths mollified, mollify(surface, mesh.edgeLengths()));
  const std::vector<double>& lengths = mollified.lengths;
  const std::vector<double> curvature = integratedMeanCurvature(mesh);
  std::vector<double> areas(surface.vertexCount(), 0.0), defect(areas.size(), 2 * std::numbers::pi);
  const std::vector<double> face_areas = mesh.faceAreas();
  for (Index f = 0; f < surface.faceCount(); ++f) {
    for (int c = 0; c < 3; ++c) {
      const Index h = 3 * f + c;
      const double b = lengths[surface.edge(h)], a = lengths[surface.edge(surface.next(h))],
                   l = lengths[surface.edge(surface.previous(h))];
      areas[surface.tail(h)] += face_areas[f] / 3;
      defect[surface.tail(h)] -=
          std::acos(std::clamp((b * b + l * l - a * a) / (2 * b * l), -1.0, 1.0));
    }
  }
  std::vector<double> energies;
  for (std::size_t v = 0; v < areas.size(); ++v) {
    const double squared = curvature[v] * curvature[v] / areas[v];
    energies.push_back(std::isfinite(squared) ? std::max(0.0, squared - defect[v]) : 0.0);
  }
  return energies;
}

Result<SpectralSurface> makeSpectralSurface(Context& context, const TriangleMesh& mesh,
                                            MatchMetric metric, std::vector<double> energies) {
  const Connectivity& surface = mesh.connectivity();
  ASSIGN_OR_RETURN(MollifiedLengths mollified, mollify(surface, mesh.edgeLengths()));
  std::vector<double> lengths = unitLengths(mollified.lengths);
  const std::vector<double> weights = cotanWeights(surface, lengths);
  std::vector<double> areas = vertexAreas(surface, lengths);
  if (metric == MatchMetric::kMobius) {
    if (energies.empty()) {
      ASSIGN_OR_RETURN(energies, willmoreEnergies(mesh));
    }
    floorEnergies(energies);
    for (Index e = 0; e < surface.edgeCount(); ++e) {
      const Index h = surface.halfedge(e), v = surface.tail(h), w = surface.head(h);
      lengths[e] *= std::sqrt((energies[v] / areas[v] + energies[w] / areas[w]) / 2);
    }
    areas = std::move(energies);
  }
  const double total = std::accumulate(areas.begin(), areas.end(), 0.0);
  for (double& area : areas) area /= total;
  for (double& length : lengths) length /= std::sqrt(total);

  EigenOptions options;
  options.count = std::min<Eigen::Index>(kMatchModes, surface.vertexCount());
  options.shift = kShift;
  options.tolerance = kTolerance;
  const Eigen::Map<const Eigen::VectorXd> mass(areas.data(), surface.vertexCount());
  ASSIGN_OR_RETURN(EigenPairs pairs,
                   smallestEigenpairs(context, stiffnessMatrix(surface, weights), mass, options));
  const Context::Stage stage(context, "features");
  RETURN_IF_ERROR(context.check());
  const Eigen::VectorXd values = pairs.values.cwiseMax(kTolerance);
  EdgeGraph graph(surface, lengths);
  Eigen::VectorXd centrality = biharmonicCentrality(values, pairs.vectors, areas);
  std::vector<Index> features = featurePoints(graph, centrality, values, pairs.vectors);
  Eigen::MatrixXd from_features(surface.vertexCount(), features.size());
  for (std::size_t i = 0; i < features.size(); ++i) {
    RETURN_IF_ERROR(context.check());
    const std::vector<double> distance = graph.distances(std::span(&features[i], 1));
    from_features.col(static_cast<Eigen::Index>(i)) =
        Eigen::Map<const Eigen::VectorXd>(distance.data(), surface.vertexCount());
  }
  MatchSamples coarse = samplesOf(graph, features, kCoarseSamples, areas);
  MatchSamples fine = samplesOf(graph, coarse.vertices, kFineSamples, areas);
  Eigen::MatrixXd waves = waveKernel(values, pairs.vectors);
  return SpectralSurface{mesh,
                         std::move(lengths),
                         std::move(areas),
                         vertexNormals(surface, mesh.positions()),
                         values,
                         std::move(pairs.vectors),
                         std::move(waves),
                         std::move(centrality),
                         std::move(graph),
                         std::move(features),
                         std::move(from_features),
                         std::move(coarse),
                         std::move(fine)};
}

}  // namespace moduli
