#include "core/ricci/prescribe.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "core/intrinsic/intrinsic_samples.h"
#include "core/mesh/samples.h"
#include "tests/core/forms/glued_surfaces.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr Geometry kPlanes[] = {Geometry::kEuclidean, Geometry::kHyperbolic};

PrescribeOptions in(Geometry geometry, bool initial_delaunay = true) {
  PrescribeOptions options;
  options.geometry = geometry;
  options.initial_delaunay = initial_delaunay;
  return options;
}

std::vector<double> zeros(const MetricSurface& metric) {
  return std::vector<double>(metric.surface.vertexCount(), 0.0);
}

Result<DiscreteMetric> prescribe(const MetricSurface& metric, const std::vector<double>& target,
                                 const PrescribeOptions& options) {
  Context context;
  return prescribeCurvature(context, metric.surface, metric.lengths, target,
                            Unknowns::all(metric.surface.vertexCount()), options);
}

MetricSurface sample(const std::string& kind, const std::map<std::string, double>& parameters) {
  const auto soup = makeSample(kind, parameters);
  EXPECT_OK(soup);
  return fromPositions(soup->vertices, soup->faces);
}

/// An irregular mesh of a torus of revolution, without ties.
MetricSurface someTorus() {
  return sample("torus", {{"R", 2}, {"r", 0.8}, {"resolution", 10}, {"seed", 3}});
}

/// One of genus 2 with 70 vertices, moved away from its symmetry.
MetricSurface someGenus2() {
  MetricSurface metric = subdivide(octahedronCover(), 3);
  std::mt19937 random(5);
  std::vector<double> s(metric.surface.vertexCount());
  for (double& value : s) value = 0.3 * (2 * uniform(random) - 1);
  for (Index e = 0; e < metric.surface.edgeCount(); ++e) {
    const Index h = metric.surface.halfedge(e);
    metric.lengths[e] *= std::exp((s[metric.surface.tail(h)] + s[metric.surface.head(h)]) / 2);
  }
  return metric;
}

MetricSurface someSurface(Geometry geometry) {
  return geometry == Geometry::kEuclidean ? someTorus() : someGenus2();
}

/// Half chords times e^{(s_i + s_j) / 2}, s random up to `far`.
std::vector<double> scaleVertices(MetricSurface& metric, double far, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<double> s(metric.surface.vertexCount());
  for (double& value : s) value = far * (2 * uniform(random) - 1);
  for (Index e = 0; e < metric.surface.edgeCount(); ++e) {
    const Index h = metric.surface.halfedge(e);
    metric.lengths[e] *= std::exp((s[metric.surface.tail(h)] + s[metric.surface.head(h)]) / 2);
  }
  return s;
}

/// The final metric as a surface of its own; lengths are its chords.
MetricSurface finalSurface(const DiscreteMetric& metric) {
  MetricSurface result{metric.triangulation.connectivity(), {}};
  for (Index e = 0; e < result.surface.edgeCount(); ++e) {
    result.lengths.push_back(2 * metric.half_chords[result.surface.halfedge(e)]);
  }
  return result;
}

using EdgeList = std::vector<std::tuple<Index, Index, double>>;

