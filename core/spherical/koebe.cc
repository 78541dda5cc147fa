#include "core/spherical/koebe.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <string>
#include <utility>
#include <variant>

#include "core/base/parallel.h"
#include "core/base/text.h"
#include "core/spherical/exterior_map.h"

namespace moduli {
namespace {

using Complex = std::complex<double>;
using Curve = std::vector<Complex>;

constexpr int kMostParts = 32;
constexpr std::size_t kGrain = 2048;
/// Radii this close count as equal.
constexpr double kTie = 1e-6;
/// Below this the history is rounding and says nothing about the rate.
constexpr double kNoise = 1e-12;

/// One step of the iteration: the map that made one loop round.
struct LoopMap {
  std::size_t loop = 0;
  std::variant<InteriorMap, ExteriorMap> map;

  const Curve& images() const {
    return std::visit([](const auto& m) -> const Curve& { return m.images(); }, map);
  }
  std::size_t apply(std::span<Complex> points) const {
    return std::visit([&](const auto& m) { return m.apply(points); }, map);
  }
};

Status checkInput(const std::vector<Complex>& points, const std::vector<std::vector<Index>>& loops,
                  const KoebeOptions& options) {
  if (!(options.tolerance > 0) || options.max_sweeps < 1) {
    return {Reason::kInvalidOption, "the tolerance and the number of sweeps must be positive"};
  }
  if (options.parts < 1 || options.parts > kMostParts) {
    return {Reason::kInvalidOption, "sides are cut into 1 to " + std::to_string(kMostParts) +
                                        " parts, not into " + std::to_string(options.parts)};
  }
  if (loops.empty()) return {Reason::kInvalidOption, "there is no outer loop"};
  for (const Complex z : points) {
    if (std::isfinite(z.real()) && std::isfinite(z.imag())) continue;
    return {Reason::kInvalidOption, "a point of the plane is not finite"};
  }
  std::vector<bool> taken(points.size(), false);
  for (std::size_t k = 0; k < loops.size(); ++k) {
    const std::string name = "loop " + std::to_string(k);
    if (loops[k].size() < 3) {
      return {Reason::kInvalidOption,
              name + " has " + std::to_string(loops[k].size()) + " points; 3 are needed"};
    }
    for (const Index v : loops[k]) {
      if (v < 0 || static_cast<std::size_t>(v) >= points.size()) {
        return {Reason::kInvalidOption, name + " has no point " + std::to_string(v)};
      }
      if (taken[v]) {
        return {Reason::kInvalidOption,
                name + ": point " + std::to_string(v) + " comes a second time"};
      }
      taken[v] = true;
    }
  }
  return {};
}

bool encloses(const Curve& polygon, Complex z) {
  bool inside = false;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Complex a = polygon[k] - z;
    const Complex b = polygon[(k + 1) % polygon.size()] - z;
    if ((a.imag() > 0) == (b.imag() > 0)) continue;
    if (a.real() + (b.real() - a.real()) * (a.imag() / (a.imag() - b.imag())) > 0) inside = !inside;
  }
  return inside;
}

double distanceToCorners(const Curve& polygon, Complex z) {
  double nearest = std::abs(polygon[0] - z);
  for (const Complex corner : polygon) nearest = std::min(nearest, std::abs(corner - z));
  return nearest;
}

/// A point far from the polygon's corners within it, on grids that close in on it.
Complex deepPoint(const Curve& polygon) {
  constexpr int kCells = 24;
  Complex middle = 0;
  for (const Complex z : polygon) middle += z / static_cast<double>(polygon.size());
  double half = 0;
  for (const Complex z : polygon) half = std::max(half, std::abs(z - middle));
  Complex best = middle;
  double depth = encloses(polygon, middle) ? distanceToCorners(polygon, middle) : 0;
  for (int level = 0; level < 4; ++level, half *= 3.0 / kCells) {
    const Complex around = best;
    for (int i = -kCells / 2; i <= kCells / 2; ++i) {
      for (int j = -kCells / 2; j <= kCells / 2; ++j) {
        const Complex z = around + half * Complex(2.0 * i / kCells, 2.0 * j / kCells);
        if (!encloses(polygon, z)) continue;
        const double d = distanceToCorners(polygon, z);
        if (d > depth * (1 + 1e-9)) {
          depth = d;
          best = z;
        }
      }
    }
  }
  return best;
}

/// The points of a loop with each side cut into parts.
Curve divided(const std::vector<Complex>& points, const std::vector<Index>& loop, int parts) {
  Curve curve;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const Complex a = points[loop[k]];
    const Complex b = points[loop[(k + 1) % loop.size()]];
    for (int i = 0; i < parts; ++i) curve.push_back(a + (b - a) * (static_cast<double>(i) / parts));
  }
  return curve;
}

