#include "core/parameterize/refine.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "core/intrinsic/overlay.h"

namespace moduli {

namespace {

/// As planeTriangleQuality, seen from outside the sphere.
double sphereTriangleQuality(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                             const Eigen::Vector3d& c) {
  const double longest =
      std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
  return longest > 0 ? a.dot((b - a).cross(c - a)) / longest : 0;
}

}  // namespace

double planeTriangleQuality(const std::complex<double>& a, const std::complex<double>& b,
                            const std::complex<double>& c) {
  const double longest = std::max({std::norm(b - a), std::norm(c - b), std::norm(a - c)});
  return longest > 0 ? std::imag(std::conj(b - a) * (c - a)) / longest : 0;
}

Result<RefinedSurface> refineFolds(Context& context, const Connectivity& surface,
                                   const std::vector<double>& lengths, const IdealPolyhedron& ideal,
                                   const std::vector<bool>& folded, const SpherePointImage& plane) {
  const Context::Stage stage(context, "refine");
  const IntrinsicTriangulation& triangulation = ideal.metric.metric.triangulation;
  ASSIGN_OR_RETURN(const Overlay overlay, Overlay::make(context, triangulation));
  const std::vector<double> scales = lightConeScales(triangulation, ideal.points);
  Points3 points = ideal.points;
  std::vector<std::complex<double>> images;
  if (plane) {
    for (const Eigen::Vector3d& point : points) images.push_back(plane(point));
  }
  SubdivisionImage image;
  image.locate = [&](const Subdivision::Vertex& vertex) {
    const Crossing& crossing = vertex.crossing;
    const Index tail = triangulation.tail(crossing.halfedge);
    const Index head = triangulation.head(crossing.halfedge);
    const double a = crossing.weight_tail * scales[tail], b = crossing.weight_head * scales[head];
    points.push_back(((a * points[tail] + b * points[head]) / (a + b)).normalized());
    if (plane) images.push_back(plane(points.back()));
  };
  image.quality = [&](Index a, Index b, Index c) {
    return plane ? planeTriangleQuality(images[a], images[b], images[c])
                 : sphereTriangleQuality(points[a], points[b], points[c]);
  };
  ASSIGN_OR_RETURN(Subdivision subdivision,
                   subdivide(context, overlay, folded, surface.faceCount(), image));
  // On a double the new vertices stand behind those of both copies.
  const Index spare = triangulation.vertexCount() - surface.vertexCount();
  for (Triangle& face : subdivision.faces) {
    for (Index& v : face) {
      if (v >= triangulation.vertexCount()) v -= spare;
    }
  }
  points.erase(points.begin() + surface.vertexCount(),
               points.begin() + triangulation.vertexCount());
  const auto vertices = surface.vertexCount() + static_cast<Index>(subdivision.vertices.size());
  ASSIGN_OR_RETURN(Connectivity refined, Connectivity::fromFaces(vertices, subdivision.faces));
  // Halfedges of the first copy have the same number in both.
  std::vector<double> refined_lengths = subdividedLengths(surface, lengths, subdivision, refined);
  return RefinedSurface{std::move(subdivision), std::move(refined), std::move(refined_lengths),
                        std::move(points)};
}

}  // namespace moduli
