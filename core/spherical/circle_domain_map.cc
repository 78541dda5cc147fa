#include "core/spherical/circle_domain_map.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "core/spherical/cap_loops.h"
#include "core/spherical/robust_map.h"
#include "core/topology/surface_topology.h"

namespace moduli {

using Loops = std::vector<std::vector<Index>>;

Loops loopsLongestFirst(const Connectivity& surface, const std::vector<double>& lengths) {
  Loops loops = computeTopology(surface).boundary_loops;
  std::size_t longest = 0;
  double length = 0;
  for (std::size_t n = 0; n < loops.size(); ++n) {
    double sum = 0;
    for (const Index h : loops[n]) sum += lengths[surface.edge(h)];
    if (sum <= length) continue;
    length = sum;
    longest = n;
  }
  const auto first = loops.begin() + static_cast<std::ptrdiff_t>(longest);
  if (!loops.empty()) std::rotate(loops.begin(), first, first + 1);
  return loops;
}

Loops loopVertices(const Connectivity& surface, Loops loops) {
  for (std::vector<Index>& loop : loops) {
    for (Index& h : loop) h = surface.tail(h);
  }
  return loops;
}

std::vector<std::complex<double>> unfoldSphere(const Points3& points, const Eigen::Vector3d& pole) {
  const Eigen::Vector3d right = pole.unitOrthogonal();
  const Eigen::Vector3d up = right.cross(pole);  // Seen from outside, opposite the pole.
  std::vector<std::complex<double>> plane;
  plane.reserve(points.size());
  for (const Eigen::Vector3d& point : points) {
    // 1 - <point, pole>, without its cancellation.
    const double height = (point - pole).squaredNorm() / 2;
    plane.push_back(std::complex<double>(point.dot(right), point.dot(up)) / height);
  }
  return plane;
}

std::vector<Eigen::Vector3d> cappedPositions(const Connectivity& surface, const Loops& loops,
                                             std::vector<Eigen::Vector3d> positions) {
  if (positions.empty()) return positions;
  for (const std::vector<Index>& loop : loops) {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const Index h : loop) middle += positions[surface.tail(h)];
    positions.push_back(middle / static_cast<double>(loop.size()));
  }
  return positions;
}

Result<CircleDomain> mapToCircleDomain(Context& context, const Connectivity& surface,
                                       const std::vector<double>& lengths,
                                       const std::vector<Eigen::Vector3d>& positions,
                                       bool initial_delaunay) {
  const Loops loops = loopsLongestFirst(surface, lengths);
  ASSIGN_OR_RETURN(const CappedSurface capped, capLoops(surface, lengths, loops));
  PuncturedSphereOptions options;
  options.initial_delaunay = initial_delaunay;
  ASSIGN_OR_RETURN(const IdealPolyhedron ideal,
                   mapToIdealPolyhedron(context, capped.connectivity, capped.lengths,
                                        cappedPositions(surface, loops, positions), options));
  const Points3 points(ideal.points.begin(), ideal.points.begin() + surface.vertexCount());
  return koebe(context, unfoldSphere(points, ideal.points[capped.apex[0]]),
               loopVertices(surface, loops));
}

}  // namespace moduli
