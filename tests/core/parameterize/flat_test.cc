#include "core/parameterize/flat.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "core/intrinsic/geometry.h"
#include "core/mesh/samples.h"
#include "core/parameterize/overlaps.h"
#include "core/topology/surface_topology.h"
#include "tests/core/forms/glued_surfaces.h"
#include "tests/core/parameterize/layout_checks.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

using ::testing::HasSubstr;
using Complex = std::complex<double>;
constexpr double kPi = std::numbers::pi;
constexpr RicciSolver kSolvers[] = {RicciSolver::kNewton, RicciSolver::kFlow,
                                    RicciSolver::kAffineNormal, RicciSolver::kLbfgs};

MetricSurface sample(const std::string& kind, const std::map<std::string, double>& parameters) {
  const auto soup = makeSample(kind, parameters);
  EXPECT_OK(soup);
  return fromPositions(soup->vertices, soup->faces);
}

Result<Parameterization> flatten(const MetricSurface& metric, const FlatOptions& options) {
  Context context;
  return parameterizeFlat(context, metric.surface, metric.lengths, options);
}

PlanarFaces facesOf(const MetricSurface& metric, const Parameterization& flat) {
  return {metric.surface, flat.points, flat.corner};
}

double areaOf(const MetricSurface& metric) {
  double area = 0;
  const auto side = [&](Index h) { return metric.lengths[metric.surface.edge(h)]; };
  for (Index h = 0; h < metric.surface.halfedgeCount(); h += 3) {
    area += triangleArea(Geometry::kEuclidean, {side(h), side(h + 1), side(h + 2)});
  }
  return area;
}

/// What every result is held to: a disk of faces the right way up, of the surface's area, cut into
/// islands where it lies on itself.
void expectSound(const MetricSurface& metric, const Parameterization& flat) {
  const PlanarFaces faces = facesOf(metric, flat);
  ASSERT_TRUE(faces.namesAllCorners());
  EXPECT_EQ(countOverlaps(flat.points, flat.corner), 0);
  if (*flat.certificate.islands == 1) {
    EXPECT_EQ(faces.eulerCharacteristic(), 1);
  }
  double area = 0;
  for (Index f = 0; f < metric.surface.faceCount(); ++f) {
    EXPECT_GT(faces.doubledArea(f), 0);
    area += faces.doubledArea(f) / 2;
  }
  // Corners stand where one of their faces puts them.
  EXPECT_NEAR(area / areaOf(metric), 1, 1e-12 + *flat.certificate.layout_closure);
  EXPECT_EQ(flat.certificate.quality.flipped_faces, 0);
  EXPECT_LE(*flat.certificate.curvature_residual, 1e-10);
  EXPECT_LE(*flat.certificate.gauss_bonnet_residual, 1e-10);
  EXPECT_LE(*flat.certificate.layout_closure, 1e-8);
  EXPECT_GE(flat.certificate.quality.mean_dilatation, 1);
  EXPECT_GE(flat.certificate.quality.max_dilatation, flat.certificate.quality.mean_dilatation);
  // Both sides of a seam have one length: the layout is that of a metric.
  for (Index h = 0; h < metric.surface.halfedgeCount(); ++h) {
    const Index twin = metric.surface.twin(h);
    if (twin == kNone) continue;
    EXPECT_NEAR(std::abs(faces.along(h)) / std::abs(faces.along(twin)), 1, 1e-8);
  }
}

/// Inner vertices have 2 pi less their cone, up to what closes to 1e-9.
void expectCones(const MetricSurface& metric, const Parameterization& flat,
                 const std::vector<Cone>& cones) {
  std::vector<double> wanted(metric.surface.vertexCount(), 2 * kPi);
  for (const Cone& cone : cones) wanted[cone.vertex] -= cone.curvature;
  const std::vector<double> sums = facesOf(metric, flat).angleSums();
  for (Index v = 0; v < metric.surface.vertexCount(); ++v) {
    if (metric.surface.isBoundaryVertex(v)) continue;
    EXPECT_NEAR(sums[v], wanted[v], 1e-9);
  }
}

