// Closed geodesics of polyhedra that come ever nearer to a surface: their lengths become those of
// the smooth surface (CHECKS G8).

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numeric>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "core/hyperbolic/dirichlet_domain.h"
#include "core/hyperbolic/fuchsian_group.h"
#include "core/hyperbolic/length_spectrum.h"
#include "core/intrinsic/mollify.h"
#include "core/mesh/samples.h"
#include "core/ricci/uniformize.h"
#include "tests/core/forms/surfaces.h"
#include "tests/core/hyperbolic/groups.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

/// Every triangle cut into four, by points that divide the edges at random as 1 - r : 1 + r, |r| <
/// `spread`: the same hyperbolic surface.
IntrinsicSurface cutInFour(const IntrinsicSurface& coarse, double spread, std::mt19937& random) {
  const Connectivity& surface = coarse.connectivity;
  std::vector<double> fraction(surface.halfedgeCount());
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    const Index h = surface.halfedge(e);
    fraction[h] = 0.5 + spread * (uniform(random) - 0.5);
    fraction[surface.twin(h)] = 1 - fraction[h];
  }
  SurfaceTables tables;
  tables.geometry = coarse.geometry;
  tables.vertex_count = surface.vertexCount() + surface.edgeCount();
  tables.twin.emplace();
  const auto middle = [&](Index h) { return surface.vertexCount() + surface.edge(h); };
  // Child c of a face is at its corner c, with its first side along side c; child 3 is the middle.
  const auto behind = [&](Index h, bool first_half) {
    const Index t = surface.twin(h);
    const Index f = Connectivity::faceOf(t);
    return first_half ? 3 * (4 * f + (t + 1) % 3) + 2 : 3 * (4 * f + t % 3);
  };
  for (Index f = 0; f < surface.faceCount(); ++f) {
    const TriangleValues sides = coarse.sides(f);
    const TriangleValues opposite = triangleAngles(coarse.geometry, {sides[1], sides[2], sides[0]});
    TriangleValues across{};
    for (Index c = 0; c < 3; ++c) {
      const Index h = 3 * f + c, before = 3 * f + (c + 2) % 3;
      const double x = fraction[h] * sides[c], y = (1 - fraction[before]) * sides[(c + 2) % 3];
      // The cosine law in half chords.
      const double half =
          std::hypot(std::sinh((x - y) / 2),
                     std::sin(opposite[c] / 2) * std::sqrt(std::sinh(x) * std::sinh(y)));
      across[c] = 2 * std::asinh(half);
      tables.faces.push_back({surface.tail(h), middle(h), middle(before)});
      tables.twin->insert(tables.twin->end(),
                          {behind(h, true), 3 * (4 * f + 3) + (c + 2) % 3, behind(before, false)});
      tables.lengths.insert(tables.lengths.end(), {x, across[c], y});
    }
    tables.faces.push_back({middle(3 * f), middle(3 * f + 1), middle(3 * f + 2)});
    for (Index c = 0; c < 3; ++c) {
      tables.twin->push_back(3 * (4 * f + (c + 1) % 3) + 1);
      tables.lengths.push_back(across[(c + 1) % 3]);
    }
  }
  Context context;
  auto fine = assembleSurface(context, std::move(tables));
  EXPECT_OK(fine);
  return *std::move(fine);
}

/// Irregular first, so that no symmetry makes up for what the triangles are not; then regularly, so
/// that errors have an expansion in their size.
IntrinsicSurface refined(IntrinsicSurface surface, int levels, unsigned seed) {
  std::mt19937 random(seed);
  surface = cutInFour(surface, 0.4, random);
  for (int k = 0; k < levels; ++k) surface = cutInFour(surface, 0, random);
  return surface;
}

/// The lengths up to `length` of the surface in whose discrete conformal class the flat triangles
/// with these sides are.
std::vector<double> shortLengths(const Connectivity& surface, const std::vector<double>& sides,
                                 double length) {
  Context context;
  const auto found = uniformize(context, surface, sides);
  EXPECT_OK(found);
  if (!found.ok()) return {};
  const auto triangles = hyperbolicTriangles(found->metric);
  EXPECT_OK(triangles);
  if (!triangles.ok()) return {};
  const auto group = computeFuchsianGroup(context, *triangles);
  EXPECT_OK(group);
  if (!group.ok()) return {};
  const auto polygon = orbitPolygon(context, *group);
  EXPECT_OK(polygon);
  if (!polygon.ok()) return {};
  const auto spectrum = lengthSpectrum(context, *polygon, length);
  EXPECT_OK(spectrum);
  std::vector<double> lengths;
  if (!spectrum.ok()) return lengths;
  for (const ClosedGeodesic& geodesic : spectrum->geodesics) lengths.push_back(geodesic.length);
  return lengths;
}

