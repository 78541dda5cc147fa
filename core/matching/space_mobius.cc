#include "core/matching/space_mobius.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace moduli {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Points = std::vector<Vector3d>;

constexpr std::size_t kFewest = 8;
constexpr int kRounds = 50;
/// Of the median distance: as far from its image a target counts for a quarter.
constexpr double kFar = 2;
constexpr double kSame = 1e-12;     ///< Spread that is none, of the distance from 0.
constexpr double kResting = 1e-10;  ///< Of the targets' spread, by which the last round moves them.

double medianOf(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The similarity, mirrors among them, that brings points nearest to targets in the least squares.
/// Source: Umeyama 1991, without the constraint.
SpaceMobius similarityTo(const Points& points, const Points& targets) {
  Vector3d p = Vector3d::Zero(), q = Vector3d::Zero();
  const double share = 1 / static_cast<double>(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    p += share * points[i];
    q += share * targets[i];
  }
  Matrix3d covariance = Matrix3d::Zero();
  double spread = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    covariance += (targets[i] - q) * (points[i] - p).transpose();
    spread += (points[i] - p).squaredNorm();
  }
  const Eigen::JacobiSVD<Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Matrix3d linear = svd.matrixU() * svd.matrixV().transpose();
  const double factor = linear.cwiseProduct(covariance).sum() / spread;
  return SpaceMobius::translation(q) * SpaceMobius::scaling(factor) *
         SpaceMobius::orthogonal(linear) * SpaceMobius::translation(-p);
}

/// Per point the logarithm of q, up to half a common number: the mean over all pairs with it of
/// minus twice the logarithm of the factor of its distance, less what the others bring to that.
std::vector<double> logScales(const Points& points, const Points& targets) {
  const std::size_t n = points.size();
  std::vector<double> result(n);
  for (std::size_t i = 0; i < n; ++i) {
    std::vector<double> logs;
    for (std::size_t j = 0; j < n; ++j) {
      const double before = (points[i] - points[j]).norm(),
                   after = (targets[i] - targets[j]).norm();
      if (before > 0 && after > 0) logs.push_back(2 * std::log(before / after));
    }
    double sum = 0;
    for (const double value : logs) sum += value;
    result[i] = logs.empty() ? 0 : sum / static_cast<double>(logs.size());
  }
  return result;
}

/// Where the map sends to infinity, by the quadratic function; nothing for a similarity.
std::optional<Vector3d> centreOf(const Points& points, const std::vector<double>& log_scales) {
  Eigen::MatrixXd rows(points.size(), 5);
  Eigen::VectorXd right(points.size());
  const double most = *std::max_element(log_scales.begin(), log_scales.end());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    const double q = std::exp(log_scales[i] - most);
    // Relative errors are alike.
    rows.row(row) << points[i].squaredNorm() / q, points[i].transpose() / q, 1 / q;
    right[row] = 1;
  }
  const Eigen::VectorXd solution = rows.leftCols(5).colPivHouseholderQr().solve(right);
  if (!(std::abs(solution[0]) > 0) || !solution.allFinite()) return {};
  return Vector3d(-solution.segment<3>(1) / (2 * solution[0]));
}

Points applied(const SpaceMobius& map, const Points& points) {
  Points images;
  for (const Vector3d& point : points) images.push_back(map(point));
  return images;
}

std::vector<double> distancesOf(const Points& images, const Points& targets) {
  std::vector<double> distances;
  for (std::size_t i = 0; i < images.size(); ++i) {
    distances.push_back((images[i] - targets[i]).norm());
  }
  return distances;
}

/// The infinitesimal Möbius map x -> t + w x x + s x + |x|^2 b - 2 (b.x) x that brings images
/// nearest to targets; as a whole one.
SpaceMobius stepTo(const Points& images, const Points& targets, double far) {
  Eigen::Matrix<double, 10, 10> normal = Eigen::Matrix<double, 10, 10>::Zero();
  Eigen::Matrix<double, 10, 1> right = Eigen::Matrix<double, 10, 1>::Zero();
  for (std::size_t i = 0; i < images.size(); ++i) {
    const Vector3d& x = images[i];
    const Vector3d gap = targets[i] - x;
    const double ratio = gap.squaredNorm() / (far * far);
    const double weight = far > 0 ? 1 / ((1 + ratio) * (1 + ratio)) : 1;
    Eigen::Matrix<double, 3, 10> fields;
    fields.leftCols<3>() = Matrix3d::Identity();
    for (int c = 0; c < 3; ++c) fields.col(3 + c) = Vector3d::Unit(c).cross(x);
    fields.col(6) = x;
    fields.rightCols<3>() = x.squaredNorm() * Matrix3d::Identity() - 2 * x * x.transpose();
    normal += weight * fields.transpose() * fields;
    right += weight * fields.transpose() * gap;
  }
  normal.diagonal() *= 1 + 1e-12;
  const Eigen::Matrix<double, 10, 1> by = normal.ldlt().solve(right);
  const Vector3d turn = by.segment<3>(3);
  const Matrix3d rotation =
      turn.norm() > 0 ? Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix()
                      : Matrix3d::Identity();
  return SpaceMobius::translation(by.head<3>()) * SpaceMobius::orthogonal(rotation) *
         SpaceMobius::scaling(std::exp(by[6])) * SpaceMobius::inversion() *
         SpaceMobius::translation(by.tail<3>()) * SpaceMobius::inversion();
}

