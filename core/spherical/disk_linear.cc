#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "core/forms/cotan.h"
#include "core/spherical/delaunay_weights.h"
#include "core/spherical/disk_finish.h"
#include "core/spherical/disk_map.h"
#include "core/topology/surface_topology.h"

namespace moduli {
namespace {

using Complex = std::complex<double>;
using PlanePoints = std::vector<Complex>;

/// Functions that are harmonic inside, with given values on the boundary or given sources. One
/// factorization, any number of solves.
class DirichletProblem {
 public:
  static Result<DirichletProblem> make(Context& context, const spherical::WeightedSurface& metric) {
    const Connectivity& surface = metric.surface;
    DirichletProblem problem(surface, metric.weights);
    std::vector<double> diagonal(problem.inside_.size(), 0.0);
    std::vector<Eigen::Triplet<double>> entries;
    for (Index e = 0; e < surface.edgeCount(); ++e) {
      const Index a = problem.row_[surface.tail(surface.halfedge(e))];
      const Index b = problem.row_[surface.head(surface.halfedge(e))];
      for (const Index row : {a, b}) {
        if (row != kNone) diagonal[row] += metric.weights[e];
      }
      if (a != kNone && b != kNone && a != b) {
        entries.emplace_back(std::max(a, b), std::min(a, b), -metric.weights[e]);
      } else if (a != kNone && a == b) {
        diagonal[a] -= 2 * metric.weights[e];  // A loop: no difference, no energy.
      }
    }
    const auto count = static_cast<Index>(problem.inside_.size());
    for (Index row = 0; row < count; ++row) entries.emplace_back(row, row, diagonal[row]);
    SparseMatrix matrix(count, count);
    matrix.setFromTriplets(entries.begin(), entries.end());
    ASSIGN_OR_RETURN(SpdSolver solver, SpdSolver::make(context, matrix));
    problem.solver_.emplace(std::move(solver));
    return problem;
  }

  bool hasInside() const { return !inside_.empty(); }

  /// With sources (per vertex) inside and 0 on the boundary. Per vertex.
  Result<std::vector<double>> fromSources(Context& context,
                                          const std::vector<double>& sources) const {
    Eigen::MatrixXd right(static_cast<Eigen::Index>(inside_.size()), 1);
    for (std::size_t row = 0; row < inside_.size(); ++row) {
      right(static_cast<Eigen::Index>(row), 0) = sources[inside_[row]];
    }
    ASSIGN_OR_RETURN(const Eigen::MatrixXd solution, solver_->solve(context, right));
    std::vector<double> values(sources.size(), 0.0);
    for (std::size_t row = 0; row < inside_.size(); ++row) {
      values[inside_[row]] = solution(static_cast<Eigen::Index>(row), 0);
    }
    return values;
  }

  /// Per boundary vertex what flows out there of a function that is 0 on the boundary.
  std::vector<double> outflow(const std::vector<double>& values) const {
    std::vector<double> flow(values.size(), 0.0);
    for (Index e = 0; e < surface_.edgeCount(); ++e) {
      const Index a = surface_.tail(surface_.halfedge(e)), b = surface_.head(surface_.halfedge(e));
      if (row_[a] == kNone) flow[a] += weights_[e] * values[b];
      if (row_[b] == kNone) flow[b] += weights_[e] * values[a];
    }
    return flow;
  }

  /// The harmonic extension of the boundary's points; what they say inside is not looked at.
  Result<PlanePoints> extend(Context& context, PlanePoints points) const {
    Eigen::MatrixXd right = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(inside_.size()), 2);
    for (Index e = 0; e < surface_.edgeCount(); ++e) {
      const Index a = surface_.tail(surface_.halfedge(e)), b = surface_.head(surface_.halfedge(e));
      const auto pull = [&](Index row, const Complex& held) {
        right(row, 0) += weights_[e] * held.real();
        right(row, 1) += weights_[e] * held.imag();
      };
      if (row_[a] != kNone && row_[b] == kNone) pull(row_[a], points[b]);
      if (row_[b] != kNone && row_[a] == kNone) pull(row_[b], points[a]);
    }
    ASSIGN_OR_RETURN(const Eigen::MatrixXd solution, solver_->solve(context, right));
    for (std::size_t row = 0; row < inside_.size(); ++row) {
      const auto n = static_cast<Eigen::Index>(row);
      points[inside_[row]] = {solution(n, 0), solution(n, 1)};
    }
    return points;
  }

 private:
  DirichletProblem(const Connectivity& surface, const std::vector<double>& weights)
      : surface_(surface), weights_(weights), row_(surface.vertexCount(), kNone) {
    for (Index v = 0; v < surface.vertexCount(); ++v) {
      if (surface.isBoundaryVertex(v)) continue;
      row_[v] = static_cast<Index>(inside_.size());
      inside_.push_back(v);
    }
  }

