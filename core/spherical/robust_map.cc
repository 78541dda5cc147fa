#include "core/spherical/robust_map.h"

#include <cmath>
#include <optional>
#include <utility>

#include "core/forms/cotan.h"
#include "core/intrinsic/flat_charts.h"
#include "core/intrinsic/unfold.h"
#include "core/spherical/plane_lift.h"

namespace moduli {

namespace {

/// Puts what the layout lost, ends of limbs shorter than the least double, where their neighbours
/// are.
void closeRanks(const Connectivity& surface, std::vector<std::complex<double>>& points) {
  const auto isThere = [&](Index v) {
    return std::isfinite(points[v].real()) && std::isfinite(points[v].imag());
  };
  std::vector<Index> queue;
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    if (isThere(v)) queue.push_back(v);
  }
  if (queue.size() == points.size()) return;
  for (std::size_t i = 0; i < queue.size(); ++i) {
    Index h = surface.outgoing(queue[i]);
    do {
      const Index w = surface.head(h);
      if (!isThere(w)) {
        points[w] = points[queue[i]];
        queue.push_back(w);
      }
      h = surface.rotate(h);
    } while (h != surface.outgoing(queue[i]));
  }
}

}  // namespace

IdealStart startOf(const PuncturedSphereMetric& metric) {
  return {metric.infinity, metric.metric.u};
}

PuncturedLayout layOutPunctured(const PuncturedSphereMetric& punctured) {
  const IntrinsicTriangulation& triangulation = punctured.metric.triangulation;
  const Index count = triangulation.halfedgeCount();
  std::vector<Index> twin(count);
  std::vector<bool> at_infinity(triangulation.faceCount(), false), fits(count, false);
  for (Index h = 0; h < count; ++h) {
    twin[h] = triangulation.twin(h);
    if (triangulation.tail(h) == punctured.infinity) at_infinity[h / 3] = true;
  }
  for (Index h = 0; h < count; ++h) {
    fits[h] = !at_infinity[h / 3] && !at_infinity[twin[h] / 3];
  }
  const FlatCharts charts =
      chartsOfTriangles(punctured.metric.half_chords, punctured.metric.angles);
  const Unfolding unfolding = unfold(charts, twin, at_infinity);
  // Every corner around a vertex says where it is, with a rounding of its own.
  PuncturedLayout layout{std::vector<std::complex<double>>(triangulation.vertexCount()),
                         unfoldingGap(unfolding, charts, twin, fits)};
  std::vector<double> corners(triangulation.vertexCount(), 0.0);
  for (Index h = 0; h < count; ++h) {
    if (at_infinity[h / 3]) continue;
    layout.points[triangulation.tail(h)] += unfolding.placed[h];
    ++corners[triangulation.tail(h)];
  }
  for (Index v = 0; v < triangulation.vertexCount(); ++v) {
    if (v != punctured.infinity) layout.points[v] /= corners[v];
  }
  return layout;
}

Result<IdealPolyhedron> mapToIdealPolyhedron(Context& context, const Connectivity& surface,
                                             const std::vector<double>& lengths,
                                             const std::vector<Eigen::Vector3d>& positions,
                                             const PuncturedSphereOptions& options) {
  ASSIGN_OR_RETURN(PuncturedSphereMetric metric,
                   uniformizePuncturedSphere(context, surface, lengths, positions, options));
  const Context::Stage stage(context, "layout");
  PuncturedLayout layout = layOutPunctured(metric);
  for (std::complex<double>& z : layout.points) z = std::conj(z);
  closeRanks(surface, layout.points);
  const std::vector<double> areas = vertexAreas(surface, lengths);
  std::vector<double> weights = areas;
  weights[metric.infinity] = 0;
  Points3 points = balancedLift(layout.points, weights);
  points[metric.infinity] = Eigen::Vector3d::UnitZ();
  ASSIGN_OR_RETURN(MobiusCentering centered, centerByMobius(context, std::move(points), areas));
  return IdealPolyhedron{std::move(centered.points), std::move(metric), layout.closure,
                         centered.residual};
}

Result<SphereMap> mapToSphereRobust(Context& context, const Connectivity& surface,
                                    const std::vector<double>& lengths,
                                    const std::vector<Eigen::Vector3d>& positions,
                                    bool initial_delaunay) {
  std::optional<SphereMap> best;
  Status failure;
  IdealStart start;
  for (const bool delaunay : {initial_delaunay, !initial_delaunay}) {
    PuncturedSphereOptions options;
    options.initial_delaunay = delaunay;
    options.infinity = start.infinity;
    options.start = start.u;
    Result<IdealPolyhedron> ideal =
        mapToIdealPolyhedron(context, surface, lengths, positions, options);
    if (!start.u.empty() && ideal.status().reason() == Reason::kNoConvergence) {
      // What is far away for one triangulation may be farther for the other.
      options.infinity = kNone;
      options.start.clear();
      ideal = mapToIdealPolyhedron(context, surface, lengths, positions, options);
    }
    if (!ideal.ok()) {
      if (ideal.status().reason() != Reason::kNoConvergence) return ideal.status();
      failure = ideal.status();
      continue;
    }
    start = startOf(ideal->metric);
    MapQuality quality = measureSphereMap(surface, lengths, ideal->points);
    if (!best || quality.flipped_faces < best->quality.flipped_faces) {
      best = SphereMap{std::move(ideal->points), std::move(quality), ideal->centering_residual,
                       ideal->metric.metric.certificate.newton_iterations};
    }
    if (best->quality.flipped_faces == 0) break;
  }
  if (!best) return failure;
  return *std::move(best);
}

std::vector<double> lightConeScales(const IntrinsicTriangulation& triangulation,
                                    const Points3& points) {
  std::vector<double> scales(points.size(), 0.0);
  const auto ratio = [&](Index h) {
    const double chord = (points[triangulation.tail(h)] - points[triangulation.head(h)]).norm();
    return triangulation.halfChord(h) / chord;
  };
  for (Index h = 0; h < triangulation.halfedgeCount(); ++h) {
    const Index v = triangulation.tail(h);
    if (scales[v] != 0) continue;
    scales[v] = ratio(h) * ratio(Connectivity::previous(h)) / ratio(Connectivity::next(h));
  }
  return scales;
}

}  // namespace moduli
