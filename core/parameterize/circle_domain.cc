#include "core/parameterize/circle_domain.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "core/intrinsic/mollify.h"
#include "core/parameterize/disk.h"
#include "core/parameterize/genus_zero.h"
#include "core/parameterize/ideal_certificate.h"
#include "core/parameterize/refine.h"
#include "core/spherical/cap_loops.h"
#include "core/spherical/circle_domain_map.h"
#include "core/spherical/exact_sign.h"
#include "core/spherical/koebe.h"
#include "core/topology/surface_topology.h"

namespace moduli {
namespace {

using Complex = std::complex<double>;
using Loops = std::vector<std::vector<Index>>;

const char* const kMap = "the map to the circle domain";

constexpr int kMostSplits = 3;

std::vector<bool> foldedIn(const Connectivity& surface, const std::vector<Complex>& points) {
  return foldedFaces(surface, points, [](const auto& a, const auto& b, const auto& c) {
    return spherical::orientationSign(a, b, c);
  });
}

/// The surface in the plane, before its loops are round.
struct PlaneDomain {
  const Connectivity& surface;
  const std::vector<double>& lengths;
  std::vector<Complex> points;  ///< Per vertex.
  Loops loops;                  ///< Vertices, the outer loop first.
};

class CircleDomainMapping {
 public:
  CircleDomainMapping(Context& context, const Connectivity& surface,
                      const std::vector<double>& lengths, std::vector<Eigen::Vector3d> positions,
                      const CircleDomainOptions& options)
      : context_(context),
        surface_(surface),
        lengths_(lengths),
        options_(options),
        loops_(loopsLongestFirst(surface, lengths)),
        positions_(std::move(positions)) {}

  Result<Parameterization> run() {
    ASSIGN_OR_RETURN(capped_, capLoops(surface_, lengths_, loops_));
    positions_ = cappedPositions(surface_, loops_, std::move(positions_));
    return robustly();
  }

 private:
  Result<Parameterization> robustly() {
    result_.method = MapMethod::kRobust;
    std::optional<IdealPolyhedron> folding;  // The one with the fewest folds.
    std::vector<bool> folded;
    Status failure;
    IdealStart start;
    for (const bool initial_delaunay : {options_.initial_delaunay, !options_.initial_delaunay}) {
      PuncturedSphereOptions punctured;
      punctured.initial_delaunay = initial_delaunay;
      punctured.infinity = start.infinity;
      punctured.start = start.u;
      Result<IdealPolyhedron> ideal = mapToIdealPolyhedron(context_, capped_->connectivity,
                                                           capped_->lengths, positions_, punctured);
      if (ideal.status().reason() == Reason::kNoConvergence) {
        if (!folding) failure = ideal.status();
        continue;
      }
      RETURN_IF_ERROR(ideal.status());
      certify(*ideal);
      failure = roundLoops(ideal->points);
      if (failure.ok()) return std::move(result_);
      if (failure.reason() != Reason::kFoldedMap) return failure;
      start = startOf(ideal->metric);
      const auto count = std::count(folded_.begin(), folded_.end(), true);
      if (folding && count >= std::count(folded.begin(), folded.end(), true)) continue;
      folded = folded_;
      folding = *std::move(ideal);
    }
    if (!folding || !options_.refine) return failure;
    return refine(*folding, folded);
  }

  /// Takes the caps off, unfolds the sphere around the apex of the outer loop, and makes the loops
  /// round; cuts the few faces that cannot follow.
  Status roundLoops(const Points3& sphere) {
    PlaneDomain plane{surface_, lengths_, unfolded(sphere, surface_.vertexCount(), sphere),
                      loopVertices(surface_, loops_)};
    Status status = roundLoops(plane);
    if (status.reason() != Reason::kFoldedMap || !options_.refine) return status;
    const std::vector<bool> folded = folded_;
    for (int n = 1; n <= kMostSplits; ++n) {
      ASSIGN_OR_RETURN(const bool done, splitFolds(plane, folded, (1 << n) - 1));
      if (done) return {};
    }
    folded_ = folded;
    return status;
  }

  /// The first points of the sphere, around the apex of the outer loop.
  std::vector<Complex> unfolded(const Points3& points, Index count, const Points3& sphere) const {
    return unfoldSphere(Points3(points.begin(), points.begin() + count), sphere[capped_->apex[0]]);
  }

  /// Leaves in folded_ what folds then.
  Status roundLoops(const PlaneDomain& plane) {
    ASSIGN_OR_RETURN(CircleDomain domain, koebe(context_, plane.points, plane.loops));
    return describe(plane.surface, plane.lengths, std::move(domain));
  }

  Status describe(const Connectivity& surface, const std::vector<double>& lengths,
                  CircleDomain domain) {
    MapCertificate& certificate = result_.certificate;
    certificate.quality = measurePlaneMap(surface, lengths, domain.points);
    if (certificate.quality.flipped_faces > 0) {
      folded_ = foldedIn(surface, domain.points);
      return foldedMap(kMap, certificate.quality.flipped_faces, surface.faceCount(),
                       "--refine auto cuts faces where that helps; finer ones at the boundary do");
    }
    certificate.sweeps = static_cast<int>(domain.history.size());
    certificate.convergence_rate.reset();
    if (domain.rate > 0) certificate.convergence_rate = domain.rate;
    if (!domain.history.empty()) certificate.boundary_deviation = domain.history.back();
    result_.points = std::move(domain.points);
    result_.circles = std::move(domain.circles);
    if (result_.circles.size() == 2) {
      result_.modulus = -std::log(result_.circles[1].radius) / (2 * std::numbers::pi);
    }
    result_.corner = vertexCorners(surface);
    return {};
  }

