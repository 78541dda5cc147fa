#include "core/matching/match_bordered.h"

#include <cmath>
#include <iostream>
#include <limits>
#include <map>
#include <utility>

#include "core/matching/map_report.h"
#include "core/mesh/double_cover.h"
#include "core/mesh/read.h"
#include "core/topology/surface_topology.h"
#include "tests/core/matching/bordered_samples.h"
#include "tests/core/matching/renumbered.h"

namespace moduli {
namespace {

using Eigen::Vector3d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

BorderedCorrespondence matched(const TriangleMesh& a, const TriangleMesh& b,
                               const std::vector<SurfacePoint>& points, double smoothing) {
  Context context;
  auto found = matchBordered(context, a, b, points, {smoothing});
  EXPECT_OK(found);
  return *std::move(found);
}

// The same surface, every face cut in four.
TriangleSoup cutInFour(const TriangleSoup& soup) {
  TriangleSoup result{soup.vertices, {}};
  std::map<std::pair<Index, Index>, Index> middles;
  const auto middle = [&](Index i, Index j) {
    const auto [found, is_new] =
        middles.try_emplace(std::minmax(i, j), static_cast<Index>(result.vertices.size()));
    if (is_new) result.vertices.push_back((soup.vertices[i] + soup.vertices[j]) / 2);
    return found->second;
  };
  for (const auto& [i, j, k] : soup.faces) {
    const Index a = middle(i, j), b = middle(j, k), c = middle(k, i);
    result.faces.insert(result.faces.end(), {{i, a, c}, {a, j, b}, {c, b, k}, {a, b, c}});
  }
  return result;
}

// Images of the boundary are on the boundary to the last bit, and nothing else is.
void expectBoundaryOnBoundary(const TriangleMesh& a, const TriangleMesh& b,
                              const BorderedCorrespondence& map) {
  const Connectivity& surface = b.connectivity();
  for (Index v = 0; v < a.vertexCount(); ++v) {
    const auto& [face, weights] = map.images[v];
    bool on = false;
    for (int c = 0; c < 3; ++c) {
      on = on || (surface.twin(3 * face + c) == kNone && weights[(c + 2) % 3] == 0);
      on = on || (surface.isBoundaryVertex(surface.face(face)[c]) && weights[c] == 1);
    }
    EXPECT_EQ(on, a.connectivity().isBoundaryVertex(v)) << v;
  }
}

// Of rings in the plane: no face is turned over there.
int foldedInPlane(const TriangleMesh& a, const TriangleMesh& b,
                  const std::vector<SurfacePoint>& images) {
  int folded = 0;
  for (const Triangle& face : a.connectivity().faces()) {
    const Vector3d p = spaceAt(b, images[face[0]]);
    folded += (spaceAt(b, images[face[1]]) - p).cross(spaceAt(b, images[face[2]]) - p)[2] <= 0;
  }
  return folded;
}

// The extremal map of rings stretches the logarithm of the radius and keeps angles: Teichmüller.
TEST(MatchBordered, StretchesTheLogarithmOfTheRadiusOfRings) {
  std::vector<double> errors;
  const double rate = std::log(3.0) / std::log(2.0);
  for (const int resolution : {6, 12, 24}) {
    const TriangleMesh a = meshOf(ring(resolution, 2, 0)), b = meshOf(ring(resolution + 2, 3, 0));
    std::vector<SurfacePoint> points;
    for (const Vector3d& p : a.positions()) {
      const Vector3d there = p.normalized() * std::pow(p.norm(), rate);
      Index nearest = 0;
      for (Index v = 0; v < b.vertexCount(); ++v) {
        if ((b.positions()[v] - there).norm() < (b.positions()[nearest] - there).norm())
          nearest = v;
      }
      points.push_back(vertexPoint(b.connectivity(), nearest));
    }
    const auto map = matched(a, b, points, kInfinity);
    expectBoundaryOnBoundary(a, b, map);
    EXPECT_EQ(foldedInPlane(a, b, map.images), 0);
    double worst = 0;
    for (Index v = 0; v < a.vertexCount(); ++v) {
      const double radius = spaceAt(b, map.images[v]).norm();
      worst =
          std::max(worst, std::abs(std::log(radius) - rate * std::log(a.positions()[v].norm())));
    }
    errors.push_back(worst);
    std::cout << "resolution " << resolution << ": log radius off by " << worst << "\n";
  }
  // Chords are off circles by h^2 / 8: second order.
  EXPECT_LT(errors[0], 0.02);
  EXPECT_GT(std::log2(errors[1] / errors[2]), 1.6);
}

// At a corner of the boundary of the angle t inside, the order is h^(2 pi / t): 4/3 for the plate,
// and above 1 for any. Coarse levels are given a quarter of room.
TEST(MatchBordered, OfASurfaceToItselfTendsToTheIdentity) {
  for (TriangleSoup soup : {bentPlate(2, 0), openTorus(8, 2)}) {
    double last = kInfinity;
    for (int level = 0; level < 3; ++level, soup = cutInFour(soup)) {
      const TriangleMesh mesh = chordFree(soup);
      const auto map = matched(mesh, mesh, vertexTargets(mesh, sameNumbers(mesh)), kInfinity);
      expectBoundaryOnBoundary(mesh, mesh, map);
      const double error = errorsOf(mesh, map.images, mesh.positions()).mean;
      const double back = errorsOf(mesh, map.inverse, mesh.positions()).mean;
      const double cycle = cycleError(mesh.connectivity(), mesh.positions(), map.images,
                                      mesh.connectivity(), map.inverse) /
                           std::sqrt(mesh.area());
      std::cout << mesh.vertexCount() << " vertices: mean error " << error << ", back " << back
                << ", there and back " << cycle << "\n";
      EXPECT_LT(error, 0.625 * last);
      EXPECT_LT(back, 2 * error);
      EXPECT_LT(cycle, error);
      last = error;
    }
  }
}

// A second way: the closed doubles, with the same targets in both copies.
TEST(MatchBordered, IsHalfOfTheMapOfTheDoubles) {
  Context context;
  const TriangleMesh mesh = chordFree(openTorus(12, 2));
  const Connectivity& surface = mesh.connectivity();
  const DoubleCover doubled = *doubleCover(surface);
  std::vector<double> lengths;
  const std::vector<double> own = mesh.edgeLengths();
  for (const Index e : doubled.edge) lengths.push_back(own[e]);
  const auto cover = straightCover(context, doubled.connectivity, lengths);
  ASSERT_OK(cover);
  std::vector<SurfacePoint> targets;
  for (Index v = 0; v < doubled.connectivity.vertexCount(); ++v) {
    targets.push_back(vertexPoint(doubled.connectivity, v));
  }
  const auto whole =
      matchHarmonically(context, doubled.connectivity, lengths, *cover, targets, {kInfinity});
  ASSERT_OK(whole);
  const auto half = matched(mesh, mesh, vertexTargets(mesh, sameNumbers(mesh)), kInfinity);
  double worst = 0;
  for (Index v = 0; v < mesh.vertexCount(); ++v) {
    SurfacePoint there = whole->map.images[v];
    if (there.face >= mesh.faceCount()) {
      there = {there.face - mesh.faceCount(),
               {there.barycentric[0], there.barycentric[2], there.barycentric[1]}};
    }
    worst = std::max(worst, (spaceAt(mesh, there) - spaceAt(mesh, half.images[v])).norm());
  }
  // Both stop when steps are 1e-7 of an edge.
  EXPECT_LT(worst, 1e-6);
}

TEST(MatchBordered, DoesNotDependOnNumberingPositionAndScale) {
  for (const auto& soup : {ring(8, 2, 3), bentPlate(3, 2), openTorus(12, 2)}) {
    const TriangleMesh a = chordFree(soup);
    const Renumbered other = renumbered(moved({a.positions(), a.connectivity().faces()}), 6);
    const TriangleMesh b = meshOf(other.soup);
    const auto own = matched(a, a, vertexTargets(a, sameNumbers(a)), 0.1);
    const auto there = matched(a, b, vertexTargets(b, other.image), 0.1);
    const TriangleSoup carried = moved({a.positions(), a.connectivity().faces()});
    double worst = 0;
    for (Index v = 0; v < a.vertexCount(); ++v) {
      Vector3d place = Vector3d::Zero();
      for (int c = 0; c < 3; ++c) {
        place += own.images[v].barycentric[c] *
                 carried.vertices[a.connectivity().face(own.images[v].face)[c]];
      }
      worst = std::max(worst, (spaceAt(b, there.images[v]) - place).norm());
    }
    EXPECT_LT(worst, 1e-5 * std::sqrt(b.area()));
  }
}

TEST(MatchBordered, StopsWhenItIsTold) {
  const TriangleMesh mesh = meshOf(ring(6, 2, 0));
  Context context;
  CancelToken token;
  token.cancel();
  context.setCancelToken(token);
  EXPECT_THAT(matchBordered(context, mesh, mesh, vertexTargets(mesh, sameNumbers(mesh))),
              FailsWith(Reason::kCancelled));
}

TEST(MatchBordered, KeepsRealSurfacesNearTheirTargets) {
  for (const char* name :
       {"multi_boundary/gpeyre__nefertiti-entire.off", "multi_boundary/libigl-data__halftunnel.off",
        "genus2/cfwen__eight.hole.off"}) {
    MODULI_NEED_SHARED_MESH(path, name);
    Context context;
    const TriangleMesh mesh = chordFree(*readMeshFile(context, path));
    const auto map = matched(mesh, mesh, vertexTargets(mesh, sameNumbers(mesh)), 0.06);
    expectBoundaryOnBoundary(mesh, mesh, map);
    const MapErrors errors = errorsOf(mesh, map.images, mesh.positions());
    std::cout << name << ": mean error " << errors.mean << ", largest " << errors.largest << "\n";
    EXPECT_LT(errors.mean, 0.002);
    EXPECT_LT(errors.largest, 0.02);
  }
}

}  // namespace
}  // namespace moduli
