#include "core/signature/shell_power.h"

#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/signature/spherical_harmonics.h"

namespace moduli {
namespace {

/// Where a shell begins, is whole, begins to fade, and ends.
struct Shell {
  double begin, whole, fade, end;
};
constexpr std::array<Shell, kShellCount> kShells = {
    {{0, 0.4, 0.8, 1.2}, {0.8, 1.2, 1.2, 1.6}, {1.2, 1.6, 1.6, 2.1}, {1.6, 2.1, 2.7, 3.4}}};
/// Of singular values; those of real surfaces are between 0 and 0.2.
constexpr double kRootFloor = 0.01;

/// Integral from `from` to `to` of (a + b r) r^2.
double cubicIntegral(double a, double b, double from, double to) {
  const auto primitive = [&](double r) { return r * r * r * (a / 3 + b * r / 4); };
  return primitive(to) - primitive(from);
}

double weightOn(const Shell& shell, double r) {
  if (r <= shell.begin || r >= shell.end) return 0;
  if (r < shell.whole) return (r - shell.begin) / (shell.whole - shell.begin);
  return r <= shell.fade ? 1 : (shell.end - r) / (shell.end - shell.fade);
}

/// Integral of weightOn(shell, r) r^2 from 0 to r.
double volumeOn(const Shell& shell, double r) {
  double result = 0;
  if (r > shell.begin) {
    const double slope = 1 / (shell.whole - shell.begin);
    result += cubicIntegral(-shell.begin * slope, slope, shell.begin, std::min(r, shell.whole));
  }
  if (r > shell.whole) result += cubicIntegral(1, 0, shell.whole, std::min(r, shell.fade));
  if (r > shell.fade) {
    const double slope = 1 / (shell.end - shell.fade);
    result += cubicIntegral(shell.end * slope, -slope, shell.fade, std::min(r, shell.end));
  }
  return result;
}

/// f((a a^T)^(1/2)) by the singular values of a, f as the header says; its upper triangle with
/// entries off the diagonal times sqrt(2).
void appendRoot(const Eigen::MatrixXd& a, std::vector<double>& result) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(a, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Eigen::VectorXd pressed =
      (svd.singularValues().array() + kRootFloor).sqrt() - std::sqrt(kRootFloor);
  const Eigen::MatrixXd root = svd.matrixU() * pressed.asDiagonal() * svd.matrixU().transpose();
  for (int i = 0; i < kShellCount; ++i) {
    for (int j = i; j < kShellCount; ++j) {
      result.push_back(i == j ? root(i, j) : std::numbers::sqrt2 * root(i, j));
    }
  }
}

std::vector<double> rootsOf(const Eigen::MatrixXd& coefficients, Eigen::Index first) {
  std::vector<double> result;
  for (int l = 0; l <= kShellDegree; ++l) {
    appendRoot(coefficients.block(SphericalHarmonics::index(l, -l), first, 2 * l + 1, kShellCount)
                   .transpose(),
               result);
  }
  return result;
}

}  // namespace

Result<ShellPower> shellPower(Context& context, const SurfacePoints& points) {
  const Context::Stage stage(context, "shells");
  constexpr Eigen::Index kBatch = 4096;
  const SphericalHarmonics harmonics(kShellDegree);
  Eigen::MatrixXd coefficients = Eigen::MatrixXd::Zero(harmonics.count(), 2 * kShellCount);
  for (Eigen::Index first = 0; first < points.points.cols(); first += kBatch) {
    RETURN_IF_ERROR(context.check());
    const Eigen::Index count = std::min(kBatch, points.points.cols() - first);
    Eigen::MatrixX3d directions(count, 3);
    Eigen::MatrixXd values = Eigen::MatrixXd::Zero(count, 2 * kShellCount);
    for (Eigen::Index i = 0; i < count; ++i) {
      const Eigen::Vector3d x = points.points.col(first + i) / points.radius;
      const double r = x.norm();
      directions.row(i) =
          r > 0 ? Eigen::RowVector3d(x.transpose() / r) : Eigen::RowVector3d(0, 0, 1);
      if (!(r > 0)) continue;
      const double area = points.areas[first + i];
      // Solid angle of the point's piece of surface, in units of r^-3.
      const double facing = area / (points.radius * points.radius) *
                            x.dot(points.normals.col(first + i)) / (r * r * r);
      for (int shell = 0; shell < kShellCount; ++shell) {
        values(i, shell) = area * weightOn(kShells[shell], r);
        values(i, kShellCount + shell) = facing * volumeOn(kShells[shell], r);
      }
    }
    harmonics.project(directions, values, coefficients);
  }
  return ShellPower{rootsOf(coefficients, 0), rootsOf(coefficients, kShellCount)};
}

}  // namespace moduli
