#include "core/ricci/punctured_sphere.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <numeric>
#include <queue>
#include <string>
#include <utility>

#include "core/base/text.h"
#include "core/intrinsic/delaunay.h"
#include "core/ricci/newton_system.h"
#include "core/ricci/prescribe.h"
#include "core/ricci/punctured_metric.h"

namespace moduli {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kTolerance = 1e-13;
constexpr double kAcceptable = 1e-10;
/// Rounding of angle sums of a link vertex; a straight one may stand on either side of pi.
constexpr double kStraight = 1e-9;
/// Relative to the residual of free vertices.
constexpr double kEarlyRelease = 0.5;
constexpr double kFineRegion = 1e-4;
/// Real meshes take 4 to 10, stressed ones up to 20; another vertex at infinity is cheaper than
/// more.
constexpr int kMaxIterations = 40;
/// Steps without a residual below all before: releases and joins go around in a circle.
constexpr int kMaxIdle = 8;
constexpr int kMaxShortenings = 30;
constexpr int kMaxReleases = 200;
constexpr double kMaxStep = 8;
constexpr double kSlopeTurn = 0.3;
constexpr double kRoundingRegion = 1e-9;
constexpr Index kCandidates = 6;

/// The active-set Newton iteration for one vertex at infinity.
class Solver {
 public:
  Solver(Context& context, IntrinsicTriangulation triangulation, Index infinity,
         const Unknowns& unknowns)
      : context_(context), metric_(std::move(triangulation), infinity, unknowns) {}

  Status run(const Eigen::VectorXd& start) {
    RETURN_IF_ERROR(metric_.moveTo(context_, start));
    keep();
    double least = residuals_.back();
    int idle = 0;
    for (int n = 0; n < kMaxIterations && idle <= kMaxIdle; ++n) {
      bool moved = false;
      if (!fine_ && residuals_.back() < kFineRegion) {
        // Changes of u far below its rounding are felt from here on.
        fine_ = true;
        base_ = metric_.u();
        metric_.setBase(base_);
        RETURN_IF_ERROR(metric_.moveTo(context_, Eigen::VectorXd::Zero(vertices())));
      }
      if (residuals_.back() > kTolerance) {
        ASSIGN_OR_RETURN(moved, step());
      }
      ASSIGN_OR_RETURN(const bool released, releaseReflex(moved ? kEarlyRelease : 0));
      if (!moved && !released) break;
      idle = residuals_.back() < least ? 0 : idle + 1;
      least = std::min(least, residuals_.back());
    }
    return judge();
  }

  const PuncturedMetric& metric() const { return metric_; }
  /// Per vertex.
  std::vector<double> factors() const {
    std::vector<double> u(metric_.u().begin(), metric_.u().end());
    if (fine_) {
      for (std::size_t v = 0; v < u.size(); ++v) u[v] += base_[static_cast<Eigen::Index>(v)];
    }
    return u;
  }
  const std::vector<double>& residuals() const { return residuals_; }

  double maxLinkAngle() const {
    double largest = 0;
    for (Index v = 0; v < vertices(); ++v) {
      if (metric_.isLinked(v)) largest = std::max(largest, metric_.angleSums()[v]);
    }
    return largest;
  }

 private:
  Index vertices() const { return metric_.triangulation().vertexCount(); }

  void keep() {
    metric_.accept();
    gradient_ = metric_.gradient();
    residuals_.push_back(metric_.residual());
  }

  /// One Newton step of the free vertices; false where rounding has the last word.
  Result<bool> step() {
    const double before = residuals_.back();
    const SparseMatrix& hessian = metric_.hessian();
    ASSIGN_OR_RETURN(
        const Eigen::VectorXd direction,
        system_.direction(context_, hessian, metric_.patternVersion(), false, {}, gradient_));
    const Eigen::VectorXd here = metric_.u();
    Eigen::VectorXd change(vertices());
    for (Index v = 0; v < vertices(); ++v) {
      change[v] = metric_.isFree(v) ? direction[metric_.unknowns().of_vertex[v]] : 0;
    }
    const double slope = gradient_.dot(direction);
    const double length = direction.cwiseAbs().maxCoeff();
    double t = length > kMaxStep ? kMaxStep / length : 1;
    for (int n = 0; n < kMaxShortenings; ++n, t /= 2) {
      const Status moved = metric_.moveTo(context_, here + t * change);
      if (moved.reason() == Reason::kNoConvergence) continue;
      RETURN_IF_ERROR(moved);
      const Eigen::VectorXd gradient = metric_.gradient();
      const double after = metric_.residual();
      if (before < kRoundingRegion && after > before / 2) {
        if (after < before)
          keep();
        else
          RETURN_IF_ERROR(metric_.moveTo(context_, here));
        return false;
      }
      if (gradient.dot(direction) <= kSlopeTurn * std::abs(slope) || after < before / 2) {
        keep();
        return true;
      }
    }
    RETURN_IF_ERROR(metric_.moveTo(context_, here));
    return false;
  }