/// Ends and final half chord of all edges; Euclidean ones over their mean.
EdgeList sortedEdges(const DiscreteMetric& metric) {
  EdgeList edges;
  double sum = 0;
  const IntrinsicTriangulation& t = metric.triangulation;
  for (Index h = 0; h < t.halfedgeCount(); ++h) {
    if (t.twin(h) < h) continue;
    edges.emplace_back(std::min(t.tail(h), t.head(h)), std::max(t.tail(h), t.head(h)),
                       metric.half_chords[h]);
    sum += metric.half_chords[h];
  }
  if (metric.geometry == Geometry::kEuclidean) {
    for (auto& edge : edges) std::get<2>(edge) *= static_cast<double>(edges.size()) / sum;
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

void expectSameMetric(const DiscreteMetric& one, const DiscreteMetric& other, double tolerance) {
  const EdgeList a = sortedEdges(one), b = sortedEdges(other);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t e = 0; e < a.size(); ++e) {
    EXPECT_EQ(std::get<0>(a[e]), std::get<0>(b[e]));
    EXPECT_EQ(std::get<1>(a[e]), std::get<1>(b[e]));
    EXPECT_NEAR(std::get<2>(a[e]) / std::get<2>(b[e]), 1, tolerance);
  }
}

/// Only the lengths, where vertices have other numbers.
void expectSameLengths(const DiscreteMetric& one, const DiscreteMetric& other, double tolerance) {
  std::vector<double> a, b;
  for (const auto& edge : sortedEdges(one)) a.push_back(std::get<2>(edge));
  for (const auto& edge : sortedEdges(other)) b.push_back(std::get<2>(edge));
  std::sort(a.begin(), a.end());
  std::sort(b.begin(), b.end());
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t e = 0; e < a.size(); ++e) EXPECT_NEAR(a[e] / b[e], 1, tolerance);
}

double faceArea(const DiscreteMetric& metric) {
  double area = 0;
  for (Index f = 0; f < metric.triangulation.faceCount(); ++f) {
    TriangleValues sides{};
    for (int c = 0; c < 3; ++c) {
      sides[c] = lengthOfHalfChord(metric.geometry, metric.half_chords[3 * f + c]);
    }
    area += triangleArea(metric.geometry, sides);
  }
  return area;
}

TEST(PrescribeCurvature, FindsTheHyperbolicMetricOfRegularMaps) {
  // CHECKS F7 and F8, from equilateral Euclidean triangles and from the hyperbolic samples.
  struct Case {
    MetricSurface surface;
    int degree;
    double area;
  };
  std::vector<Case> cases{{octahedronCover(), 8, 4 * kPi}, {kleinQuartic(), 7, 8 * kPi}};
  for (const char* kind : {"bolza", "klein"}) {
    const auto made = makeIntrinsicSample(kind);
    ASSERT_OK(made);
    const bool bolza = kind == std::string("bolza");
    cases.push_back({{made->connectivity, made->lengths}, bolza ? 8 : 7, (bolza ? 4 : 8) * kPi});
  }
  for (const Case& map : cases) {
    const auto metric = prescribe(map.surface, zeros(map.surface), in(Geometry::kHyperbolic));
    ASSERT_OK(metric);
    const double cosine = 1 / (2 * std::sin(kPi / map.degree));
    for (const double u : metric->u) EXPECT_NEAR(u, metric->u[0], 1e-12);
    for (const double x : metric->half_chords) EXPECT_NEAR(std::hypot(1, x), cosine, 1e-12);
    for (const double a : metric->angles) EXPECT_NEAR(a, 2 * kPi / map.degree, 1e-12);
    EXPECT_NEAR(faceArea(*metric), map.area, 1e-12 * map.area);
    EXPECT_LT(metric->certificate.curvature_residual, 1e-12);
    EXPECT_LT(metric->certificate.gauss_bonnet_residual, 1e-12);
  }
}

TEST(PrescribeCurvature, UndoesAScalingOfADelaunaySurface) {
  // CHECKS F9: lengths of a flat or hyperbolic Delaunay triangulation times e^{(s_i + s_j) / 2};
  // Ptolemy flips alone lead back. In E2 u is free of a constant, in H2 it knows the unit.
  for (const Geometry geometry : kPlanes) {
    const MetricSurface start = someSurface(geometry);
    const auto known = prescribe(start, zeros(start), in(geometry));
    ASSERT_OK(known);
    MetricSurface scaled = finalSurface(*known);
    const std::vector<double> s = scaleVertices(scaled, 0.3, 1);
    const auto found = prescribe(scaled, zeros(scaled), in(geometry, false));
    ASSERT_OK(found);
    const double constant = found->u[0] + s[0];
    for (std::size_t v = 0; v < s.size(); ++v) EXPECT_NEAR(found->u[v], constant - s[v], 1e-10);
    expectSameMetric(*found, *known, 1e-10);
  }
}

