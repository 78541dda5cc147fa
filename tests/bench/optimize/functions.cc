#include "tests/bench/optimize/functions.h"

#include <map>
#include <memory>
#include <utility>

#include "core/mesh/samples.h"
#include "core/mesh/triangle_mesh.h"
#include "core/ricci/uniformization_energy.h"

namespace moduli {
namespace {

/// A Ricci energy with what it is of.
class SurfaceEnergy final : public Objective {
 public:
  explicit SurfaceEnergy(std::unique_ptr<UniformizationEnergy> energy)
      : energy_(std::move(energy)), inner_(energy_->objective()) {}

  Eigen::Index dimension() const override { return inner_.dimension(); }
  std::string name() const override { return inner_.name(); }
  bool constantsInKernel() const override { return inner_.constantsInKernel(); }
  Status moveTo(Context& context, const Eigen::VectorXd& x) override {
    return inner_.moveTo(context, x);
  }
  double value() const override { return inner_.value(); }
  const Eigen::VectorXd& gradient() const override { return inner_.gradient(); }
  const SparseMatrix& hessian() override { return inner_.hessian(); }
  int patternVersion() const override { return inner_.patternVersion(); }
  bool hasThirdDerivatives() const override { return inner_.hasThirdDerivatives(); }
  Eigen::VectorXd thirdContraction(const SparseMatrix& weights) const override {
    return inner_.thirdContraction(weights);
  }

 private:
  std::unique_ptr<UniformizationEnergy> energy_;
  Objective& inner_;
};

using Values = std::map<std::string, double>;

Result<NamedObjective> energyOf(const std::string& kind, const Values& values, Scheme scheme) {
  Context context;
  ASSIGN_OR_RETURN(TriangleSoup soup, makeSample(kind, values));
  ASSIGN_OR_RETURN(const TriangleMesh mesh, TriangleMesh::fromSoup(std::move(soup)));
  ASSIGN_OR_RETURN(auto energy, UniformizationEnergy::make(context, mesh.connectivity(),
                                                           mesh.edgeLengths(), {scheme}));
  Eigen::VectorXd start = energy->start();
  return NamedObjective{std::make_unique<SurfaceEnergy>(std::move(energy)), std::move(start), {}};
}

BenchFunction ricci(const std::string& label, const std::string& kind, const Values& values,
                    Scheme scheme = Scheme::kVertexScaling) {
  return {label, [=] { return energyOf(kind, values, scheme); }, false};
}

BenchFunction named(const std::string& name, Eigen::Index dimension, double condition = 1,
                    const std::string& label = "") {
  ObjectiveOptions options;
  options.dimension = dimension;
  options.condition = condition;
  return {label.empty() ? name : label, [=] { return makeObjective(name, options); }};
}

}  // namespace

std::vector<BenchFunction> benchFunctions() {
  return {named("quadratic", 10, 1e2, "quadratic, condition 1e2"),
          named("quadratic", 10, 1e8, "quadratic, condition 1e8"),
          named("quartic", 10),
          named("rosenbrock", 2),
          named("rosenbrock", 10),
          named("log-barrier", 10),
          named("log-sum-exp", 10),
          named("exp-sum", 2),
          named("exp-sum", 10),
          named("exp-sum", 50),
          ricci("ricci E2, torus", "torus", {{"resolution", 20}}),
          ricci("ricci H2, genus 2", "genus", {{"resolution", 4}}),
          ricci("ricci H2, genus 2, circle packing", "genus", {{"resolution", 4}},
                Scheme::kTangential)};
}

}  // namespace moduli
