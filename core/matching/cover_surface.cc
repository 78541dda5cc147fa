#include "core/matching/cover_surface.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "core/base/parallel.h"
#include "core/hyperbolic/straight_faces.h"
#include "core/intrinsic/mollify.h"
#include "core/ricci/uniformize.h"
#include "core/topology/surface_topology.h"

namespace moduli {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;

/// Elements that one thread takes before it asks for more.
constexpr std::size_t kTogether = 2048;

/// Calls act for all elements, on all processors. It writes to its own one alone.
template <typename Action>
void forEach(Index count, const Action& act) {
  parallelBlocks(static_cast<std::size_t>(count), kTogether,
                 [&](std::size_t begin, std::size_t end) {
                   for (std::size_t i = begin; i < end; ++i) act(static_cast<Index>(i));
                 });
}

/// From 0 and the x axis to the tail of corner c's halfedge and its direction.
Motion cornerFrame(const CoverPlane& plane, const std::vector<double>& lengths,
                   const std::vector<double>& angles, Index h) {
  const Index first = h - h % 3;
  if (h == first) return Motion::Identity();
  if (h == first + 1) {
    return plane.shift({lengths[first], 0}) * CoverPlane::turn(kPi - angles[first + 1]);
  }
  return CoverPlane::turn(angles[first]) * plane.shift({lengths[first + 2], 0}) *
         CoverPlane::turn(kPi);
}

double totalArea(const CoverSurface& cover) {
  const CoverPlane plane = cover.plane();
  double sum = 0;
  for (Index h = 0; h < cover.surface.halfedgeCount(); h += 3) {
    sum += plane.area(cover.corners[h + 1], cover.corners[h + 2]);
  }
  return sum;
}

/// Turns the coordinates of all faces of a flat surface alike, and scales them.
void alignFaces(CoverSurface& cover, double scale) {
  const Connectivity& surface = cover.surface;
  std::vector<std::optional<Eigen::Matrix2d>> turn(surface.faceCount());
  std::vector<Index> queue = {0};
  turn[0] = Eigen::Matrix2d::Identity();
  for (std::size_t n = 0; n < queue.size(); ++n) {
    for (Index h = 3 * queue[n]; h < 3 * queue[n] + 3; ++h) {
      if (surface.twin(h) == kNone) continue;
      const Index beyond = Connectivity::faceOf(surface.twin(h));
      if (turn[beyond]) continue;
      const Eigen::Matrix2d next = *turn[queue[n]] * cover.across[h].topLeftCorner<2, 2>();
      turn[beyond] = next / std::sqrt(next.determinant());
      queue.push_back(beyond);
    }
  }
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    cover.corners[h].head<2>() = (*turn[h / 3] * cover.corners[h].head<2>() * scale).eval();
  }
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    const Index h = surface.halfedge(e), t = surface.twin(h);
    if (t == kNone) continue;
    // What both faces make of the middle of the edge.
    const Vector3d shift = (cover.corners[h] + cover.corners[Connectivity::next(h)] -
                            cover.corners[t] - cover.corners[Connectivity::next(t)]) /
                           2;
    cover.across[h] = cover.across[t] = Motion::Identity();
    cover.across[h].topRightCorner<2, 1>() = shift.head<2>();
    cover.across[t].topRightCorner<2, 1>() = -shift.head<2>();
  }
}

/// Faces side by side; across edges of a boundary there is nothing.
CoverSurface glued(Geometry geometry, const Connectivity& surface,
                   const std::vector<double>& lengths, const std::vector<double>& angles,
                   const std::vector<double>& given) {
  CoverSurface cover{geometry, surface, given, {}, {}};
  const CoverPlane plane(geometry);
  std::vector<Motion> frames(surface.halfedgeCount());
  cover.corners.resize(surface.halfedgeCount());
  cover.across.resize(surface.halfedgeCount());
  forEach(surface.halfedgeCount(), [&](Index h) {
    frames[h] = cornerFrame(plane, lengths, angles, h);
    cover.corners[h] = plane.normalized(Vector3d(frames[h].col(2)));
  });
  forEach(surface.edgeCount(), [&](Index e) {
    const Index h = surface.halfedge(e), t = surface.twin(h);
    if (t == kNone) return;
    cover.across[h] = plane.normalized(Motion(frames[h] * plane.shift({lengths[h], 0}) *
                                              CoverPlane::turn(kPi) * plane.inverse(frames[t])));
    cover.across[t] = plane.inverse(cover.across[h]);
  });
  return cover;
}

