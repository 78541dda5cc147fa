#include "core/parameterize/flat.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "core/base/text.h"
#include "core/forms/cotan.h"
#include "core/intrinsic/flat_charts.h"
#include "core/intrinsic/mollify.h"
#include "core/mesh/double_cover.h"
#include "core/parameterize/flat_faces.h"
#include "core/parameterize/flatten.h"
#include "core/parameterize/genus_zero.h"
#include "core/parameterize/holonomy.h"
#include "core/parameterize/layout.h"
#include "core/parameterize/overlaps.h"
#include "core/parameterize/seams.h"
#include "core/ricci/circle_packing.h"
#include "core/ricci/flow.h"
#include "core/ricci/minimize_curvature.h"
#include "core/ricci/mirror_symmetry.h"
#include "core/ricci/newton.h"
#include "core/ricci/prescribe.h"
#include "core/topology/surface_topology.h"

namespace moduli {
namespace {

constexpr int kMaxRoundings = 15;
/// Of the mean turning at a vertex.
constexpr double kEvenTurning = 2e-3;
/// Of the curvature on the way there.
constexpr double kRoughly = 1e-6;
/// Past these a result is an error.
constexpr double kMaxResidual = 1e-9;
constexpr double kMaxClosure = 1e-4;
constexpr const char* kMap = "the flat layout";

/// A theorem forbids a closed sphere with one cone or two, whatever their curvatures.
Status checkSphere(const Connectivity& surface, std::size_t cones) {
  if (surface.eulerCharacteristic() <= 0 || cones == 0 || cones > 2) return {};
  return {
      Reason::kInvalidOption,
      "by the theorem of Gauss and Bonnet the cones of a flat sphere share a curvature of 4 pi, "
      "and each has less than 2 pi: " +
          std::string(cones == 1 ? "one cone" : "two cones") + " cannot, three can",
      "name three cones at least"};
}

class Flattening {
 public:
  Flattening(Context& context, const Connectivity& surface, const std::vector<double>& lengths,
             const FlatOptions& options)
      : context_(context), surface_(surface), lengths_(lengths), options_(options) {
    loops_ = computeTopology(surface_).boundary_loops;
    bordered_ = !loops_.empty();
  }

  Result<FlatMap> run() {
    if (!bordered_) {
      RETURN_IF_ERROR(checkSphere(surface_, options_.cones.size()));
    }
    ASSIGN_OR_RETURN(target_, flatTarget(surface_, options_.cones, options_.boundary, lengths_));
    RETURN_IF_ERROR(options_.scheme == Scheme::kVertexScaling ? scaleVertices() : packCircles());
    return layOutFaces({surface_, charts_});
  }

  /// After a run that folded: with faces cut.
  Result<FlatMap> runRefined() {
    ASSIGN_OR_RETURN(FlatFaces faces, refineFlatFaces(context_, surface_, *metric_));
    return layOutFaces(std::move(faces));
  }

  bool mayRefine() const { return options_.refine && metric_.has_value(); }

 private:
  Result<FlatMap> layOutFaces(FlatFaces flat) {
    const Connectivity& faces = flat.surface;
    const Context::Stage stage(context_, "layout");
    RETURN_IF_ERROR(context_.check());
    const std::vector<double> lengths =
        flat.subdivision ? subdividedLengths(surface_, lengths_, *flat.subdivision, faces)
                         : lengths_;
    PlanarLayout layout = layOut(faces, flat.charts, seamsOf(flat, lengths));
    certificate().layout_closure = layout.closure;
    RETURN_IF_ERROR(judgeMetric());
    result_.points = std::move(layout.points);
    result_.corner = std::move(layout.corner);
    RETURN_IF_ERROR(judgeFaces(flat, lengths));
    ConeDomain& domain = result_.cones.emplace();
    domain.cones = options_.cones;
    if (!bordered_) domain.handle_turns = handleTurns(faces, result_.points, result_.corner);
    certificate().islands = 1;
    if (options_.cut_overlaps) {
      certificate().islands = cutOverlaps(faces, result_.points, result_.corner, options_.margin);
    }
    result_.subdivision = flat.subdivision;
    return FlatMap{result_, std::move(flat)};
  }

