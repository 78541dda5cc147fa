#include "core/parameterize/circle_domain.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "core/intrinsic/mollify.h"
#include "core/parameterize/genus_zero.h"
#include "core/parameterize/refine.h"
#include "core/spherical/cap_loops.h"
#include "core/spherical/exact_sign.h"
#include "core/spherical/heat_flow.h"
#include "core/spherical/koebe.h"
#include "core/spherical/sphere_map.h"
#include "core/topology/surface_topology.h"

namespace moduli {
namespace {

using Complex = std::complex<double>;
using Loops = std::vector<std::vector<Index>>;

const char* const kMap = "the map to the circle domain";

/// The boundary loops, as halfedges, the longest one first.
Loops loopsOf(const Connectivity& surface, const std::vector<double>& lengths) {
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
  std::rotate(loops.begin(), loops.begin() + static_cast<std::ptrdiff_t>(longest),
              loops.begin() + static_cast<std::ptrdiff_t>(longest) + 1);
  return loops;
}

Loops tailsOf(const Connectivity& surface, Loops loops) {
  for (std::vector<Index>& loop : loops) {
    for (Index& h : loop) h = surface.tail(h);
  }
  return loops;
}

/// The plane around the sphere with `pole` at infinity, counter-clockwise as seen from outside.
class Stereographic {
 public:
  explicit Stereographic(const Eigen::Vector3d& pole) : pole_(pole) {
    right_ = pole.unitOrthogonal();
    up_ = right_.cross(pole);  // Seen from outside at the opposite point.
  }
  Complex operator()(const Eigen::Vector3d& point) const {
    // 1 - <point, pole>, without its cancellation.
    const double height = (point - pole_).squaredNorm() / 2;
    return Complex(point.dot(right_), point.dot(up_)) / height;
  }

 private:
  Eigen::Vector3d pole_, right_, up_;
};

/// A surface whose vertices lie on the sphere, some with boundary loops of it.
struct CaplessSphere {
  const Connectivity& surface;
  const std::vector<double>& lengths;
  Points3 points;  ///< Per vertex of the surface.
  Loops loops;     ///< Vertices, the outer loop first.
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
        loops_(loopsOf(surface, lengths)),
        positions_(std::move(positions)) {}

  Result<Parameterization> run() {
    ASSIGN_OR_RETURN(capped_, capLoops(surface_, lengths_, loops_));
    placeApexes();
    if (options_.method == MapMethod::kLinear || options_.method == MapMethod::kHeatFlow) {
      ASSIGN_OR_RETURN(const Points3 points, simpleMap());
      result_.method = options_.method;
      RETURN_IF_ERROR(takeOffCaps(points));
      return std::move(result_);
    }
    return robustly();
  }

 private:
  /// In space the new vertices stand in the middle of their loops.
  void placeApexes() {
    if (positions_.empty()) return;
    for (const std::vector<Index>& loop : loops_) {
      Eigen::Vector3d middle = Eigen::Vector3d::Zero();
      for (const Index h : loop) middle += positions_[surface_.tail(h)];
      positions_.push_back(middle / static_cast<double>(loop.size()));
    }
  }

  Result<Points3> simpleMap() {
    if (options_.method == MapMethod::kLinear) {
      ASSIGN_OR_RETURN(SphereMap map,
                       mapToSphereLinear(context_, capped_->connectivity, capped_->lengths));
      return std::move(map.points);
    }
    ASSIGN_OR_RETURN(HeatFlowMap map, mapToSphereHeatFlow(context_, capped_->connectivity,
                                                          capped_->lengths, positions_));
    return std::move(map.points);
  }

  Result<Parameterization> robustly() {
    result_.method = MapMethod::kRobust;
    Status failure;
    std::optional<IdealPolyhedron> unflipped;
    std::vector<bool> folded;
    for (const bool initial_delaunay : {options_.initial_delaunay, !options_.initial_delaunay}) {
      PuncturedSphereOptions punctured;
      punctured.initial_delaunay = initial_delaunay;
      Result<IdealPolyhedron> ideal = mapToIdealPolyhedron(context_, capped_->connectivity,
                                                           capped_->lengths, positions_, punctured);
      failure = ideal.status();
      if (failure.reason() == Reason::kNoConvergence) continue;
      RETURN_IF_ERROR(failure);
      certify(*ideal);
      failure = takeOffCaps(ideal->points);
      if (failure.ok()) return std::move(result_);
      if (failure.reason() != Reason::kFoldedMap) return failure;
      if (initial_delaunay || folded_.empty()) continue;
      folded = folded_;
      unflipped = *std::move(ideal);
    }
    if (!unflipped || !options_.refine) return failure;
    return refine(*unflipped, folded);
  }