/// The iteration on the loops alone. Keeps its maps for the points between them.
class Iteration {
 public:
  Iteration(Context& context, std::vector<Curve> curves)
      : context_(context), curves_(std::move(curves)), misplaced_(curves_.size(), 0) {}

  /// Until all loops are round to the tolerance or points of one lie beyond another one.
  Status run(const KoebeOptions& options);

  bool placed() const {
    return std::all_of(misplaced_.begin(), misplaced_.end(), [](auto n) { return n == 0; });
  }
  const std::vector<std::size_t>& misplaced() const { return misplaced_; }
  const std::vector<Curve>& curves() const { return curves_; }
  const std::vector<LoopMap>& maps() const { return maps_; }
  const std::vector<double>& history() const { return history_; }

 private:
  Result<LoopMap> mapFor(std::size_t loop) const;
  Status makeRound(std::size_t loop);

  Context& context_;
  std::vector<Curve> curves_;
  std::vector<std::size_t> misplaced_;
  std::vector<LoopMap> maps_;
  std::vector<double> history_;
};

Result<LoopMap> Iteration::mapFor(std::size_t loop) const {
  if (loop > 0) {
    ASSIGN_OR_RETURN(ExteriorMap map, ExteriorMap::make(curves_[loop]));
    return LoopMap{loop, std::move(map)};
  }
  // After the first sweep the outer loop is close to the unit circle.
  const Complex base = history_.empty() ? deepPoint(curves_[0]) : Complex(0);
  ASSIGN_OR_RETURN(InteriorMap map, InteriorMap::make(curves_[0], base));
  return LoopMap{loop, std::move(map)};
}

Status Iteration::makeRound(std::size_t loop) {
  RETURN_IF_ERROR(context_.check());
  const Result<LoopMap> map = mapFor(loop);
  if (!map.ok()) return map.status().withContext("loop " + std::to_string(loop));
  for (std::size_t k = 0; k < curves_.size(); ++k) {
    if (k != loop) misplaced_[loop] += map->apply(curves_[k]);
  }
  curves_[loop] = map->images();
  maps_.push_back(*map);
  return {};
}

Status Iteration::run(const KoebeOptions& options) {
  for (int sweep = 0; sweep < options.max_sweeps; ++sweep) {
    for (std::size_t loop = 0; loop < curves_.size(); ++loop) {
      RETURN_IF_ERROR(makeRound(loop));
      if (misplaced_[loop] > 0) return {};
    }
    const double radius = fitCircle(curves_[0]).radius;
    double error = 0;
    for (const Curve& curve : curves_) {
      error = std::max(error, roundnessError(fitCircle(curve), curve) / radius);
    }
    history_.push_back(error);
    if (error <= options.tolerance) return {};
    if (!std::isfinite(error)) break;
  }
  return {Reason::kNoConvergence, "after " + std::to_string(history_.size()) +
                                      " sweeps loops differ from circles by " +
                                      shortestDouble(history_.back()) + " radii of the outer one"};
}

/// Moves the points between the loops by all maps. Per loop how many lay beyond it.
Result<std::vector<std::size_t>> moveOthers(Context& context, const std::vector<LoopMap>& maps,
                                            std::size_t loop_count, std::vector<Complex>& others) {
  const std::size_t blocks = (others.size() + kGrain - 1) / kGrain;
  std::vector<std::vector<std::size_t>> beyond(blocks, std::vector<std::size_t>(loop_count, 0));
  std::vector<Status> states(blocks);
  parallelBlocks(others.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    const std::span<Complex> block(others.data() + begin, end - begin);
    for (const LoopMap& map : maps) {
      states[begin / kGrain] = context.check();
      if (!states[begin / kGrain].ok()) return;
      beyond[begin / kGrain][map.loop] += map.apply(block);
    }
  });
  std::vector<std::size_t> sum(loop_count, 0);
  for (std::size_t k = 0; k < blocks; ++k) {
    RETURN_IF_ERROR(states[k]);
    for (std::size_t loop = 0; loop < loop_count; ++loop) sum[loop] += beyond[k][loop];
  }
  return sum;
}

/// The ratio of the last two errors that are more than rounding.
double lastRate(const std::vector<double>& history) {
  for (std::size_t k = history.size(); k-- > 1;) {
    if (history[k] > kNoise) return history[k] / history[k - 1];
  }
  return 0;
}

/// The first loop whose size is the largest up to rounding, among those allowed; 0 if none.
template <typename Size>
std::size_t firstLargest(const std::vector<Circle>& circles, std::size_t but, const Size& size) {
  std::size_t best = 0;
  for (std::size_t k = 1; k < circles.size(); ++k) {
    if (k == but) continue;
    if (best == 0 || size(circles[k]) > (1 + kTie) * size(circles[best])) best = k;
  }
  return best;
}

void transform(CircleDomain& domain, const DiskTranslation& map) {
  for (Complex& z : domain.points) z = map(z);
  for (std::size_t k = 1; k < domain.circles.size(); ++k) {
    domain.circles[k] = map(domain.circles[k]);
  }
}