Status checkTopology(const Connectivity& surface) {
  const SurfaceTopology topology = computeTopology(surface);
  if (topology.components == 1 && topology.boundary_loops.empty() && topology.genus >= 1) return {};
  return {Reason::kUnsupportedTopology,
          "maps between covers are those of closed connected surfaces with handles"};
}

}  // namespace

Vector3d CoverSurface::place(const SurfacePoint& point) const {
  const Index h = 3 * point.face;
  return plane().normalized(Vector3d(point.barycentric[0] * corners[h] +
                                     point.barycentric[1] * corners[h + 1] +
                                     point.barycentric[2] * corners[h + 2]));
}

Vector3d CoverSurface::weights(Index face, const Vector3d& place) const {
  const Index h = 3 * face;
  const Vector3d &a = corners[h], &b = corners[h + 1], &c = corners[h + 2];
  // Seen from corner a = (0, 0, 1), so that small faces keep their digits.
  const auto cross = [](const Vector3d& p, const Vector3d& q) { return p[0] * q[1] - p[1] * q[0]; };
  const double whole = cross(b, c);
  const double at_b = cross(place, c) / whole, at_c = cross(b, place) / whole;
  return {(place[2] - at_b * b[2] - at_c * c[2]) / a[2], at_b, at_c};
}

SurfacePoint CoverSurface::pointAt(Index face, const Vector3d& place) const {
  const Vector3d found = weights(face, place).cwiseMax(0.0);
  const double sum = found.sum();
  return {face, {found[0] / sum, found[1] / sum, found[2] / sum}};
}

CoverSurface coverOfTriangles(Geometry geometry, const Connectivity& surface,
                              const std::vector<double>& lengths, const std::vector<double>& angles,
                              const std::vector<double>& given) {
  CoverSurface cover = glued(geometry, surface, lengths, angles, given);
  if (geometry == Geometry::kEuclidean) {
    alignFaces(cover, 1 / std::sqrt(std::abs(totalArea(cover))));
  }
  cover.area = totalArea(cover);
  return cover;
}

CoverSurface coverOfLinks(Geometry geometry, const Connectivity& surface, const VertexLinks& links,
                          const std::vector<double>& given) {
  const CoverPlane plane(geometry);
  std::vector<double> lengths(surface.halfedgeCount()), angles(surface.halfedgeCount());
  forEach(surface.halfedgeCount(), [&](Index h) {
    const Vector3d to = links[h].col(2);
    const Vector3d back = plane.inverse(links[Connectivity::previous(h)]).col(2);
    lengths[h] = plane.wayTo(links[surface.halfedge(surface.edge(h))].col(2)).norm();
    angles[h] = std::atan2(to[0] * back[1] - to[1] * back[0], to.head<2>().dot(back.head<2>()));
  });
  CoverSurface cover = glued(geometry, surface, lengths, angles, given);
  if (geometry == Geometry::kEuclidean) alignFaces(cover, 1);
  cover.area = totalArea(cover);
  return cover;
}