  Status takeOffCaps(const Points3& points) {
    return roundLoops(
        {surface_, lengths_, Points3(points.begin(), points.begin() + surface_.vertexCount()),
         tailsOf(surface_, loops_)},
        points[capped_->apex[0]]);
  }

  /// Unfolds the sphere around the apex of the outer loop, and makes the loops round. Leaves in
  /// folded_ what folds then.
  Status roundLoops(const CaplessSphere& sphere, const Eigen::Vector3d& infinity) {
    folded_.clear();
    const Stereographic plane(infinity);
    std::vector<Complex> points;
    for (const Eigen::Vector3d& point : sphere.points) points.push_back(plane(point));
    ASSIGN_OR_RETURN(CircleDomain domain, koebe(context_, std::move(points), sphere.loops));
    const Connectivity& surface = sphere.surface;
    MapCertificate& certificate = result_.certificate;
    certificate.quality = measurePlaneMap(surface, sphere.lengths, domain.points);
    if (certificate.quality.flipped_faces > 0) {
      folded_ =
          foldedFaces(surface, domain.points, [](const auto& a, const auto& b, const auto& c) {
            return spherical::orientationSign(a, b, c);
          });
      return foldedMap(kMap, certificate.quality.flipped_faces, surface.faceCount(),
                       "--refine auto cuts faces where that helps; finer ones at the boundary do");
    }
    certificate.sweeps = static_cast<int>(domain.history.size());
    if (domain.rate > 0) certificate.convergence_rate = domain.rate;
    if (!domain.history.empty()) certificate.boundary_deviation = domain.history.back();
    result_.points = std::move(domain.points);
    result_.circles = std::move(domain.circles);
    if (result_.circles.size() == 2) {
      result_.modulus = -std::log(result_.circles[1].radius) / (2 * std::numbers::pi);
    }
    result_.corner.clear();
    for (Index h = 0; h < surface.halfedgeCount(); ++h) result_.corner.push_back(surface.tail(h));
    return {};
  }

  /// Cuts the folded faces along the polyhedron's edges; loops get the new vertices on them.
  Result<Parameterization> refine(const IdealPolyhedron& ideal, const std::vector<bool>& folded) {
    const Eigen::Vector3d infinity = ideal.points[capped_->apex[0]];
    certify(ideal);
    ASSIGN_OR_RETURN(RefinedSurface refined, refineFolds(context_, surface_, lengths_, ideal,
                                                         folded, sphereTriangleQuality));
    RETURN_IF_ERROR(roundLoops(
        {refined.surface, refined.lengths, refined.points, refinedLoops(refined.surface)},
        infinity));
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
    for (std::vector<Index>& loop : tailsOf(surface, computeTopology(surface).boundary_loops)) {
      const auto known = std::find_if(loop.begin(), loop.end(),
                                      [&](Index v) { return loop_of[v] < loops_.size(); });
      ordered[loop_of[*known]] = std::move(loop);
    }
    return ordered;
  }

  void certify(const IdealPolyhedron& ideal) {
    MapCertificate& certificate = result_.certificate;
    const MetricCertificate& metric = ideal.metric.metric.certificate;
    certificate.curvature_residual = metric.curvature_residual;
    certificate.gauss_bonnet_residual = metric.gauss_bonnet_residual;
    certificate.layout_closure = ideal.layout_closure;
    certificate.max_link_angle = ideal.metric.max_link_angle;
    certificate.smallest_angle = metric.smallest_angle;
    certificate.newton_iterations = metric.newton_iterations;
    certificate.flips = metric.flips;
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
  ASSIGN_OR_RETURN(const MollifiedLengths mollified, mollify(surface, lengths));
  ASSIGN_OR_RETURN(
      Parameterization result,
      CircleDomainMapping(context, surface, mollified.lengths, positions, options).run());
  result.certificate.mollification = mollified.relative_shift;
  return result;
}

}  // namespace moduli
