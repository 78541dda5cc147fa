#include "core/parameterize/disk_geodesics.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <utility>

#include "core/hyperbolic/closed_path.h"
#include "core/hyperbolic/dirichlet_domain.h"
#include "core/hyperbolic/fuchsian_group.h"
#include "core/hyperbolic/length_spectrum.h"
#include "core/mesh/double_cover.h"
#include "core/signature/hyperbolic_invariants.h"
#include "core/topology/surface_topology.h"

namespace moduli {
namespace {

/// Of geodesics that are not the shortest.
constexpr std::size_t kMostGeodesics = 12;
/// Of edges, from their ends.
constexpr double kAtVertex = 1e-6;

/// A bordered surface and its mirror image.
Result<HyperbolicTriangles> doubled(const HyperbolicTriangles& half) {
  ASSIGN_OR_RETURN(DoubleCover cover, doubleCover(half.surface));
  HyperbolicTriangles whole{std::move(cover.connectivity), {}, half.angles};
  for (Index h = 0; h < whole.surface.halfedgeCount(); ++h) {
    const Index edge = cover.edge[whole.surface.edge(h)];
    whole.lengths.push_back(half.lengths[half.surface.halfedge(edge)]);
  }
  for (Index f = 0; f < cover.face_count; ++f) {
    // The mirrored face has the corners 0, 2, 1.
    for (const int c : {0, 2, 1}) whole.angles.push_back(half.angles[3 * f + c]);
  }
  return whole;
}

/// Geodesics in the faces of a surface that is a part of what they were found in, or all of it.
class Paths {
 public:
  Paths(const HyperbolicTriangles& part, const Development& development)
      : part_(part), development_(development) {}

  /// Nothing where it leaves the part, or runs along its boundary.
  std::optional<GeodesicPath> path(double length, const std::vector<PathStep>& steps) const {
    GeodesicPath result;
    result.length = length;
    bool on_boundary = true;
    for (std::size_t i = 0; i < steps.size(); ++i) {
      const PathStep& step = steps[i];
      if (step.entry >= part_.surface.halfedgeCount()) return std::nullopt;
      on_boundary = on_boundary && isOnBoundary(step);
      const PathStep& next = steps[(i + 1) % steps.size()];
      result.steps.push_back({step.entry, step.fraction, place(step.entry, step.fraction),
                              place(exitBefore(next.entry, step.entry), 1 - next.fraction)});
    }
    if (on_boundary) return std::nullopt;
    return result;
  }

 private:
  /// The side of the face of `entry` beyond which `next` lies.
  Index exitBefore(Index next, Index entry) const {
    if (next >= part_.surface.halfedgeCount()) return entry;  // The path is dropped.
    const Index twin = part_.surface.twin(next);
    return twin == kNone ? entry : twin;
  }

  bool isOnBoundary(const PathStep& step) const {
    const Connectivity& surface = part_.surface;
    if (step.fraction < kAtVertex) return surface.isBoundaryVertex(surface.tail(step.entry));
    return step.fraction > 1 - kAtVertex && surface.isBoundaryVertex(surface.head(step.entry));
  }

  Complex place(Index h, double fraction) const {
    const Complex local = std::tanh(fraction * part_.lengths[h] / 2);
    return imageOf(development_.placed[Connectivity::faceOf(h)] * cornerFrame(part_, h), local);
  }

  const HyperbolicTriangles& part_;
  const Development& development_;
};

}  // namespace

Result<DiskGeodesics> diskGeodesics(Context& context, const HyperbolicTriangles& triangles,
                                    const Development& development) {
  const Context::Stage stage(context, "geodesics");
  const bool closed = computeTopology(triangles.surface).boundary_loops.empty();
  std::optional<HyperbolicTriangles> cover;
  std::optional<Development> cover_development;
  if (!closed) {
    ASSIGN_OR_RETURN(cover, doubled(triangles));
    ASSIGN_OR_RETURN(cover_development, develop(context, *cover));
  }
  const HyperbolicTriangles& whole = closed ? triangles : *cover;
  const Development& whole_development = closed ? development : *cover_development;
  ASSIGN_OR_RETURN(const FuchsianGroup group,
                   computeFuchsianGroup(context, whole, whole_development));
  DiskGeodesics result;
  result.relation_residual = group.certificate.relation_residual;
  if (closed) {
    for (const Su11& g : group.generators) {
      result.generators.push_back(renormalized(group.base * g * inverse(group.base)));
    }
    result.relation_residual = canonicalRelationResidual(result.generators);
  }
  ASSIGN_OR_RETURN(const OrbitPolygon polygon, orbitPolygon(context, group));
  ASSIGN_OR_RETURN(const LengthSpectrum spectrum, shortGeodesics(context, polygon));
  result.complete_to = spectrum.complete_to;
  const Paths paths(triangles, development);
  const Su11 frame = group.base * polygon.base;
  for (const ClosedGeodesic& geodesic : spectrum.geodesics) {
    const bool shortest = !result.geodesics.empty() &&
                          geodesic.length <= result.geodesics.front().length * (1 + 1e-9);
    if (!shortest && result.geodesics.size() >= kMostGeodesics) break;
    const Su11 element = frame * geodesic.element * inverse(frame);
    ASSIGN_OR_RETURN(const std::vector<PathStep> steps,
                     followGeodesic(context, whole, whole_development, element));
    if (auto path = paths.path(geodesic.length, steps)) {
      result.geodesics.push_back(*std::move(path));
    }
  }
  return result;
}

}  // namespace moduli
