#include "core/hyperbolic/developing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <queue>
#include <string>
#include <utility>

#include "core/hyperbolic/central_face.h"

namespace moduli {
namespace {

constexpr double kPi = std::numbers::pi;

/// Where frames miss by more, the metric is not one of constant curvature without cones.
constexpr double kWorstResidual = 1e-6;

Status checkTopology(const Connectivity& surface) {
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    if (surface.isBoundaryVertex(v)) {
      return {Reason::kUnsupportedTopology,
              "the surface has a boundary, at vertex " + std::to_string(v)};
    }
  }
  const Index characteristic = surface.eulerCharacteristic();
  if (characteristic >= 0) {
    return {Reason::kUnsupportedTopology, "a closed surface of Euler characteristic " +
                                              std::to_string(characteristic) +
                                              " has no hyperbolic metric"};
  }
  return {};
}

Status checkAngles(const HyperbolicTriangles& triangles) {
  std::vector<double> sum(triangles.surface.vertexCount(), 0.0);
  for (Index h = 0; h < triangles.surface.halfedgeCount(); ++h) {
    sum[triangles.surface.tail(h)] += triangles.angles[h];
  }
  for (std::size_t v = 0; v < sum.size(); ++v) {
    if (std::abs(sum[v] - 2 * kPi) <= 1e-9) continue;
    return {Reason::kInvalidMetric, "the angles at vertex " + std::to_string(v) + " add up to " +
                                        std::to_string(sum[v]) + ", not to 2 pi"};
  }
  return {};
}

/// The changes of coordinates across all edges.
std::vector<Su11> crossings(const HyperbolicTriangles& triangles) {
  const Connectivity& surface = triangles.surface;
  std::vector<Su11> crossing(surface.halfedgeCount());
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    const Index h = surface.halfedge(e);
    const Index twin = surface.twin(h);
    if (twin == kNone) continue;
    crossing[h] = renormalized(cornerFrame(triangles, h) * edgeHalfTurn(triangles.lengths[h]) *
                               inverse(cornerFrame(triangles, twin)));
    crossing[twin] = inverse(crossing[h]);
  }
  return crossing;
}

/// From 0 to the centre of a face, the middle of its corners on the hyperboloid, in its own
/// coordinates. The middle's square is -(3 + 2 sum of cosh(side)), a sum without cancellation.
Su11 centre(const HyperbolicTriangles& triangles, Index f) {
  Complex across = 0;
  double height = 0;
  double square = 3;
  for (Index h = 3 * f; h < 3 * f + 3; ++h) {
    const Su11 corner = cornerFrame(triangles, h);
    across += 2.0 * corner.a * corner.b;
    height += 1 + 2 * std::norm(corner.b);
    square += 2 * std::cosh(triangles.lengths[h]);
  }
  const double norm = std::sqrt(square);
  const double a = std::sqrt((height / norm + 1) / 2);
  return renormalized({a, across / (2 * norm * a)});
}

/// Puts faces into the disk, nearest first.
class Layout {
 public:
  Layout(const Connectivity& surface, const std::vector<Su11>& crossing,
         const std::vector<Su11>& centre)
      : surface_(surface), crossing_(crossing), centre_(centre) {
    placed_.resize(surface.faceCount());
    entry_.assign(surface.faceCount(), kNone);
    distance_.assign(surface.faceCount(), -1.0);
  }

  void from(Index root) {
    place(root, inverse(centre_[root]));
    while (!queue_.empty()) {
      const Candidate next = queue_.top();
      queue_.pop();
      const Index f = Connectivity::faceOf(next.entry);
      if (distance_[f] >= 0) continue;
      const Index behind = surface_.twin(next.entry);
      entry_[f] = next.entry;
      place(f, placed_[Connectivity::faceOf(behind)] * crossing_[behind]);
    }
  }

  void moveTo(Development& development) {
    development.placed = std::move(placed_);
    development.entry = std::move(entry_);
    const double farthest = *std::max_element(distance_.begin(), distance_.end());
    development.certificate.radius = 2 * std::asinh(std::sqrt(farthest));
  }

 private:
  struct Candidate {
    double distance = 0;
    Index entry = 0;
    bool operator<(const Candidate& other) const {
      return distance != other.distance ? distance > other.distance : entry > other.entry;
    }
  };

  void place(Index f, const Su11& frame) {
    placed_[f] = renormalized(frame);
    distance_[f] = distanceOf(placed_[f], f);
    for (Index h = 3 * f; h < 3 * f + 3; ++h) {
      const Index entry = surface_.twin(h);
      if (entry == kNone) continue;
      const Index g = Connectivity::faceOf(entry);
      if (distance_[g] < 0) queue_.push({distanceOf(placed_[f] * crossing_[h], g), entry});
    }
  }

  double distanceOf(const Su11& frame, Index f) const {
    return std::norm(frame.a * centre_[f].b + frame.b * std::conj(centre_[f].a));
  }