TEST(ParameterizeFlat, OfATorusTilesThePlane) {
  // The two sides of every seam are translates of one another, by vectors of one lattice whose
  // cells have the surface's area.
  const MetricSurface torus =
      sample("torus", {{"R", 2}, {"r", 0.8}, {"resolution", 10}, {"seed", 3}});
  for (const bool initial_delaunay : {true, false}) {
    for (const RicciSolver solver : kSolvers) {
      FlatOptions options;
      options.initial_delaunay = initial_delaunay;
      options.solver = solver;
      const auto flat = flatten(torus, options);
      ASSERT_OK(flat);
      expectSound(torus, *flat);
      expectCones(torus, *flat, {});
      const PlanarFaces faces = facesOf(torus, *flat);
      std::vector<Complex> translations;
      for (Index h = 0; h < torus.surface.halfedgeCount(); ++h) {
        if (!faces.isSeam(h)) continue;
        const Index twin = torus.surface.twin(h);
        EXPECT_LE(std::abs(faces.along(h) + faces.along(twin)), 1e-8);
        translations.push_back(faces.at(Connectivity::next(twin)) - faces.at(h));
      }
      ASSERT_FALSE(translations.empty());
      bool one = false;
      for (const Complex& a : translations) {
        for (const Complex& b : translations) {
          const double cells = std::imag(std::conj(a) * b) / areaOf(torus);
          EXPECT_NEAR(cells, std::round(cells), 1e-8);
          one = one || std::abs(cells - 1) < 1e-8;
        }
      }
      EXPECT_TRUE(one);
    }
  }
}

TEST(ParameterizeFlat, LeavesAFlatDiskAlone) {
  // A free boundary keeps its scale; flat already, nothing moves: Delaunay edges are flipped and
  // back, and all lengths are what they were.
  for (const MetricSurface& grid :
       {plate(6, 4, {}), insertVertices(plate(4, 3, {}), 40, 0.05, 1)}) {
    for (const Scheme scheme : {Scheme::kVertexScaling, Scheme::kInversiveDistance}) {
      FlatOptions options;
      options.scheme = scheme;
      const auto flat = flatten(grid, options);
      ASSERT_OK(flat);
      expectSound(grid, *flat);
      EXPECT_EQ(flat->points.size(), static_cast<std::size_t>(grid.surface.vertexCount()));
      EXPECT_NEAR(flat->certificate.quality.max_dilatation, 1, 1e-10);
      const PlanarFaces faces = facesOf(grid, *flat);
      for (Index h = 0; h < grid.surface.halfedgeCount(); ++h) {
        EXPECT_NEAR(std::abs(faces.along(h)), grid.lengths[grid.surface.edge(h)], 1e-10);
      }
    }
  }
  const auto flat = flatten(plate(6, 4, {}), {});
  ASSERT_OK(flat);
  EXPECT_NEAR(flat->certificate.quality.max_dilatation, 1, 1e-12);
  EXPECT_NEAR(flat->certificate.quality.mean_dilatation, 1, 1e-12);
}

/// A bump over a square grid: a disk that is not flat.
MetricSurface bumpy(int n, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<Eigen::Vector3d> positions;
  std::vector<Triangle> faces;
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= n; ++j) {
      const bool inner = i > 0 && j > 0 && i < n && j < n;
      const double x = (i + (inner ? 0.3 * (uniform(random) - 0.5) : 0)) / n;
      const double y = (j + (inner ? 0.3 * (uniform(random) - 0.5) : 0)) / n;
      positions.emplace_back(x, y, std::sin(kPi * x) * std::sin(kPi * y) * 0.6);
    }
  }
  const auto id = [&](int i, int j) { return i * (n + 1) + j; };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      faces.push_back({id(i, j), id(i + 1, j), id(i + 1, j + 1)});
      faces.push_back({id(i, j), id(i + 1, j + 1), id(i, j + 1)});
    }
  }
  return fromPositions(positions, std::move(faces));
}

/// The turning of the layout's boundary at every boundary vertex.
std::vector<double> turnings(const MetricSurface& metric, const Parameterization& flat) {
  std::vector<double> result = facesOf(metric, flat).angleSums();
  for (Index v = 0; v < metric.surface.vertexCount(); ++v) {
    result[v] = metric.surface.isBoundaryVertex(v) ? kPi - result[v] : 0;
  }
  return result;
}

