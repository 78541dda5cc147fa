#include "core/optimize/named_objectives.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/text.h"
#include "core/optimize/elementary_objectives.h"
#include "core/optimize/exponential_objectives.h"
#include "core/optimize/normal_deviates.h"

namespace moduli {
namespace {

/// Of functions with dense and with sparse Hessians.
constexpr Eigen::Index kLargestDense = 1000;
constexpr Eigen::Index kLargestSparse = 10000;

Eigen::Index largestDimension(std::string_view name) {
  const bool sparse = name == "quartic" || name == "rosenbrock" || name == "log-barrier";
  return sparse ? kLargestSparse : kLargestDense;
}

NamedObjective quadratic(const ObjectiveOptions& options) {
  const Eigen::Index n = options.dimension;
  NormalDeviates deviates(options.seed);
  const Eigen::MatrixXd basis = deviates.matrix(n, n).householderQr().householderQ();
  Eigen::VectorXd values = Eigen::VectorXd::Constant(n, options.condition);
  for (Eigen::Index i = 0; i + 1 < n; ++i) {
    values[i] = std::pow(options.condition, static_cast<double>(i) / static_cast<double>(n - 1));
  }
  const Eigen::MatrixXd A = basis * values.asDiagonal() * basis.transpose();
  const Eigen::VectorXd center = deviates.vector(n);
  return {std::make_unique<Quadratic>(0.5 * (A + A.transpose()), center), Eigen::VectorXd::Zero(n),
          center};
}

NamedObjective quartic(const ObjectiveOptions& options) {
  const Eigen::Index n = options.dimension;
  // 1, 1/2, ..., 1/n: the affine normal at (1, ..., 1) leads to 0 by symmetry.
  const Eigen::VectorXd start = Eigen::VectorXd::LinSpaced(n, 1, static_cast<double>(n));
  return {std::make_unique<Quartic>(n), start.cwiseInverse(), Eigen::VectorXd::Zero(n)};
}

NamedObjective rosenbrock(const ObjectiveOptions& options) {
  const Eigen::Index n = options.dimension;
  Eigen::VectorXd start = Eigen::VectorXd::Ones(n);
  for (Eigen::Index i = 0; i < n; i += 2) start[i] = -1.2;
  return {std::make_unique<Rosenbrock>(n), start, Eigen::VectorXd::Ones(n)};
}

NamedObjective logBarrier(const ObjectiveOptions& options) {
  const auto n = static_cast<double>(options.dimension);
  const Eigen::VectorXd c = Eigen::VectorXd::LinSpaced(options.dimension, 1, n) / n;
  const Eigen::VectorXd start = Eigen::VectorXd::Constant(options.dimension, 0.1);
  return {std::make_unique<LogBarrier>(c), start, c.cwiseInverse()};
}

/// 4 n random forms of sum 0, so that 0 is inside their convex hull.
struct Forms {
  Eigen::MatrixXd a;
  Eigen::VectorXd b;
  Eigen::VectorXd start;
};

Forms randomForms(const ObjectiveOptions& options) {
  const Eigen::Index n = options.dimension;
  NormalDeviates deviates(options.seed);
  Forms forms{deviates.matrix(n, 4 * n), deviates.vector(4 * n), deviates.vector(n)};
  forms.a.colwise() -= forms.a.rowwise().mean().eval();
  forms.a *= 0.6;
  forms.b *= 0.3;
  return forms;
}

NamedObjective logSumExp(const ObjectiveOptions& options) {
  Forms forms = randomForms(options);
  return {std::make_unique<LogSumExp>(std::move(forms.a), std::move(forms.b)), forms.start, {}};
}

NamedObjective exponentialSum(const ObjectiveOptions& options) {
  Forms forms = randomForms(options);
  return {
      std::make_unique<ExponentialSum>(std::move(forms.a), std::move(forms.b)), forms.start, {}};
}

Status unknownName(std::string_view name) {
  std::string known;
  for (const std::string& other : objectiveNames()) known += (known.empty() ? "" : ", ") + other;
  return {Reason::kInvalidOption, "there is no function '" + std::string(name) + "'",
          "the functions are " + known};
}

}  // namespace

const std::vector<std::string>& objectiveNames() {
  static const std::vector<std::string> names{"quadratic",   "quartic",     "rosenbrock",
                                              "log-barrier", "log-sum-exp", "exp-sum"};
  return names;
}

Status checkObjective(std::string_view name, const ObjectiveOptions& options) {
  const auto& names = objectiveNames();
  if (std::find(names.begin(), names.end(), name) == names.end()) return unknownName(name);
  const Eigen::Index least = name == "rosenbrock" ? 2 : 1;
  if (options.dimension < least || options.dimension > largestDimension(name)) {
    return {Reason::kInvalidOption, "dimension is " + std::to_string(options.dimension) + ", " +
                                        std::string(name) + " takes " + std::to_string(least) +
                                        " to " + std::to_string(largestDimension(name))};
  }
  if (!(options.condition >= 1) || !std::isfinite(options.condition)) {
    return {Reason::kInvalidOption, "condition is " + shortestDouble(options.condition) +
                                        ", a finite number of at least 1 is needed"};
  }
  return {};
}

Result<NamedObjective> makeObjective(std::string_view name, const ObjectiveOptions& options) {
  RETURN_IF_ERROR(checkObjective(name, options));
  if (name == "quadratic") return quadratic(options);
  if (name == "quartic") return quartic(options);
  if (name == "rosenbrock") return rosenbrock(options);
  if (name == "log-barrier") return logBarrier(options);
  if (name == "log-sum-exp") return logSumExp(options);
  return exponentialSum(options);
}

}  // namespace moduli
