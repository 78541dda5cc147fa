#pragma once

#include <Eigen/Core>
#include <array>
#include <complex>
#include <random>
#include <vector>

#include "core/mesh/connectivity.h"

/// Surfaces with a metric, given by their lengths alone, for the tests of forms. They are built
/// here and not by the library's own samples, so that both are not wrong together.
namespace moduli {

struct MetricSurface {
  Connectivity surface;
  std::vector<double> lengths;  ///< Per edge.
};

/// A number in [0, 1), the same on every machine.
inline double uniform(std::mt19937& random) {
  return static_cast<double>(random()) / 4294967296.0;
}

/// A closed or bordered surface in space.
MetricSurface fromPositions(const std::vector<Eigen::Vector3d>& positions,
                            std::vector<Triangle> faces);

/// Glued triangles with a length per halfedge.
MetricSurface fromHalfedges(Index vertex_count, std::vector<Triangle> faces,
                            std::vector<Index> twin, const std::vector<double>& halfedge_lengths);

/// Radius R of the circle of centres, r of the tube; m x n quadrilaterals cut along a diagonal.
MetricSurface torusOfRevolution(double R, double r, int m, int n);

/// Flat polyhedral torus of MATH 12.2 and its period.
MetricSurface diplotorus(int n, double phi, double h, int s, int s2);
std::complex<double> diplotorusTau(int n, double phi, double h, int s, int s2);

/// The torus C / (Z + tau Z), in n x m cells with random diagonals, its vertices moved at random by
/// up to `jitter` (< 0.25 keeps all triangles proper on a square grid) of a cell.
MetricSurface flatTorus(std::complex<double> tau, int n, int m, double jitter, unsigned seed);

/// The double cover, branched over the four vertices, of the tetrahedron all of whose faces have
/// the sides a, b, c: the flat torus whose tau is the shape of the face.
MetricSurface disphenoidCover(double a, double b, double c);

/// Every face cut into n^2 similar ones: another triangulation of the same metric.
MetricSurface subdivide(const MetricSurface& coarse, int n);

/// `count` random edges tried: where the two triangles beside one make a convex quadrilateral with
/// room to spare, its other diagonal takes the edge's place. Another triangulation of the metric.
MetricSurface flipEdges(const MetricSurface& given, int count, unsigned seed);

/// `count` vertices put one after the other into random faces at random places, no nearer to an
/// edge than `margin` in barycentric coordinates: the same metric again, and, as harmonic functions
/// are linear across a flat face, the same harmonic forms.
MetricSurface insertVertices(const MetricSurface& coarse, int count, double margin, unsigned seed);

/// One vertex put into every face, at `height` above a side: caps. Or at `distance` from a corner:
/// needles. Both in barycentric coordinates.
MetricSurface insertNearEdges(const MetricSurface& coarse, double height, unsigned seed);
MetricSurface insertNearCorners(const MetricSurface& coarse, double distance, unsigned seed);

/// Vertices, faces and corners renumbered at random.
MetricSurface renumber(const MetricSurface& given, unsigned seed);

/// The mirror image: all faces reversed.
MetricSurface mirror(const MetricSurface& given);

MetricSurface scale(MetricSurface given, double factor);

}  // namespace moduli