TEST(PrescribeCurvature, RecoversConesFromAScaling) {
  // The curvature of a polyhedron as the target, from its own class: MATH 6.9.
  for (const MetricSurface& polyhedron :
       {octahedronCover(), insertVertices(gluedPolygon(8), 40, 0.05, 2),
        sample("sphere", {{"resolution", 3}, {"seed", 4}})}) {
    // A first solution with its own curvature leaves all alone but the diagonals.
    Context context;
    IntrinsicTriangulation t(polyhedron.surface, polyhedron.lengths);
    VertexScalingModel model(Geometry::kEuclidean, t,
                             Unknowns::all(polyhedron.surface.vertexCount()),
                             VertexScalingModel::Flips::kOff);
    ASSERT_OK(model.moveTo(context, Eigen::VectorXd::Zero(model.size())));
    const auto same = prescribe(polyhedron, model.vertexCurvatures(), in(Geometry::kEuclidean));
    ASSERT_OK(same);
    for (const double u : same->u) EXPECT_NEAR(u, 0, 1e-10);
    MetricSurface scaled = finalSurface(*same);
    const std::vector<double> s = scaleVertices(scaled, 0.5, 3);
    const auto found = prescribe(scaled, model.vertexCurvatures(), in(Geometry::kEuclidean, false));
    ASSERT_OK(found);
    for (std::size_t v = 0; v < s.size(); ++v) {
      EXPECT_NEAR(found->u[v] + s[v], found->u[0] + s[0], 1e-10);
    }
  }
}

TEST(PrescribeCurvature, ConvergesQuadratically) {
  // CHECKS F10: 70 vertices, genus 2. Below a hundredth the next residual is at most the power 1.5,
  // which no linear rate keeps up over the decades down to rounding.
  const MetricSurface metric = someGenus2();
  ASSERT_EQ(metric.surface.vertexCount(), 70);
  const auto found = prescribe(metric, zeros(metric), in(Geometry::kHyperbolic));
  ASSERT_OK(found);
  const std::vector<double>& residuals = found->certificate.residuals;
  EXPECT_EQ(found->certificate.newton_iterations, static_cast<int>(residuals.size()) - 1);
  EXPECT_LE(residuals.size(), 9U);
  EXPECT_LT(residuals.back(), 1e-13);
  int judged = 0;
  for (std::size_t n = 0; n + 1 < residuals.size(); ++n) {
    EXPECT_LT(residuals[n + 1], residuals[n]);
    if (residuals[n] > 1e-2) continue;
    ++judged;
    EXPECT_LT(residuals[n + 1], std::max(std::pow(residuals[n], 1.5), 1e-13));
  }
  EXPECT_GE(judged, 2);
}

TEST(PrescribeCurvature, MakesACubeOfASphere) {
  // CHECKS F12: eight cones of pi / 2, nearest to the corners of a cube.
  const auto soup = makeSample("sphere", {{"resolution", 4}});
  ASSERT_OK(soup);
  const MetricSurface sphere = fromPositions(soup->vertices, soup->faces);
  std::vector<double> target = zeros(sphere);
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d place(corner & 1 ? 1.01 : -1, corner & 2 ? 1.02 : -1,
                                corner & 4 ? 1.03 : -1);
    Index nearest = 0;
    for (Index v = 1; v < sphere.surface.vertexCount(); ++v) {
      if (soup->vertices[v].dot(place) > soup->vertices[nearest].dot(place)) nearest = v;
    }
    target[nearest] += kPi / 2;
  }
  EXPECT_EQ(std::count(target.begin(), target.end(), kPi / 2), 8);
  const auto found = prescribe(sphere, target, in(Geometry::kEuclidean));
  ASSERT_OK(found);
  EXPECT_LT(found->certificate.curvature_residual, 1e-10);
  EXPECT_LT(found->certificate.gauss_bonnet_residual, 1e-10);
  std::vector<double> sums(target.size(), 0.0);
  for (Index h = 0; h < found->triangulation.halfedgeCount(); ++h) {
    sums[found->triangulation.tail(h)] += found->angles[h];
  }
  for (std::size_t v = 0; v < sums.size(); ++v) EXPECT_NEAR(2 * kPi - sums[v], target[v], 1e-10);
}

