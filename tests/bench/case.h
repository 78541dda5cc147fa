#pragma once

#include <benchmark/benchmark.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <string>

#include "core/base/status.h"
#include "core/mesh/prepare.h"
#include "core/mesh/triangle_soup.h"
#include "tests/bench/yardstick.h"

/// What benchmarks of all families share: meshes with their F, and costs counted in it.
namespace moduli {

/// A mesh file in memory, prepared, with its F.
struct Case {
  std::string name;
  std::string bytes;
  TriangleSoup soup;
  PreparedMesh prepared;
  Yardstick yardstick;
};

/// refine > 0: every face is cut in four and all vertices are moved a little, as long as there are
/// no more than `refine` faces then.
Result<std::shared_ptr<Case>> loadFile(const std::string& path, std::size_t refine);
Result<std::shared_ptr<Case>> loadSample(const std::string& kind, double resolution);

/// Adds seconds per iteration as a multiple of F.
void count(benchmark::State& state, const std::string& name, double seconds, const Case& mesh);

/// Runs `work` as a benchmark whose counter F is its cost in F.
void runTimed(benchmark::State& state, const Case& mesh, const std::function<Status()>& work);

/// Registers name/mesh, timed by hand, in milliseconds.
void registerTimed(const std::string& name, const std::shared_ptr<Case>& mesh,
                   const std::function<void(benchmark::State&)>& body);

}  // namespace moduli