  /// Takes the vertices off the link whose angle is above pi, by more than `ratio` times the
  /// residual; false if there are none. An angle that is wrong by more than all others is not going
  /// to come right by itself. Vertices that a symmetry exchanges go together; those of which
  /// rounding has put one on the link alone, too, or their unknown would stay held.
  Result<bool> releaseReflex(double ratio) {
    const double excess = std::max(kStraight, ratio * residuals_.back());
    std::vector<bool> reflex(metric_.unknowns().count, false), linked = reflex, free = reflex;
    for (Index v = 0; v < vertices(); ++v) {
      const Index n = metric_.unknowns().of_vertex[v];
      if (metric_.isFree(v)) free[n] = true;
      if (!metric_.isLinked(v)) continue;
      linked[n] = true;
      if (metric_.angleSums()[v] > kPi + excess) reflex[n] = true;
    }
    std::vector<bool> moved(metric_.unknowns().count, false);
    for (Index v = 0; v < vertices(); ++v) {
      const Index n = metric_.unknowns().of_vertex[v];
      if (!metric_.isLinked(v) || !(reflex[n] || (linked[n] && free[n]))) continue;
      if (releases_ >= kMaxReleases) break;
      if (!metric_.release(v)) continue;
      ++releases_;
      moved[n] = true;
    }
    if (std::find(moved.begin(), moved.end(), true) == moved.end()) return false;
    RETURN_IF_ERROR(metric_.moveTo(context_, evened(moved)));
    metric_.accept();
    gradient_ = metric_.gradient();
    residuals_.back() = metric_.residual();
    return true;
  }

  /// u, where the vertices of these unknowns have the largest that one of them has.
  Eigen::VectorXd evened(const std::vector<bool>& unknowns) const {
    const auto base = [&](Index v) { return fine_ ? base_[v] : 0.0; };
    std::vector<double> largest(unknowns.size(), -std::numeric_limits<double>::infinity());
    Eigen::VectorXd u = metric_.u();
    for (Index v = 0; v < vertices(); ++v) {
      const Index n = metric_.unknowns().of_vertex[v];
      largest[n] = std::max(largest[n], u[v] + base(v));
    }
    for (Index v = 0; v < vertices(); ++v) {
      const Index n = metric_.unknowns().of_vertex[v];
      if (unknowns[n]) u[v] = largest[n] - base(v);
    }
    return u;
  }

  /// Whether a vertex has two arcs to infinity: then the finite faces hang together at it only, in
  /// several polygons, each of which may be convex.
  bool touchesItself() const {
    const IntrinsicTriangulation& triangulation = metric_.triangulation();
    std::vector<bool> met(vertices(), false);
    for (Index h = 0; h < triangulation.halfedgeCount(); ++h) {
      if (triangulation.tail(h) != metric_.infinity()) continue;
      if (met[triangulation.head(h)]) return true;
      met[triangulation.head(h)] = true;
    }
    return false;
  }

  Status judge() const {
    if (residuals_.back() > kAcceptable) {
      return {Reason::kNoConvergence, "the punctured sphere stays " +
                                          shortestDouble(residuals_.back()) +
                                          " radians from flat after " +
                                          std::to_string(residuals_.size() - 1) + " Newton steps"};
    }
    if (maxLinkAngle() > kPi + kStraight) {
      return {Reason::kNoConvergence, "the boundary of the flattened sphere stays concave by " +
                                          shortestDouble(maxLinkAngle() - kPi) + " radians"};
    }
    if (touchesItself()) {
      return {Reason::kNoConvergence, "the boundary of the flattened sphere touches itself"};
    }
    return {};
  }

