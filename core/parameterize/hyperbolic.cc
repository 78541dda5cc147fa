#include "core/parameterize/hyperbolic.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include "core/base/text.h"
#include "core/intrinsic/mollify.h"
#include "core/parameterize/disk_geodesics.h"
#include "core/parameterize/disk_layout.h"
#include "core/parameterize/genus_zero.h"
#include "core/parameterize/straighten.h"
#include "core/spherical/exact_sign.h"
#include "core/topology/surface_topology.h"

namespace moduli {
namespace {

constexpr double kMaxClosure = 1e-4;
constexpr int kMostRounds = 20;
constexpr const char* kMap = "the map to the Poincaré disk";

std::string described(const SurfaceTopology& topology) {
  const auto loops = static_cast<Index>(topology.boundary_loops.size());
  if (topology.genus == 1 && loops == 0) return "a torus, which is flat";
  if (topology.genus == 0 && loops == 0) return "a sphere, which is round";
  if (topology.genus == 0 && loops == 1) return "a disk, which is flat";
  if (topology.genus == 0 && loops == 2) return "an annulus, which is flat";
  return "of genus " + std::to_string(topology.genus) + " with " + std::to_string(loops) +
         " boundary loops";
}

Status checkTopology(const SurfaceTopology& topology) {
  if (topology.components != 1) {
    return {Reason::kUnsupportedTopology,
            "a hyperbolic metric is that of a connected surface, and this one has " +
                std::to_string(topology.components) + " components",
            targetOf(topology)};
  }
  if (topology.euler_characteristic < 0) return {};
  return {Reason::kUnsupportedTopology,
          "a hyperbolic metric needs a negative Euler characteristic, and this surface is " +
              described(topology),
          targetOf(topology)};
}

/// Faces in charts around their own centres, where the disk's metric is nearly twice the plane's.
std::vector<Complex> localPoints(const HyperbolicTriangles& triangles) {
  std::vector<Complex> points(triangles.surface.halfedgeCount());
  for (Index f = 0; f < triangles.surface.faceCount(); ++f) {
    Complex middle = 0;
    for (Index h = 3 * f; h < 3 * f + 3; ++h) {
      points[h] = imageOf(cornerFrame(triangles, h), 0.0);
      middle += points[h] / 3.0;
    }
    const Su11 back = inverse(translationTo(middle));
    for (Index h = 3 * f; h < 3 * f + 3; ++h) points[h] = 2.0 * imageOf(back, points[h]);
  }
  return points;
}

/// Faces whose images, as straight triangles, are turned over.
std::vector<Index> foldedImages(const Connectivity& surface, const DiskLayout& layout) {
  std::vector<Index> folded;
  for (Index f = 0; f < surface.faceCount(); ++f) {
    const auto point = [&](int c) { return layout.points[layout.corner[3 * f + c]]; };
    if (spherical::orientationSign(point(0), point(1), point(2)) <= 0) folded.push_back(f);
  }
  return folded;
}

/// The edge of a given face on which neighbouring vertices are farthest from each other, with so
/// many more on each of its parts. longest: per edge its longest part without these.
Index widestGap(const Connectivity& surface, Index face, const std::vector<double>& longest,
                const std::vector<int>& counts) {
  Index widest = kNone;
  double width = 0;
  for (Index h = 3 * face; h < 3 * face + 3; ++h) {
    const Index e = surface.edge(h);
    const double gap = longest[e] / (counts[e] + 1);
    if (!(gap > width)) continue;
    width = gap;
    widest = e;
  }
  return widest;
}

class HyperbolicMapping {
 public:
  HyperbolicMapping(Context& context, const Connectivity& surface,
                    const std::vector<double>& lengths, const HyperbolicOptions& options)
      : context_(context), surface_(surface), lengths_(lengths), options_(options) {}

  Result<Parameterization> run() {
    ASSIGN_OR_RETURN(StraightSurface straight, findFaces());
    ASSIGN_OR_RETURN(DiskImage image, layOut(straight.triangles));
    RETURN_IF_ERROR(splitNeedles(straight, image));
    RETURN_IF_ERROR(judge(straight, image));
    RETURN_IF_ERROR(addGeodesics(straight.triangles, image.development));
    result_.points = std::move(image.layout.points);
    result_.corner = std::move(image.layout.corner);
    result_.hyperbolic->neighbours = std::move(image.layout.neighbours);
    result_.hyperbolic->radius = image.layout.radius;
    result_.subdivision = std::move(straight.subdivision);
    return std::move(result_);
  }

 private:
  struct DiskImage {
    Development development;
    DiskLayout layout;
  };

  /// The faces in the hyperbolic metric: from either starting triangulation, or cut.
  Result<StraightSurface> findFaces() {
    std::optional<Uniformization> folding;
    Index least_folds = 0;
    for (const bool initial_delaunay : {options_.initial_delaunay, !options_.initial_delaunay}) {
      UniformizeOptions options;
      options.initial_delaunay = initial_delaunay;
      ASSIGN_OR_RETURN(Uniformization found, uniformize(context_, surface_, lengths_, options));
      StraightSurface straight = straighten(surface_, found);
      if (folding && straight.folded >= least_folds) continue;
      certify(found.metric.certificate);
      if (straight.folded == 0) return straight;
      least_folds = straight.folded;
      folding = std::move(found);
    }
    if (!options_.refine) {
      return foldedMap(kMap, least_folds, surface_.faceCount(), "--refine auto cuts these faces");
    }
    ASSIGN_OR_RETURN(StraightSurface refined, straightenRefined(context_, surface_, *folding));
    if (refined.folded == 0) return refined;
    return foldedMap(kMap, refined.folded, refined.triangles.surface.faceCount(),
                     "its limbs are thinner than doubles tell apart");
  }

