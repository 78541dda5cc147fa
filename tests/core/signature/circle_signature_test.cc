#include <Eigen/Eigenvalues>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <set>

#include "core/forms/bordered_period.h"
#include "core/signature/canonical_circles.h"
#include "core/signature/compute.h"
#include "core/spherical/circle_domain_capacity.h"
#include "tests/core/forms/glued_surfaces.h"
#include "tests/core/spherical/plane_domains.h"
#include "tests/core/spherical/surfaces.h"
#include "tests/core/testing.h"

/// The circles in the signatures of surfaces of genus 0 with three boundary loops or more.
namespace moduli {
namespace {

using Complex = std::complex<double>;
using Circles = std::vector<Circle>;
using testing::Contains;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

/// Canonical, and without symmetry.
const Circles kThreeHoles = {{0, 1}, {0, 0.25}, {0.6, 0.12}, {{-0.2, 0.65}, 0.08}};

PreparedMesh prepare(const TriangleSoup& soup) {
  Context context;
  auto prepared = prepareMesh(context, soup, {});
  EXPECT_OK(prepared);
  return *std::move(prepared);
}

Signature sign(const TriangleSoup& soup) {
  Context context;
  auto signature = computeSignature(context, prepare(soup), {Space::kConformal});
  EXPECT_OK(signature);
  return *std::move(signature);
}

Signature sign(const IntrinsicSurface& surface) {
  Context context;
  auto signature = computeIntrinsicSignature(context, surface, {Space::kConformal});
  EXPECT_OK(signature);
  return *std::move(signature);
}

IntrinsicSurface intrinsic(const MetricSurface& given) {
  return {given.surface, given.lengths, Geometry::kEuclidean};
}

double difference(const Circles& a, const Circles& b) {
  if (a.size() != b.size()) return 1;
  double largest = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    largest = std::max(
        {largest, std::abs(a[k].center - b[k].center), std::abs(a[k].radius - b[k].radius)});
  }
  return largest;
}

/// One to one on the disk with the three holes (koebe_test.cc), but not on the disk.
Complex univalent(Complex z) {
  Complex sum = z + 0.1 * z * z;
  for (std::size_t k = 1; k < kThreeHoles.size(); ++k) {
    const Circle& hole = kThreeHoles[k];
    sum += 0.3 * hole.radius * hole.radius / (z - hole.center);
  }
  return sum;
}

TriangleSoup lifted(const PlaneDomain& domain, const std::function<Complex(Complex)>& map) {
  TriangleSoup soup;
  soup.faces = domain.faces;
  for (const Complex z : domain.points) {
    const Complex w = map(z);
    soup.vertices.push_back(Eigen::Vector3d(2 * w.real(), 2 * w.imag(), std::norm(w) - 1) /
                            (1 + std::norm(w)));
  }
  return soup;
}

/// A conformal image of the disk with the three holes on the unit sphere, in triangles with edges
/// of about h in the disk.
TriangleSoup onSphere(double h) {
  return lifted(triangulateDomain(kThreeHoles, h), univalent);
}

/// Of the full flux matrix, whose rows sum to zero; free of the order of loops.
Eigen::VectorXd fluxes(const Eigen::MatrixXd& reduced) {
  const Eigen::Index n = reduced.rows();
  Eigen::MatrixXd full(n + 1, n + 1);
  full.topLeftCorner(n, n) = reduced;
  full.topRightCorner(n, 1) = -reduced.rowwise().sum();
  full.bottomLeftCorner(1, n) = -reduced.colwise().sum();
  full(n, n) = reduced.sum();
  // The first eigenvalue is 0.
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(full).eigenvalues().tail(n);
}

/// Of the circles without a mesh, and of the surface by finite elements.
struct Fluxes {
  Eigen::ArrayXd circles, surface;