  Context& context_;
  PuncturedMetric metric_;
  NewtonSystem system_;
  Eigen::VectorXd gradient_;
  std::vector<double> residuals_;
  int releases_ = 0;
  Eigen::VectorXd base_;
  bool fine_ = false;  ///< u counts from base_.
};

/// Where the search begins: a triangulation in its discrete conformal class, and factors under
/// which its metric is sound.
struct Start {
  IntrinsicTriangulation triangulation;
  std::vector<double> u;

  double half(Index h) const {
    return triangulation.halfChord(h) *
           std::exp((u[triangulation.tail(h)] + u[triangulation.head(h)]) / 2);
  }
};

/// Distances from one vertex along edges, in half chords of the start's metric.
std::vector<double> edgeDistances(const Start& start, Index source) {
  const IntrinsicTriangulation& triangulation = start.triangulation;
  std::vector<std::vector<std::pair<Index, double>>> neighbours(triangulation.vertexCount());
  for (Index h = 0; h < triangulation.halfedgeCount(); ++h) {
    neighbours[triangulation.tail(h)].push_back({triangulation.head(h), start.half(h)});
  }
  std::vector<double> distance(triangulation.vertexCount(),
                               std::numeric_limits<double>::infinity());
  using Entry = std::pair<double, Index>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  queue.push({0, source});
  distance[source] = 0;
  while (!queue.empty()) {
    const auto [d, v] = queue.top();
    queue.pop();
    if (d > distance[v]) continue;
    for (const auto& [w, length] : neighbours[v]) {
      if (d + length >= distance[w]) continue;
      distance[w] = d + length;
      queue.push({distance[w], w});
    }
  }
  return distance;
}

/// What the inversion at a vertex adds to u: -2 log of the half chord to it.
Eigen::VectorXd invertedFactors(const Start& start, const std::vector<double>& distance,
                                Index infinity) {
  double smallest = std::numeric_limits<double>::infinity();
  for (Index h = 0; h < start.triangulation.halfedgeCount(); ++h) {
    smallest = std::min(smallest, start.half(h));
  }
  Eigen::VectorXd u = Eigen::VectorXd::Zero(start.triangulation.vertexCount());
  for (Index v = 0; v < start.triangulation.vertexCount(); ++v) {
    if (v == infinity) continue;
    u[v] = start.u[v] + start.u[infinity] - 2 * std::log(std::max(distance[v], smallest / 2));
  }
  return u;
}

std::vector<double> spaceDistances(const std::vector<Eigen::Vector3d>& positions, double unit,
                                   Index infinity) {
  std::vector<double> distance;
  distance.reserve(positions.size());
  for (const Eigen::Vector3d& p : positions) {
    distance.push_back((p - positions[infinity]).norm() * unit);
  }
  return distance;
}

/// Per unknown the number of its vertices.
std::vector<Index> orbitSizes(const Unknowns& unknowns) {
  std::vector<Index> sizes(unknowns.count, 0);
  for (const Index n : unknowns.of_vertex) ++sizes[n];
  return sizes;
}

/// The flat metric with three equal cones (orbits of them), far apart: a sound one in every class.
Result<Start> coneMetric(Context& context, const Connectivity& surface,
                         const std::vector<double>& lengths, bool initial_delaunay,
                         const Unknowns& unknowns) {
  const Start given{IntrinsicTriangulation(surface, lengths),
                    std::vector<double>(surface.vertexCount(), 0.0)};
  std::vector<double> target(surface.vertexCount(), 0.0);
  std::vector<double> nearest(surface.vertexCount(), std::numeric_limits<double>::infinity());
  const std::vector<Index> sizes = orbitSizes(unknowns);
  Index cone = 0;
  for (int n = 0; n < 3; ++n) {
    const Index orbit = unknowns.of_vertex[cone];
    for (Index w = 0; w < surface.vertexCount(); ++w) {
      if (unknowns.of_vertex[w] != orbit) continue;
      target[w] = 4 * kPi / (3 * sizes[orbit]);
      const std::vector<double> distance = edgeDistances(given, w);
      for (std::size_t v = 0; v < distance.size(); ++v) {
        nearest[v] = std::min(nearest[v], distance[v]);
      }
    }
    cone = static_cast<Index>(std::max_element(nearest.begin(), nearest.end()) - nearest.begin());
  }
  PrescribeOptions options;
  options.initial_delaunay = initial_delaunay;
  ASSIGN_OR_RETURN(DiscreteMetric metric,
                   prescribeCurvature(context, surface, lengths, target, unknowns, options));
  return Start{std::move(metric.triangulation), std::move(metric.u)};
}

bool hasLoop(const IntrinsicTriangulation& triangulation, Index v) {
  for (Index h = 0; h < triangulation.halfedgeCount(); ++h) {
    if (triangulation.tail(h) == v && triangulation.head(h) == v) return true;
  }
  return false;
}

/// Vertices in the order in which they are tried: the most central ones in space first, or those
/// with most neighbours; well apart in that order after the first.
std::vector<Index> candidates(const IntrinsicTriangulation& triangulation,
                              const std::vector<Eigen::Vector3d>& positions,
                              const Unknowns& unknowns) {
  const Index count = triangulation.vertexCount();
  std::vector<double> key(count, 0.0);
  if (positions.empty()) {
    for (Index h = 0; h < triangulation.halfedgeCount(); ++h) --key[triangulation.tail(h)];
  } else {
    // Weighted by the edges around: an even sampling of the surface, whatever that of the vertices.
    Eigen::Vector3d center = Eigen::Vector3d::Zero();
    double total = 0;
    for (Index h = 0; h < triangulation.halfedgeCount(); ++h) {
      const double weight = triangulation.halfChord(h) * triangulation.halfChord(h);
      center += weight * positions[triangulation.tail(h)];
      total += weight;
    }
    center /= total;
    for (Index v = 0; v < count; ++v) key[v] = (positions[v] - center).norm();
  }
  const std::vector<Index> sizes = orbitSizes(unknowns);
  std::vector<Index> order;
  for (Index v = 0; v < count; ++v) {
    if (sizes[unknowns.of_vertex[v]] == 1) order.push_back(v);
  }
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return key[a] < key[b]; });
  std::vector<Index> chosen;
  const auto fixed = static_cast<Index>(order.size());
  const Index tries = std::min(kCandidates, fixed);
  for (Index n = 0; n < tries; ++n) chosen.push_back(order[n * (fixed / tries)]);
  return chosen;
}

