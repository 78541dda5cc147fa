#include "core/retrieval/principal_axes.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/base/parallel.h"

namespace moduli {
namespace {

constexpr std::size_t kSampleRows = 16384;
constexpr std::size_t kLargestTurned = 512;
constexpr std::size_t kBlockRows = 256;
constexpr double kLongest = 0x1p20;

using FloatRow = Eigen::Map<const Eigen::RowVectorXf>;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

FloatRow rowOf(const VectorSet& set, std::size_t row) {
  return {set.values.data() + row * set.dimension, static_cast<Eigen::Index>(set.dimension)};
}

}  // namespace

PrincipalAxes::PrincipalAxes(const VectorSet& set, std::span<const std::uint32_t> rows) {
  findAxes(set, rows);
  const double radius = this->radius(set, rows);
  // A power of two, so that scaling rounds nothing.
  if (radius > 0) scale_ = std::ldexp(1.0, -(std::ilogb(radius) + 1));
}

void PrincipalAxes::findAxes(const VectorSet& set, std::span<const std::uint32_t> rows) {
  const std::size_t step = (rows.size() + kSampleRows - 1) / kSampleRows;
  const std::size_t count = (rows.size() + step - 1) / step;
  RowMajor sample(count, set.dimension);
  for (std::size_t i = 0; i < count; ++i) sample.row(i) = rowOf(set, rows[i * step]).cast<double>();
  centre_ = sample.colwise().mean();
  if (set.dimension > kLargestTurned) return;
  sample.rowwise() -= centre_;
  const double largest = sample.cwiseAbs().maxCoeff();
  if (!(largest > 0)) return;
  sample /= largest;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(sample.transpose() * sample);
  if (solver.info() != Eigen::Success) return;
  Eigen::MatrixXd axes = solver.eigenvectors().rowwise().reverse();
  // Axes that are not orthogonal would change distances; slack() leaves room for 1e-10.
  const Eigen::MatrixXd product = axes.transpose() * axes;
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(product.rows(), product.cols());
  if ((product - identity).norm() < 1e-10) axes_ = std::move(axes);
}

double PrincipalAxes::radius(const VectorSet& set, std::span<const std::uint32_t> rows) const {
  constexpr std::size_t kGrain = 16384;
  std::vector<double> radii((rows.size() + kGrain - 1) / kGrain, 0);
  parallelBlocks(rows.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    double& largest = radii[begin / kGrain];
    for (std::size_t i = begin; i < end; ++i) {
      largest = std::max(largest, (rowOf(set, rows[i]).cast<double>() - centre_).norm());
    }
  });
  return *std::max_element(radii.begin(), radii.end());
}

void PrincipalAxes::turnRows(const VectorSet& set, std::span<const std::uint32_t> rows,
                             float* turned) const {
  using Turned = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  RowMajor block, product;
  for (std::size_t first = 0; first < rows.size(); first += kBlockRows) {
    const std::size_t count = std::min(kBlockRows, rows.size() - first);
    block.resize(static_cast<Eigen::Index>(count), centre_.size());
    for (std::size_t i = 0; i < count; ++i) {
      block.row(i) = (rowOf(set, rows[first + i]).cast<double>() - centre_) * scale_;
    }
    Eigen::Map<Turned> out(turned + first * dimension(), block.rows(), block.cols());
    if (axes_.size() == 0) {
      out = block.cast<float>();
    } else {
      product.noalias() = block * axes_;
      out = product.cast<float>();
    }
  }
}

std::optional<std::vector<float>> PrincipalAxes::turn(std::span<const float> vector) const {
  const FloatRow row(vector.data(), static_cast<Eigen::Index>(vector.size()));
  Eigen::RowVectorXd shifted = (row.cast<double>() - centre_) * scale_;
  if (!(shifted.norm() <= kLongest)) return std::nullopt;
  if (axes_.size() > 0) shifted = (shifted * axes_).eval();
  std::vector<float> turned(vector.size());
  for (std::size_t i = 0; i < turned.size(); ++i) turned[i] = static_cast<float>(shifted[i]);
  return turned;
}

}  // namespace moduli