  /// Through the cones, along what is asked for.
  std::vector<bool> seamsOf(const FlatFaces& flat, const std::vector<double>& lengths) const {
    std::vector<bool> is_cone(flat.surface.vertexCount(), false);
    for (Index v = 0; v < surface_.vertexCount(); ++v) {
      is_cone[v] = target_[v] != 0 && !surface_.isBoundaryVertex(v);
    }
    std::vector<bool> given = options_.seams;
    if (!given.empty() && flat.subdivision) {
      given = edgesAlong(surface_, given, *flat.subdivision, flat.surface);
    }
    return chooseSeams(flat.surface, seamCosts(flat.surface, lengths), is_cone, given);
  }

  MapCertificate& certificate() { return result_.certificate; }
  bool roundsBoundary() const { return bordered_ && options_.boundary == BoundaryRule::kCircle; }
  bool freesBoundary() const { return bordered_ && options_.boundary == BoundaryRule::kFree; }

  /// One unknown per vertex.
  std::vector<bool> fixedVertices() const {
    if (!freesBoundary()) return {};
    std::vector<bool> fixed(surface_.vertexCount(), false);
    for (Index v = 0; v < surface_.vertexCount(); ++v) fixed[v] = surface_.isBoundaryVertex(v);
    return fixed;
  }

  /// Vertex scaling of the surface, or of its double under the mirror symmetry: there every target
  /// has a metric, whatever the boundary's triangles are like.
  Status scaleVertices() {
    PrescribeOptions options;
    options.initial_delaunay = options_.initial_delaunay;
    options.solver = options_.solver;
    options.fixed = fixedVertices();
    if (!bordered_) {
      PrescribedCurvature problem(surface_, Unknowns::all(surface_.vertexCount()), options);
      RETURN_IF_ERROR(problem.start(context_, lengths_));
      ASSIGN_OR_RETURN(const DiscreteMetric metric, problem.solve(context_, target_));
      keep(metric);
      return {};
    }
    ASSIGN_OR_RETURN(const DoubleCover cover, doubleCover(surface_));
    PrescribedCurvature problem(cover.connectivity, mirrorUnknowns(cover), options);
    RETURN_IF_ERROR(problem.start(context_, lengthsOnDouble(cover, lengths_)));
    return solveDouble(cover, problem);
  }

  Status solveDouble(const DoubleCover& cover, PrescribedCurvature& problem) {
    int iterations = 0;
    const auto keepHalf = [&](const DiscreteMetric& metric) {
      keep(metric);
      iterations += metric.certificate.newton_iterations;
      certificate().newton_iterations = iterations;
      *certificate().gauss_bonnet_residual /= 2;
    };
    if (roundsBoundary()) {
      double uneven = 1;
      for (int n = 0; n < kMaxRoundings && uneven > kEvenTurning; ++n) {
        ASSIGN_OR_RETURN(const DiscreteMetric metric,
                         problem.approach(context_, curvaturesOnDouble(cover, target_), kRoughly));
        keepHalf(metric);
        ASSIGN_OR_RETURN(uneven, turnEvenly());
      }
      warnUneven(uneven);
    }
    ASSIGN_OR_RETURN(const DiscreteMetric metric,
                     problem.solve(context_, curvaturesOnDouble(cover, target_)));
    keepHalf(metric);
    return {};
  }

  void warnUneven(double uneven) {
    if (uneven <= kEvenTurning) return;
    certificate().warnings.push_back("UNEVEN_BOUNDARY: the turning of the boundary is even up to " +
                                     shortestDouble(uneven) + " of its mean only");
  }

