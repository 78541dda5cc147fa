// Maps of surfaces of genus 0 as their users ask for them: sphere, disk, rectangle.

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>

#include "core/forms/quadrilateral.h"
#include "core/mesh/prepare.h"
#include "core/parameterize/disk.h"
#include "core/parameterize/rectangle.h"
#include "core/parameterize/sphere.h"
#include "core/spherical/rectangle_map.h"
#include "core/topology/surface_topology.h"
#include "tests/core/matching/ball_with_limbs.h"
#include "tests/core/spherical/surfaces.h"

namespace moduli {
namespace {

using Complex = std::complex<double>;

TriangleMesh prepared(const std::string& path) {
  Context context;
  auto result = prepareMesh(context, surfaces::read(path), {});
  EXPECT_OK(result);
  return std::move(result->mesh);
}

/// Splits every face near its first side: caps, whose middle vertices no map keeps where they are.
TriangleMesh withCaps(const TriangleMesh& mesh, double height) {
  TriangleSoup soup{mesh.positions(), {}};
  for (const Triangle& face : mesh.connectivity().faces()) {
    const auto apex = static_cast<Index>(soup.vertices.size());
    const double side = (1 - height) / 2;
    soup.vertices.push_back(side * soup.vertices[face[0]] + side * soup.vertices[face[1]] +
                            height * soup.vertices[face[2]]);
    for (int c = 0; c < 3; ++c) soup.faces.push_back({face[c], face[(c + 1) % 3], apex});
  }
  return surfaces::mesh(std::move(soup));
}

/// A rectangle of columns x rows cells, each cut along one diagonal.
TriangleMesh plate(Index columns, Index rows, double width, double height) {
  TriangleSoup soup;
  for (Index j = 0; j <= rows; ++j) {
    for (Index i = 0; i <= columns; ++i) {
      soup.vertices.emplace_back(width * i / columns, height * j / rows, 0);
    }
  }
  for (Index j = 0; j < rows; ++j) {
    for (Index i = 0; i < columns; ++i) {
      const Index a = j * (columns + 1) + i, b = a + 1, c = b + columns + 1, d = c - 1;
      soup.faces.push_back({a, b, c});
      soup.faces.push_back({a, c, d});
    }
  }
  return surfaces::mesh(std::move(soup));
}

/// The upper half of the unit sphere in `rings` rings, 6 j vertices in ring j.
TriangleMesh hemisphere(Index rings) {
  TriangleSoup soup;
  soup.vertices.emplace_back(0, 0, 1);
  for (Index j = 1; j <= rings; ++j) {
    for (Index i = 0; i < 6 * j; ++i) {
      const double polar = std::numbers::pi / 2 * j / rings;
      const double around = std::numbers::pi / 3 * i / j;
      soup.vertices.emplace_back(std::sin(polar) * std::cos(around),
                                 std::sin(polar) * std::sin(around), std::cos(polar));
    }
  }
  const auto at = [](Index ring, Index place) {
    return ring == 0 ? 0 : 1 + 3 * ring * (ring - 1) + place % (6 * ring);
  };
  for (Index j = 0; j < rings; ++j) {
    for (Index sector = 0; sector < 6; ++sector) {
      for (Index i = 0; i <= j; ++i) {
        const Index inner = sector * j + i, outer = sector * (j + 1) + i;
        soup.faces.push_back({at(j, inner), at(j + 1, outer), at(j + 1, outer + 1)});
        if (i < j) soup.faces.push_back({at(j, inner), at(j + 1, outer + 1), at(j, inner + 1)});
      }
    }
  }
  return surfaces::mesh(std::move(soup));
}

/// What every result promises.
void expectSound(const TriangleMesh& mesh, const Parameterization& result) {
  EXPECT_EQ(result.certificate.quality.flipped_faces, 0);
  EXPECT_GE(result.certificate.quality.mean_dilatation, 1);
  double shares = 0;
  for (const double share : result.certificate.quality.dilatation_histogram) shares += share;
  EXPECT_NEAR(shares, 1, 1e-12);
  if (!result.subdivision) {
    EXPECT_EQ(result.corner.size(), static_cast<std::size_t>(mesh.connectivity().halfedgeCount()));
    return;
  }
  // Faces that are whole stand where they stood; pieces follow each other.
  const Subdivision& subdivision = *result.subdivision;
  EXPECT_TRUE(std::is_sorted(subdivision.parent.begin(), subdivision.parent.end()));
  std::vector<int> pieces(mesh.faceCount(), 0);
  for (const Index parent : subdivision.parent) ++pieces[parent];
  for (std::size_t f = 0; f < subdivision.faces.size(); ++f) {
    const Index parent = subdivision.parent[f];
    if (pieces[parent] == 1) {
      EXPECT_EQ(subdivision.faces[f], mesh.connectivity().face(parent));
    }
  }
  EXPECT_OK(Connectivity::fromFaces(
      mesh.vertexCount() + static_cast<Index>(subdivision.vertices.size()), subdivision.faces));
}

Result<Parameterization> toSphere(const TriangleMesh& mesh, const SphereOptions& options = {}) {
  Context context;
  return parameterizeSphere(context, mesh.connectivity(), mesh.edgeLengths(), mesh.positions(),
                            options);
}

Result<Parameterization> toDisk(const TriangleMesh& mesh, const DiskOptions& options = {}) {
  Context context;
  return parameterizeDisk(context, mesh.connectivity(), mesh.edgeLengths(), mesh.positions(),
                          options);
}

TEST(ParameterizeSphere, CutsFacesThatHaveToFoldAndNoOthers) {
  const TriangleMesh mesh =
      withCaps(surfaces::mesh(surfaces::sample(
                   "spheroid", {{"a", 1}, {"c", 2.5}, {"resolution", 4}, {"seed", 3}})),
               0.002);
  SphereOptions options;
  options.refine = false;
  EXPECT_THAT(toSphere(mesh, options), FailsWith(Reason::kFoldedMap));
  const auto result = toSphere(mesh);
  ASSERT_OK(result);
  expectSound(mesh, *result);
  ASSERT_TRUE(result->subdivision);
  EXPECT_NEAR(result->certificate.quality.covering_degree, 1, 1e-12);
  for (const Eigen::Vector3d& point : result->sphere) EXPECT_NEAR(point.norm(), 1, 1e-14);
}

TEST(ParameterizeSphere, HasNoFoldsOnRealSurfaces) {
  for (const std::string& folder : {std::string("closed_g0"), std::string("brain")}) {
    const std::vector<std::string> paths = sharedMeshes(folder);
    if (paths.empty()) GTEST_SKIP() << "no meshes in " << folder << "; set MODULI_SHARED";
    for (const std::string& path : paths) {
      SCOPED_TRACE(path);
      const TriangleMesh mesh = prepared(path);
      if (mesh.connectivity().eulerCharacteristic() != 2) continue;
      const auto result = toSphere(mesh);
      ASSERT_OK(result);
      expectSound(mesh, *result);
      EXPECT_FALSE(result->subdivision);
    }
  }
}

TEST(ParameterizeSphere, MovesByAMobiusMapLast) {
  const TriangleMesh mesh = surfaces::mesh(surfaces::sample("sphere", {{"resolution", 6}}));
  const auto plain = toSphere(mesh);
  ASSERT_OK(plain);
  SphereOptions options;
  options.mobius = *makeMobiusMap(1, Complex(0.3, 0.1), Complex(0, 0.2), 1);
  const auto moved = toSphere(mesh, options);
  ASSERT_OK(moved);
  for (Index v = 0; v < mesh.vertexCount(); ++v) {
    EXPECT_LT((moved->sphere[v] - (*options.mobius)(plain->sphere[v])).norm(), 1e-14);
  }
  EXPECT_EQ(moved->certificate.quality.flipped_faces, 0);
}

TEST(ParameterizeSphere, NamesWhatOtherSurfacesNeed) {
  const auto disk = toSphere(plate(6, 5, 2, 1));
  EXPECT_THAT(disk, FailsWith(Reason::kUnsupportedTopology));
  EXPECT_THAT(disk.status().hint(), testing::HasSubstr("--to disk"));
  const auto torus = toSphere(surfaces::mesh(surfaces::sample("torus", {})));
  EXPECT_THAT(torus, FailsWith(Reason::kUnsupportedTopology));
  EXPECT_THAT(torus.status().hint(), testing::HasSubstr("--to flat"));
}

TEST(ParameterizeDisk, HasNoFoldsOnRealSurfaces) {
  for (const std::string& folder : {std::string("disk"), std::string("brain")}) {
    const std::vector<std::string> paths = sharedMeshes(folder);
    if (paths.empty()) GTEST_SKIP() << "no meshes in " << folder << "; set MODULI_SHARED";
    for (const std::string& path : paths) {
      SCOPED_TRACE(path);
      const TriangleMesh mesh = prepared(path);
      if (mesh.connectivity().eulerCharacteristic() != 1) continue;
      const auto result = toDisk(mesh);
      ASSERT_OK(result);
      expectSound(mesh, *result);
      // At most 5% more faces.
      if (result->subdivision) {
        EXPECT_LE(result->subdivision->faces.size(), 1.05 * mesh.faceCount());
      }
      EXPECT_LT(*result->certificate.boundary_deviation, 1e-8);
      for (Index v = 0; v < mesh.vertexCount(); ++v) {
        const double radius = std::abs(result->points[v]);
        if (mesh.connectivity().isBoundaryVertex(v)) {
          EXPECT_NEAR(radius, 1, 1e-14);
        } else {
          EXPECT_LT(radius, 1);
        }
      }
    }
  }
}

TEST(ParameterizeDisk, OfAHemisphereIsStereographicProjection) {
  // Exactly tan(theta / 2), up to a rotation: CHECKS B6.
  const auto error = [](Index rings, MapMethod method) {
    const TriangleMesh mesh = hemisphere(rings);
    DiskOptions options;
    options.method = method;
    const auto result = toDisk(mesh, options);
    EXPECT_OK(result);
    Complex turn = 0;
    std::vector<Complex> exact;
    for (const Eigen::Vector3d& p : mesh.positions()) {
      exact.push_back(Complex(p.x(), p.y()) / (1 + p.z()));
      turn += exact.back() * std::conj(result->points[exact.size() - 1]);
    }
    turn /= std::abs(turn);
    double sum = 0;
    for (std::size_t v = 0; v < exact.size(); ++v) {
      sum += std::norm(turn * result->points[v] - exact[v]);
    }
    return std::sqrt(sum / static_cast<double>(exact.size()));
  };
  // Vertices on a sphere are a Möbius map away from the plane: vertex scaling finds it exactly.
  EXPECT_LT(error(16, MapMethod::kRobust), 1e-11);
  for (const MapMethod method : {MapMethod::kLinear, MapMethod::kHeatFlow}) {
    const double coarse = error(8, method), fine = error(16, method);
    EXPECT_NEAR(std::log2(coarse / fine), 2, 0.3)
        << methodName(method) << ": " << coarse << ", " << fine;
  }
}

TEST(ParameterizeDisk, AutomorphismsKeepTheCircle) {
  const TriangleMesh mesh = plate(6, 5, 2, 1);
  DiskOptions options;
  options.mobius = diskAutomorphism(Complex(0.4, -0.2), 0.7);
  const auto result = toDisk(mesh, options);
  ASSERT_OK(result);
  for (Index v = 0; v < mesh.vertexCount(); ++v) {
    if (mesh.connectivity().isBoundaryVertex(v)) {
      EXPECT_NEAR(std::abs(result->points[v]), 1, 1e-14);
    }
  }
  options.mobius = *makeMobiusMap(2, 0, 0, 1);
  EXPECT_THAT(toDisk(mesh, options), FailsWith(Reason::kInvalidOption));
}

std::array<Index, 4> quarters(const Connectivity& surface) {
  const SurfaceTopology topology = computeTopology(surface);
  const std::vector<Index>& loop = topology.boundary_loops[0];
  std::array<Index, 4> corners;
  for (std::size_t n = 0; n < 4; ++n) corners[n] = surface.tail(loop[n * loop.size() / 4]);
  return corners;
}

TEST(ParameterizeRectangle, LeavesAFlatRectangleAsItIs) {
  const Index columns = 7, rows = 4;
  const double width = 2.5, height = 1.3;
  const TriangleMesh mesh = plate(columns, rows, width, height);
  const Index last = mesh.vertexCount() - 1;
  Context context;
  RectangleOptions options;
  options.corners = {0, columns, last, last - columns};
  const auto result = parameterizeRectangle(context, mesh.connectivity(), mesh.edgeLengths(),
                                            mesh.positions(), options);
  ASSERT_OK(result);
  EXPECT_NEAR(*result->modulus, width / height, 1e-12);
  for (Index v = 0; v < mesh.vertexCount(); ++v) {
    const Eigen::Vector3d& p = mesh.positions()[v];
    EXPECT_LT(std::abs(result->points[v] * height - Complex(p.x(), p.y())), 1e-11);
  }
  options.corners = {0, last, columns, last - columns};
  EXPECT_THAT(parameterizeRectangle(context, mesh.connectivity(), mesh.edgeLengths(),
                                    mesh.positions(), options),
              FailsWith(Reason::kInvalidOption));
  options.corners = {0, columns, last, columns + 2};
  EXPECT_THAT(parameterizeRectangle(context, mesh.connectivity(), mesh.edgeLengths(),
                                    mesh.positions(), options),
              FailsWith(Reason::kInvalidOption));
}

TEST(ParameterizeRectangle, ModulusLiesBetweenTheEnergiesOnRealSurfaces) {
  const std::vector<std::string> paths = sharedMeshes("disk");
  if (paths.empty()) GTEST_SKIP() << "no meshes; set MODULI_SHARED";
  for (const std::string& path : paths) {
    SCOPED_TRACE(path);
    const TriangleMesh mesh = prepared(path);
    Context context;
    RectangleOptions options;
    options.corners = quarters(mesh.connectivity());
    const auto result = parameterizeRectangle(context, mesh.connectivity(), mesh.edgeLengths(),
                                              mesh.positions(), options);
    ASSERT_OK(result);
    expectSound(mesh, *result);
    const auto bounds =
        quadrilateralModulus(context, mesh.connectivity(), mesh.edgeLengths(), options.corners);
    ASSERT_OK(bounds);
    // Another discretization: bounds of the polyhedron's modulus, widened by their own distance.
    const double slack = bounds->upper - bounds->lower;
    EXPECT_GT(*result->modulus, bounds->lower - slack);
    EXPECT_LT(*result->modulus, bounds->upper + slack);
    for (Index v = 0; v < mesh.vertexCount(); ++v) {
      if (!mesh.connectivity().isBoundaryVertex(v)) continue;
      // On a side, exactly.
      const Complex w = result->points[v];
      EXPECT_TRUE(w.real() == 0 || w.real() == *result->modulus || w.imag() == 0 || w.imag() == 1);
    }
  }
}

TEST(RectangleMap, IsTheSchwarzChristoffelMap) {
  for (const double skew : {0.0, 0.3, -0.9}) {
    std::array<Complex, 4> corners;
    for (int c = 0; c < 4; ++c) {
      corners[c] = std::polar(1.0, 0.1 + c * std::numbers::pi / 2 + (c % 2 == 1 ? skew : 0));
    }
    const auto map = RectangleMap::make(corners);
    ASSERT_OK(map);
    EXPECT_EQ((*map)(corners[2], true), Complex(map->modulus(), 1));
    for (int n = 0; n < 100; ++n) {
      const Complex w = std::polar(0.97 * std::sqrt((n + 0.5) / 100), 2.4 * n);
      const Complex image = (*map)(w, false);
      EXPECT_TRUE(image.real() > 0 && image.real() < map->modulus());
      EXPECT_TRUE(image.imag() > 0 && image.imag() < 1);
      // Cauchy and Riemann, by central differences of error h^2 and rounding 1e-16 / h.
      const double h = 1e-5;
      const Complex dx = ((*map)(w + h, false) - (*map)(w - h, false)) / (2 * h);
      const Complex dy =
          ((*map)(w + Complex(0, h), false) - (*map)(w - Complex(0, h), false)) / (2 * h);
      EXPECT_LT(std::abs(dy - Complex(0, 1) * dx), 1e-6 * std::abs(dx));
    }
  }
  // By symmetry a square.
  const auto square = RectangleMap::make({Complex(1), Complex(0, 1), Complex(-1), Complex(0, -1)});
  ASSERT_OK(square);
  EXPECT_NEAR(square->modulus(), 1, 1e-14);
  EXPECT_LT(std::abs((*square)(0, false) - Complex(0.5, 0.5)), 1e-14);
  EXPECT_THAT(RectangleMap::make({Complex(1), Complex(-1), Complex(0, 1), Complex(0, -1)}),
              FailsWith(Reason::kInvalidOption));
}

TEST(CarlsonRf, HasItsPublishedValues) {
  // Carlson 1995, section 3.
  EXPECT_NEAR(std::abs(carlsonRf(1, 2, 0) - 1.3110287771461), 0, 1e-12);
  EXPECT_NEAR(std::abs(carlsonRf(2, 3, 4) - 0.58408284167715), 0, 1e-13);
  EXPECT_NEAR(std::abs(carlsonRf(Complex(0, 1), Complex(0, -1), 0) - 1.8540746773014), 0, 1e-12);
  EXPECT_NEAR(std::abs(carlsonRf(Complex(-1, 1), Complex(0, 1), 0) -
                       Complex(0.79612586584234, -1.2138566698365)),
              0, 1e-12);
}

TEST(GenusZero, LimbsThatDoublesCannotTellApartAreLaidOutWithoutFolds) {
  Context context;
  // Twenty times as long as thick: conformal scales of e^-63 at their ends.
  const TriangleMesh mesh = ballWithLimbs(6, 20);
  SphereOptions strict;
  strict.method = MapMethod::kRobust;
  const auto folded = parameterizeSphere(context, mesh.connectivity(), mesh.edgeLengths(),
                                         mesh.positions(), strict);
  EXPECT_EQ(folded.status().reason(), Reason::kFoldedMap);
  const auto map =
      parameterizeSphere(context, mesh.connectivity(), mesh.edgeLengths(), mesh.positions(), {});
  ASSERT_OK(map);
  EXPECT_EQ(map->certificate.quality.flipped_faces, 0);
  EXPECT_THAT(map->certificate.warnings, testing::ElementsAre(testing::HasSubstr("UNFOLDED")));
}

}  // namespace
}  // namespace moduli
