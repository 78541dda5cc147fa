#include "tests/bench/ricci_bench.h"

#include <chrono>
#include <map>
#include <string>
#include <utility>

#include "core/intrinsic/delaunay.h"
#include "core/intrinsic/mollify.h"
#include "core/optimize/affine_normal.h"
#include "core/optimize/hessian_factor.h"
#include "core/ricci/ricci_objective.h"
#include "core/ricci/vertex_scaling.h"

namespace moduli {
namespace {

/// Times the contraction of an objective it passes all else on to.
class TimedObjective final : public Objective {
 public:
  explicit TimedObjective(Objective& objective) : objective_(objective) {}
  Eigen::Index dimension() const override { return objective_.dimension(); }
  std::string name() const override { return objective_.name(); }
  bool constantsInKernel() const override { return objective_.constantsInKernel(); }
  Status moveTo(Context& context, const Eigen::VectorXd& x) override {
    return objective_.moveTo(context, x);
  }
  double value() const override { return objective_.value(); }
  const Eigen::VectorXd& gradient() const override { return objective_.gradient(); }
  const SparseMatrix& hessian() override { return objective_.hessian(); }
  int patternVersion() const override { return objective_.patternVersion(); }
  bool hasThirdDerivatives() const override { return true; }
  Eigen::VectorXd thirdContraction(const SparseMatrix& weights) const override {
    const auto start = std::chrono::steady_clock::now();
    Eigen::VectorXd result = objective_.thirdContraction(weights);
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return result;
  }

  mutable double seconds = 0;

 private:
  Objective& objective_;
};

Result<VertexScalingModel> modelOf(Context& context, const Case& mesh) {
  const Connectivity& surface = mesh.prepared.mesh.connectivity();
  ASSIGN_OR_RETURN(MollifiedLengths mollified, mollify(surface, mesh.prepared.mesh.edgeLengths()));
  double total = 0;
  for (const double length : mollified.lengths) total += length;
  for (double& length : mollified.lengths) length *= surface.edgeCount() / (2 * total);
  IntrinsicTriangulation triangulation(surface, mollified.lengths);
  RETURN_IF_ERROR(flipToDelaunayIsometric(context, triangulation).status());
  return VertexScalingModel(
      surface.eulerCharacteristic() < 0 ? Geometry::kHyperbolic : Geometry::kEuclidean,
      std::move(triangulation), Unknowns::all(surface.vertexCount()),
      VertexScalingModel::Flips::kOn);
}

void benchAffineStep(benchmark::State& state, const std::shared_ptr<Case>& mesh) {
  Context setup;
  auto model = modelOf(setup, *mesh);
  if (!model.ok()) return state.SkipWithError(model.status().toString().c_str());
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(model->size());
  RicciObjective energy(*model, zero, zero);
  TimedObjective objective(energy);
  AffineNormalOptions options;
  HessianFactor factor;
  std::map<std::string, double> stages;
  bool odd = false;
  const auto step = [&]() -> Status {
    Context context;
    const auto start = std::chrono::steady_clock::now();
    // Away and back: the objective does nothing where it is already.
    odd = !odd;
    const Eigen::VectorXd x = Eigen::VectorXd::Constant(zero.size(), odd ? 1e-9 : 0);
    RETURN_IF_ERROR(objective.moveTo(context, x));
    benchmark::DoNotOptimize(objective.value());
    stages["value"] +=
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    RETURN_IF_ERROR(factor.factorize(context, objective, HessianFactor::Indefinite::kFail));
    ASSIGN_OR_RETURN(const Eigen::VectorXd newton, factor.solve(context, objective.gradient()));
    RETURN_IF_ERROR(affineNormalOf(context, objective, x, factor, newton, options).status());
    for (const char* stage : {"factorize", "invert", "solve"}) {
      stages[stage] += context.timing().at(stage);
    }
    return {};
  };
  const Status first = step();
  if (!first.ok()) return state.SkipWithError(first.toString().c_str());
  stages.clear();
  objective.seconds = 0;
  runTimed(state, *mesh, step);
  stages["tau"] = objective.seconds;
  for (const auto& [stage, seconds] : stages) count(state, stage, seconds, *mesh);
  state.counters["inverses"] = stages["invert"] / stages["factorize"];
  state.counters["faces"] = mesh->prepared.mesh.faceCount();
}

}  // namespace

void registerRicci(const std::shared_ptr<Case>& mesh) {
  registerTimed("affine_step", mesh,
                [=](benchmark::State& state) { benchAffineStep(state, mesh); });
}

}  // namespace moduli