  double difference() const { return (surface / circles - 1).abs().maxCoeff(); }
};

Fluxes fluxesOf(const Signature& signature, const Connectivity& surface,
                const std::vector<double>& lengths) {
  Context context;
  const auto exact = circleDomainCapacity(context, signature.conformal->circles);
  const auto periods = computeBorderedPeriods(context, surface, lengths);
  EXPECT_OK(exact.status());
  EXPECT_OK(periods.status());
  if (!exact.ok() || !periods.ok()) return {Eigen::ArrayXd::Zero(1), Eigen::ArrayXd::Ones(1)};
  return {fluxes(exact->capacity), fluxes(periods->capacity)};
}

Fluxes fluxesOf(const MetricSurface& given) {
  return fluxesOf(sign(intrinsic(given)), given.surface, given.lengths);
}

TEST(CircleSignature, ConvergesToTheRoundHolesAtSecondOrder) {
  std::vector<double> errors, flux;
  for (const double h : {0.04, 0.02}) {
    const TriangleSoup soup = onSphere(h);
    const Signature signature = sign(soup);
    ASSERT_TRUE(signature.conformal);
    EXPECT_EQ(signature.conformal->type, ConformalType::kCircleDomain);
    EXPECT_THAT(signature.certificate.warnings, IsEmpty());
    errors.push_back(difference(signature.conformal->circles, kThreeHoles));
    const TriangleMesh mesh = surfaces::mesh(soup);
    flux.push_back(fluxesOf(signature, mesh.connectivity(), mesh.edgeLengths()).difference());
  }
  RecordProperty("circles", testing::PrintToString(errors));
  RecordProperty("fluxes", testing::PrintToString(flux));
  EXPECT_GT(std::log2(errors[0] / errors[1]), 1.75);
  EXPECT_GT(std::log2(flux[0] / flux[1]), 1.75);
  EXPECT_LT(errors[1], 1e-4);
  EXPECT_LT(flux[1], 1e-3);
}

// Of a polyhedron inscribed in a sphere the map knows the exact points, and loops on circles are
// round from the start: any Möbius map of space, which makes any loop the longest one, keeps the
// circles up to rounding, however coarse the mesh.
TEST(CircleSignature, OfInscribedSurfacesIsExactWhicheverLoopIsTheLongest) {
  const PlaneDomain domain = triangulateDomain(kThreeHoles, 0.1);
  for (const Circle& hole : {Circle{2.0, 1}, kThreeHoles[1], kThreeHoles[2], kThreeHoles[3]}) {
    const Complex pole = hole.center + 0.2 * hole.radius;
    const Signature signature = sign(lifted(domain, [&](Complex z) { return 0.15 / (z - pole); }));
    EXPECT_LT(difference(signature.conformal->circles, kThreeHoles), 1e-11);
  }
}

MetricSurface plateWithSquareHoles(int n) {
  std::set<std::pair<int, int>> holes;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      holes.insert({n + i, n + j});
      holes.insert({3 * n + i, 2 * n + j});
      if (2 * i < n && 2 * j < n) holes.insert({n + i, 3 * n + j});
    }
  }
  return plate(6 * n, 5 * n, holes);
}

// At corners with an angle of 3 pi / 2 inside, functions like r^(2 / 3) make energies of linear
// elements converge with order 4 / 3. So do the circles, to the same limit; what the next order
// leaves of the limits is a fraction of the last error.
TEST(CircleSignature, OfAPlateWithSquareHolesHasItsFluxes) {
  constexpr double kOrder = 4.0 / 3;
  std::vector<Fluxes> flux;
  for (const int n : {4, 8, 16}) flux.push_back(fluxesOf(plateWithSquareHoles(n)));
  const auto limitOf = [&](Eigen::ArrayXd Fluxes::*way) -> Eigen::ArrayXd {
    return flux[2].*way - (flux[1].*way - flux[2].*way) / (std::exp2(kOrder) - 1);
  };
  const Eigen::ArrayXd exact = limitOf(&Fluxes::surface);
  const double left = (flux[2].surface / exact - 1).abs().maxCoeff();
  const double apart = (limitOf(&Fluxes::circles) / exact - 1).abs().maxCoeff();
  EXPECT_LT(apart, 0.2 * left);
  const auto errorAt = [&](int k) { return (flux[k].circles / exact - 1).abs().maxCoeff(); };
  RecordProperty("error", std::to_string(errorAt(2)));
  RecordProperty("apart", std::to_string(apart));
  RecordProperty("order", std::to_string(std::log2(errorAt(0) / errorAt(2)) / 2));
  EXPECT_NEAR(std::log2(errorAt(0) / errorAt(2)) / 2, kOrder, 0.2);
}

