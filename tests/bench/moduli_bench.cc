// moduli_bench [google-benchmark flags] [--refine FACES] [MESH...]: what every stage costs, in F.
//
// F is the time of one CHOLMOD analyse + factorize + solve of the same mesh's cotan Laplacian in
// the same run (yardstick.h). The counters named after stages, and `F` for a whole benchmark, are
// multiples of it. Without meshes, sample surfaces are measured.
// --refine cuts the faces of the meshes that follow in four and moves the vertices a little, as
// long as there are no more than FACES faces then.
#include <benchmark/benchmark.h>
#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "core/intrinsic/mollify.h"
#include "core/mesh/prepare.h"
#include "core/mesh/read.h"
#include "core/retrieval/vector_index.h"
#include "core/ricci/punctured_sphere.h"
#include "core/ricci/uniformize.h"
#include "core/signature/compute.h"
#include "core/topology/surface_topology.h"
#include "tests/bench/case.h"
#include "tests/bench/hyperbolic_bench.h"
#include "tests/bench/map_bench.h"
#include "tests/bench/matching_bench.h"
#include "tests/bench/ricci_bench.h"

namespace moduli {
namespace {

void benchYardstick(benchmark::State& state, const std::shared_ptr<Case>& mesh) {
  for (auto iteration : state) state.SetIterationTime(mesh->yardstick.total());
  state.counters["analyse"] = mesh->yardstick.analyse / mesh->yardstick.total();
  state.counters["factorize"] = mesh->yardstick.factorize / mesh->yardstick.total();
  state.counters["solve"] = mesh->yardstick.solve / mesh->yardstick.total();
  state.counters["alone"] = mesh->yardstick.alone / mesh->yardstick.total();
  state.counters["faces"] = mesh->prepared.mesh.faceCount();
}

void benchRead(benchmark::State& state, const std::shared_ptr<Case>& mesh) {
  ReadOptions options;
  options.name = mesh->name;
  runTimed(state, *mesh, [&] {
    Context context;
    return readMesh(context, mesh->bytes, options).status();
  });
}

void benchPrepare(benchmark::State& state, const std::shared_ptr<Case>& mesh) {
  runTimed(state, *mesh, [&] {
    Context context;
    return prepareMesh(context, mesh->soup, {}).status();
  });
}

// The most memory that the process holds while this lives, above what it held at first, sampled.
class MemoryWatch {
 public:
  MemoryWatch() : before_(resident()), peak_(before_), sampler_([this] { sample(); }) {}
  ~MemoryWatch() { stop(); }
  double stop() {
    done_ = true;
    if (sampler_.joinable()) sampler_.join();
    return peak_ - before_;
  }