double largestDifference(const std::vector<double>& a, const std::vector<double>& b) {
  EXPECT_EQ(a.size(), b.size());
  double worst = 0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    worst = std::max(worst, std::abs(a[i] - b[i]));
  return worst;
}

/// Errors at successive halvings of the triangles: the discrete metrics converge to the smooth one
/// at first order at least (Gu, Luo and Wu 2019; Wu and Zhu 2020), and so do the lengths, which are
/// smooth functions on Teichmueller space. Where errors have an expansion, at second order.
void expectConvergence(const std::vector<double>& errors) {
  for (std::size_t k = 1; k < errors.size(); ++k) {
    const double order = std::log2(errors[k - 1] / errors[k]);
    std::cout << "  error " << errors[k] << ", order " << order << "\n";
    // The coarsest are not yet where the order shows.
    if (k + 2 >= errors.size()) {
      EXPECT_GE(order, 1);
    }
  }
  EXPECT_LT(errors.back(), 0.02);
}

constexpr int kLevels = 5;

struct Known {
  const char* name;
  IntrinsicSurface surface;
  double length;
  std::vector<double> lengths;  ///< All up to that.
};

std::vector<Known> knownSurfaces() {
  const double root = std::sqrt(2.0);
  std::vector<double> bolza(24, 2 * std::acosh(1 + root));
  std::fill(bolza.begin() + 12, bolza.end(), 2 * std::acosh(3 + 2 * root));
  Context context;
  const auto polygon = orbitPolygon(context, polygonGroup(2), 2);
  EXPECT_OK(polygon);
  const auto spectrum = lengthSpectrum(context, *polygon, 4.1);
  EXPECT_OK(spectrum);
  std::vector<double> octagon;
  for (const ClosedGeodesic& geodesic : spectrum->geodesics) octagon.push_back(geodesic.length);
  return {{"bolza", *makeIntrinsicSample("bolza"), 5.3, bolza},
          {"octagon", polygonSurface(2), 4.1, octagon}};
}

TEST(Refinement, FlatTrianglesWithHyperbolicSidesComeToTheLengthsOfTheSurface) {
  for (const Known& known : knownSurfaces()) {
    std::cout << known.name << ":";
    for (const double length : known.lengths) std::cout << " " << length;
    std::cout << "\n";
    std::vector<double> errors;
    for (int level = 0; level < kLevels; ++level) {
      const IntrinsicSurface fine = refined(known.surface, level, 1);
      const std::vector<double> lengths =
          shortLengths(fine.connectivity, fine.lengths, known.length);
      errors.push_back(largestDifference(lengths, known.lengths));
    }
    std::cout << "  error " << errors[0] << "\n";
    expectConvergence(errors);
  }
}

TEST(Refinement, OtherTriangulationsComeToTheSameLengths) {
  const Known known = knownSurfaces()[1];
  std::vector<double> differences;
  for (int level = 0; level < kLevels; ++level) {
    std::vector<std::vector<double>> found;
    for (const unsigned seed : {11, 12}) {
      const IntrinsicSurface fine = refined(known.surface, level, seed);
      found.push_back(shortLengths(fine.connectivity, fine.lengths, known.length));
    }
    differences.push_back(largestDifference(found[0], found[1]));
  }
  std::cout << "  difference " << differences[0] << "\n";
  expectConvergence(differences);
}

/// A surface in space: what the next finer mesh changes.
TEST(Refinement, FinerMeshesOfASmoothSurfaceHaveConvergingLengths) {
  std::vector<double> last, differences;
  for (const double resolution : {2, 4, 8, 16}) {
    const auto soup = makeSample("genus", {{"genus", 2}, {"resolution", resolution}, {"seed", 1}});
    ASSERT_OK(soup);
    const MetricSurface surface = fromPositions(soup->vertices, soup->faces);
    const auto mollified = mollify(surface.surface, surface.lengths);
    ASSERT_OK(mollified);
    const std::vector<double> lengths = shortLengths(surface.surface, mollified->lengths, 4);
    std::cout << surface.surface.faceCount() << " faces:";
    for (const double length : lengths) std::cout << " " << length;
    std::cout << "\n";
    if (!last.empty()) differences.push_back(largestDifference(lengths, last));
    last = lengths;
  }
  expectConvergence(differences);
}

}  // namespace
}  // namespace moduli