  /// Moves the targets along the boundary towards even turning in the present metric. Returns how
  /// far they were from it, relative to the mean turning at a vertex.
  Result<double> turnEvenly() {
    std::vector<double> lengths(surface_.edgeCount());
    for (Index e = 0; e < surface_.edgeCount(); ++e) {
      lengths[e] = std::abs(charts_[surface_.halfedge(e)]);
    }
    ASSIGN_OR_RETURN(const std::vector<double> even,
                     flatTarget(surface_, options_.cones, options_.boundary, lengths));
    double change = 0, turning = 0, count = 0;
    for (const std::vector<Index>& loop : loops_) {
      double total = 0;
      for (const Index h : loop) {
        const Index v = surface_.tail(h);
        change = std::max(change, std::abs(even[v] - target_[v]));
        total += even[v];
      }
      turning += std::abs(total);
      count += static_cast<double>(loop.size());
      // A wave with k crests around the loop comes back m / k times as large, m the loop's turning
      // over 2 pi; k = 1 is a Möbius map where m = 1. The step suits the middle of what is left.
      const double m = total / (2 * std::numbers::pi);
      const double step = 1 / (1 - (m > 0 ? m / 4 : m / 2));
      for (const Index h : loop) {
        const Index v = surface_.tail(h);
        target_[v] += step * (even[v] - target_[v]);
      }
    }
    return turning > 0 ? change / (turning / count) : change;
  }

  void keep(const DiscreteMetric& metric) {
    metric_ = metric;
    charts_ = flatFaces(surface_, metric).charts;
    certificate().curvature_residual = metric.certificate.curvature_residual;
    certificate().gauss_bonnet_residual = metric.certificate.gauss_bonnet_residual;
    certificate().newton_iterations = metric.certificate.newton_iterations;
    certificate().flips = metric.certificate.flips;
    certificate().smallest_angle = metric.certificate.smallest_angle;
  }

  /// Circles on the surface's own triangles.
  Status packCircles() {
    ASSIGN_OR_RETURN(
        CirclePackingModel model,
        CirclePackingModel::make(surface_, Geometry::kEuclidean, options_.scheme, lengths_));
    certificate().clamped_fraction = model.clampedFraction();
    int iterations = 0;
    double uneven = roundsBoundary() ? 1 : 0;
    Eigen::VectorXd u = model.initial();
    for (int n = 0;; ++n) {
      const Eigen::VectorXd wanted =
          Eigen::Map<const Eigen::VectorXd>(target_.data(), surface_.vertexCount());
      const bool last = uneven <= kEvenTurning || n >= kMaxRoundings;
      ASSIGN_OR_RETURN(const int steps, solveCircles(model, wanted, u, last));
      iterations += steps;
      if (model.brokenFaces() > 0) return noPacking();
      keepCircles(model, wanted);
      certificate().newton_iterations = iterations;
      if (last) break;
      ASSIGN_OR_RETURN(uneven, turnEvenly());
    }
    warnUneven(uneven);
    return {};
  }

  /// Moves the model and u; returns the number of steps.
  Result<int> solveCircles(CirclePackingModel& model, const Eigen::VectorXd& wanted,
                           Eigen::VectorXd& u, bool exactly) {
    if (options_.solver == RicciSolver::kFlow) {
      FlowOptions flow_options;
      flow_options.fixed = fixedVertices();
      ASSIGN_OR_RETURN(const FlowResult flow, ricciFlow(context_, model, wanted, u, flow_options));
      u = flow.u;
      return static_cast<int>(flow.history.size()) - 1;
    }
    NewtonOptions newton;
    newton.fixed = fixedVertices();
    if (!exactly) newton.tolerance = newton.acceptable = kRoughly;
    const Result<RicciSolution> solution =
        findCurvature(context_, model, wanted, u, newton, options_.solver);
    // Where u runs away towards a target out of reach, the matrix degenerates with the circles.
    const Reason reason = solution.status().reason();
    if (reason == Reason::kNoConvergence || reason == Reason::kNotPositiveDefinite) {
      return noPacking();
    }
    RETURN_IF_ERROR(solution.status());
    u = solution->u;
    return solution->iterations();
  }

  static Status noPacking() {
    return {Reason::kNoConvergence, "no circle packing on these triangles has the curvature wanted",
            "use vertex scaling, which flips edges where triangles break"};
  }