TEST(PrescribeCurvature, DoesNotDependOnIsometricFlipsBefore) {
  // CHECKS F14 (a).
  for (const Geometry geometry : kPlanes) {
    const MetricSurface metric = someSurface(geometry);
    const auto reference = prescribe(metric, zeros(metric), in(geometry));
    ASSERT_OK(reference);
    for (unsigned seed = 1; seed <= 2; ++seed) {
      const MetricSurface flipped = flipEdges(metric, 300, seed);
      const auto found = prescribe(flipped, zeros(metric), in(geometry));
      ASSERT_OK(found);
      expectSameMetric(*found, *reference, 1e-8);
    }
  }
}

TEST(PrescribeCurvature, DoesNotDependOnPtolemyFlipsBefore) {
  // CHECKS F14 (b): without the Delaunay flips of the polyhedral metric, which is another one after
  // such flips, while the class is the same.
  for (const Geometry geometry : kPlanes) {
    const MetricSurface metric = someSurface(geometry);
    const auto reference = prescribe(metric, zeros(metric), in(geometry, false));
    ASSERT_OK(reference);
    IntrinsicTriangulation t(metric.surface, metric.lengths);
    std::mt19937 random(2);
    for (int n = 0; n < 150; ++n) {
      const auto h = static_cast<Index>(random() % t.halfedgeCount());
      if (!t.canFlip(h)) continue;
      t.flip(h, t.ptolemyDiagonal(h));
      bool proper = true;
      for (const Index g : {h, t.twin(h)}) {
        proper = proper && !isBrokenTriangle({t.halfChord(g), t.halfChord(Connectivity::next(g)),
                                              t.halfChord(Connectivity::previous(g))});
      }
      if (!proper) t.undoTo(t.history().size() - 1);
    }
    ASSERT_GT(t.history().size(), 20U);
    const auto found =
        prescribe({t.connectivity(), t.edgeHalfChords()}, zeros(metric), in(geometry, false));
    ASSERT_OK(found);
    expectSameMetric(*found, *reference, 1e-8);
  }
}

TEST(PrescribeCurvature, DoesNotDependOnNumbersAndUnits) {
  for (const Geometry geometry : kPlanes) {
    const MetricSurface metric = someSurface(geometry);
    const auto reference = prescribe(metric, zeros(metric), in(geometry));
    ASSERT_OK(reference);
    const auto renumbered = prescribe(renumber(metric, 1), zeros(metric), in(geometry));
    ASSERT_OK(renumbered);
    expectSameLengths(*renumbered, *reference, 1e-10);
    for (const double unit : {1e-6, 1e6}) {
      const auto other = prescribe(scale(metric, unit), zeros(metric), in(geometry));
      ASSERT_OK(other);
      expectSameMetric(*other, *reference, 1e-10);
      for (std::size_t v = 0; v < other->u.size(); ++v) {
        EXPECT_NEAR(other->u[v], reference->u[v], 1e-10);
      }
    }
  }
}

TEST(PrescribeCurvature, DoesNotSeeRigidMotions) {
  const auto soup = makeSample("torus", {{"R", 2}, {"r", 0.8}, {"resolution", 10}, {"seed", 3}});
  ASSERT_OK(soup);
  std::vector<Eigen::Vector3d> moved = soup->vertices;
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  for (Eigen::Vector3d& p : moved) p = (turn * p + Eigen::Vector3d(3, -1, 2)).eval();
  const MetricSurface metric = fromPositions(soup->vertices, soup->faces);
  const auto one = prescribe(metric, zeros(metric), in(Geometry::kEuclidean));
  const auto other =
      prescribe(fromPositions(moved, soup->faces), zeros(metric), in(Geometry::kEuclidean));
  ASSERT_OK(one);
  ASSERT_OK(other);
  expectSameMetric(*one, *other, 1e-10);
}