void turn(CircleDomain& domain, Complex direction) {
  const Complex factor = std::conj(direction) / std::abs(direction);
  for (Complex& z : domain.points) z *= factor;
  for (Circle& circle : domain.circles) {
    const Complex center = factor * circle.center;
    circle.center = {center.real() + 0.0, center.imag() + 0.0};  // No -0.
  }
}

/// The outer circle becomes the unit circle.
void makeOuterUnit(CircleDomain& domain) {
  const Circle outer = domain.circles[0];
  for (Complex& z : domain.points) z = (z - outer.center) / outer.radius;
  for (Circle& circle : domain.circles) {
    circle = {(circle.center - outer.center) / outer.radius, circle.radius / outer.radius};
  }
  domain.circles[0] = {0, 1};
}

void normalize(CircleDomain& domain, const std::vector<std::vector<Index>>& loops) {
  makeOuterUnit(domain);
  const std::size_t central = firstLargest(domain.circles, 0, centeredRadius);
  if (central > 0) {
    const double radius = centeredRadius(domain.circles[central]);
    transform(domain, centeringMap(domain.circles[central]));
    domain.circles[central] = {0, radius};
    domain.centered = static_cast<Index>(central);
  }
  const std::size_t second =
      firstLargest(domain.circles, central, [](const Circle& circle) { return circle.radius; });
  if (domain.circles.size() > 2) {
    turn(domain, domain.circles[second].center);
    domain.circles[second].center = domain.circles[second].center.real();
    domain.aligned = static_cast<Index>(second);
  } else {
    turn(domain, domain.points[loops[0][0]]);
  }
  for (std::size_t k = 0; k < loops.size(); ++k) {
    for (const Index v : loops[k]) domain.points[v] = domain.circles[k].project(domain.points[v]);
  }
}

Status beyondLoop(const std::vector<std::size_t>& misplaced, const std::vector<int>& parts) {
  for (std::size_t k = 0; k < misplaced.size(); ++k) {
    if (misplaced[k] == 0 || parts[k] < kMostParts) continue;
    return {Reason::kFoldedMap, std::to_string(misplaced[k]) + " points lie beyond loop " +
                                    std::to_string(k) + ", which should bound them"};
  }
  return {};
}

/// The loops' points go where the iteration took them, each first of its side's parts.
CircleDomain collect(const Iteration& iteration, std::vector<Complex> points,
                     const std::vector<std::vector<Index>>& loops, const std::vector<int>& parts) {
  CircleDomain domain;
  domain.points = std::move(points);
  for (std::size_t k = 0; k < loops.size(); ++k) {
    const Curve& curve = iteration.curves()[k];
    for (std::size_t i = 0; i < loops[k].size(); ++i) {
      domain.points[loops[k][i]] = curve[i * parts[k]];
    }
    domain.circles.push_back(fitCircle(curve));
  }
  domain.history = iteration.history();
  domain.rate = lastRate(domain.history);
  domain.parts = parts;
  normalize(domain, loops);
  return domain;
}

}  // namespace

Result<CircleDomain> koebe(Context& context, std::vector<Complex> points,
                           const std::vector<std::vector<Index>>& loops,
                           const KoebeOptions& options) {
  RETURN_IF_ERROR(checkInput(points, loops, options));
  const Context::Stage stage(context, "circles");
  std::vector<bool> in_loop(points.size(), false);
  for (const std::vector<Index>& loop : loops) {
    for (const Index v : loop) in_loop[v] = true;
  }
  std::vector<int> parts(loops.size(), options.parts);
  while (true) {
    std::vector<Curve> curves;
    for (std::size_t k = 0; k < loops.size(); ++k) {
      curves.push_back(divided(points, loops[k], parts[k]));
    }
    Iteration iteration(context, std::move(curves));
    RETURN_IF_ERROR(iteration.run(options));
    std::vector<std::size_t> misplaced = iteration.misplaced();
    if (iteration.placed()) {
      std::vector<Complex> others;
      for (std::size_t v = 0; v < points.size(); ++v) {
        if (!in_loop[v]) others.push_back(points[v]);
      }
      ASSIGN_OR_RETURN(misplaced, moveOthers(context, iteration.maps(), loops.size(), others));
      if (std::all_of(misplaced.begin(), misplaced.end(), [](auto n) { return n == 0; })) {
        std::size_t next = 0;
        for (std::size_t v = 0; v < points.size(); ++v) {
          if (!in_loop[v]) points[v] = others[next++];
        }
        return collect(iteration, std::move(points), loops, parts);
      }
    }
    RETURN_IF_ERROR(beyondLoop(misplaced, parts));
    for (std::size_t k = 0; k < loops.size(); ++k) {
      if (misplaced[k] > 0) parts[k] = std::min(2 * parts[k], kMostParts);
    }
  }
}

}  // namespace moduli
