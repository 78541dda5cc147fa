#include "core/matching/functional_map.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/linalg/dense_product.h"

namespace moduli {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// Keeps fits of maps that collapsed to few samples solvable.
constexpr double kRegularization = 1e-9;

/// Distances are compared block by block of so many columns, which stay in the cache.
constexpr Eigen::Index kColumns = 128;

/// Under each column its place among a paraboloid's tangents: the products of those of two matrices
/// are half the squared distances of the columns. Floats tell samples apart well enough.
Eigen::MatrixXf lifted(const MatrixXd& columns, double sign) {
  const Eigen::Index k = columns.rows();
  Eigen::MatrixXf result(k + 2, columns.cols());
  result.topRows(k) = (sign * columns).cast<float>();
  const Eigen::RowVectorXf halves = (columns.colwise().squaredNorm() / 2).cast<float>();
  result.row(sign > 0 ? k : k + 1) = halves;
  result.row(sign > 0 ? k + 1 : k).setOnes();
  return result;
}

/// Whole numbers in the order of floats: loops over them have no branches.
using Keys = std::vector<std::int32_t>;

void makeKeys(const float* values, Keys& keys) {
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const auto bits = std::bit_cast<std::int32_t>(values[i]);
    keys[i] = bits ^ ((bits >> 31) & 0x7fffffff);
  }
}

/// The place of the least key, the first of several.
Index leastOf(const Keys& keys) {
  const auto count = static_cast<Index>(keys.size());
  const std::int32_t* const values = keys.data();
  std::int32_t least = values[0];
  for (Index i = 0; i < count; ++i) least = values[i] < least ? values[i] : least;
  Index first = count;
  for (Index i = 0; i < count; ++i) {
    const Index here = values[i] == least ? i : count;
    first = here < first ? here : first;
  }
  return first;
}

/// Takes a place for every key that is less than the least one so far.
void takeLess(const Keys& keys, Index place, Keys& least, std::vector<Index>& places) {
  for (std::size_t i = 0; i < keys.size(); ++i) {
    places[i] = keys[i] < least[i] ? place : places[i];
    least[i] = std::min(least[i], keys[i]);
  }
}

/// For each column of one matrix the nearest of the other, both ways; the lowest of several.
SampleMaps nearestColumns(const MatrixXd& from, const MatrixXd& to) {
  const Eigen::MatrixXf source = lifted(from, -1), target = lifted(to, 1);
  SampleMaps nearest;
  nearest.there.reserve(static_cast<std::size_t>(from.cols()));
  nearest.back.assign(static_cast<std::size_t>(to.cols()), 0);
  Keys keys(nearest.back.size()), least(keys.size(), std::numeric_limits<std::int32_t>::max());
  for (Eigen::Index begin = 0; begin < from.cols(); begin += kColumns) {
    const Eigen::Index width = std::min(kColumns, from.cols() - begin);
    const Eigen::MatrixXf halves = transposedProduct(target, source.middleCols(begin, width));
    for (Eigen::Index c = 0; c < width; ++c) {
      makeKeys(halves.col(c).data(), keys);
      nearest.there.push_back(leastOf(keys));
      takeLess(keys, static_cast<Index>(begin + c), least, nearest.back);
    }
  }
  return nearest;
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
  // Pairs of both maps with the same sample of a are one equation.
  VectorXd weights = a.weights;
  MatrixXd there(a.weights.size(), k);
  for (Eigen::Index i = 0; i < a.weights.size(); ++i) {
    there.row(i) = a.weights[i] * b.functions.col(maps.there[i]).head(k).transpose();
  }
  for (Eigen::Index j = 0; j < b.weights.size(); ++j) {
    const Index i = maps.back[j];
    weights[i] += b.weights[j];
    there.row(i) += b.weights[j] * b.functions.col(j).head(k).transpose();
  }
  const MatrixXd here = a.functions.topRows(k).transpose();
  MatrixXd normal = transposedProduct(here, weights.asDiagonal() * here);
  normal.diagonal().array() += kRegularization;
  return normal.ldlt().solve(transposedProduct(here, there));
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
  const Eigen::Index k = functional.rows();
  const MatrixXd to_space = functional * coordinates_.topRows(k);
  const MatrixXd first = first_.leftCols(k) * to_space, second = second_.leftCols(k) * to_space;
  double sum = 0;
  for (Eigen::Index i = 0; i < first.rows(); ++i) {
    const Vector3d normal = Vector3d(first.row(i)).cross(Vector3d(second.row(i)));
    sum += weights_[i] * normal.stableNormalized().dot(normals_[maps.there[i]]);
  }
  return sum;
}

}  // namespace moduli