TEST(PrescribeCurvature, KeepsFixedFactorsToTheBit) {
  const MetricSurface metric = someTorus();
  PrescribeOptions options = in(Geometry::kEuclidean);
  for (Index v = 0; v < metric.surface.vertexCount(); ++v) options.fixed.push_back(v % 7 == 0);
  for (const RicciSolver solver : {RicciSolver::kNewton, RicciSolver::kFlow,
                                   RicciSolver::kAffineNormal, RicciSolver::kLbfgs}) {
    options.solver = solver;
    const auto found = prescribe(metric, zeros(metric), options);
    ASSERT_OK(found);
    std::vector<double> curvature(metric.surface.vertexCount(), 2 * kPi);
    for (Index h = 0; h < found->triangulation.halfedgeCount(); ++h) {
      curvature[found->triangulation.tail(h)] -= found->angles[h];
    }
    double largest = 0;
    for (Index v = 0; v < metric.surface.vertexCount(); ++v) {
      if (options.fixed[v]) {
        EXPECT_EQ(found->u[v], 0);
        largest = std::max(largest, std::abs(curvature[v]));
      } else {
        EXPECT_NEAR(curvature[v], 0, 1e-10);
      }
    }
    EXPECT_GT(largest, 1e-3);
    EXPECT_LE(found->certificate.curvature_residual, 1e-10);
  }
}

TEST(PrescribeCurvature, IsReachedByEverySolverAsByNewton) {
  // The flow's residual, 1e-11, over the smallest eigenvalue, above 0.02; the minimizers leave
  // less.
  for (const Geometry geometry : kPlanes) {
    const MetricSurface metric = someSurface(geometry);
    PrescribeOptions options = in(geometry);
    const auto newton = prescribe(metric, zeros(metric), options);
    ASSERT_OK(newton);
    for (const RicciSolver solver :
         {RicciSolver::kFlow, RicciSolver::kAffineNormal, RicciSolver::kLbfgs}) {
      options.solver = solver;
      const auto found = prescribe(metric, zeros(metric), options);
      ASSERT_OK(found);
      for (std::size_t v = 0; v < found->u.size(); ++v) {
        EXPECT_NEAR(found->u[v], newton->u[v], 1e-9);
      }
      expectSameMetric(*found, *newton, 1e-9);
    }
  }
}

TEST(PrescribeCurvature, HasAMeanFactorOfOneInTheEuclideanPlane) {
  const MetricSurface metric = someTorus();
  const auto found = prescribe(metric, zeros(metric), in(Geometry::kEuclidean));
  ASSERT_OK(found);
  double sum = 0, size = 0;
  for (const double u : found->u) {
    sum += u;
    size += std::abs(u);
  }
  EXPECT_NEAR(sum, 0, 1e-13 * size);
}

TEST(PrescribeCurvature, SurvivesWildScalings) {
  // Factors from e^-3 to e^3 break most triangles; the class, and so the metric, stays.
  for (const Geometry geometry : kPlanes) {
    const MetricSurface metric = someSurface(geometry);
    const auto reference = prescribe(metric, zeros(metric), in(geometry, false));
    ASSERT_OK(reference);
    MetricSurface wild = metric;
    const std::vector<double> s = scaleVertices(wild, 3, 4);
    const auto found = prescribe(wild, zeros(metric), in(geometry, false));
    ASSERT_OK(found);
    expectSameMetric(*found, *reference, 1e-9);
    for (std::size_t v = 0; v < s.size(); ++v) {
      EXPECT_NEAR(found->u[v] + s[v] - reference->u[v], found->u[0] + s[0] - reference->u[0], 1e-9);
    }
  }
}

