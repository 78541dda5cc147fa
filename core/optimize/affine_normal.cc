#include "core/optimize/affine_normal.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <string>
#include <utility>

#include "core/base/text.h"
#include "core/optimize/normal_deviates.h"
#include "core/optimize/tangent_inverse.h"
#include "core/optimize/third_trace.h"

namespace moduli {
namespace {

constexpr Eigen::Index kMostEigenColumns = 400;

ThirdSource sourceFor(const Objective& objective, const AffineNormalOptions& options) {
  if (options.third != ThirdSource::kAutomatic) return options.third;
  if (objective.hasThirdDerivatives()) return ThirdSource::kAnalytic;
  return objective.dimension() <= kMostEigenColumns ? ThirdSource::kEigenColumns
                                                    : ThirdSource::kGaussian;
}

/// The point, and what differences need to know of it.
struct Here {
  Context& context;
  Objective& objective;
  const Eigen::VectorXd& x;
  Eigen::VectorXd gradient;  ///< 0 at the fixed unknown.
  Eigen::VectorXd whole_gradient;
  Eigen::Index fixed = -1;
  const AffineNormalOptions& options;

  Here(Context& c, Objective& o, const Eigen::VectorXd& at, Eigen::Index fix,
       const AffineNormalOptions& opt)
      : context(c),
        objective(o),
        x(at),
        gradient(o.gradient()),
        whole_gradient(gradient),
        fixed(fix),
        options(opt) {
    if (fixed >= 0) gradient[fixed] = 0;
  }

  double divisor() const { return static_cast<double>(x.size() + (fixed >= 0 ? 0 : 1)); }

  Result<Eigen::VectorXd> along(const EigenColumns& columns) const {
    return tauAlong(context, objective, x, whole_gradient, columns, options.difference_step);
  }
  Result<Eigen::VectorXd> byLogDeterminant() const {
    return tauByLogDeterminant(context, objective, x, gradient, fixed, options.difference_step);
  }

  /// After differences: back to x, nothing at the fixed unknown.
  Result<Eigen::VectorXd> settle(Result<Eigen::VectorXd> tau, bool moved) const {
    if (!tau.ok()) return tau;
    if (moved) RETURN_IF_ERROR(objective.moveTo(context, x));
    if (fixed >= 0) (*tau)[fixed] = 0;
    return tau;
  }

  AffineNormal finish(Eigen::VectorXd direction, Eigen::VectorXd tau, bool convex) const {
    AffineNormal normal;
    normal.decrease = gradient.dot(direction);
    if (fixed >= 0) direction.array() -= direction.mean();
    normal.direction = std::move(direction);
    normal.tau = std::move(tau);
    normal.convex = convex;
    return normal;
  }
};

/// The mean of T(w, w, .) over the columns w of `samples`.
Result<Eigen::VectorXd> meanAlong(const Here& here, Eigen::MatrixXd samples) {
  const Eigen::VectorXd signs = Eigen::VectorXd::Ones(samples.cols());
  ASSIGN_OR_RETURN(const Eigen::VectorXd sum, here.along({std::move(samples), signs}));
  return Eigen::VectorXd(sum / here.options.samples);
}

Result<Eigen::VectorXd> gaussianTau(const Here& here, const SparseMatrix& hessian,
                                    const Eigen::VectorXd& newton) {
  ASSIGN_OR_RETURN(Eigen::MatrixXd samples,
                   tangentSamples({hessian, here.gradient, newton, here.fixed},
                                  here.options.samples, here.options.seed));
  return meanAlong(here, std::move(samples));
}

Result<Eigen::VectorXd> gaussianTau(const Here& here, const Eigen::MatrixXd& P) {
  const EigenColumns roots = eigenColumns(P);
  if (roots.signs.minCoeff() < 0 &&
      roots.columns.col(0).norm() > 1e-7 * roots.columns.colwise().norm().maxCoeff()) {
    return Status{Reason::kNotPositiveDefinite,
                  "the level set is not convex at the point: its inverse Hessian is no covariance",
                  "take eigen-columns"};
  }
  NormalDeviates deviates(here.options.seed);
  return meanAlong(here, roots.columns * deviates.matrix(P.rows(), here.options.samples));
}

Result<Eigen::VectorXd> analyticTau(const Here& here, HessianFactor& factor,
                                    const Eigen::VectorXd& newton, double q) {
  ASSIGN_OR_RETURN(SparseMatrix weights, factor.inverse(here.context));
  for (Eigen::Index column = 0; column < weights.outerSize(); ++column) {
    for (SparseMatrix::InnerIterator it(weights, column); it; ++it) {
      it.valueRef() -= newton[it.row()] * newton[column] / q;
    }
  }
  return here.objective.thirdContraction(weights);
}

Result<Eigen::VectorXd> eigenTau(const Here& here, const SparseMatrix& hessian,
                                 const Eigen::VectorXd& newton, double q) {
  const Eigen::MatrixXd dense = denseOf(hessian);
  Eigen::MatrixXd P = dense.llt().solve(Eigen::MatrixXd::Identity(dense.rows(), dense.cols()));
  P -= newton * newton.transpose() / q;
  if (here.fixed >= 0) P.row(here.fixed).setZero();
  if (here.fixed >= 0) P.col(here.fixed).setZero();
  return here.along(eigenColumns(0.5 * (P + P.transpose())));
}

Result<Eigen::VectorXd> sparseTau(const Here& here, HessianFactor& factor,
                                  const Eigen::VectorXd& newton, double q) {
  const ThirdSource source = sourceFor(here.objective, here.options);
  switch (source) {
    case ThirdSource::kAnalytic:
      return here.settle(analyticTau(here, factor, newton, q), false);
    case ThirdSource::kLogDeterminant:
      return here.settle(here.byLogDeterminant(), true);
    case ThirdSource::kGaussian:
      return here.settle(gaussianTau(here, factor.matrix(), newton), true);
    default:
      return here.settle(eigenTau(here, factor.matrix(), newton, q), true);
  }
}

Result<Eigen::VectorXd> denseTau(const Here& here, const Eigen::MatrixXd& P) {
  switch (sourceFor(here.objective, here.options)) {
    case ThirdSource::kAnalytic:
      return here.settle(here.objective.thirdContraction(onPattern(P, here.objective.hessian())),
                         false);
    case ThirdSource::kLogDeterminant:
      return here.settle(here.byLogDeterminant(), true);
    case ThirdSource::kGaussian:
      return here.settle(gaussianTau(here, P), true);
    default:
      return here.settle(here.along(eigenColumns(P)), true);
  }
}

Status vanishingGradient() {
  return {Reason::kInvalidOption,
          "the gradient vanishes at the point: no level set passes there that has a normal",
          "ask at another point"};
}

Status checkPoint(const Objective& objective, const Eigen::VectorXd& x) {
  if (x.size() != objective.dimension()) {
    return {Reason::kInvalidOption,
            "the point has " + std::to_string(x.size()) + " entries, " + objective.name() +
                " has " + std::to_string(objective.dimension()) + " unknowns",
            "give one entry for each unknown"};
  }
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    if (std::isfinite(x[i])) continue;
    return {Reason::kInvalidOption,
            "entry " + std::to_string(i) + " of the point is " + shortestDouble(x[i]),
            "give finite numbers"};
  }
  return {};
}

Result<AffineNormal> denseNormal(const Here& here) {
  const Eigen::MatrixXd bare = denseHessian(here.objective, here.fixed, 0);
  const double scale = bare.cwiseAbs().maxCoeff();
  const Eigen::MatrixXd hessian = denseHessian(here.objective, here.fixed, scale);
  ASSIGN_OR_RETURN(TangentInverse tangent, here.options.form == AffineForm::kTangent
                                               ? tangentInverseByBasis(hessian, here.gradient)
                                               : tangentInverseBordered(hessian, here.gradient));
  if (here.fixed >= 0) {
    tangent.P.row(here.fixed).setZero();
    tangent.P.col(here.fixed).setZero();
  }
  ASSIGN_OR_RETURN(Eigen::VectorXd tau, denseTau(here, tangent.P));
  const double length = here.gradient.norm();
  const Eigen::VectorXd normal = here.gradient / length;
  const Eigen::VectorXd side = length / here.divisor() * tau - hessian * normal;
  Eigen::VectorXd direction = tangent.P * side;
  direction += normal * (1 - normal.dot(direction));
  return here.finish(std::move(direction), std::move(tau), tangent.positive);
}

}  // namespace

