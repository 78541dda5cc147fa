#include "tests/bench/hyperbolic_bench.h"

#include <optional>
#include <utility>

#include "core/hyperbolic/dirichlet_domain.h"
#include "core/hyperbolic/fuchsian_group.h"
#include "core/hyperbolic/length_spectrum.h"
#include "core/hyperbolic/pants.h"
#include "core/intrinsic/mollify.h"
#include "core/ricci/uniformize.h"
#include "core/signature/hyperbolic_invariants.h"

namespace moduli {
namespace {

/// What the steps start from.
struct Steps {
  DiscreteMetric metric;
  HyperbolicTriangles triangles;
  Development development;
  FuchsianGroup group;
  OrbitPolygon polygon;
  double systole = 0;
};

Result<Steps> takeSteps(const Case& mesh) {
  Context context;
  const Connectivity& surface = mesh.prepared.mesh.connectivity();
  ASSIGN_OR_RETURN(const MollifiedLengths mollified,
                   mollify(surface, mesh.prepared.mesh.edgeLengths()));
  ASSIGN_OR_RETURN(Uniformization found, uniformize(context, surface, mollified.lengths));
  ASSIGN_OR_RETURN(HyperbolicTriangles triangles, hyperbolicTriangles(found.metric));
  ASSIGN_OR_RETURN(Development development, develop(context, triangles));
  ASSIGN_OR_RETURN(FuchsianGroup group, computeFuchsianGroup(context, triangles, development));
  ASSIGN_OR_RETURN(OrbitPolygon polygon, orbitPolygon(context, group));
  ASSIGN_OR_RETURN(const LengthSpectrum shortest, systoles(context, polygon));
  return Steps{std::move(found.metric), std::move(triangles), std::move(development),
               std::move(group),        std::move(polygon),   shortest.geodesics.front().length};
}

/// Once for all benchmarks of a mesh, when the first of them runs.
class Prepared {
 public:
  explicit Prepared(std::shared_ptr<Case> mesh) : mesh_(std::move(mesh)) {}
  const Case& mesh() const { return *mesh_; }
  const Result<Steps>& steps() {
    if (!steps_) steps_.emplace(takeSteps(*mesh_));
    return *steps_;
  }

 private:
  std::shared_ptr<Case> mesh_;
  std::optional<Result<Steps>> steps_;
};

/// Runs one step; its body gets the state for counters of its own.
template <typename Body>
void registerStep(const std::string& name, const std::shared_ptr<Case>& mesh,
                  const std::shared_ptr<Prepared>& prepared, const Body& body) {
  registerTimed("hyperbolic/" + name, mesh, [=](benchmark::State& state) {
    const Result<Steps>& steps = prepared->steps();
    if (!steps.ok()) {
      state.SkipWithError(steps.status().toString().c_str());
      return;
    }
    runTimed(state, prepared->mesh(), [&] {
      Context context;
      return body(context, *steps, state);
    });
  });
}

Status benchDevelop(Context& context, const Steps& steps, benchmark::State& state) {
  ASSIGN_OR_RETURN(const Development found, develop(context, steps.triangles));
  state.counters["faces"] = steps.triangles.surface.faceCount();
  state.counters["radius"] = found.certificate.radius;
  state.counters["root"] = found.root;
  return {};
}

Status benchGroup(Context& context, const Steps& steps, benchmark::State& state) {
  ASSIGN_OR_RETURN(const FuchsianGroup found,
                   computeFuchsianGroup(context, steps.triangles, steps.development));
  state.counters["genus"] = static_cast<double>(found.generators.size()) / 2;
  state.counters["longest"] = found.certificate.longest_displacement;
  return {};
}

Status benchPolygon(Context& context, const Steps& steps, benchmark::State& state) {
  ASSIGN_OR_RETURN(const OrbitPolygon found, orbitPolygon(context, steps.group));
  state.counters["radius"] = found.radius;
  return {};
}

void showSpectrum(const LengthSpectrum& found, benchmark::State& state) {
  state.counters["systole"] = found.geodesics.front().length;
  state.counters["complete"] = found.complete_to / found.geodesics.front().length;
  state.counters["geodesics"] = static_cast<double>(found.geodesics.size());
  state.counters["elements"] = static_cast<double>(found.elements);
}

Status benchSpectrum(Context& context, const Steps& steps, benchmark::State& state) {
  ASSIGN_OR_RETURN(const LengthSpectrum found, shortGeodesics(context, steps.polygon));
  showSpectrum(found, state);
  return {};
}

Status benchLengths(Context& context, const Steps& steps, benchmark::State& state) {
  ASSIGN_OR_RETURN(const LengthSpectrum found,
                   lengthSpectrum(context, steps.polygon, 1.5 * steps.systole));
  showSpectrum(found, state);
  return {};
}

Status benchPants(Context& context, const Steps& steps, benchmark::State& state) {
  ASSIGN_OR_RETURN(const PantsDecomposition found, pantsDecomposition(context, steps.polygon));
  state.counters["seams"] = found.seam_error;
  return {};
}

Status benchSignature(Context& context, const Steps& steps, benchmark::State& state) {
  ASSIGN_OR_RETURN(const HyperbolicInvariants found, hyperbolicInvariants(context, steps.metric));
  state.counters["geodesics"] = static_cast<double>(found.lengths.size());
  return {};
}

}  // namespace

void registerHyperbolic(const std::shared_ptr<Case>& mesh) {
  if (mesh->prepared.mesh.connectivity().eulerCharacteristic() >= 0) return;
  const auto prepared = std::make_shared<Prepared>(mesh);
  registerStep("develop", mesh, prepared, benchDevelop);
  registerStep("group", mesh, prepared, benchGroup);
  registerStep("polygon", mesh, prepared, benchPolygon);
  registerStep("spectrum", mesh, prepared, benchSpectrum);
  registerStep("pants", mesh, prepared, benchPants);
  registerStep("signature", mesh, prepared, benchSignature);
  registerStep("lengths", mesh, prepared, benchLengths);
}

}  // namespace moduli