  const Connectivity& surface_;
  const std::vector<Su11>& crossing_;
  const std::vector<Su11>& centre_;
  std::vector<Su11> placed_;
  std::vector<Index> entry_;
  std::vector<double> distance_;  ///< Per face sinh(d / 2)^2 of its centre's distance d from 0.
  std::priority_queue<Candidate> queue_;
};

double vertexResidual(const Connectivity& surface, const std::vector<Su11>& crossing) {
  double worst = 0;
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    if (surface.isBoundaryVertex(v)) continue;
    Su11 product;
    const Index first = surface.outgoing(v);
    Index h = first;
    do {
      product = product * crossing[Connectivity::previous(h)];
      h = surface.rotate(h);
    } while (h != first);
    worst = std::max(worst, distanceToUnit(product));
  }
  return worst;
}

double faceResidual(const HyperbolicTriangles& triangles) {
  double worst = 0;
  for (Index h = 1; h < triangles.surface.halfedgeCount(); h += 3) {
    const Su11 along = cornerFrame(triangles, h) * translation(triangles.lengths[h]) *
                       rotation(kPi - triangles.angles[h + 1]);
    worst = std::max(worst, distanceUpToSign(along, cornerFrame(triangles, h + 1)));
  }
  return worst;
}

}  // namespace

Result<HyperbolicTriangles> hyperbolicTriangles(const DiscreteMetric& metric) {
  if (metric.geometry != Geometry::kHyperbolic) {
    return Status(Reason::kInvalidMetric, "the metric is not hyperbolic");
  }
  HyperbolicTriangles triangles{metric.triangulation.connectivity(), {}, metric.angles};
  RETURN_IF_ERROR(checkTopology(triangles.surface));
  for (const double x : metric.half_chords) {
    triangles.lengths.push_back(lengthOfHalfChord(Geometry::kHyperbolic, x));
  }
  return triangles;
}

Result<HyperbolicTriangles> hyperbolicTriangles(const IntrinsicSurface& surface) {
  if (surface.geometry != Geometry::kHyperbolic) {
    return Status(Reason::kInvalidMetric, "the surface is not hyperbolic");
  }
  HyperbolicTriangles triangles{surface.connectivity, {}, {}};
  RETURN_IF_ERROR(checkTopology(triangles.surface));
  for (Index f = 0; f < surface.connectivity.faceCount(); ++f) {
    const TriangleValues sides = surface.sides(f);
    const TriangleValues angles = triangleAngles(Geometry::kHyperbolic, sides);
    triangles.lengths.insert(triangles.lengths.end(), sides.begin(), sides.end());
    for (int c = 0; c < 3; ++c) triangles.angles.push_back(angles[(c + 1) % 3]);
  }
  RETURN_IF_ERROR(checkAngles(triangles));
  return triangles;
}

Su11 cornerFrame(const HyperbolicTriangles& triangles, Index h) {
  const Index first = h - h % 3;
  switch (h % 3) {
    case 0:
      return {};
    case 1:
      return translation(triangles.lengths[first]) * rotation(kPi - triangles.angles[h]);
    default:
      // Back along the third side, from the first corner.
      return rotation(triangles.angles[first]) * translation(triangles.lengths[h]) * rotation(kPi);
  }
}

Result<Development> develop(Context& context, const HyperbolicTriangles& triangles,
                            const DevelopOptions& options) {
  const Context::Stage stage(context, "develop");
  Development development;
  development.crossing = crossings(triangles);
  std::vector<Su11> centres;
  for (Index f = 0; f < triangles.surface.faceCount(); ++f) centres.push_back(centre(triangles, f));
  development.root = options.root;
  if (options.root == kNone) {
    ASSIGN_OR_RETURN(development.root, findCentralFace(context, triangles, development.crossing,
                                                       centres, options.candidates));
  }
  Layout layout(triangles.surface, development.crossing, centres);
  layout.from(development.root);
  layout.moveTo(development);
  DevelopmentCertificate& certificate = development.certificate;
  for (const Su11& g : development.crossing) {
    certificate.determinant_drift =
        std::max(certificate.determinant_drift, std::abs(determinantDrift(g)));
  }
  certificate.vertex_residual = vertexResidual(triangles.surface, development.crossing);
  certificate.face_residual = faceResidual(triangles);
  if (!(certificate.vertex_residual < kWorstResidual &&
        certificate.face_residual < kWorstResidual)) {
    return Status(
        Reason::kResidualTooLarge,
        "the triangles do not close up around their corners: frames miss by " +
            std::to_string(std::max(certificate.vertex_residual, certificate.face_residual)));
  }
  return development;
}

Su11 holonomy(const Connectivity& surface, const Development& development,
              const std::vector<Index>& loop) {
  Su11 product;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    // Clockwise around the head, through the faces on the left.
    const Index end = loop[(i + 1) % loop.size()];
    for (Index h = Connectivity::next(loop[i]); h != end; h = Connectivity::next(surface.twin(h))) {
      product = renormalized(product * development.crossing[h]);
    }
  }
  return product;
}

}  // namespace moduli
