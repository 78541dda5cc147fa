#include "core/matching/refinement.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/parallel.h"
#include "core/matching/thinning.h"
#include "core/spherical/map_quality.h"

namespace moduli {
namespace {

constexpr int kChances = 10;  ///< How often room is made for a vertex that found no place.
constexpr int kRepairs = 3;
/// Vertices that one thread places before it asks for more.
constexpr std::size_t kTogether = 128;

double excessOf(const Relaxation& map) {
  return map.excess(map.present());
}

/// Vertices of no common edge, side by side. Where one finds no place it is the last one that is
/// back, and returned.
std::optional<RingMesh::Collapse> restoreSome(Relaxation& map, Index wanted) {
  const std::vector<RingMesh::Collapse> undone =
      restoreSeparated(map.mesh(), wanted - map.mesh().vertexCount());
  std::vector<char> placed(undone.size());
  parallelBlocks(undone.size(), kTogether, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      placed[i] = map.place(undone[i].removed, undone[i].kept) ? 1 : 0;
    }
  });
  const auto stuck =
      static_cast<std::size_t>(std::find(placed.begin(), placed.end(), 0) - placed.begin());
  if (stuck == undone.size()) return std::nullopt;
  for (std::size_t i = undone.size() - 1; i > stuck; --i) {
    map.mesh().collapse(undone[i].removed, undone[i].kept);
  }
  return undone[stuck];
}

/// Takes a vertex that found no place out again, and others with it that are stuck near it.
bool makeRoom(Relaxation& map, const RingMesh::Collapse& undone) {
  map.mesh().collapse(undone.removed, undone.kept);
  const Index before = map.mesh().vertexCount();
  return thinUntilTame(map) && map.mesh().vertexCount() < before;
}

/// Whether it helped.
bool repairOnce(Relaxation& map, const RefinementOptions& options) {
  const Index count = map.mesh().vertexCount();
  Relaxation trial = map;
  if (!thinUntilTame(trial, options.wildest)) return false;
  std::vector<Index> restored;
  while (trial.mesh().vertexCount() < count) {
    const RingMesh::Collapse undone = trial.mesh().restore();
    if (!trial.place(undone.removed, undone.kept)) return false;
    restored.push_back(undone.removed);
  }
  for (const Index v : restored) trial.jump(v);
  trial.relaxNear(restored, options.sweeps, options.tolerance);
  if (!(excessOf(trial) < excessOf(map))) return false;
  map = std::move(trial);
  return true;
}

}  // namespace

bool coversOnce(const Relaxation& map) {
  double angle = 0;
  for (const Index v : map.present()) {
    const std::vector<Index>& ring = map.mesh().ring(v);
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Index a = ring[i], b = ring[i + 1 == ring.size() ? 0 : i + 1];
      if (v > a || v > b) continue;
      angle +=
          signedSolidAngle(map.image(v).direction, map.image(a).direction, map.image(b).direction);
    }
  }
  return std::abs(angle / (4 * std::numbers::pi) - 1) < 0.25;
}

bool isAllTame(const Relaxation& map, double wildest) {
  for (const Index v : map.present()) {
    const std::vector<Index>& ring = map.mesh().ring(v);
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Index a = ring[i], b = ring[i + 1 == ring.size() ? 0 : i + 1];
      if (v < a && v < b && !map.isTame(v, a, b, wildest)) return false;
    }
  }
  return true;
}

bool thinUntilTame(Relaxation& map, double wildest) {
  const FaceRule rule = [&](Index a, Index b, Index c) { return map.isTame(a, b, c, wildest); };
  return thinUntil(map.mesh(), map.positions(), rule) && coversOnce(map);
}

Status restoreVertices(Context& context, Relaxation& map, Index wanted) {
  int chances = kChances;
  while (map.mesh().vertexCount() < wanted) {
    RETURN_IF_ERROR(context.check());
    const std::optional<RingMesh::Collapse> undone = restoreSome(map, wanted);
    if (!undone || (chances-- > 0 && makeRoom(map, *undone))) continue;
    return {Reason::kFoldedMap,
            "vertex " + std::to_string(undone->removed) +
                " finds no place that folds no face: the map is thinner there than doubles tell "
                "apart"};
  }
  return {};
}

Status restoreVertices(Context& context, Relaxation& map, Index wanted,
                       const RefinementOptions& options) {
  while (map.mesh().vertexCount() < wanted) {
    const Index next = std::min(2 * map.mesh().vertexCount(), wanted);
    RETURN_IF_ERROR(restoreVertices(context, map, next));
    const std::vector<Index> order = map.inSweepOrder();
    for (const Index v : order) map.jump(v);
    RETURN_IF_ERROR(map.relaxAll(context, order, options.sweeps, options.tolerance));
  }
  return {};
}

Status repairMap(Context& context, Relaxation& map, const RefinementOptions& options) {
  for (int round = 0; round < kRepairs && !isAllTame(map, options.wildest); ++round) {
    RETURN_IF_ERROR(context.check());
    if (!repairOnce(map, options)) break;
  }
  return {};
}

}  // namespace moduli
