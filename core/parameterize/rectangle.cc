#include "core/parameterize/rectangle.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "core/intrinsic/mollify.h"
#include "core/parameterize/flat.h"
#include "core/parameterize/genus_zero.h"
#include "core/parameterize/ideal_disk_map.h"
#include "core/spherical/rectangle_map.h"
#include "core/topology/surface_topology.h"

namespace moduli {
namespace {

using Complex = std::complex<double>;

const char* const kMap = "the map to the rectangle";

/// Vertices of the boundary from the first corner on, in order.
Result<std::vector<Index>> boundaryFrom(const Connectivity& surface,
                                        const std::array<Index, 4>& corners) {
  std::vector<Index> boundary;
  const SurfaceTopology topology = computeTopology(surface);
  for (const Index h : topology.boundary_loops[0]) {
    boundary.push_back(surface.tail(h));
  }
  const auto place = [&](Index v) { return std::find(boundary.begin(), boundary.end(), v); };
  for (const Index corner : corners) {
    if (corner < 0 || corner >= surface.vertexCount() || place(corner) == boundary.end()) {
      return Status{Reason::kInvalidOption,
                    "corner " + std::to_string(corner) + " is no vertex of the boundary",
                    "name four boundary vertices with --corners a,b,c,d"};
    }
  }
  std::rotate(boundary.begin(), place(corners[0]), boundary.end());
  if (!(place(corners[0]) < place(corners[1]) && place(corners[1]) < place(corners[2]) &&
        place(corners[2]) < place(corners[3]))) {
    return Status{
        Reason::kInvalidOption,
        "the corners do not follow each other along the boundary, the surface on the left",
        "give them counter-clockwise, each once"};
  }
  return boundary;
}

class RectangleMapping {
 public:
  RectangleMapping(Context& context, const Connectivity& surface,
                   const std::vector<double>& lengths,
                   const std::vector<Eigen::Vector3d>& positions, const RectangleOptions& options,
                   std::vector<Index> boundary)
      : context_(context),
        surface_(surface),
        lengths_(lengths),
        positions_(positions),
        options_(options),
        boundary_(std::move(boundary)) {}

  Result<Parameterization> run() {
    Status failure;
    for (const bool initial_delaunay : {options_.initial_delaunay, !options_.initial_delaunay}) {
      Result<Parameterization> flat = layOutFlat(initial_delaunay);
      if (flat.ok()) return flat;
      failure = flat.status();
      if (failure.reason() != Reason::kFoldedMap && failure.reason() != Reason::kNoConvergence) {
        return failure;
      }
    }
    if (!options_.refine) return failure;
    return throughDisk();
  }

 private:
  Result<Parameterization> layOutFlat(bool initial_delaunay) {
    FlatOptions flat;
    for (const Index corner : options_.corners) {
      flat.cones.push_back({corner, std::numbers::pi / 2});
    }
    flat.boundary = BoundaryRule::kStraight;
    flat.initial_delaunay = initial_delaunay;
    ASSIGN_OR_RETURN(Parameterization result, parameterizeFlat(context_, surface_, lengths_, flat));
    std::vector<Complex> points(surface_.vertexCount());
    for (Index h = 0; h < surface_.halfedgeCount(); ++h) {
      points[surface_.tail(h)] = result.points[result.corner[h]];
      result.corner[h] = surface_.tail(h);
    }
    result.points = std::move(points);
    standUpright(result);
    const MapQuality quality = measurePlaneMap(surface_, lengths_, result.points);
    if (quality.flipped_faces > 0) {
      return foldedMap(kMap, quality.flipped_faces, surface_.faceCount(),
                       "--refine auto cuts these faces; finer or less obtuse ones avoid it");
    }
    result.certificate.quality = quality;
    return result;
  }

  /// The first corner to 0, the second to the real axis, height 1; the boundary onto its sides.
  void standUpright(Parameterization& result) const {
    const auto& [a, b, c, d] = options_.corners;
    std::vector<Complex>& points = result.points;
    const Complex origin = points[a];
    const double height = (std::abs(points[d] - points[a]) + std::abs(points[c] - points[b])) / 2;
    Complex turn = std::conj(points[b] - points[a]);
    turn /= std::abs(turn) * height;
    for (Complex& point : points) point = turn * (point - origin);
    const double width = (points[b].real() + points[c].real() - points[d].real()) / 2;
    double deviation = 0;
    int side = 0;
    for (const Index v : boundary_) {
      if (side < 3 && v == options_.corners[side + 1]) ++side;
      const Complex before = points[v];
      if (side == 0) points[v].imag(0);
      if (side == 1) points[v].real(width);
      if (side == 2) points[v].imag(1);
      if (side == 3) points[v].real(0);
      if (v == a || v == d) points[v].real(0);
      if (v == b || v == c) points[v].real(width);
      if (v == c || v == d) points[v].imag(1);
      if (v == a || v == b) points[v].imag(0);
      deviation = std::max(deviation, std::abs(points[v] - before) / std::max(width, 1.0));
    }
    result.modulus = width;
    result.certificate.boundary_deviation = deviation;
  }

  Result<Parameterization> throughDisk() {
    double modulus = 0;
    const auto domain = [&](const IdealDisk& disk) -> Result<DiskImage> {
      std::array<Complex, 4> corners;
      for (int c = 0; c < 4; ++c) corners[c] = disk.points[options_.corners[c]];
      ASSIGN_OR_RETURN(const RectangleMap map, RectangleMap::make(corners));
      modulus = map.modulus();
      return DiskImage(map);
    };
    ASSIGN_OR_RETURN(Parameterization result,
                     mapThroughIdealDisk(context_, surface_, lengths_, positions_,
                                         {kMap, options_.initial_delaunay, true, domain}));
    result.modulus = modulus;
    return result;
  }

  Context& context_;
  const Connectivity& surface_;
  const std::vector<double>& lengths_;
  const std::vector<Eigen::Vector3d>& positions_;
  const RectangleOptions& options_;
  std::vector<Index> boundary_;  ///< From the first corner on.
};

}  // namespace

Status checkRectangle(const Connectivity& surface) {
  return checkGenusZero(surface, kMap, 1, 1);
}

Result<Parameterization> parameterizeRectangle(Context& context, const Connectivity& surface,
                                               const std::vector<double>& lengths,
                                               const std::vector<Eigen::Vector3d>& positions,
                                               const RectangleOptions& options) {
  RETURN_IF_ERROR(checkRectangle(surface));
  ASSIGN_OR_RETURN(std::vector<Index> boundary, boundaryFrom(surface, options.corners));
  ASSIGN_OR_RETURN(const MollifiedLengths mollified, mollify(surface, lengths));
  ASSIGN_OR_RETURN(
      Parameterization result,
      RectangleMapping(context, surface, mollified.lengths, positions, options, std::move(boundary))
          .run());
  result.certificate.mollification = mollified.relative_shift;
  return result;
}

}  // namespace moduli
