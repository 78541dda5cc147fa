#include "core/matching/torus_correlation.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/forms/cotan.h"

namespace moduli {
namespace {

using Complex = std::complex<double>;
using Eigen::Vector2d;

constexpr int kLow = 8, kGrid = 64;
constexpr double kTurn = 2 * std::numbers::pi;

using LowWaves = Eigen::Matrix<Complex, 2 * kLow + 1, 2 * kLow + 1>;

/// The product's waves: their sum at a shift is the integral of a(u) b(marking u + shift).
LowWaves product(const TorusField& a, const TorusField& b, const Eigen::Matrix2i& marking) {
  LowWaves waves;
  for (int k = -kLow; k <= kLow; ++k) {
    for (int l = -kLow; l <= kLow; ++l) {
      const Eigen::Vector2i back = marking.transpose() * Eigen::Vector2i(k, l);
      waves(k + kLow, l + kLow) = b.at(k, l) * std::conj(a.at(back[0], back[1]));
    }
  }
  return waves;
}

double valueAt(const LowWaves& waves, const Vector2d& shift) {
  double sum = 0;
  for (int k = -kLow; k <= kLow; ++k) {
    for (int l = -kLow; l <= kLow; ++l) {
      const Complex turn = std::polar(1.0, kTurn * (k * shift[0] + l * shift[1]));
      sum += (waves(k + kLow, l + kLow) * turn).real();
    }
  }
  return sum;
}

Vector2d bestOnGrid(const LowWaves& waves) {
  // One coordinate after the other.
  Eigen::MatrixXcd turns(2 * kLow + 1, kGrid);
  for (int k = -kLow; k <= kLow; ++k) {
    for (int n = 0; n < kGrid; ++n) turns(k + kLow, n) = std::polar(1.0, kTurn * k * n / kGrid);
  }
  const Eigen::MatrixXd values = (turns.transpose() * waves * turns).real();
  Eigen::Index row = 0, column = 0;
  values.maxCoeff(&row, &column);
  return Vector2d(static_cast<double>(row), static_cast<double>(column)) / kGrid;
}

}  // namespace

TorusField::TorusField(const CoverSurface& cover, const TorusShape& shape) {
  const Connectivity& surface = cover.surface;
  const std::vector<double> areas = faceAreas(surface, unitLengths(cover.lengths));
  const Eigen::Matrix2d inverse = shape.periods.inverse();
  std::vector<double> flat(surface.faceCount()), factor(surface.faceCount());
  double mean = 0;
  for (Index f = 0; f < surface.faceCount(); ++f) {
    const Vector2d &p = shape.steps[3 * f], &q = shape.steps[3 * f + 1];
    flat[f] = (p[0] * q[1] - p[1] * q[0]) / 2;
    factor[f] = flat[f] > 0 && areas[f] > 0 ? std::log(areas[f] / flat[f]) : 0;
    mean += flat[f] * factor[f];
  }
  values_.setZero();
  // Positions of faces along a tree.
  std::vector<Vector2d> origin(surface.faceCount(), Vector2d::Zero());
  std::vector<bool> seen(surface.faceCount(), false);
  std::vector<Index> queue = {0};
  seen[0] = true;
  for (std::size_t n = 0; n < queue.size(); ++n) {
    const Index f = queue[n];
    const Vector2d centre = origin[f] + (shape.steps[3 * f] - shape.steps[3 * f + 2]) / 3;
    const Vector2d u = inverse * centre;
    std::array<Complex, 2 * kMost + 1> first, second;
    for (int k = -kMost; k <= kMost; ++k) {
      first[k + kMost] = std::polar(1.0, -kTurn * k * u[0]);
      second[k + kMost] = std::polar(1.0, -kTurn * k * u[1]);
    }
    const double weight = flat[f] * (factor[f] - mean);
    for (int l = 0; l <= 2 * kMost; ++l) {
      for (int k = 0; k <= 2 * kMost; ++k) values_(k, l) += weight * first[k] * second[l];
    }
    for (Index h = 3 * f; h < 3 * f + 3; ++h) {
      const Index beyond = Connectivity::faceOf(surface.twin(h));
      if (seen[beyond]) continue;
      seen[beyond] = true;
      origin[beyond] = origin[f] + cover.across[h].topRightCorner<2, 1>();
      queue.push_back(beyond);
    }
  }
  values_(kMost, kMost) = 0;
}

double TorusField::norm(int most) const {
  double sum = 0;
  for (int k = -most; k <= most; ++k) {
    for (int l = -most; l <= most; ++l) sum += std::norm(at(k, l));
  }
  return std::sqrt(sum);
}

TorusAlignment alignFields(const TorusField& a, const TorusField& b,
                           const Eigen::Matrix2i& marking) {
  const LowWaves waves = product(a, b, marking);
  double norm = 0;
  for (int k = -kLow; k <= kLow; ++k) {
    for (int l = -kLow; l <= kLow; ++l) {
      const Eigen::Vector2i back = marking.transpose() * Eigen::Vector2i(k, l);
      norm += std::norm(a.at(back[0], back[1]));
    }
  }
  norm = std::sqrt(norm) * b.norm(kLow);
  TorusAlignment best;
  best.shift = bestOnGrid(waves);
  double value = valueAt(waves, best.shift);
  for (double step = 0.5 / kGrid; step > 1e-9; step /= 2) {
    for (bool better = true; better;) {
      better = false;
      for (const Vector2d& way :
           {Vector2d(1, 0), Vector2d(-1, 0), Vector2d(0, 1), Vector2d(0, -1)}) {
        const double next = valueAt(waves, best.shift + step * way);
        if (!(next > value)) continue;
        value = next;
        best.shift += step * way;
        better = true;
      }
    }
  }
  best.correlation = norm > 0 ? value / norm : 0;
  return best;
}

}  // namespace moduli