 private:
  static double resident() {
    std::ifstream statistics("/proc/self/statm");
    double total = 0, pages = 0;
    statistics >> total >> pages;
    return pages * static_cast<double>(sysconf(_SC_PAGESIZE));
  }
  void sample() {
    while (!done_) {
      peak_ = std::max(peak_, resident());
      std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
  }

  double before_;
  double peak_;
  std::atomic<bool> done_ = false;
  std::thread sampler_;
};

// The conformal block alone: F, what 2 F and a back-substitution for each of its forms would be
// (`allowed`), and the memory at its peak over that of the factor.
void benchConformal(benchmark::State& state, const std::shared_ptr<Case>& mesh) {
  SignatureOptions options;
  options.space = Space::kConformal;
  std::map<std::string, double> stages;
  std::optional<Signature> last;
  const auto sign = [&] {
    Context context;
    auto signature = computeSignature(context, mesh->prepared, options);
    if (!signature.ok()) return signature.status();
    for (const auto& [stage, seconds] : signature->timing) stages[stage] += seconds;
    last = *std::move(signature);
    return Status();
  };
  malloc_trim(0);
  MemoryWatch watch;
  const Status once = sign();
  const double memory = watch.stop();
  if (!once.ok()) {
    state.SkipWithError(once.toString().c_str());
    return;
  }
  stages.clear();
  runTimed(state, *mesh, sign);
  for (const auto& [stage, seconds] : stages) count(state, stage, seconds, *mesh);
  const SignatureTopology& topology = last->topology;
  const Index forms = topology.boundary_loops == 0
                          ? 2 * topology.genus
                          : 2 * (2 * topology.genus + topology.boundary_loops - 1);
  state.counters["genus"] = topology.genus;
  state.counters["loops"] = topology.boundary_loops;
  state.counters["allowed"] = 2 + forms * mesh->yardstick.solve / mesh->yardstick.total();
  state.counters["memory"] = memory / mesh->yardstick.factor_bytes;
}

void benchSignature(benchmark::State& state, const std::shared_ptr<Case>& mesh) {
  std::map<std::string, double> stages;
  runTimed(state, *mesh, [&] {
    Context context;
    const auto signature = computeSignature(context, mesh->prepared);
    if (signature.ok()) {
      for (const auto& [stage, seconds] : signature->timing) stages[stage] += seconds;
    }
    return signature.status();
  });
  for (const auto& [stage, seconds] : stages) count(state, stage, seconds, *mesh);
}

/// The metric of constant curvature: closed surfaces through their own faces (a sphere through
/// infinity), bordered ones of negative Euler characteristic through their doubles.
void benchUniformize(benchmark::State& state, const std::shared_ptr<Case>& mesh) {
  const Connectivity& surface = mesh->prepared.mesh.connectivity();
  const auto mollified = mollify(surface, mesh->prepared.mesh.edgeLengths());
  MetricCertificate certificate;
  std::map<std::string, double> stages;
  runTimed(state, *mesh, [&]() -> Status {
    Context context;
    RETURN_IF_ERROR(mollified.status());
    if (surface.eulerCharacteristic() == 2) {
      ASSIGN_OR_RETURN(const PuncturedSphereMetric found,
                       uniformizePuncturedSphere(context, surface, mollified->lengths,
                                                 mesh->prepared.mesh.positions()));
      certificate = found.metric.certificate;
    } else {
      ASSIGN_OR_RETURN(const Uniformization found,
                       uniformize(context, surface, mollified->lengths));
      certificate = found.metric.certificate;
    }
    for (const auto& [stage, seconds] : context.timing()) stages[stage] += seconds;
    return {};
  });
  for (const auto& [stage, seconds] : stages) count(state, stage, seconds, *mesh);
  state.counters["steps"] = certificate.newton_iterations;
  state.counters["flips"] = certificate.flips;
  state.counters["residual"] = certificate.curvature_residual;
  state.counters["faces"] = surface.faceCount();
  state.counters["chi"] = surface.eulerCharacteristic();
}

void registerMesh(const std::shared_ptr<Case>& mesh) {
  const auto add = [&](const char* stage,
                       void (*body)(benchmark::State&, const std::shared_ptr<Case>&)) {
    registerTimed(stage, mesh, [=](benchmark::State& state) { body(state, mesh); });
  };
  add("F", benchYardstick);
  add("read", benchRead);
  add("prepare", benchPrepare);
  add("conformal", benchConformal);
  if (mesh->prepared.mesh.connectivity().eulerCharacteristic() != 1) {
    add("uniformize", benchUniformize);
  }
  registerRicci(mesh);
  registerMaps(mesh);
  registerHyperbolic(mesh);
  registerMatching(mesh);
  add("signature", benchSignature);
}

VectorSet randomVectors(std::size_t rows, std::size_t dimension) {
  std::mt19937 bits(1);
  VectorSet set;
  set.dimension = dimension;
  set.values.resize(rows * dimension);
  for (float& value : set.values) value = static_cast<float>(bits() >> 8) * 0x1p-24F;
  for (std::size_t i = 0; i < rows; ++i) set.ids.push_back(static_cast<std::int64_t>(i));
  return set;
}

// Ten nearest of random vectors of the shape space's length; queries are rows, moved a little.
void benchSearch(benchmark::State& state) {
  constexpr std::size_t kDimension = 96;
  const VectorSet set = randomVectors(static_cast<std::size_t>(state.range(0)), kDimension);
  auto index = makeFlannIndex(set);
  if (!index.ok()) {
    state.SkipWithError(index.status().toString().c_str());
    return;
  }
  std::size_t row = 0;
  for (auto iteration : state) {
    std::vector<float> query(set.values.begin() + row * kDimension,
                             set.values.begin() + (row + 1) * kDimension);
    for (float& value : query) value += 0.01F;
    row = (row + 7919) % set.ids.size();
    Context context;
    auto found = (*index)->search(context, query, 10);
    if (!found.ok()) state.SkipWithError(found.status().toString().c_str());
    benchmark::DoNotOptimize(found);
  }
}

bool registerCase(const Result<std::shared_ptr<Case>>& mesh) {
  if (mesh.ok()) {
    registerMesh(*mesh);
  } else {
    std::fprintf(stderr, "moduli_bench: %s\n", mesh.status().toString().c_str());
  }
  return mesh.ok();
}

int runAll(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  bool good = true;
  std::size_t refine = 0;
  for (int i = 1; i < argc; ++i) {
    if (std::string(argv[i]) == "--refine" && i + 1 < argc) {
      refine = std::strtoul(argv[++i], nullptr, 10);
    } else {
      good &= registerCase(loadFile(argv[i], refine));
    }
  }
  if (argc == 1) {
    good &= registerCase(loadSample("sphere", 45)) && registerCase(loadSample("torus", 100)) &&
            registerCase(loadSample("genus", 16)) && registerCase(loadSample("annulus", 40));
    benchmark::RegisterBenchmark("search", benchSearch)
        ->Arg(10000)
        ->Arg(100000)
        ->Unit(benchmark::kMillisecond);
  }
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return good ? 0 : 1;
}

}  // namespace
}  // namespace moduli

int main(int argc, char** argv) {
  return moduli::runAll(argc, argv);
}