TEST(ParameterizeFlat, MakesARectangleOfADiskWithFourCorners) {
  const int n = 10;
  const MetricSurface disk = bumpy(n, 1);
  FlatOptions options;
  options.boundary = BoundaryRule::kStraight;
  for (const Index corner : {0, n, n * (n + 1), (n + 1) * (n + 1) - 1}) {
    options.cones.push_back({corner, kPi / 2});
  }
  for (const bool initial_delaunay : {true, false}) {
    options.initial_delaunay = initial_delaunay;
    const auto flat = flatten(disk, options);
    ASSERT_OK(flat);
    expectSound(disk, *flat);
    expectCones(disk, *flat, {});
    const std::vector<double> turning = turnings(disk, *flat);
    for (Index v = 0; v < disk.surface.vertexCount(); ++v) {
      const bool corner = std::any_of(options.cones.begin(), options.cones.end(),
                                      [&](const Cone& cone) { return cone.vertex == v; });
      EXPECT_NEAR(turning[v], corner ? kPi / 2 : 0, 1e-9);
    }
    // Straight sides with right angles: the points of opposite sides span a rectangle.
    std::vector<Complex> place(disk.surface.vertexCount());
    for (Index h = 0; h < disk.surface.halfedgeCount(); ++h) {
      place[disk.surface.tail(h)] = flat->points[flat->corner[h]];
    }
    const Complex a = place[options.cones[1].vertex] - place[0];
    const Complex b = place[options.cones[2].vertex] - place[0];
    EXPECT_NEAR(std::real(std::conj(a) * b) / std::abs(a * b), 0, 1e-9);
    EXPECT_NEAR(std::abs(a + b - (place[options.cones[3].vertex] - place[0])), 0, 1e-9);
    EXPECT_NEAR(std::abs(a) * std::abs(b), areaOf(disk), 1e-9);
  }
}

TEST(ParameterizeFlat, MakesACircleTurnEvenly) {
  // Within the 2e-3 of the mean turning that is promised, by the lengths that came out.
  for (const MetricSurface& disk : {bumpy(10, 2), sample("disk", {{"resolution", 6}, {"seed", 2}}),
                                    subdivide(plate(3, 3, {}), 3)}) {
    FlatOptions options;
    options.boundary = BoundaryRule::kCircle;
    const auto flat = flatten(disk, options);
    ASSERT_OK(flat);
    expectSound(disk, *flat);
    expectCones(disk, *flat, {});
    EXPECT_THAT(flat->certificate.warnings, ::testing::IsEmpty());
    const std::vector<double> turning = turnings(disk, *flat);
    const PlanarFaces faces = facesOf(disk, *flat);
    double whole = 0, count = 0;
    std::vector<double> around(disk.surface.vertexCount(), 0.0);
    for (Index h = 0; h < disk.surface.halfedgeCount(); ++h) {
      if (disk.surface.twin(h) != kNone) continue;
      const double length = std::abs(faces.along(h));
      around[disk.surface.tail(h)] += length / 2;
      around[disk.surface.head(h)] += length / 2;
      whole += length;
      ++count;
    }
    double total = 0;
    for (Index v = 0; v < disk.surface.vertexCount(); ++v) {
      if (!disk.surface.isBoundaryVertex(v)) continue;
      total += turning[v];
      EXPECT_NEAR(turning[v], 2 * kPi * around[v] / whole, 2e-3 * 2 * kPi / count);
    }
    EXPECT_NEAR(total, 2 * kPi, 1e-9);
  }
}

TEST(ParameterizeFlat, TurnsBothLoopsOfAnAnnulus) {
  const MetricSurface annulus = squareFrame(6, 2);
  FlatOptions options;
  options.boundary = BoundaryRule::kCircle;
  const auto flat = flatten(annulus, options);
  ASSERT_OK(flat);
  expectSound(annulus, *flat);
  const std::vector<double> turning = turnings(annulus, *flat);
  std::vector<double> loops;
  for (const std::vector<Index>& loop : computeTopology(annulus.surface).boundary_loops) {
    loops.push_back(0);
    for (const Index h : loop) loops.back() += turning[annulus.surface.tail(h)];
  }
  std::sort(loops.begin(), loops.end());
  ASSERT_EQ(loops.size(), 2U);
  EXPECT_NEAR(loops[0], -2 * kPi, 1e-9);
  EXPECT_NEAR(loops[1], 2 * kPi, 1e-9);
}