TEST(CircleSignature, OfAMovedOrMirroredSurfaceIsTheSameOrMirrored) {
  const TriangleSoup soup = onSphere(0.06);
  const Circles circles = sign(soup).conformal->circles;
  // What rounding of coordinates does to a well-posed map: nothing is chosen otherwise here.
  EXPECT_LT(difference(sign(surfaces::moved(soup, 1234.5)).conformal->circles, circles), 1e-9);
  for (const double factor : {0x1p-300, 0x1p300}) {
    TriangleSoup scaled = soup;
    for (Eigen::Vector3d& p : scaled.vertices) p *= factor;
    EXPECT_EQ(difference(sign(scaled).conformal->circles, circles), 0);
  }
  TriangleSoup mirrored = soup;
  for (Eigen::Vector3d& p : mirrored.vertices) p.x() = -p.x();
  // The same lengths: positions only tell the map where to start.
  EXPECT_LT(difference(sign(mirrored).conformal->circles, circles), 1e-9);
  Circles conjugate = circles;
  for (Circle& circle : conjugate) circle.center = std::conj(circle.center);
  // Loops are followed the other way round, as in another numbering.
  const double error = difference(circles, kThreeHoles);
  EXPECT_LT(difference(sign(surfaces::reversed(mirrored)).conformal->circles, conjugate), error);
  EXPECT_LT(difference(sign(surfaces::reversed(soup)).conformal->circles, conjugate), error);
  EXPECT_GT(difference(circles, conjugate), 1);
}

// The curves between points depend on where they start, at second order: less than the error of
// the circles themselves.
TEST(CircleSignature, OfARenumberedSurfaceIsTheSameUpToTheMesh) {
  std::vector<double> differences;
  for (const double h : {0.06, 0.03}) {
    const TriangleSoup soup = onSphere(h);
    const Circles circles = sign(soup).conformal->circles;
    double largest = 0;
    for (const unsigned seed : {1U, 2U, 3U}) {
      largest = std::max(
          largest, difference(sign(surfaces::renumbered(soup, seed)).conformal->circles, circles));
    }
    EXPECT_LT(largest, difference(circles, kThreeHoles));
    differences.push_back(largest);
  }
  RecordProperty("differences", testing::PrintToString(differences));
}

// Three holes in a row, all as near to the outer loop as one may be, and two that are each other's
// mirror image: each numbering has other ones a little nearer. Choices among them that followed it
// would exchange holes of different sizes.
TEST(CircleSignature, OfASymmetricSurfaceDoesNotDependOnNumbers) {
  for (const auto& parameters : std::vector<std::map<std::string, double>>{
           {{"holes", 3}, {"resolution", 4}},
           {{"holes", 2}, {"hole_step", 4}, {"resolution", 4}}}) {
    const TriangleSoup soup = surfaces::sample("plate", parameters);
    const Circles circles = sign(soup).conformal->circles;
    double largest = 0;
    for (const unsigned seed : {1U, 2U, 3U, 4U, 5U}) {
      largest = std::max(
          largest, difference(sign(surfaces::renumbered(soup, seed)).conformal->circles, circles));
    }
    RecordProperty("differences", std::to_string(largest));
    // Loops of 32 edges, and curves through them that lie within (pi / 32)^2 / 2 of their polygons.
    EXPECT_LT(largest, std::pow(std::numbers::pi / 32, 2) / 2 * circles[1].radius);
  }
}

