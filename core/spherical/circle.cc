#include "core/spherical/circle.h"

#include <Eigen/Core>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace moduli {

Circle fitCircle(const std::vector<std::complex<double>>& points) {
  const auto n = static_cast<Eigen::Index>(points.size());
  std::complex<double> mean = 0;
  for (const std::complex<double> z : points) mean += z / static_cast<double>(n);
  double scale = 0;
  for (const std::complex<double> z : points) scale = std::max(scale, std::abs(z - mean));
  // |z|^2 = 2 Re(conj(c) z) + (r^2 - |c|^2) around the mean.
  Eigen::MatrixXd matrix(n, 3);
  Eigen::VectorXd squares(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const std::complex<double> z = (points[k] - mean) / scale;
    matrix.row(k) << 2 * z.real(), 2 * z.imag(), 1;
    squares[k] = std::norm(z);
  }
  const Eigen::Vector3d x = matrix.colPivHouseholderQr().solve(squares);
  const std::complex<double> center(x[0], x[1]);
  return {mean + scale * center, scale * std::sqrt(std::max(0.0, x[2] + std::norm(center)))};
}

double roundnessError(const Circle& circle, const std::vector<std::complex<double>>& points) {
  double error = 0;
  for (const std::complex<double> z : points) {
    error = std::max(error, std::abs(circle.distance(z)));
  }
  return error;
}

/// The centre of an image is the image of the point that mirrors the map's pole in the circle.
Circle DiskTranslation::operator()(const Circle& circle) const {
  // c + r^2 / conj(1 / conj(p) - c), times p above and below.
  const double r2 = circle.radius * circle.radius;
  const std::complex<double> mirrored =
      circle.center + r2 * zero / (1.0 - std::conj(circle.center) * zero);
  const std::complex<double> center = (*this)(mirrored);
  return {center, std::abs((*this)(circle.center + circle.radius) - center)};
}

DiskTranslation centeringMap(const Circle& circle) {
  const double d = std::abs(circle.center);
  const double sum = 1 + d * d - circle.radius * circle.radius;
  return {2.0 * circle.center / (sum + std::sqrt(std::max(0.0, (sum - 2 * d) * (sum + 2 * d))))};
}

double centeredRadius(const Circle& circle) {
  // Of hyperbolic diameter D: tanh(D / 2) from the ends of the Euclidean diameter, then half of it.
  const double t =
      2 * circle.radius / (1 - std::norm(circle.center) + circle.radius * circle.radius);
  return t / (1 + std::sqrt(std::max(0.0, (1 - t) * (1 + t))));
}

}  // namespace moduli