PuncturedSphereMetric describe(const Solver& solver) {
  const PuncturedMetric& metric = solver.metric();
  const Index vertices = metric.triangulation().vertexCount();
  PuncturedSphereMetric result{{Geometry::kEuclidean, metric.triangulation(), solver.factors(),
                                metric.scaledHalfChords(), metric.angles(), MetricCertificate()},
                               metric.infinity(),
                               std::vector<bool>(vertices, false),
                               solver.maxLinkAngle()};
  MetricCertificate& certificate = result.metric.certificate;
  double total = -2 * kPi;  // The turning of the polygon's boundary.
  for (Index v = 0; v < vertices; ++v) {
    if (v == metric.infinity()) continue;
    result.on_link[v] = metric.isLinked(v);
    const double curvature = (metric.isLinked(v) ? kPi : 2 * kPi) - metric.angleSums()[v];
    total += curvature;
    if (metric.isLinked(v)) continue;
    certificate.curvature_residual = std::max(certificate.curvature_residual, std::abs(curvature));
  }
  certificate.gauss_bonnet_residual = std::abs(total);
  certificate.newton_iterations = static_cast<int>(solver.residuals().size()) - 1;
  certificate.residuals = solver.residuals();
  certificate.flips = static_cast<int>(metric.triangulation().history().size());
  certificate.smallest_angle = kPi;
  for (Index h = 0; h < metric.triangulation().halfedgeCount(); ++h) {
    if (metric.finiteFace(h)) {
      certificate.smallest_angle = std::min(certificate.smallest_angle, metric.angles()[h]);
    }
  }
  return result;
}

/// Tries one vertex at infinity after the other.
template <typename Distances>
Result<PuncturedSphereMetric> search(Context& context, const Start& start, const Unknowns& unknowns,
                                     const std::vector<Index>& tries, const Distances& distances) {
  Status failure{Reason::kNoConvergence, "every vertex that was tried has a loop around it"};
  for (const Index infinity : tries) {
    if (hasLoop(start.triangulation, infinity)) continue;
    Solver solver(context, start.triangulation, infinity, unknowns);
    const Status solved = solver.run(invertedFactors(start, distances(infinity), infinity));
    if (solved.ok()) return describe(solver);
    if (solved.reason() != Reason::kNoConvergence) return solved;
    failure = solved;
  }
  return failure;
}

