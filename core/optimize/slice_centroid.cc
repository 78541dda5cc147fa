#include "core/optimize/slice_centroid.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "core/base/text.h"
#include "core/optimize/formula_objective.h"
#include "core/optimize/minimize.h"
#include "core/optimize/tangent_inverse.h"

namespace moduli {
namespace {

constexpr int kAngles = 200;  ///< Of a plane slice.
constexpr int kHeights = 32;  ///< Of a solid slice, by Gauss's rule, with twice as many angles.
constexpr int kMaxRootSteps = 100;

/// The objective on the plane origin + U z.
class OnPlane : public Objective {
 public:
  OnPlane(Objective& inner, Eigen::VectorXd origin, Eigen::MatrixXd U)
      : inner_(inner), origin_(std::move(origin)), U_(std::move(U)) {}

  Eigen::Index dimension() const override { return U_.cols(); }
  std::string name() const override { return "slice of " + inner_.name(); }
  Status moveTo(Context& context, const Eigen::VectorXd& z) override {
    RETURN_IF_ERROR(inner_.moveTo(context, origin_ + U_ * z));
    gradient_ = U_.transpose() * inner_.gradient();
    return {};
  }
  double value() const override { return inner_.value(); }
  const Eigen::VectorXd& gradient() const override { return gradient_; }
  const SparseMatrix& hessian() override {
    hessian_ = lowerOf(U_.transpose() * denseOf(inner_.hessian()) * U_);
    return hessian_;
  }
  Eigen::VectorXd thirdContraction(const SparseMatrix& /*weights*/) const override { return {}; }

 private:
  Objective& inner_;
  Eigen::VectorXd origin_;
  Eigen::MatrixXd U_;
  Eigen::VectorXd gradient_;
  SparseMatrix hessian_;
};

/// Directions with weights for integrals over the unit sphere of R^m.
struct Directions {
  std::vector<Eigen::VectorXd> vectors;
  std::vector<double> weights;

  void add(Eigen::VectorXd vector, double weight) {
    vectors.push_back(std::move(vector));
    weights.push_back(weight);
  }
};

/// Nodes and weights of Gauss's rule on [-1, 1] by Golub and Welsch.
std::pair<Eigen::VectorXd, Eigen::VectorXd> gaussRule(int count) {
  Eigen::VectorXd off(count - 1);
  for (int k = 1; k < count; ++k) off[k - 1] = k / std::sqrt(4.0 * k * k - 1);
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
  solver.computeFromTridiagonal(Eigen::VectorXd::Zero(count), off);
  return {solver.eigenvalues(), 2 * solver.eigenvectors().row(0).transpose().array().square()};
}

Directions directionsOf(Eigen::Index m) {
  Directions result;
  if (m == 1) {
    result.add(Eigen::VectorXd::Constant(1, 1.0), 1);
    result.add(Eigen::VectorXd::Constant(1, -1.0), 1);
  } else if (m == 2) {
    for (int k = 0; k < kAngles; ++k) {
      const double angle = 2 * std::numbers::pi * k / kAngles;
      result.add(Eigen::Vector2d(std::cos(angle), std::sin(angle)), 1);
    }
  } else {
    const auto [heights, weights] = gaussRule(kHeights);
    for (int i = 0; i < kHeights; ++i) {
      const double radius = std::sqrt(1 - heights[i] * heights[i]);
      for (int k = 0; k < 2 * kHeights; ++k) {
        const double angle = std::numbers::pi * k / kHeights;
        result.add(Eigen::Vector3d(radius * std::cos(angle), radius * std::sin(angle), heights[i]),
                   weights[i]);
      }
    }
  }
  return result;
}

/// How far the level set reaches from z along a direction: a root of a convex function, by Newton's
/// method between a point inside and a point outside.
Result<double> reach(Context& context, OnPlane& slice, const Eigen::VectorXd& z,
                     const Eigen::VectorXd& direction, double level, double guess) {
  double low = 0, high = 0, r = guess;
  for (int n = 0; n < kMaxRootSteps; ++n) {
    RETURN_IF_ERROR(slice.moveTo(context, z + r * direction));
    const double excess = slice.value() - level;
    if (excess == 0) return r;
    (excess < 0 ? low : high) = r;
    double next = r - excess / slice.gradient().dot(direction);
    if (high > 0 && !(next > low && next < high)) next = 0.5 * (low + high);
    if (high == 0 && !(next > low && next < 4 * r)) next = 2 * r;
    if (std::abs(next - r) <= 4e-16 * r) return next;
    r = next;
  }
  // Rounding of the value makes Newton's method jump about the root.
  if (high > 0 && high - low <= 1e-9 * high) return r;
  return Status{Reason::kNoConvergence, "the edge of the slice is not found: is it bounded?"};
}

Status checkSlice(const Objective& objective, const Eigen::VectorXd& x, double depth) {
  if (x.size() != objective.dimension() || x.size() < 2 || x.size() > 4) {
    return {Reason::kInvalidOption, "the point has " + std::to_string(x.size()) +
                                        " entries, slices are for 2 to 4 unknowns, and " +
                                        objective.name() + " has " +
                                        std::to_string(objective.dimension())};
  }
  if (depth > 0 && std::isfinite(depth)) return {};
  return {Reason::kInvalidOption, "depth is " + shortestDouble(depth),
          "give a positive number, small against the level set"};
}

}  // namespace

Result<Eigen::VectorXd> sliceCentroid(Context& context, Objective& objective,
                                      const Eigen::VectorXd& x, double depth) {
  RETURN_IF_ERROR(checkSlice(objective, x, depth));
  RETURN_IF_ERROR(objective.moveTo(context, x));
  const double level = objective.value();
  const Eigen::VectorXd normal = objective.gradient().normalized();
  const Eigen::MatrixXd basis = tangentBasis(objective.gradient());
  const Eigen::Index m = basis.cols();
  OnPlane slice(objective, x - depth * normal, basis);
  const Status outside{Reason::kNoConvergence, "no point of the slice lies in the level set",
                       "take a smaller depth"};
  RETURN_IF_ERROR(slice.moveTo(context, Eigen::VectorXd::Zero(m)));
  if (!std::isfinite(slice.value())) return outside;
  MinimizeOptions options;
  options.method = MinimizeMethod::kNewton;
  ASSIGN_OR_RETURN(const Minimum inside,
                   minimize(context, slice, Eigen::VectorXd::Zero(m), options));
  if (!(inside.value < level)) return outside;
  const Eigen::MatrixXd hessian = denseOf(slice.hessian());
  const Directions directions = directionsOf(m);
  Eigen::VectorXd moment = Eigen::VectorXd::Zero(m);
  double volume = 0;
  for (std::size_t k = 0; k < directions.vectors.size(); ++k) {
    const Eigen::VectorXd& u = directions.vectors[k];
    const double guess = std::sqrt(2 * (level - inside.value) / u.dot(hessian * u));
    ASSIGN_OR_RETURN(const double r, reach(context, slice, inside.x, u, level, guess));
    const auto power = std::pow(r, static_cast<double>(m));
    volume += directions.weights[k] * power / static_cast<double>(m);
    moment += directions.weights[k] * power * r / static_cast<double>(m + 1) * u;
  }
  RETURN_IF_ERROR(objective.moveTo(context, x));
  return Eigen::VectorXd(normal - basis * (inside.x + moment / volume) / depth);
}

}  // namespace moduli