TEST(ParameterizeFlat, HasTheConesOfASphere) {
  const MetricSurface sphere = sample("sphere", {{"resolution", 4}, {"seed", 3}});
  const std::vector<std::vector<Cone>> choices{
      {{0, kPi}, {3, kPi}, {5, kPi}, {8, kPi}},
      {{0, kPi / 2},
       {1, kPi / 2},
       {2, kPi / 2},
       {3, kPi / 2},
       {4, kPi / 2},
       {5, kPi / 2},
       {6, kPi / 2},
       {7, kPi / 2}},
      {{2, 1.5 * kPi}, {9, 1.5 * kPi}, {11, 1.5 * kPi}, {40, -kPi / 2}}};
  for (const std::vector<Cone>& cones : choices) {
    FlatOptions options;
    options.cones = cones;
    const auto flat = flatten(sphere, options);
    ASSERT_OK(flat);
    expectSound(sphere, *flat);
    expectCones(sphere, *flat, cones);
    ASSERT_EQ(flat->cones->cones.size(), cones.size());
    EXPECT_THAT(flat->cones->handle_turns, ::testing::IsEmpty());
    // Uncut, the same layout is a disk; it may lie on itself.
    options.cut_overlaps = false;
    const auto whole = flatten(sphere, options);
    ASSERT_OK(whole);
    EXPECT_EQ(facesOf(sphere, *whole).eulerCharacteristic(), 1);
    EXPECT_EQ(countOverlaps(whole->points, whole->corner) == 0, *flat->certificate.islands == 1);
  }
}

TEST(ParameterizeFlat, CutsFacesThatFold) {
  const MetricSurface torus = insertNearCorners(
      sample("torus", {{"R", 1.2}, {"r", 1}, {"resolution", 6}, {"seed", 2}}), 0.02, 4);
  FlatOptions options;
  options.cones = {{0, 1}, {20, -1}};
  options.refine = false;
  EXPECT_THAT(flatten(torus, options), FailsWith(Reason::kFoldedMap));
  options.refine = true;
  const auto flat = flatten(torus, options);
  ASSERT_OK(flat);
  ASSERT_TRUE(flat->subdivision.has_value());
  const auto surface = Connectivity::fromFaces(
      torus.surface.vertexCount() + static_cast<Index>(flat->subdivision->vertices.size()),
      flat->subdivision->faces);
  ASSERT_OK(surface);
  const MetricSurface refined{
      *surface, subdividedLengths(torus.surface, torus.lengths, *flat->subdivision, *surface)};
  expectSound(refined, *flat);
  expectCones(refined, *flat, options.cones);
}

TEST(ParameterizeFlat, CutsFoldedFacesOfADisk) {
  // Of a surface with boundary, the faces of one half of its double.
  const MetricSurface disk =
      insertNearCorners(sample("disk", {{"resolution", 4}, {"seed", 2}}), 0.004, 4);
  FlatOptions options;
  options.boundary = BoundaryRule::kStraight;
  options.cones = {{0, -0.5 * kPi}};
  Index first = 0;
  for (Index v = 0; v < disk.surface.vertexCount() && options.cones.size() < 6; ++v) {
    if (disk.surface.isBoundaryVertex(v) && first++ % 4 == 0) options.cones.push_back({v, kPi / 2});
  }
  ASSERT_EQ(options.cones.size(), 6U);
  options.refine = false;
  EXPECT_THAT(flatten(disk, options), FailsWith(Reason::kFoldedMap));
  options.refine = true;
  const auto flat = flatten(disk, options);
  ASSERT_OK(flat);
  ASSERT_TRUE(flat->subdivision.has_value());
  EXPECT_EQ(flat->certificate.quality.flipped_faces, 0);
  EXPECT_EQ(countOverlaps(flat->points, flat->corner), 0);
}

TEST(ParameterizeFlat, HasTheConesOfASurfaceOfGenusTwo) {
  const MetricSurface surface = sample("genus", {{"genus", 2}, {"resolution", 4}, {"seed", 1}});
  ASSERT_EQ(surface.surface.eulerCharacteristic(), -2);
  ASSERT_LT(surface.surface.faceCount(), 5000);
  FlatOptions options;
  for (Index v = 0; v < 16; ++v) options.cones.push_back({50 * v, -kPi / 4});
  const auto flat = flatten(surface, options);
  ASSERT_OK(flat);
  expectSound(surface, *flat);
  expectCones(surface, *flat, options.cones);
}