  void keepCircles(const CirclePackingModel& model, const Eigen::VectorXd& wanted) {
    std::vector<double> lengths(surface_.halfedgeCount());
    for (Index h = 0; h < surface_.halfedgeCount(); ++h) {
      lengths[h] = model.lengths()[surface_.edge(h)];
    }
    charts_ = chartsOfTriangles(lengths, model.angles());
    const Eigen::VectorXd& curvature = model.curvature();
    const std::vector<bool> fixed = fixedVertices();
    const double mean = fixed.empty() ? (curvature - wanted).mean() : 0;
    double residual = 0;
    for (Index v = 0; v < surface_.vertexCount(); ++v) {
      if (!fixed.empty() && fixed[v]) continue;
      residual = std::max(residual, std::abs(curvature[v] - wanted[v] - mean));
    }
    certificate().curvature_residual = residual;
    certificate().gauss_bonnet_residual =
        std::abs(curvature.sum() - 2 * std::numbers::pi * surface_.eulerCharacteristic());
    certificate().smallest_angle = *std::min_element(model.angles().begin(), model.angles().end());
  }

  Status judgeMetric() {
    const double residual = *certificate().curvature_residual;
    const double closure = *certificate().layout_closure;
    if (residual <= kMaxResidual && closure <= kMaxClosure) return {};
    return {Reason::kResidualTooLarge,
            "the flat metric has a curvature residual of " + shortestDouble(residual) +
                " (allowed: " + shortestDouble(kMaxResidual) + ") and closes up to " +
                shortestDouble(closure) + " of an edge (allowed: " + shortestDouble(kMaxClosure) +
                ")",
            "spread the curvature over more cones, or remesh parts that are thin"};
  }

  /// Scales the layout to the surface's area and compares its faces with the surface's.
  Status judgeFaces(FlatFaces& flat, const std::vector<double>& lengths) {
    const Connectivity& faces = flat.surface;
    double area = 0, image = 0;
    for (const double face : faceAreas(surface_, lengths_)) area += face;
    for (Index f = 0; f < faces.faceCount(); ++f) image += doubledArea(flat.charts, f) / 2;
    certificate().quality = measurePlaneMap(faces, lengths, result_.points, result_.corner);
    const Index flipped = certificate().quality.flipped_faces;
    if (flipped > 0) {
      return foldedMap(kMap, flipped, faces.faceCount(),
                       "refine the mesh there, or spread the curvature over more cones");
    }
    const double scale = std::sqrt(area / image);
    for (std::complex<double>& point : result_.points) point *= scale;
    for (std::complex<double>& side : flat.charts) side *= scale;
    return {};
  }

  Context& context_;
  const Connectivity& surface_;
  const std::vector<double>& lengths_;
  const FlatOptions& options_;
  std::vector<std::vector<Index>> loops_;
  bool bordered_ = false;
  std::vector<double> target_;
  std::optional<DiscreteMetric> metric_;  ///< Of vertex scaling; of the double.
  FlatCharts charts_;
  Parameterization result_;
};

}  // namespace

Result<FlatMap> flatten(Context& context, const Connectivity& surface,
                        const std::vector<double>& lengths, const FlatOptions& options) {
  if (!(options.margin >= 0 && std::isfinite(options.margin))) {
    return Status(Reason::kInvalidOption,
                  "a margin of " + shortestDouble(options.margin) + " between islands",
                  "give a fraction of the root of the area, 0 or more");
  }
  ASSIGN_OR_RETURN(const MollifiedLengths mollified, mollify(surface, lengths));
  Flattening first(context, surface, mollified.lengths, options);
  Result<FlatMap> result = first.run();
  const auto folds = [&] { return result.status().reason() == Reason::kFoldedMap; };
  if (folds() && options.scheme == Scheme::kVertexScaling) {
    FlatOptions other = options;
    other.initial_delaunay = !options.initial_delaunay;
    Result<FlatMap> second = Flattening(context, surface, mollified.lengths, other).run();
    if (second.status().reason() != Reason::kFoldedMap) result = std::move(second);
  }
  if (folds() && first.mayRefine()) result = first.runRefined();
  RETURN_IF_ERROR(result.status());
  result->map.certificate.mollification = mollified.relative_shift;
  return result;
}

Result<Parameterization> parameterizeFlat(Context& context, const Connectivity& surface,
                                          const std::vector<double>& lengths,
                                          const FlatOptions& options) {
  ASSIGN_OR_RETURN(FlatMap flat, flatten(context, surface, lengths, options));
  return std::move(flat.map);
}

}  // namespace moduli