TEST(CircleSignature, OfAMeshWithoutPositionsIsTheMeshs) {
  const TriangleSoup soup = onSphere(0.08);
  const Signature whole = sign(soup);
  const Signature without = sign(forgetPositions(surfaces::mesh(soup)));
  EXPECT_LT(difference(without.conformal->circles, whole.conformal->circles),
            difference(whole.conformal->circles, kThreeHoles));
}

// A mesh with thin triangles: another discrete conformal class without flips, of the same limit.
TEST(CircleSignature, StartsFromTheTriangulationThatWasAskedFor) {
  TriangleSoup soup = onSphere(0.08);
  const double error = difference(sign(soup).conformal->circles, kThreeHoles);
  for (Eigen::Vector3d& p : soup.vertices) p.x() *= 4;
  std::vector<Circles> circles;
  for (const bool initial_delaunay : {true, false}) {
    SignatureOptions options;
    options.space = Space::kConformal;
    options.initial_delaunay = initial_delaunay;
    Context context;
    const auto signature = computeSignature(context, prepare(soup), options);
    ASSERT_OK(signature);
    circles.push_back(signature->conformal->circles);
  }
  EXPECT_GT(difference(circles[0], circles[1]), 1e-6);
  // Triangles four times as long: errors of second order 16 times as large, of either sign.
  EXPECT_LT(difference(circles[0], circles[1]), 2 * 16 * error);
}

TEST(CircleSignature, IsTheSameBytesEveryTime) {
  const TriangleSoup soup = surfaces::sample("plate", {{"holes", 3}, {"resolution", 3}});
  const Circles circles = sign(soup).conformal->circles;
  ASSERT_EQ(circles.size(), 4U);
  EXPECT_EQ(difference(sign(soup).conformal->circles, circles), 0);
}

TEST(CircleSignature, OtherTypesHaveNoCircles) {
  for (const char* kind : {"sphere", "disk", "annulus", "torus", "genus"}) {
    const Signature signature = sign(surfaces::sample(kind, {{"resolution", 4}}));
    EXPECT_THAT(signature.conformal->circles, IsEmpty()) << kind;
    EXPECT_THAT(signature.certificate.warnings, Not(Contains(StartsWith("CIRCLES_OMITTED"))));
  }
}

/// A pair of pants with loops of one edge: a regular heptagon with the sides a x b x' y c y'.
MetricSurface smallestPants() {
  std::vector<std::array<Complex, 3>> triangles;
  const auto corner = [](int k) { return std::polar(1.0, 2 * std::numbers::pi * k / 7); };
  for (int k = 1; k < 6; ++k) triangles.push_back({corner(0), corner(k), corner(k + 1)});
  std::vector<std::pair<GluedSide, GluedSide>> gluing;
  for (Index k = 0; k < 4; ++k) gluing.push_back({{k, 2}, {k + 1, 0}});
  // Side k of the heptagon is side 1 of triangle k - 1, but the first and the last one.
  gluing.push_back({{0, 1}, {2, 1}});
  gluing.push_back({{3, 1}, {4, 2}});
  return glueTriangles(triangles, gluing);
}

TEST(CircleSignature, WithoutAMapToCirclesHasAllElseAndSaysWhy) {
  const Signature signature = sign(intrinsic(smallestPants()));
  EXPECT_EQ(signature.topology.boundary_loops, 3);
  EXPECT_EQ(signature.topology.genus, 0);
  ASSERT_TRUE(signature.conformal);
  EXPECT_EQ(signature.conformal->type, ConformalType::kCircleDomain);
  EXPECT_TRUE(signature.conformal->period_matrix);
  EXPECT_THAT(signature.conformal->circles, IsEmpty());
  EXPECT_THAT(signature.certificate.warnings, Contains(StartsWith("CIRCLES_OMITTED: ")));
  EXPECT_TRUE(signature.certificate.curvature_residual);
}

