#include "core/matching/functional_map.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "core/linalg/dense_product.h"

namespace moduli {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// Keeps fits of maps that collapsed to few samples solvable.
constexpr double kRegularization = 1e-9;

/// For each column of one matrix the nearest of the other, both ways; the lowest of several.
SampleMaps nearestColumns(const MatrixXd& from, const MatrixXd& to) {
  const VectorXd from_squares = from.colwise().squaredNorm() / 2;
  const VectorXd to_squares = to.colwise().squaredNorm() / 2;
  const MatrixXd products = transposedProduct(to, from);
  SampleMaps nearest;
  nearest.there.resize(static_cast<std::size_t>(from.cols()));
  nearest.back.resize(static_cast<std::size_t>(to.cols()), 0);
  // Half of |y - x|^2 but for what is the same for all y, or all x.
  VectorXd best_back = VectorXd::Constant(to.cols(), std::numeric_limits<double>::infinity());
  for (Eigen::Index i = 0; i < from.cols(); ++i) {
    const double* product = products.data() + i * products.rows();
    double best = std::numeric_limits<double>::infinity();
    Index best_there = 0;
    for (Eigen::Index j = 0; j < to.cols(); ++j) {
      const double there = to_squares[j] - product[j];
      if (there < best) {
        best = there;
        best_there = static_cast<Index>(j);
      }
      const double back = from_squares[i] - product[j];
      if (back < best_back[j]) {
        best_back[j] = back;
        nearest.back[j] = static_cast<Index>(i);
      }
    }
    nearest.there[i] = best_there;
  }
  return nearest;
}

/// Columns of k modes at chosen samples, times the roots of weights.
MatrixXd weighted(const MatrixXd& functions, Eigen::Index k, const std::vector<Index>& chosen,
                  const VectorXd& weights) {
  MatrixXd result(k, static_cast<Eigen::Index>(chosen.size()));
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    result.col(column) = functions.col(chosen[i]).head(k) * std::sqrt(weights[column]);
  }
  return result;
}

MatrixXd weighted(const MatrixXd& functions, Eigen::Index k, const VectorXd& weights) {
  return functions.topRows(k) * weights.cwiseSqrt().asDiagonal();
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
  MatrixXd normal = kRegularization * MatrixXd::Identity(k, k);
  MatrixXd right = MatrixXd::Zero(k, k);
  const MatrixXd a_there = weighted(a.functions, k, a.weights);
  const MatrixXd b_there = weighted(b.functions, k, maps.there, a.weights);
  const MatrixXd a_back = weighted(a.functions, k, maps.back, b.weights);
  const MatrixXd b_back = weighted(b.functions, k, b.weights);
  normal += a_there * a_there.transpose() + a_back * a_back.transpose();
  right += a_there * b_there.transpose() + a_back * b_back.transpose();
  return normal.ldlt().solve(right);
}

SampleMaps nearestSamples(const SampledModes& a, const SampledModes& b,
                          const MatrixXd& functional) {
  const Eigen::Index k = functional.rows();
  return nearestColumns(functional.transpose() * a.functions.topRows(k), b.functions.topRows(k));
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
