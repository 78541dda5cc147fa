#include "tests/bench/map_bench.h"

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "core/parameterize/atlas.h"
#include "core/parameterize/circle_domain.h"
#include "core/parameterize/cones.h"
#include "core/parameterize/disk.h"
#include "core/parameterize/flat.h"
#include "core/parameterize/polycube.h"
#include "core/parameterize/quads.h"
#include "core/parameterize/sphere.h"
#include "core/parameterize/torus.h"
#include "core/topology/surface_topology.h"

namespace moduli {
namespace {

/// A map of a surface: its cost, what it keeps of angles, and how it was found.
void benchMap(benchmark::State& state, const std::shared_ptr<Case>& mesh,
              const std::function<Result<Parameterization>(
                  Context&, const Connectivity&, const std::vector<double>&,
                  const std::vector<Eigen::Vector3d>&)>& map) {
  const Connectivity& surface = mesh->prepared.mesh.connectivity();
  std::map<std::string, double> stages;
  MapCertificate certificate;
  Index added = 0;
  runTimed(state, *mesh, [&]() -> Status {
    Context context;
    ASSIGN_OR_RETURN(
        const Parameterization found,
        map(context, surface, mesh->prepared.mesh.edgeLengths(), mesh->prepared.mesh.positions()));
    certificate = found.certificate;
    if (found.subdivision) {
      added = static_cast<Index>(found.subdivision->faces.size()) - surface.faceCount();
    }
    for (const auto& [stage, seconds] : context.timing()) stages[stage] += seconds;
    return {};
  });
  for (const auto& [stage, seconds] : stages) count(state, stage, seconds, *mesh);
  state.counters["K"] = certificate.quality.mean_dilatation;
  state.counters["islands"] = certificate.islands.value_or(1);
  state.counters["folds"] = certificate.quality.flipped_faces;
  state.counters["added"] = added;
  state.counters["steps"] = certificate.newton_iterations.value_or(0);
  state.counters["faces"] = surface.faceCount();
}

template <typename Options>
Options withMethod(MapMethod method) {
  Options options;
  options.method = method;
  return options;
}

template <typename Map>
void add(const std::string& name, const std::shared_ptr<Case>& mesh, const Map& map) {
  registerTimed(name, mesh, [=](benchmark::State& state) { benchMap(state, mesh, map); });
}

void registerGenusZero(const std::shared_ptr<Case>& mesh, std::size_t loops) {
  for (const MapMethod method : {MapMethod::kRobust, MapMethod::kLinear, MapMethod::kHeatFlow}) {
    if (loops == 0) {
      add("sphere/" + methodName(method), mesh, [=](Context& context, const auto&... surface) {
        return parameterizeSphere(context, surface..., withMethod<SphereOptions>(method));
      });
    } else if (loops == 1) {
      add("disk/" + methodName(method), mesh, [=](Context& context, const auto&... surface) {
        return parameterizeDisk(context, surface..., withMethod<DiskOptions>(method));
      });
    }
  }
  if (loops > 1) {
    add("circles", mesh, [](Context& context, const auto&... surface) {
      return parameterizeCircleDomain(context, surface...);
    });
  }
}

using Points = std::vector<Eigen::Vector3d>;
using Lengths = std::vector<double>;

Result<Parameterization> withChosenCones(Context& context, const Connectivity& surface,
                                         const Lengths& lengths, const Points&) {
  ASSIGN_OR_RETURN(const ChosenCones chosen, chooseCones(context, surface, lengths, {}));
  FlatOptions options;
  options.cones = chosen.cones;
  return parameterizeFlat(context, surface, lengths, options);
}

/// plane/flat and so on.
void registerPlane(const std::shared_ptr<Case>& mesh, Index genus, bool closed) {
  if (!closed || genus == 1) {
    add("plane/flat", mesh,
        [](Context& context, const Connectivity& surface, const Lengths& lengths, const Points&) {
          return parameterizeFlat(context, surface, lengths, {});
        });
  }
  add("plane/cones", mesh, withChosenCones);
  if (!closed) return;
  if (genus == 1) {
    add("plane/torus", mesh,
        [](Context& context, const Connectivity& surface, const Lengths& lengths, const Points&) {
          return parameterizeTorus(context, surface, lengths, {});
        });
  }
  add("plane/polycube", mesh,
      [](Context& context, const Connectivity& surface, const Lengths& lengths, const Points&) {
        return parameterizePolycube(context, surface, lengths, {});
      });
  add("plane/atlas", mesh,
      [](Context& context, const Connectivity& surface, const Lengths& lengths, const Points&) {
        return parameterizeAtlas(context, surface, lengths, {});
      });
  if (genus == 0) return;
  add("plane/quads", mesh,
      [](Context& context, const Connectivity& surface, const Lengths& lengths, const Points&) {
        return parameterizeQuads(context, surface, lengths, {});
      });
}

}  // namespace

void registerMaps(const std::shared_ptr<Case>& mesh) {
  const SurfaceTopology topology = computeTopology(mesh->prepared.mesh.connectivity());
  if (topology.components != 1) return;
  const std::size_t loops = topology.boundary_loops.size();
  if (topology.genus == 0) registerGenusZero(mesh, loops);
  registerPlane(mesh, topology.genus, loops == 0);
}

}  // namespace moduli