Status checkOptions(const Objective& objective, const AffineNormalOptions& options) {
  if (options.samples < 1) {
    return {Reason::kInvalidOption,
            "samples is " + std::to_string(options.samples) + ", at least 1 is needed"};
  }
  if (!(options.difference_step > 0) || !std::isfinite(options.difference_step)) {
    return {Reason::kInvalidOption,
            "difference_step is " + shortestDouble(options.difference_step) +
                ", a positive number is needed",
            "0.001 serves most"};
  }
  if (options.third == ThirdSource::kAnalytic && !objective.hasThirdDerivatives()) {
    return {Reason::kInvalidOption, objective.name() + " has no third derivatives of its own",
            "take differences of gradients"};
  }
  return {};
}

Result<AffineNormal> affineNormalOf(Context& context, Objective& objective,
                                    const Eigen::VectorXd& x, HessianFactor& factor,
                                    const Eigen::VectorXd& newton,
                                    const AffineNormalOptions& options) {
  const Here here(context, objective, x, factor.fixed(), options);
  const double q = here.gradient.dot(newton);
  if (!(q > 0)) return vanishingGradient();
  ASSIGN_OR_RETURN(Eigen::VectorXd tau, sparseTau(here, factor, newton, q));
  ASSIGN_OR_RETURN(Eigen::VectorXd tangent, factor.solve(context, tau));
  tangent -= newton * (newton.dot(tau) / q);  // P tau.
  return here.finish(newton + q / here.divisor() * tangent, std::move(tau), true);
}

Result<AffineNormal> affineNormal(Context& context, Objective& objective, const Eigen::VectorXd& x,
                                  const AffineNormalOptions& options) {
  RETURN_IF_ERROR(checkPoint(objective, x));
  RETURN_IF_ERROR(checkOptions(objective, options));
  RETURN_IF_ERROR(context.check());
  RETURN_IF_ERROR(objective.moveTo(context, x));
  if (!std::isfinite(objective.value()) || !objective.gradient().allFinite()) {
    return Status{
        Reason::kInvalidOption,
        objective.name() + " has the value " + shortestDouble(objective.value()) + " at the point",
        "ask inside its domain"};
  }
  if (!(objective.gradient().cwiseAbs().maxCoeff() > 0)) return vanishingGradient();
  if (options.form != AffineForm::kInverse) {
    return denseNormal(
        Here(context, objective, x, fixedUnknown(objective, objective.hessian()), options));
  }
  HessianFactor factor;
  RETURN_IF_ERROR(factor.factorize(context, objective, HessianFactor::Indefinite::kFail));
  ASSIGN_OR_RETURN(const Eigen::VectorXd newton, factor.solve(context, objective.gradient()));
  return affineNormalOf(context, objective, x, factor, newton, options);
}

}  // namespace moduli