  const Connectivity& surface_;
  const std::vector<double>& weights_;
  std::vector<Index> row_;     ///< Per vertex; kNone on the boundary.
  std::vector<Index> inside_;  ///< Per row its vertex.
  std::optional<SpdSolver> solver_;
};

class LinearDiskMap {
 public:
  LinearDiskMap(const Connectivity& surface, const std::vector<double>& lengths)
      : surface_(surface), lengths_(unitLengths(lengths)), areas_(vertexAreas(surface, lengths_)) {
    const SurfaceTopology topology = computeTopology(surface);
    for (const Index h : topology.boundary_loops[0]) {
      boundary_.push_back(surface.tail(h));
      boundary_lengths_.push_back(lengths_[surface.edge(h)]);
    }
  }

  Result<DiskMap> compute(Context& context) {
    ASSIGN_OR_RETURN(const spherical::WeightedSurface metric,
                     spherical::delaunayWeights(context, surface_, lengths_));
    ASSIGN_OR_RETURN(const DirichletProblem problem, DirichletProblem::make(context, metric));
    ASSIGN_OR_RETURN(DiskMap map, compute(context, problem));
    map.flips = metric.flips;
    return map;
  }

 private:
  Result<DiskMap> compute(Context& context, const DirichletProblem& problem) const {
    // A surface without inner vertices has no point to see its boundary from: any convex polygon.
    if (!problem.hasInside()) {
      const std::vector<double> even(surface_.vertexCount(), 1.0);
      return finish(context, around(even), 0);
    }
    // Far from the boundary: where a walker takes the longest to leave.
    ASSIGN_OR_RETURN(const std::vector<double> time, problem.fromSources(context, areas_));
    const auto farthest = std::max_element(time.begin(), time.end()) - time.begin();
    ASSIGN_OR_RETURN(const DiskMap first, seenFrom(context, problem, static_cast<Index>(farthest)));
    // What lies at the centre of the disk sees the boundary as evenly as the map wants it.
    Index center = kNone;
    for (Index v = 0; v < surface_.vertexCount(); ++v) {
      if (surface_.isBoundaryVertex(v)) continue;
      if (center == kNone || std::abs(first.points[v]) < std::abs(first.points[center])) center = v;
    }
    return seenFrom(context, problem, center);
  }

  /// The map that carries a vertex to 0: it turns the boundary by the harmonic measure seen from
  /// there, which is what flows out of a source there.
  Result<DiskMap> seenFrom(Context& context, const DirichletProblem& problem, Index vertex) const {
    std::vector<double> source(surface_.vertexCount(), 0.0);
    source[vertex] = 1;
    ASSIGN_OR_RETURN(const std::vector<double> green, problem.fromSources(context, source));
    ASSIGN_OR_RETURN(const PlanePoints points,
                     problem.extend(context, around(problem.outflow(green))));
    return finish(context, points, 1);
  }

  /// Boundary vertices on the circle. A share is the integral over the two edges at the vertex of a
  /// function that falls from 1 there to 0: each edge gets of both its ends what its length claims.
  PlanePoints around(const std::vector<double>& shares) const {
    const std::size_t count = boundary_.size();
    std::vector<double> arcs(count);
    double total = 0;
    for (std::size_t n = 0; n < count; ++n) {
      const std::size_t before = (n + count - 1) % count, after = (n + 1) % count;
      const double length = boundary_lengths_[n];
      arcs[n] = shares[boundary_[n]] * length / (length + boundary_lengths_[before]) +
                shares[boundary_[after]] * length / (length + boundary_lengths_[after]);
      total += arcs[n];
    }
    PlanePoints points(surface_.vertexCount());
    double sum = 0;
    for (std::size_t n = 0; n < count; ++n) {
      points[boundary_[n]] = std::polar(1.0, 2 * std::numbers::pi * sum / total);
      sum += arcs[n];
    }
    return points;
  }

  Result<DiskMap> finish(Context& context, const PlanePoints& points, int iterations) const {
    ASSIGN_OR_RETURN(DiskMap map,
                     spherical::centeredDiskMap(context, surface_, lengths_, areas_, points));
    map.iterations = iterations;
    return spherical::withTipsReset(context, surface_, lengths_, areas_, std::move(map));
  }

  const Connectivity& surface_;
  std::vector<double> lengths_;
  std::vector<double> areas_;
  std::vector<Index> boundary_;           ///< In order, the surface on the left.
  std::vector<double> boundary_lengths_;  ///< From each of them to the next one.
};

}  // namespace

Result<DiskMap> mapToDiskLinear(Context& context, const Connectivity& surface,
                                const std::vector<double>& lengths) {
  RETURN_IF_ERROR(spherical::checkDisk(surface));
  const Context::Stage stage(context, "disk map");
  ASSIGN_OR_RETURN(DiskMap map, LinearDiskMap(surface, lengths).compute(context));
  RETURN_IF_ERROR(spherical::checkUnfolded(surface, map));
  return map;
}

}  // namespace moduli
