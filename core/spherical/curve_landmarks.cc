#include "core/spherical/curve_landmarks.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>

namespace moduli {
namespace {

/// The shortest halfedge from one vertex to another; kNone if there is none. On the boundary the
/// last edge around a vertex has only the halfedge that arrives.
Index halfedgeBetween(const Connectivity& surface, const std::vector<double>& lengths, Index from,
                      Index to) {
  Index best = kNone;
  const auto offer = [&](Index h) {
    if (best == kNone || lengths[surface.edge(h)] < lengths[surface.edge(best)]) best = h;
  };
  Index h = surface.outgoing(from);
  do {
    if (surface.head(h) == to) offer(h);
    const Index arriving = Connectivity::previous(h);
    if (surface.twin(arriving) == kNone && surface.tail(arriving) == to) offer(arriving);
    h = surface.rotate(h);
  } while (h != kNone && h != surface.outgoing(from));
  return best;
}

struct Step {
  Index halfedge;
  bool backwards;  ///< The path goes from the halfedge's head to its tail.
};

Result<std::vector<Step>> stepsOf(const Connectivity& surface, const std::vector<double>& lengths,
                                  std::vector<Index> path, bool closed) {
  for (const Index v : path) {
    if (v < 0 || v >= surface.vertexCount()) {
      return Status(Reason::kInvalidOption,
                    "a curve leaves the surface: there is no vertex " + std::to_string(v));
    }
  }
  if (closed && !path.empty()) path.push_back(path.front());
  if (path.size() < 2) return Status(Reason::kInvalidOption, "a curve needs two vertices");
  std::vector<Step> steps;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const Index h =
        path[i] == path[i + 1] ? kNone : halfedgeBetween(surface, lengths, path[i], path[i + 1]);
    if (h == kNone) {
      return Status(Reason::kInvalidOption,
                    "a curve follows no edge from vertex " + std::to_string(path[i]) +
                        " to vertex " + std::to_string(path[i + 1]),
                    "name the vertices of a path along edges");
    }
    steps.push_back({h, surface.tail(h) != path[i]});
  }
  return steps;
}

/// The corner that a point is; kNone within edges and faces.
Index vertexOf(const Connectivity& surface, const SurfacePoint& point) {
  for (int c = 0; c < 3; ++c) {
    if (point.barycentric[c] == 1) return surface.face(point.face)[c];
  }
  return kNone;
}

}  // namespace

Result<std::vector<SurfacePoint>> resampleCurve(const Connectivity& surface,
                                                const std::vector<double>& lengths,
                                                const std::vector<Index>& path, int count,
                                                bool closed) {
  if (count < (closed ? 1 : 2)) {
    return Status(Reason::kInvalidOption,
                  "a curve needs two points, a closed one needs one, not " + std::to_string(count));
  }
  ASSIGN_OR_RETURN(const std::vector<Step> steps, stepsOf(surface, lengths, path, closed));
  std::vector<double> until = {0};  // Length of the curve up to each vertex.
  for (const Step& step : steps) {
    until.push_back(until.back() + lengths[surface.edge(step.halfedge)]);
  }
  std::vector<SurfacePoint> points;
  std::size_t i = 0;
  for (int k = 0; k < count; ++k) {
    const double at = until.back() * k / (closed ? count : count - 1);
    while (i + 1 < steps.size() && until[i + 1] <= at) ++i;
    double t = std::clamp((at - until[i]) / (until[i + 1] - until[i]), 0.0, 1.0);
    if (k + 1 == count && !closed) t = 1;
    points.push_back(edgePoint(steps[i].halfedge, steps[i].backwards ? 1 - t : t));
  }
  return points;
}

Result<std::vector<Landmark>> curveLandmarks(const MeasuredSurface& a, const MeasuredSurface& b,
                                             const Points3& points_b,
                                             const std::vector<CurvePair>& curves) {
  if (points_b.size() != static_cast<std::size_t>(b.surface.vertexCount())) {
    return Status(Reason::kInvalidOption, "a map to the sphere needs one point for every vertex");
  }
  std::vector<Landmark> landmarks;
  std::set<std::pair<Index, Index>> common;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const auto& [path_a, path_b, count, closed] = curves[i];
    const auto on_a = resampleCurve(a.surface, a.lengths, path_a, count, closed);
    const auto on_b = resampleCurve(b.surface, b.lengths, path_b, count, closed);
    const std::string name = "curve " + std::to_string(i);
    if (!on_a.ok()) return on_a.status().withContext(name + " of the first surface");
    if (!on_b.ok()) return on_b.status().withContext(name + " of the second surface");
    for (int k = 0; k < count; ++k) {
      const Index va = vertexOf(a.surface, (*on_a)[k]), vb = vertexOf(b.surface, (*on_b)[k]);
      if (va != kNone && vb != kNone && !common.emplace(va, vb).second) continue;
      landmarks.push_back({(*on_a)[k], spherePoint(b.surface, points_b, (*on_b)[k])});
    }
  }
  return landmarks;
}

}  // namespace moduli