TEST(CircleSignature, PassesOnCancellationAndDeadlines) {
  const PreparedMesh prepared = prepare(onSphere(0.1));
  Context cancelled;
  CancelToken token;
  cancelled.setCancelToken(token);
  cancelled.setProgressSink([&](const Progress& progress) {
    if (progress.stage == "circles") token.cancel();
  });
  EXPECT_THAT(computeSignature(cancelled, prepared), FailsWith(Reason::kCancelled));
  // A deadline that is only there for the circles: what comes after them would not notice.
  Context late;
  late.setProgressSink([&](const Progress& progress) {
    const bool now = progress.stage == "circles";
    late.setDeadline(Context::Clock::now() + std::chrono::hours(now ? 0 : 1));
  });
  EXPECT_THAT(computeSignature(late, prepared), FailsWith(Reason::kDeadlineExceeded));
}

/// Coarse meshes of flat faces and sharp edges: the circles converge to those of the polyhedral
/// surface as its faces are cut, at corners of the loops with order 4 / 3 at least.
class CoarseCircles : public testing::TestWithParam<const char*> {};

TEST_P(CoarseCircles, ConvergeToThePolyhedralFluxes) {
  MODULI_NEED_SHARED_MESH(path, GetParam());
  const PreparedMesh prepared = prepare(surfaces::read(path));
  const MetricSurface coarse{prepared.mesh.connectivity(), prepared.mesh.edgeLengths()};
  std::vector<double> flux;
  for (const int n : {1, 4}) flux.push_back(fluxesOf(subdivide(coarse, n)).difference());
  RecordProperty("fluxes", testing::PrintToString(flux));
  EXPECT_LT(flux[1], std::pow(4, -4.0 / 3) * flux[0]);
}

INSTANTIATE_TEST_SUITE_P(Shared, CoarseCircles,
                         testing::Values("multi_boundary/gpeyre__pipes.off",
                                         "multi_boundary/libigl-data__halftunnel.off"));

// The bound of the periods is what finite elements on this mesh know.
TEST(RealCircles, OfABunnyWithHolesHaveItsFluxes) {
  MODULI_NEED_SHARED_MESH(path, "multi_boundary/cfwen__bunny.off");
  const PreparedMesh prepared = prepare(surfaces::read(path));
  Context context;
  const auto signature = computeSignature(context, prepared, {});
  ASSERT_OK(signature);
  const TriangleMesh& mesh = prepared.mesh;
  const double flux = fluxesOf(*signature, mesh.connectivity(), mesh.edgeLengths()).difference();
  RecordProperty("fluxes", std::to_string(flux));
  RecordProperty("bound", std::to_string(*signature->conformal->energy_spectrum_error));
  EXPECT_LT(flux, *signature->conformal->energy_spectrum_error);
}

// Loops of 12 edges: another start of the curve through them moves it by a fraction of what lies
// between it and their polygon, some (2 pi / 12)^2 / 8 of the radius.
TEST(RealCircles, OfAPlaneWith26HolesDoNotDependOnNumbers) {
  MODULI_NEED_SHARED_MESH(path, "multi_boundary/odedstein__plane_holes.obj");
  const TriangleSoup soup = surfaces::read(path);
  const Circles circles = sign(soup).conformal->circles;
  ASSERT_EQ(circles.size(), 27U);
  const double moved = difference(sign(surfaces::renumbered(soup, 1)).conformal->circles, circles);
  RecordProperty("renumbered", std::to_string(moved));
  EXPECT_LT(moved, 0.03 * circles[1].radius);
}

}  // namespace
}  // namespace moduli