Result<CoverSurface> straightCover(Context& context, const Connectivity& surface,
                                   const std::vector<double>& lengths) {
  RETURN_IF_ERROR(checkTopology(surface));
  ASSIGN_OR_RETURN(const MollifiedLengths mollified, mollify(surface, lengths));
  std::optional<CoverSurface> best;
  Index least = 0;
  for (const bool initial_delaunay : {true, false}) {
    ASSIGN_OR_RETURN(const Uniformization found,
                     uniformize(context, surface, mollified.lengths, {initial_delaunay}));
    const StraightFaces faces = straightFaces(found.metric);
    Index folded = 0;
    for (Index f = 0; f < surface.faceCount(); ++f) folded += faces.isFolded(f);
    if (best && folded >= least) continue;
    least = folded;
    best = coverOfTriangles(found.metric.geometry, surface, faces.lengths, faces.angles,
                            mollified.lengths);
    if (folded == 0) return *std::move(best);
  }
  ASSIGN_OR_RETURN(const HarmonicMap map, harmonicMap(context, best->geometry, surface,
                                                      positiveWeights(surface, mollified.lengths),
                                                      ownLinks(*best, vertexFrames(*best))));
  if (map.folded_faces > 0) {
    return Status(Reason::kFoldedMap,
                  "straight faces turn over " + std::to_string(map.folded_faces) + " of " +
                      std::to_string(surface.faceCount()) + " faces",
                  "simplify limbs that are long and thin");
  }
  CoverSurface cover = coverOfLinks(best->geometry, surface, map.links, mollified.lengths);
  cover.unfolded = least;
  return cover;
}

std::vector<Motion> vertexFrames(const CoverSurface& cover) {
  const Connectivity& surface = cover.surface;
  const CoverPlane plane = cover.plane();
  std::vector<Motion> frames(surface.halfedgeCount());
  forEach(surface.vertexCount(), [&](Index v) {
    const Index first = surface.outgoing(v);
    frames[first] = plane.shift(plane.wayTo(cover.corners[first]));
    for (Index h = first, next = surface.rotate(h); next != first;
         h = next, next = surface.rotate(h)) {
      // Entering the face of `next` across the side before h.
      frames[next] = plane.normalized(Motion(cover.across[next] * frames[h]));
    }
  });
  return frames;
}

VertexLinks ownLinks(const CoverSurface& cover, const std::vector<Motion>& frames) {
  const CoverPlane plane = cover.plane();
  VertexLinks links(cover.surface.halfedgeCount());
  forEach(cover.surface.edgeCount(), [&](Index e) {
    const Index h = cover.surface.halfedge(e);
    links[h] = plane.normalized(Motion(plane.inverse(frames[h]) * frames[Connectivity::next(h)]));
    links[cover.surface.twin(h)] = plane.inverse(links[h]);
  });
  return links;
}

CoverArrival walkStraight(const CoverSurface& cover, Index face, const Vector3d& from,
                          const Vector3d& to) {
  const Connectivity& surface = cover.surface;
  const CoverPlane plane = cover.plane();
  CoverArrival at{face, to, Motion::Identity()};
  Vector3d start = from;
  Index entry = kNone;
  for (Index n = 0; n < 3 * surface.faceCount() + 64; ++n) {
    const Vector3d here = cover.weights(at.face, start), there = cover.weights(at.face, at.place);
    Index exit = kNone;
    double earliest = 2, lowest = 0;
    for (int c = 0; c < 3; ++c) {
      // The side opposite corner c.
      const Index h = 3 * at.face + (c + 1) % 3;
      if (h == entry || surface.twin(h) == kNone || !(there[c] < 0)) continue;
      const double fraction = here[c] > 0 ? here[c] / (here[c] - there[c]) : 0;
      if (fraction > earliest || (fraction == earliest && there[c] >= lowest)) continue;
      earliest = fraction;
      lowest = there[c];
      exit = h;
    }
    if (exit == kNone) break;
    entry = surface.twin(exit);
    const Motion& back = cover.across[entry];
    at = {Connectivity::faceOf(entry), plane.normalized(Vector3d(back * at.place)),
          plane.normalized(Motion(at.motion * cover.across[exit]))};
    start = plane.normalized(Vector3d(back * start));
  }
  return at;
}

}  // namespace moduli