std::vector<Index> triesOf(const PuncturedSphereOptions& options, const Unknowns& unknowns,
                           const IntrinsicTriangulation& triangulation,
                           const std::vector<Eigen::Vector3d>& positions) {
  if (options.infinity != kNone) return {options.infinity};
  return candidates(triangulation, positions, unknowns);
}

/// Half chords of a mean length of 1.
double unitOf(const std::vector<double>& lengths) {
  const double sum = std::accumulate(lengths.begin(), lengths.end(), 0.0);
  return static_cast<double>(lengths.size()) / (2 * sum);
}

Result<Start> givenMetric(Context& context, const Connectivity& surface,
                          std::vector<double> lengths, bool initial_delaunay) {
  const double unit = unitOf(lengths);
  for (double& length : lengths) length *= unit;
  Start start{IntrinsicTriangulation(surface, lengths),
              std::vector<double>(surface.vertexCount(), 0.0)};
  if (initial_delaunay) {
    const Context::Stage stage(context, "delaunay");
    RETURN_IF_ERROR(flipToDelaunayIsometric(context, start.triangulation).status());
  }
  return start;
}

Result<PuncturedSphereMetric> fromSpace(Context& context, const Connectivity& surface,
                                        const std::vector<double>& lengths,
                                        const std::vector<Eigen::Vector3d>& positions,
                                        const PuncturedSphereOptions& options,
                                        const Unknowns& unknowns) {
  ASSIGN_OR_RETURN(const Start start,
                   givenMetric(context, surface, lengths, options.initial_delaunay));
  // Weighted by the surface's own edges, whatever the start makes of them.
  const Start own{IntrinsicTriangulation(surface, lengths), {}};
  const double unit = unitOf(lengths);
  return search(context, start, unknowns, triesOf(options, unknowns, own.triangulation, positions),
                [&](Index infinity) { return spaceDistances(positions, unit, infinity); });
}

/// From factors that are known to be near.
Result<PuncturedSphereMetric> fromFactors(Context& context, const Connectivity& surface,
                                          const std::vector<double>& lengths,
                                          const PuncturedSphereOptions& options,
                                          const Unknowns& unknowns) {
  ASSIGN_OR_RETURN(Start start, givenMetric(context, surface, lengths, options.initial_delaunay));
  if (hasLoop(start.triangulation, options.infinity)) {
    return Status{Reason::kNoConvergence, "the vertex at infinity has a loop around it"};
  }
  Solver solver(context, std::move(start.triangulation), options.infinity, unknowns);
  RETURN_IF_ERROR(
      solver.run(Eigen::Map<const Eigen::VectorXd>(options.start.data(), surface.vertexCount())));
  return describe(solver);
}

Result<PuncturedSphereMetric> fromCones(Context& context, const Connectivity& surface,
                                        const std::vector<double>& lengths,
                                        const PuncturedSphereOptions& options,
                                        const Unknowns& unknowns) {
  ASSIGN_OR_RETURN(const Start start,
                   coneMetric(context, surface, lengths, options.initial_delaunay, unknowns));
  return search(context, start, unknowns, triesOf(options, unknowns, start.triangulation, {}),
                [&](Index infinity) { return edgeDistances(start, infinity); });
}

}  // namespace

Result<PuncturedSphereMetric> uniformizePuncturedSphere(
    Context& context, const Connectivity& surface, const std::vector<double>& lengths,
    const std::vector<Eigen::Vector3d>& positions, const PuncturedSphereOptions& options) {
  if (surface.eulerCharacteristic() != 2 || surface.vertexCount() < 4) {
    return Status{Reason::kUnsupportedTopology,
                  "a sphere of at least 4 vertices is needed, not one of Euler characteristic " +
                      std::to_string(surface.eulerCharacteristic()) + " and " +
                      std::to_string(surface.vertexCount()) + " vertices"};
  }
  const Unknowns unknowns =
      options.unknowns.count > 0 ? options.unknowns : Unknowns::all(surface.vertexCount());
  if (!options.start.empty()) return fromFactors(context, surface, lengths, options, unknowns);
  if (!positions.empty()) {
    Result<PuncturedSphereMetric> found =
        fromSpace(context, surface, lengths, positions, options, unknowns);
    if (found.status().reason() != Reason::kNoConvergence) return found;
  }
  return fromCones(context, surface, lengths, options, unknowns);
}

}  // namespace moduli