  /// A face with all of its corners on the circle of a hole is turned over, whatever the map: the
  /// circle bends towards it. New vertices on its inner edges, mapped like all others, stay outside
  /// the hole.
  Result<bool> splitFolds(const PlaneDomain& plane, const std::vector<bool>& folded, int count) {
    std::vector<Index> edges;
    std::vector<bool> taken(surface_.edgeCount(), false);
    for (Index h = 0; h < surface_.halfedgeCount(); ++h) {
      const Index e = surface_.edge(h);
      if (!folded[h / 3] || surface_.twin(h) == kNone || taken[e]) continue;
      taken[e] = true;
      edges.push_back(e);
    }
    const std::vector<Subdivision::Vertex> vertices = evenVertices(surface_, edges, count);
    std::vector<Complex> points = plane.points;
    for (const Subdivision::Vertex& vertex : vertices) {
      const Complex& tail = plane.points[surface_.tail(vertex.halfedge)];
      const Complex& head = plane.points[surface_.head(vertex.halfedge)];
      points.push_back(tail + vertex.fraction * (head - tail));
    }
    ASSIGN_OR_RETURN(CircleDomain domain, koebe(context_, std::move(points), plane.loops));
    const std::vector<Complex>& image = domain.points;
    SubdivisionImage judge;
    judge.quality = [&](Index a, Index b, Index c) {
      return planeTriangleQuality(image[a], image[b], image[c]);
    };
    std::optional<Subdivision> subdivision = splitEdges(surface_, vertices, judge);
    if (!subdivision) return false;
    ASSIGN_OR_RETURN(const Connectivity surface,
                     Connectivity::fromFaces(static_cast<Index>(image.size()), subdivision->faces));
    const std::vector<double> lengths =
        subdividedLengths(surface_, lengths_, *subdivision, surface);
    const Status status = describe(surface, lengths, std::move(domain));
    if (!status.ok()) return status.reason() == Reason::kFoldedMap ? Result<bool>(false) : status;
    result_.subdivision = *std::move(subdivision);
    return true;
  }

  /// Cuts the folded faces along the polyhedron's edges; loops get the new vertices on them.
  Result<Parameterization> refine(const IdealPolyhedron& ideal, const std::vector<bool>& folded) {
    certify(ideal);
    ASSIGN_OR_RETURN(RefinedSurface refined,
                     refineFolds(context_, surface_, lengths_, ideal, folded));
    RETURN_IF_ERROR(
        roundLoops({refined.surface, refined.lengths,
                    unfolded(refined.points, refined.surface.vertexCount(), ideal.points),
                    refinedLoops(refined.surface)}));
    result_.subdivision = std::move(refined.subdivision);
    return std::move(result_);
  }

  /// The loops of a finer surface, in the order of those of the given one.
  Loops refinedLoops(const Connectivity& surface) const {
    std::vector<std::size_t> loop_of(surface.vertexCount(), loops_.size());
    for (std::size_t n = 0; n < loops_.size(); ++n) {
      for (const Index h : loops_[n]) loop_of[surface_.tail(h)] = n;
    }
    Loops ordered(loops_.size());
    for (std::vector<Index>& loop :
         loopVertices(surface, computeTopology(surface).boundary_loops)) {
      const auto known = std::find_if(loop.begin(), loop.end(),
                                      [&](Index v) { return loop_of[v] < loops_.size(); });
      ordered[loop_of[*known]] = std::move(loop);
    }
    return ordered;
  }

  /// The sphere's centre means nothing in the plane.
  void certify(const IdealPolyhedron& ideal) {
    certifyIdeal(ideal, result_.certificate);
    result_.certificate.centering_residual.reset();
  }

  Context& context_;
  const Connectivity& surface_;
  const std::vector<double>& lengths_;
  const CircleDomainOptions& options_;
  Loops loops_;  ///< Halfedges.
  std::vector<Eigen::Vector3d> positions_;
  std::optional<CappedSurface> capped_;
  std::vector<bool> folded_;
  Parameterization result_;
};

}  // namespace

Result<Parameterization> parameterizeCircleDomain(Context& context, const Connectivity& surface,
                                                  const std::vector<double>& lengths,
                                                  const std::vector<Eigen::Vector3d>& positions,
                                                  const CircleDomainOptions& options) {
  RETURN_IF_ERROR(checkGenusZero(surface, kMap, 1, std::numeric_limits<Index>::max()));
  if (computeTopology(surface).boundary_loops.size() == 1) {
    DiskOptions disk;
    disk.method = options.method;
    disk.initial_delaunay = options.initial_delaunay;
    disk.refine = options.refine;
    ASSIGN_OR_RETURN(Parameterization result,
                     parameterizeDisk(context, surface, lengths, positions, disk));
    result.circles = {Circle{0, 1}};
    return result;
  }
  if (options.method == MapMethod::kLinear || options.method == MapMethod::kHeatFlow) {
    return Status{Reason::kInvalidOption,
                  "method " + methodName(options.method) + " does not map several boundary loops",
                  "take method robust or auto"};
  }
  ASSIGN_OR_RETURN(const MollifiedLengths mollified, mollify(surface, lengths));
  ASSIGN_OR_RETURN(
      Parameterization result,
      CircleDomainMapping(context, surface, mollified.lengths, positions, options).run());
  result.certificate.mollification = mollified.relative_shift;
  return result;
}

}  // namespace moduli