TEST(ParameterizeFlat, KnowsNoUnit) {
  const MetricSurface disk = bumpy(8, 5);
  const auto reference = flatten(disk, {});
  ASSERT_OK(reference);
  for (const double unit : {1e-6, 1e6}) {
    const auto flat = flatten(scale(disk, unit), {});
    ASSERT_OK(flat);
    EXPECT_NEAR(flat->certificate.quality.max_dilatation,
                reference->certificate.quality.max_dilatation, 1e-9);
    const PlanarFaces one = facesOf(disk, *reference), other = facesOf(disk, *flat);
    for (Index h = 0; h < disk.surface.halfedgeCount(); ++h) {
      EXPECT_NEAR(std::abs(other.along(h)) / unit, std::abs(one.along(h)), 1e-9);
    }
  }
}

TEST(ParameterizeFlat, PacksEqualCirclesOnATorusGrid) {
  // Six touching circles around each: equilateral triangles.
  const MetricSurface torus = torusOfRevolution(2, 1, 8, 6);
  FlatOptions options;
  options.scheme = Scheme::kTangential;
  for (const RicciSolver solver : kSolvers) {
    options.solver = solver;
    const auto flat = flatten(torus, options);
    ASSERT_OK(flat);
    expectSound(torus, *flat);
    const double side = std::sqrt(areaOf(torus) / 96 * 4 / std::sqrt(3.0));
    const PlanarFaces faces = facesOf(torus, *flat);
    for (Index h = 0; h < torus.surface.halfedgeCount(); ++h) {
      EXPECT_NEAR(std::abs(faces.along(h)), side, 1e-9);
    }
  }
}

TEST(ParameterizeFlat, SaysWhereFixedTrianglesHaveNoPacking) {
  // Touching circles leave each of six corners less than pi: a curvature below 2 pi - 6 pi is out
  // of reach, but not for flips.
  const MetricSurface torus = sample("torus", {{"R", 2}, {"r", 0.8}, {"resolution", 8}});
  FlatOptions options;
  options.cones = {{0, -4.5 * kPi}, {50, 1.5 * kPi}, {90, 1.5 * kPi}, {120, 1.5 * kPi}};
  options.scheme = Scheme::kTangential;
  for (const RicciSolver solver : {RicciSolver::kNewton, RicciSolver::kAffineNormal}) {
    options.solver = solver;
    const auto packed = flatten(torus, options);
    EXPECT_THAT(packed, FailsWith(Reason::kNoConvergence));
    EXPECT_THAT(packed.status().hint(), HasSubstr("vertex scaling"));
  }
}

TEST(ParameterizeFlat, RefusesWhatHasNoMetric) {
  const MetricSurface sphere = sample("sphere", {{"resolution", 2}});
  FlatOptions options;
  EXPECT_THAT(flatten(sphere, options), FailsWith(Reason::kInvalidOption));
  options.cones = {{0, 4 * kPi}};
  EXPECT_THAT(flatten(sphere, options), FailsWith(Reason::kInvalidOption));
  EXPECT_EQ(flatten(sphere, options).status().message(),
            "by the theorem of Gauss and Bonnet the cones of a flat sphere share a curvature of "
            "4 pi, and each has less than 2 pi: one cone cannot, three can");
  options.cones = {{0, 2 * kPi}, {1, kPi}, {2, kPi}};
  EXPECT_THAT(flatten(sphere, options), FailsWith(Reason::kInvalidOption));
  options.cones = {{0, kPi}, {0, kPi}, {1, kPi}, {2, kPi}};
  EXPECT_THAT(flatten(sphere, options), FailsWith(Reason::kInvalidOption));
  options.cones = {{0, kPi}, {1000, kPi}, {1, kPi}, {2, kPi}};
  EXPECT_THAT(flatten(sphere, options), FailsWith(Reason::kInvalidOption));
  const MetricSurface square = plate(3, 3, {});
  options.cones = {};
  options.boundary = BoundaryRule::kStraight;
  EXPECT_THAT(flatten(square, options), FailsWith(Reason::kInvalidOption));
}

TEST(ParameterizeFlat, StopsWhenCancelled) {
  const MetricSurface torus = torusOfRevolution(2, 1, 8, 6);
  Context context;
  CancelToken token;
  token.cancel();
  context.setCancelToken(token);
  EXPECT_THAT(parameterizeFlat(context, torus.surface, torus.lengths, {}),
              FailsWith(Reason::kCancelled));
}

}  // namespace
}  // namespace moduli
