#include "tests/bench/case.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <fstream>
#include <iterator>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include "core/mesh/read.h"
#include "core/mesh/samples.h"
#include "core/mesh/write.h"

namespace moduli {
namespace {

Result<std::shared_ptr<Case>> makeCase(const std::string& name, std::string bytes) {
  Context context;
  ReadOptions options;
  options.name = name;
  ASSIGN_OR_RETURN(TriangleSoup soup, readMesh(context, bytes, options));
  ASSIGN_OR_RETURN(PreparedMesh prepared, prepareMesh(context, soup, {}));
  ASSIGN_OR_RETURN(const Yardstick yardstick, measureYardstick(prepared.mesh));
  return std::make_shared<Case>(
      Case{name, std::move(bytes), std::move(soup), std::move(prepared), yardstick});
}

/// Every face cut in four at the middles of its edges; all vertices moved by up to a tenth of the
/// mean edge.
void refineOnce(TriangleSoup& soup, std::mt19937& random) {
  std::map<std::pair<Index, Index>, Index> middles;
  double total = 0;
  const auto middle = [&](Index a, Index b) {
    const auto [entry, fresh] =
        middles.emplace(std::minmax(a, b), static_cast<Index>(soup.vertices.size()));
    if (fresh) {
      total += (soup.vertices[a] - soup.vertices[b]).norm();
      soup.vertices.push_back((soup.vertices[a] + soup.vertices[b]) / 2);
    }
    return entry->second;
  };
  std::vector<Triangle> faces;
  for (const auto& [a, b, c] : soup.faces) {
    const Index ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    faces.insert(faces.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
  }
  soup.faces = std::move(faces);
  const double reach = 0.1 * total / 2 / static_cast<double>(middles.size());
  for (Eigen::Vector3d& p : soup.vertices) {
    for (int k = 0; k < 3; ++k) p[k] += reach * (static_cast<double>(random()) / 2147483648.0 - 1);
  }
}

Result<std::string> refined(const std::string& name, const std::string& bytes, std::size_t faces) {
  Context context;
  ReadOptions options;
  options.name = name;
  ASSIGN_OR_RETURN(TriangleSoup soup, readMesh(context, bytes, options));
  std::mt19937 random(1);
  while (4 * soup.faces.size() <= faces) refineOnce(soup, random);
  return writeMesh(soup, MeshFormat::kPly, Encoding::kBinary);
}

double timed(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

Result<std::shared_ptr<Case>> loadFile(const std::string& path, std::size_t refine) {
  std::ifstream in(path, std::ios::binary);
  if (!in) return Status(Reason::kFileNotFound, path + ": cannot be opened");
  std::string bytes((std::istreambuf_iterator<char>(in)), {});
  std::string name = path.substr(path.find_last_of('/') + 1);
  if (refine > 0) {
    ASSIGN_OR_RETURN(bytes, refined(name, bytes, refine));
    name += "-" + std::to_string(refine);
  }
  return makeCase(name, std::move(bytes));
}

Result<std::shared_ptr<Case>> loadSample(const std::string& kind, double resolution) {
  ASSIGN_OR_RETURN(const TriangleSoup soup,
                   makeSample(kind, {{"resolution", resolution}, {"seed", 1}}));
  ASSIGN_OR_RETURN(std::string bytes, writeMesh(soup, MeshFormat::kPly, Encoding::kBinary));
  return makeCase(kind + "-" + std::to_string(soup.faces.size()), std::move(bytes));
}

void count(benchmark::State& state, const std::string& name, double seconds, const Case& mesh) {
  state.counters[name] =
      benchmark::Counter(seconds / mesh.yardstick.total(), benchmark::Counter::kAvgIterations);
}

void runTimed(benchmark::State& state, const Case& mesh, const std::function<Status()>& work) {
  double total = 0;
  for (auto iteration : state) {
    Status status;
    const double seconds = timed([&] { status = work(); });
    if (!status.ok()) {
      state.SkipWithError(status.toString().c_str());
      return;
    }
    state.SetIterationTime(seconds);
    total += seconds;
  }
  count(state, "F", total, mesh);
}

void registerTimed(const std::string& name, const std::shared_ptr<Case>& mesh,
                   const std::function<void(benchmark::State&)>& body) {
  benchmark::RegisterBenchmark((name + "/" + mesh->name).c_str(), body)
      ->UseManualTime()
      ->Unit(benchmark::kMillisecond);
}

}  // namespace moduli
