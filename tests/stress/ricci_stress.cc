// ricci_stress [--cases N] [--seed S] [--max-faces N] MESH...: the Ricci solver on hard cases.
//
// Makes N cases from the closed connected surfaces among the meshes (others are passed over) and
// fails where the curvature is off by more than 1e-10 or Newton's method needs more than 30 steps.
// Prints every failure with what was done to the surface, and a table per mesh at the end.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "tests/stress/stress_case.h"

namespace moduli::stress {
namespace {

constexpr double kResidual = 1e-10;
constexpr int kSteps = 30;
constexpr int kSkipped = 77;

struct Tally {
  int cases = 0, failures = 0, most_steps = 0;
  double worst_residual = 0;
};

struct Arguments {
  int cases = 50;
  std::uint64_t seed = 1;
  int max_faces = 1 << 30;
  std::vector<std::string> meshes;
};

Arguments parse(int argc, char** argv) {
  Arguments arguments;
  for (int n = 1; n < argc; ++n) {
    const std::string word = argv[n];
    const bool valued = n + 1 < argc;
    if (word == "--cases" && valued) {
      arguments.cases = std::atoi(argv[++n]);
    } else if (word == "--seed" && valued) {
      arguments.seed = std::strtoull(argv[++n], nullptr, 10);
    } else if (word == "--max-faces" && valued) {
      arguments.max_faces = std::atoi(argv[++n]);
    } else {
      arguments.meshes.push_back(word);
    }
  }
  return arguments;
}

std::vector<Surface> readAll(const Arguments& arguments) {
  std::vector<Surface> surfaces;
  for (const std::string& path : arguments.meshes) {
    Context context;
    Result<Surface> surface = readSurface(context, path);
    if (!surface.ok()) continue;
    if (surface->connectivity.faceCount() > arguments.max_faces) continue;
    surfaces.push_back(*std::move(surface));
  }
  return surfaces;
}

bool run(const Surface& surface, std::uint64_t seed, Tally& tally) {
  const Case problem = makeCase(surface, seed);
  Context context;
  const Outcome outcome = solve(context, problem);
  ++tally.cases;
  tally.most_steps = std::max(tally.most_steps, outcome.iterations);
  tally.worst_residual = std::max(tally.worst_residual, outcome.residual);
  if (outcome.status.ok() && outcome.residual <= kResidual && outcome.iterations <= kSteps) {
    return true;
  }
  ++tally.failures;
  std::printf("FAILED %s: %s residual %.1e, %d steps, %d flips\n", problem.description.c_str(),
              outcome.status.ok() ? "" : outcome.status.toString().c_str(), outcome.residual,
              outcome.iterations, outcome.flips);
  std::fflush(stdout);
  return false;
}

int main(int argc, char** argv) {
  const Arguments arguments = parse(argc, argv);
  const std::vector<Surface> surfaces = readAll(arguments);
  if (surfaces.empty()) {
    std::printf("SKIPPED: no closed connected surface among %zu files\n", arguments.meshes.size());
    return kSkipped;
  }
  std::map<std::string, Tally> tallies;
  int failures = 0;
  for (int n = 0; n < arguments.cases; ++n) {
    const Surface& surface = surfaces[static_cast<std::size_t>(n) % surfaces.size()];
    const std::uint64_t seed = arguments.seed * 1000003 + static_cast<std::uint64_t>(n);
    if (!run(surface, seed, tallies[surface.name])) ++failures;
  }
  for (const auto& [name, tally] : tallies) {
    std::printf("%-36s %4d cases, %d failed, at most %2d steps, residual %.1e\n", name.c_str(),
                tally.cases, tally.failures, tally.most_steps, tally.worst_residual);
  }
  std::printf("%d of %d failed\n", failures, arguments.cases);
  return failures == 0 ? 0 : 1;
}

}  // namespace
}  // namespace moduli::stress

int main(int argc, char** argv) {
  return moduli::stress::main(argc, argv);
}