bool allFinite(const Points& points) {
  return std::all_of(points.begin(), points.end(),
                     [](const Vector3d& point) { return point.allFinite(); });
}

/// Rounds that lower the median.
SpaceMobiusFit polished(SpaceMobius map, const Points& points, const Points& targets) {
  SpaceMobiusFit best{map, medianOf(distancesOf(applied(map, points), targets))};
  for (int round = 0; round < kRounds; ++round) {
    const Points images = applied(map, points);
    const SpaceMobius next =
        stepTo(images, targets, kFar * medianOf(distancesOf(images, targets))) * map;
    const Points then = applied(next, points);
    if (!allFinite(then)) break;
    const double moved = medianOf(distancesOf(images, then));
    map = next;
    const double median = medianOf(distancesOf(then, targets));
    if (median < best.median) best = {map, median};
    if (!(moved > kResting)) break;
  }
  return best;
}

}  // namespace

SpaceMobius SpaceMobius::translation(const Vector3d& by) {
  Matrix matrix = Matrix::Identity();
  const double half = by.squaredNorm() / 2;
  matrix.block<3, 1>(0, 3) = -by;
  matrix.block<3, 1>(0, 4) = by;
  for (const int row : {3, 4}) {
    matrix.block<1, 3>(row, 0) = by.transpose();
    matrix(row, 3) -= half;
    matrix(row, 4) += half;
  }
  return SpaceMobius(matrix);
}

SpaceMobius SpaceMobius::orthogonal(const Matrix3d& linear) {
  Matrix matrix = Matrix::Identity();
  matrix.topLeftCorner<3, 3>() = linear;
  return SpaceMobius(matrix);
}

SpaceMobius SpaceMobius::scaling(double factor) {
  Matrix matrix = Matrix::Identity();
  const double sum = (factor + 1 / factor) / 2, difference = (factor - 1 / factor) / 2;
  matrix.bottomRightCorner<2, 2>() << sum, difference, difference, sum;
  return SpaceMobius(matrix);
}

SpaceMobius SpaceMobius::inversion() {
  Matrix matrix = Matrix::Identity();
  matrix(3, 3) = -1;
  return SpaceMobius(matrix);
}

SpaceMobius SpaceMobius::operator*(const SpaceMobius& first) const {
  return SpaceMobius(matrix_ * first.matrix_);
}

Vector3d SpaceMobius::operator()(const Vector3d& x) const {
  Eigen::Matrix<double, 5, 1> lifted;
  lifted << x, (x.squaredNorm() - 1) / 2, (x.squaredNorm() + 1) / 2;
  const Eigen::Matrix<double, 5, 1> image = matrix_ * lifted;
  return image.head<3>() / (image[4] - image[3]);
}

Result<SpaceMobiusFit> fitSpaceMobius(const Points& points, const Points& targets) {
  if (points.size() != targets.size() || points.size() < kFewest) {
    return Status(Reason::kInvalidOption,
                  "a Möbius map of space needs 8 points or more, and as "
                  "many targets");
  }
  // Both about 0 and of size 1, where the lift is best.
  const auto unit = [](const Points& all) {
    Vector3d middle = Vector3d::Zero();
    for (const Vector3d& p : all) middle += p / static_cast<double>(all.size());
    double spread = 0;
    for (const Vector3d& p : all) spread += (p - middle).squaredNorm();
    spread = std::sqrt(spread / static_cast<double>(all.size()));
    return std::pair(middle, spread > kSame * middle.norm() ? spread : 0.0);
  };
  const auto [middle_a, spread_a] = unit(points);
  const auto [middle_b, spread_b] = unit(targets);
  if (!(spread_a > 0) || !(spread_b > 0)) {
    return Status(Reason::kNoConvergence, "all points of a Möbius map of space are the same");
  }
  const SpaceMobius to_unit =
      SpaceMobius::scaling(1 / spread_a) * SpaceMobius::translation(-middle_a);
  const SpaceMobius from_unit = SpaceMobius::translation(middle_b) * SpaceMobius::scaling(spread_b);
  Points from, to;
  for (const Vector3d& p : points) from.push_back((p - middle_a) / spread_a);
  for (const Vector3d& p : targets) to.push_back((p - middle_b) / spread_b);

  std::vector<SpaceMobius> starts = {similarityTo(from, to)};
  if (const auto centre = centreOf(from, logScales(from, to))) {
    const SpaceMobius inverted = SpaceMobius::inversion() * SpaceMobius::translation(-*centre);
    const Points images = applied(inverted, from);
    if (allFinite(images)) starts.push_back(similarityTo(images, to) * inverted);
  }
  std::optional<SpaceMobiusFit> best;
  for (const SpaceMobius& start : starts) {
    if (!allFinite(applied(start, from))) continue;
    const SpaceMobiusFit fit = polished(start, from, to);
    if (!best || fit.median < best->median) best = fit;
  }
  if (!best) return Status(Reason::kNoConvergence, "no Möbius map of space fits");
  return SpaceMobiusFit{from_unit * best->map * to_unit, best->median * spread_b};
}

}  // namespace moduli