TEST(PrescribeCurvature, SharesFactorsWithinOrbits) {
  // The double of an irregular plate, flat but for its corners: both halves alike.
  const MetricSurface half = insertVertices(plate(3, 2, {}), 10, 0.1, 6);
  const MetricSurface metric = doubled(half);
  const Index count = half.surface.vertexCount();
  Unknowns orbits;
  orbits.count = count;
  std::vector<double> target;
  Index beyond = count;
  std::vector<Index> mirror(metric.surface.vertexCount(), kNone);
  for (Index v = 0; v < count; ++v) {
    if (!half.surface.isBoundaryVertex(v)) mirror[beyond++] = v;
  }
  for (Index v = 0; v < metric.surface.vertexCount(); ++v) {
    orbits.of_vertex.push_back(v < count ? v : mirror[v]);
    target.push_back(0);
  }
  // Two inner vertices with their images carry the curvature of the sphere.
  Index a = 0;
  while (half.surface.isBoundaryVertex(a)) ++a;
  Index b = a + 1;
  while (half.surface.isBoundaryVertex(b)) ++b;
  for (Index v = 0; v < metric.surface.vertexCount(); ++v) {
    if (orbits.of_vertex[v] == a || orbits.of_vertex[v] == b) target[v] = kPi;
  }
  Context context;
  const auto found = prescribeCurvature(context, metric.surface, metric.lengths, target, orbits,
                                        in(Geometry::kEuclidean));
  ASSERT_OK(found);
  const auto free = prescribe(metric, target, in(Geometry::kEuclidean));
  ASSERT_OK(free);
  EXPECT_LT(found->certificate.curvature_residual, 1e-10);
  for (Index v = 0; v < metric.surface.vertexCount(); ++v) {
    EXPECT_EQ(found->u[v], found->u[orbits.of_vertex[v]]);
    EXPECT_NEAR(found->u[v] - found->u[0], free->u[v] - free->u[0], 1e-9);
  }
}

TEST(PrescribeCurvature, StopsWhenToldTo) {
  const MetricSurface metric = someTorus();
  Context cancelled;
  CancelToken token;
  token.cancel();
  cancelled.setCancelToken(token);
  const Unknowns all = Unknowns::all(metric.surface.vertexCount());
  EXPECT_THAT(prescribeCurvature(cancelled, metric.surface, metric.lengths, zeros(metric), all),
              FailsWith(Reason::kCancelled));
  Context late;
  late.setDeadline(Context::Clock::now() - std::chrono::seconds(1));
  EXPECT_THAT(prescribeCurvature(late, metric.surface, metric.lengths, zeros(metric), all),
              FailsWith(Reason::kDeadlineExceeded));
}

TEST(PrescribedCurvature, GoesOnFromItsLastSolution) {
  const MetricSurface metric = someTorus();
  Context context;
  PrescribedCurvature problem(metric.surface, Unknowns::all(metric.surface.vertexCount()),
                              in(Geometry::kEuclidean));
  ASSERT_OK(problem.start(context, metric.lengths));
  std::vector<double> target = zeros(metric);
  const auto rough = problem.approach(context, target, 1e-3);
  ASSERT_OK(rough);
  EXPECT_LE(rough->certificate.curvature_residual, 1e-3);
  const auto exact = problem.solve(context, target);
  ASSERT_OK(exact);
  const auto again = problem.solve(context, target);
  ASSERT_OK(again);
  EXPECT_LE(again->certificate.newton_iterations, 1);
  // Other cones, and back.
  target[3] = 1;
  target[8] = -1;
  ASSERT_OK(problem.solve(context, target));
  const auto back = problem.solve(context, zeros(metric));
  ASSERT_OK(back);
  expectSameMetric(*back, *exact, 1e-9);
}

}  // namespace
}  // namespace moduli
