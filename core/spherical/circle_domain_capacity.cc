#include "core/spherical/circle_domain_capacity.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>

#include "core/base/text.h"

namespace moduli {
namespace {

using Complex = std::complex<double>;

constexpr Eigen::Index kMostCoefficients = 3000;
constexpr int kLeastTerms = 4;
constexpr double kLargestResidual = 1e-8;
/// Terms are cut off where two circles alone would leave this, with a margin for the others.
constexpr double kCutOff = 1e-15;
constexpr double kMargin = 1.25;

Status checkCircles(const std::vector<Circle>& circles) {
  if (circles.size() < 2) {
    return {Reason::kInvalidOption, "a disk without holes has no capacity"};
  }
  for (std::size_t k = 0; k < circles.size(); ++k) {
    if (!(circles[k].radius > 0) || !std::isfinite(circles[k].radius) ||
        !std::isfinite(std::abs(circles[k].center))) {
      return {Reason::kInvalidOption, "circle " + std::to_string(k) + " has no finite size"};
    }
    if (k > 0 && !(circles[0].distance(circles[k].center) + circles[k].radius < 0)) {
      return {Reason::kInvalidOption, "circle " + std::to_string(k) + " leaves circle 0"};
    }
    for (std::size_t j = 1; j < k; ++j) {
      if (circles[j].distance(circles[k].center) > circles[k].radius) continue;
      return {Reason::kInvalidOption,
              "circles " + std::to_string(j) + " and " + std::to_string(k) + " meet"};
    }
  }
  return {};
}

/// By what factor multipoles around circle a fall where only circle b is there too: where between
/// the centre and the circle the pencil of the two has its limit point.
double decay(const Circle& a, const Circle& b) {
  const double distance = std::abs(b.center - a.center);
  if (distance == 0) return 0;
  const double r = a.radius;
  const double sum =
      std::abs((distance * distance + (r - b.radius) * (r + b.radius)) / (distance * 2 * r));
  return 1 / (sum + std::sqrt(std::max(0.0, (sum - 1) * (sum + 1))));
}

/// The unit disk with its holes, and what the functions are made of.
class Expansion {
 public:
  explicit Expansion(const std::vector<Circle>& circles) {
    for (const Circle& circle : circles) {
      circles_.push_back({(circle.center - circles[0].center) / circles[0].radius,
                          circle.radius / circles[0].radius});
    }
    for (std::size_t k = 0; k < circles_.size(); ++k) {
      double slowest = 0;
      for (std::size_t j = 0; j < circles_.size(); ++j) {
        if (j != k) slowest = std::max(slowest, decay(circles_[k], circles_[j]));
      }
      const double terms = slowest > 0 ? kMargin * std::log(kCutOff) / std::log(slowest) : 0;
      terms_.push_back(kLeastTerms + static_cast<int>(std::min(terms, 1e6)));
      first_.push_back(coefficients_);
      coefficients_ += 2 * terms_.back() + 1;
    }
  }

  Eigen::Index coefficients() const { return coefficients_; }
  std::size_t count() const { return circles_.size(); }
  /// The coefficient of log |z - c_k|; of circle 0, of the constant.
  Eigen::Index leading(std::size_t k) const { return first_[k]; }
  /// Points on circle k: twice as many as it has coefficients.
  int samples(std::size_t k) const { return 4 * terms_[k] + 2; }

  /// The place of sample i (+ shift) on circle k.
  Complex place(std::size_t k, double i) const {
    return circles_[k].center +
           std::polar(circles_[k].radius, 2 * std::numbers::pi * i / samples(k));
  }

  /// The value of each function of the expansion at z.
  void fillRow(Complex z, Eigen::Ref<Eigen::RowVectorXd> row) const {
    for (std::size_t k = 0; k < circles_.size(); ++k) {
      const Complex base = k == 0 ? z : circles_[k].radius / (z - circles_[k].center);
      row[first_[k]] = k == 0 ? 1 : std::log(std::abs(z - circles_[k].center));
      Complex power = 1;
      for (int m = 0; m < terms_[k]; ++m) {
        power *= base;
        row[first_[k] + 1 + 2 * m] = power.real();
        row[first_[k] + 2 + 2 * m] = power.imag();
      }
    }
  }

  /// All samples, shifted by a part of their distance; and what the functions are on them.
  void fill(double shift, Eigen::MatrixXd& matrix, Eigen::MatrixXd& values) const {
    Eigen::Index rows = 0;
    for (std::size_t k = 0; k < circles_.size(); ++k) rows += samples(k);
    matrix.resize(rows, coefficients_);
    values = Eigen::MatrixXd::Zero(rows, static_cast<Eigen::Index>(circles_.size()) - 1);
    Eigen::Index row = 0;
    Eigen::RowVectorXd entries(coefficients_);
    for (std::size_t k = 0; k < circles_.size(); ++k) {
      for (int i = 0; i < samples(k); ++i, ++row) {
        fillRow(place(k, i + shift), entries);
        matrix.row(row) = entries;
        if (k > 0) values(row, static_cast<Eigen::Index>(k) - 1) = 1;
      }
    }
  }

 private:
  std::vector<Circle> circles_;
  std::vector<int> terms_;
  std::vector<Eigen::Index> first_;
  Eigen::Index coefficients_ = 0;
};

}  // namespace

Result<CircleDomainCapacity> circleDomainCapacity(Context& context,
                                                  const std::vector<Circle>& circles) {
  RETURN_IF_ERROR(checkCircles(circles));
  const Context::Stage stage(context, "capacity");
  const Expansion expansion(circles);
  if (expansion.coefficients() > kMostCoefficients) {
    return Status(Reason::kUnsupportedContent, "circles are so close that their functions need " +
                                                   std::to_string(expansion.coefficients()) +
                                                   " coefficients");
  }
  RETURN_IF_ERROR(context.check());
  Eigen::MatrixXd matrix, values;
  expansion.fill(0, matrix, values);
  const Eigen::MatrixXd solution = matrix.householderQr().solve(values);
  RETURN_IF_ERROR(context.check());
  expansion.fill(0.5, matrix, values);
  CircleDomainCapacity result;
  result.residual = (matrix * solution - values).cwiseAbs().maxCoeff();
  if (!(result.residual <= kLargestResidual)) {
    return Status(Reason::kResidualTooLarge, "harmonic functions miss their boundary values by " +
                                                 shortestDouble(result.residual));
  }
  // The flux of u_j out of the domain through circle k: -2 pi times its logarithm's coefficient.
  const auto holes = static_cast<Eigen::Index>(expansion.count()) - 1;
  Eigen::MatrixXd flux(holes, holes);
  for (Eigen::Index k = 0; k < holes; ++k) {
    flux.row(k) =
        -2 * std::numbers::pi * solution.row(expansion.leading(static_cast<std::size_t>(k) + 1));
  }
  result.asymmetry = (flux - flux.transpose()).cwiseAbs().maxCoeff();
  result.capacity = (flux + flux.transpose()) / 2;
  return result;
}

}  // namespace moduli
