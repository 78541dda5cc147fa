#include "core/matching/functional_map.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/linalg/dense_product.h"

namespace moduli {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// Keeps fits of maps that collapsed to few samples solvable.
constexpr double kRegularization = 1e-9;

/// The place of the least entry, the first of several.
Index leastOf(const double* values, Eigen::Index count) {
  const double least = Eigen::Map<const VectorXd>(values, count).minCoeff();
  return static_cast<Index>(std::find(values, values + count, least) - values);
}

/// For each column of one matrix the nearest of the other, both ways; the lowest of several.
SampleMaps nearestColumns(const MatrixXd& from, const MatrixXd& to) {
  const VectorXd from_squares = from.colwise().squaredNorm() / 2;
  const VectorXd to_squares = to.colwise().squaredNorm() / 2;
  // Half of |y - x|^2.
  MatrixXd halves = -transposedProduct(to, from);
  halves.colwise() += to_squares;
  halves.rowwise() += from_squares.transpose();
  SampleMaps nearest;
  for (Eigen::Index i = 0; i < from.cols(); ++i) {
    nearest.there.push_back(leastOf(halves.data() + i * halves.rows(), halves.rows()));
  }
  const MatrixXd turned = halves.transpose();
  for (Eigen::Index j = 0; j < to.cols(); ++j) {
    nearest.back.push_back(leastOf(turned.data() + j * turned.rows(), turned.rows()));
  }
  return nearest;
}

/// The first modes at chosen samples, or at all in their order, times the roots of weights.
void takeRows(const MatrixXd& functions, const std::vector<Index>& chosen, const VectorXd& weights,
              Eigen::Ref<MatrixXd> rows) {
  const Eigen::Index k = rows.cols();
  for (Eigen::Index i = 0; i < weights.size(); ++i) {
    const Eigen::Index from = chosen.empty() ? i : chosen[i];
    rows.row(i) = functions.col(from).head(k).transpose() * std::sqrt(weights[i]);
  }
}

}  // namespace

SampledModes sampleModes(const SpectralSurface& surface, const MatchSamples& samples) {
  SampledModes result;
  result.weights = samples.weights;
  result.functions.resize(surface.values.size(),
                          static_cast<Eigen::Index>(samples.vertices.size()));
  for (std::size_t i = 0; i < samples.vertices.size(); ++i) {
    result.functions.col(static_cast<Eigen::Index>(i)) =
        surface.functions.row(samples.vertices[i]).transpose();
  }
  return result;
}

MatrixXd fitFunctionalMap(const SampledModes& a, const SampledModes& b, const SampleMaps& maps,
                          Eigen::Index k) {
  const Eigen::Index here = a.weights.size(), all = here + b.weights.size();
  MatrixXd of_a(all, k), of_b(all, k);  // One row for each of both maps' pairs.
  takeRows(a.functions, {}, a.weights, of_a.topRows(here));
  takeRows(b.functions, maps.there, a.weights, of_b.topRows(here));
  takeRows(a.functions, maps.back, b.weights, of_a.bottomRows(all - here));
  takeRows(b.functions, {}, b.weights, of_b.bottomRows(all - here));
  MatrixXd normal = transposedProduct(of_a, of_a);
  normal.diagonal().array() += kRegularization;
  return normal.ldlt().solve(transposedProduct(of_a, of_b));
}

SampleMaps nearestSamples(const SampledModes& a, const SampledModes& b,
                          const MatrixXd& functional) {
  const Eigen::Index k = functional.rows();
  return nearestColumns(transposedProduct(functional, a.functions.topRows(k)),
                        b.functions.topRows(k));
}

Result<MatrixXd> refineFunctionalMap(Context& context, const SampledModes& a, const SampledModes& b,
                                     const std::vector<Eigen::Index>& steps, SampleMaps& maps) {
  MatrixXd functional;
  for (const Eigen::Index k : steps) {
    RETURN_IF_ERROR(context.check());
    functional = fitFunctionalMap(a, b, maps, k);
    maps = nearestSamples(a, b, functional);
  }
  return functional;
}

double orthogonalityDefect(const MatrixXd& functional) {
  const Eigen::Index k = functional.rows();
  return (functional.transpose() * functional - MatrixXd::Identity(k, k)).squaredNorm() /
         static_cast<double>(k);
}

OrientationTest::OrientationTest(const SpectralSurface& a, const SpectralSurface& b,
                                 Eigen::Index modes)
    : weights_(a.coarse.weights) {
  const auto count = static_cast<Eigen::Index>(a.coarse.vertices.size());
  first_.resize(count, modes);
  second_.resize(count, modes);
  const auto sides = [&](const SpectralSurface& surface, Index v) {
    const Connectivity& connectivity = surface.mesh.connectivity();
    const Index h = connectivity.outgoing(v);
    return std::pair(connectivity.head(h), connectivity.tail(connectivity.previous(h)));
  };
  for (Eigen::Index i = 0; i < count; ++i) {
    const Index v = a.coarse.vertices[i];
    const auto [u, w] = sides(a, v);
    first_.row(i) = (a.functions.row(u) - a.functions.row(v)).head(modes);
    second_.row(i) = (a.functions.row(w) - a.functions.row(v)).head(modes);
  }
  // The surface of b as its lowest modes have it.
  MatrixXd positions(b.mesh.vertexCount(), 3);
  for (Index v = 0; v < b.mesh.vertexCount(); ++v) {
    positions.row(v) = b.mesh.positions()[v].transpose() * b.areas[v];
  }
  coordinates_ = b.functions.leftCols(modes).transpose() * positions;
  for (const Index v : b.coarse.vertices) {
    const auto [u, w] = sides(b, v);
    const auto side = [&](Index other) -> Vector3d {
      return ((b.functions.row(other) - b.functions.row(v)).head(modes) * coordinates_).transpose();
    };
    normals_.push_back(side(u).cross(side(w)).stableNormalized());
  }
}

double OrientationTest::operator()(const MatrixXd& functional, const SampleMaps& maps) const {
  const MatrixXd to_space = functional * coordinates_;
  const MatrixXd first = first_ * to_space, second = second_ * to_space;
  double sum = 0;
  for (Eigen::Index i = 0; i < first.rows(); ++i) {
    const Vector3d normal = Vector3d(first.row(i)).cross(Vector3d(second.row(i)));
    sum += weights_[i] * normal.stableNormalized().dot(normals_[maps.there[i]]);
  }
  return sum;
}

}  // namespace moduli