  Result<DiskImage> layOut(const HyperbolicTriangles& triangles) {
    const Context::Stage stage(context_, "layout");
    ASSIGN_OR_RETURN(Development development, develop(context_, triangles));
    DiskLayout layout = sewUp(triangles, development);
    return DiskImage{std::move(development), std::move(layout)};
  }

  /// The straight triangle between three points of the disk may be turned over where that of
  /// geodesics is not: in long needles. New vertices on their long sides make them straighter.
  Status splitNeedles(StraightSurface& straight, DiskImage& image) {
    std::vector<Index> folded = foldedImages(straight.triangles.surface, image.layout);
    const auto failure = [&](const std::string& hint) {
      return foldedMap(kMap, static_cast<Index>(folded.size()),
                       straight.triangles.surface.faceCount(), hint);
    };
    if (folded.empty()) return {};
    if (!options_.refine) return failure("--refine auto cuts these faces");
    const StraightSurface before = straight;
    const std::vector<double> longest = longestParts(before);
    std::vector<int> counts(surface_.edgeCount(), 0);
    for (int round = 0; round < kMostRounds && !folded.empty(); ++round) {
      std::vector<int> more = counts;
      for (const Index f : folded) {
        const Index parent = straight.subdivision ? straight.subdivision->parent[f] : f;
        const Index e = widestGap(surface_, parent, longest, counts);
        more[e] = counts[e] + 1;
      }
      counts = std::move(more);
      ASSIGN_OR_RETURN(straight, splitStraight(before, counts));
      ASSIGN_OR_RETURN(image, layOut(straight.triangles));
      folded = foldedImages(straight.triangles.surface, image.layout);
    }
    return folded.empty() ? Status() : failure("finer faces avoid it");
  }

  void certify(const MetricCertificate& metric) {
    MapCertificate& certificate = result_.certificate;
    certificate.curvature_residual = metric.curvature_residual;
    certificate.gauss_bonnet_residual = metric.gauss_bonnet_residual;
    certificate.smallest_angle = metric.smallest_angle;
    certificate.newton_iterations = metric.newton_iterations;
    certificate.flips = metric.flips;
  }

  Status judge(const StraightSurface& straight, const DiskImage& image) {
    MapCertificate& certificate = result_.certificate;
    const double closure = image.layout.closure;
    certificate.layout_closure = closure;
    certificate.cycle_residual = image.development.certificate.vertex_residual;
    if (!(closure <= kMaxClosure)) {
      return {Reason::kResidualTooLarge,
              "the image in the disk closes up to " + shortestDouble(closure) +
                  " of an edge (allowed: " + shortestDouble(kMaxClosure) + ")",
              "the surface reaches too far for doubles: simplify its thin parts"};
    }
    const HyperbolicTriangles& triangles = straight.triangles;
    std::vector<Index> own(triangles.surface.halfedgeCount());
    std::iota(own.begin(), own.end(), 0);
    const std::vector<double> lengths =
        straight.subdivision
            ? subdividedLengths(surface_, lengths_, *straight.subdivision, triangles.surface)
            : lengths_;
    certificate.quality = measurePlaneMap(triangles.surface, lengths, localPoints(triangles), own);
    certificate.quality.flipped_faces =
        static_cast<Index>(foldedImages(triangles.surface, image.layout).size());
    return {};
  }

  Status addGeodesics(const HyperbolicTriangles& triangles, const Development& development) {
    HyperbolicDomain& domain = result_.hyperbolic.emplace();
    domain.boundary_lengths = boundaryLengths(triangles.surface, triangles.lengths);
    MapCertificate& certificate = result_.certificate;
    Result<DiskGeodesics> found = diskGeodesics(context_, triangles, development);
    const Reason reason = found.status().reason();
    if (reason == Reason::kCancelled || reason == Reason::kDeadlineExceeded) return found.status();
    if (!found.ok()) {
      certificate.warnings.push_back("GEODESICS_OMITTED: " + found.status().message());
      return {};
    }
    domain.generators = std::move(found->generators);
    domain.geodesics = std::move(found->geodesics);
    certificate.relation_residual = found->relation_residual;
    certificate.spectrum_complete_to = found->complete_to;
    return {};
  }

  Context& context_;
  const Connectivity& surface_;
  const std::vector<double>& lengths_;
  const HyperbolicOptions& options_;
  Parameterization result_;
};

}  // namespace

Result<Parameterization> parameterizeHyperbolic(Context& context, const Connectivity& surface,
                                                const std::vector<double>& lengths,
                                                const HyperbolicOptions& options) {
  RETURN_IF_ERROR(checkTopology(computeTopology(surface)));
  ASSIGN_OR_RETURN(const MollifiedLengths mollified, mollify(surface, lengths));
  ASSIGN_OR_RETURN(Parameterization result,
                   HyperbolicMapping(context, surface, mollified.lengths, options).run());
  result.certificate.mollification = mollified.relative_shift;
  return result;
}

}  // namespace moduli
