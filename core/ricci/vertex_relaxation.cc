#include "core/ricci/vertex_relaxation.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/intrinsic/delaunay.h"
#include "core/ricci/scaled_face.h"

namespace moduli {
namespace {

constexpr double kFirstChange = 0.125;
constexpr double kMaxChange = 64;
constexpr int kMaxHalvings = 50;

}  // namespace

VertexRelaxation::VertexRelaxation(Geometry geometry, IntrinsicTriangulation& triangulation,
                                   std::vector<double>& scale)
    : geometry_(geometry),
      triangulation_(triangulation),
      scale_(scale),
      outgoing_(triangulation.vertexCount(), kNone) {
  for (Index h = 0; h < triangulation_.halfedgeCount(); ++h) {
    // On the boundary the one from which turning counter-clockwise meets every face.
    Index& outgoing = outgoing_[triangulation_.tail(h)];
    if (outgoing == kNone || triangulation_.twin(h) == kNone) outgoing = h;
  }
}

template <typename Visit>
void VertexRelaxation::aroundVertex(Index v, const Visit& visit) const {
  const Index first = outgoing_[v];
  for (Index h = first; h != kNone;) {
    visit(h);
    h = triangulation_.twin(Connectivity::previous(h));
    if (h == first) break;
  }
}

double VertexRelaxation::curvature(Index v) const {
  const bool boundary = triangulation_.twin(outgoing_[v]) == kNone;
  double sum = (boundary ? 1 : 2) * std::numbers::pi;
  aroundVertex(v, [&](Index h) {
    TriangleValues sides;
    Index g = h;
    for (double& side : sides) {
      side = triangulation_.halfChord(g) *
             (scale_[triangulation_.tail(g)] * scale_[triangulation_.head(g)]);
      g = Connectivity::next(g);
    }
    // The angle at the tail is opposite the side after h.
    sum -= 2 * std::atan(scaledFace(geometry_, sides).half_tangent[1]);
  });
  return sum;
}

/// Flips keep all vertices of the faces that they touch in these faces.
void VertexRelaxation::noteFlips(std::size_t since) {
  const auto& history = triangulation_.history();
  for (std::size_t n = since; n < history.size(); ++n) {
    const Index h = history[n].halfedge;
    for (const Index face : {h / 3, triangulation_.twin(h) / 3}) {
      for (Index g = 3 * face; g < 3 * face + 3; ++g) {
        Index& outgoing = outgoing_[triangulation_.tail(g)];
        const bool kept = triangulation_.tail(outgoing) == triangulation_.tail(g) &&
                          triangulation_.twin(outgoing) == kNone;
        if (!kept) outgoing = g;
      }
    }
  }
}

/// The curvature above the target with u changed by `change` from where it was at first.
Result<double> VertexRelaxation::excessAt(Context& context, const std::vector<Index>& vertices,
                                          double change, double target) {
  for (std::size_t n = 0; n < vertices.size(); ++n) {
    scale_[vertices[n]] = start_[n] * std::exp(change / 2);
  }
  std::vector<Index> edges;
  for (const Index v : vertices) {
    aroundVertex(v, [&](Index h) {
      edges.insert(edges.end(), {h, Connectivity::next(h), Connectivity::previous(h)});
    });
  }
  const std::size_t before = triangulation_.history().size();
  RETURN_IF_ERROR(
      flipToDelaunayPtolemy(context, triangulation_, scale_, std::move(edges)).status());
  noteFlips(before);
  double sum = -target;
  for (const Index v : vertices) sum += curvature(v);
  return sum;
}

Result<double> VertexRelaxation::solve(Context& context, const std::vector<Index>& vertices,
                                       double target, double tolerance) {
  start_.clear();
  for (const Index v : vertices) start_.push_back(scale_[v]);
  ASSIGN_OR_RETURN(double excess, excessAt(context, vertices, 0, target));
  if (std::abs(excess) <= tolerance) return 0.0;
  // Curvature grows with u. `near` is on the side of the start, `far` beyond the solution.
  const double sign = excess > 0 ? -1 : 1;
  double near = 0, far = sign * kFirstChange;
  for (;;) {
    ASSIGN_OR_RETURN(excess, excessAt(context, vertices, far, target));
    if (std::abs(excess) <= tolerance) return far;
    if (sign * excess > 0) break;
    near = far;
    far *= 2;
    if (std::abs(far) <= kMaxChange) continue;
    RETURN_IF_ERROR(excessAt(context, vertices, 0, target).status());
    return 0.0;
  }
  double middle = near;
  for (int n = 0; n < kMaxHalvings; ++n) {
    middle = (near + far) / 2;
    ASSIGN_OR_RETURN(excess, excessAt(context, vertices, middle, target));
    if (std::abs(excess) <= tolerance) break;
    (sign * excess > 0 ? far : near) = middle;
  }
  return middle;
}

}  // namespace moduli
