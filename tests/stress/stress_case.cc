#include "tests/stress/stress_case.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>
#include <sstream>
#include <utility>

#include "core/intrinsic/geometry.h"
#include "core/intrinsic/intrinsic_triangulation.h"
#include "core/intrinsic/mollify.h"
#include "core/mesh/prepare.h"
#include "core/mesh/read.h"
#include "core/ricci/prescribe.h"
#include "core/ricci/punctured_sphere.h"

namespace moduli::stress {
namespace {

constexpr double kPi = std::numbers::pi;

class Maker {
 public:
  Maker(const Surface& surface, std::uint64_t seed) : random_(seed) {
    surface_.emplace(surface);
    text_ << surface.name << " seed " << seed;
  }

  Case make() {
    bool sound = true;
    if (chance(0.5)) insertNeedles();
    if (chance(0.5)) {
      flipAtRandom();
      sound = false;
    }
    if (chance(0.6)) {
      scaleVertices();
      sound = false;
    }
    const Index chi = surface_->connectivity.eulerCharacteristic();
    std::vector<double> target(surface_->connectivity.vertexCount(), 0.0);
    const bool cones = chance(0.5);
    if (cones) placeCones(chi, target);
    const bool hyperbolic = chi < 0;
    const bool punctured = chi > 0 && !cones;
    const bool delaunay = sound && chance(0.5);
    text_ << (delaunay ? ", isometric Delaunay first" : "");
    return {*std::move(surface_), std::move(target), hyperbolic, punctured, delaunay, text_.str()};
  }

 private:
  double uniform(double low, double high) {
    return low + (high - low) * std::uniform_real_distribution<double>()(random_);
  }
  bool chance(double p) { return uniform(0, 1) < p; }
  Index below(Index n) { return std::uniform_int_distribution<Index>(0, n - 1)(random_); }

  /// Splits faces at points next to a corner or an edge.
  void insertNeedles() {
    const Index count = 1 + below(20);
    double thinnest = 1;
    for (Index n = 0; n < count; ++n) {
      const double thin = std::pow(10, uniform(-6, -1));
      thinnest = std::min(thinnest, thin);
      const double along = uniform(0, 1);
      std::array<double, 3> weights = {1 - thin, thin * along, thin * (1 - along)};
      if (chance(0.5)) weights = {(1 - thin) * along, (1 - thin) * (1 - along), thin};
      std::rotate(weights.begin(), weights.begin() + below(3), weights.end());
      splitFace(below(surface_->connectivity.faceCount()), weights);
    }
    text_ << ", " << count << " needles down to " << thinnest;
  }

  void splitFace(Index f, const std::array<double, 3>& weights) {
    const Connectivity& old = surface_->connectivity;
    // Plane coordinates of the face and of the new vertex.
    TriangleValues sides;
    for (int c = 0; c < 3; ++c) sides[c] = surface_->lengths[old.edge(3 * f + c)];
    // Entry c of the angles is opposite side c, which runs from corner c on.
    const double angle = triangleAngles(Geometry::kEuclidean, sides)[1];
    const double x = sides[2] * std::cos(angle), y = sides[2] * std::sin(angle);
    const double px = weights[1] * sides[0] + weights[2] * x, py = weights[2] * y;
    const std::array<double, 3> spokes = {std::hypot(px, py), std::hypot(px - sides[0], py),
                                          std::hypot(px - x, py - y)};
    // Faces f, n, n + 1 keep the sides 0, 1, 2 of f as their first halfedges.
    const Index n = old.faceCount(), v = old.vertexCount();
    const std::array<Index, 3> parts = {f, n, n + 1};
    std::vector<Triangle> faces = old.faces();
    faces.resize(n + 2);
    std::vector<Index> twins(3 * (n + 2), kNone);
    std::vector<double> lengths(3 * (n + 2));
    const auto moved = [&](Index h) { return h / 3 == f ? 3 * parts[h % 3] : h; };
    for (Index h = 0; h < old.halfedgeCount(); ++h) {
      twins[moved(h)] = moved(old.twin(h));
      lengths[moved(h)] = surface_->lengths[old.edge(h)];
    }
    const Triangle corners = old.face(f);
    for (int c = 0; c < 3; ++c) {
      const int d = (c + 1) % 3;
      faces[parts[c]] = {corners[c], corners[d], v};
      const Index out = 3 * parts[c] + 1, back = 3 * parts[d] + 2;
      twins[out] = back;
      twins[back] = out;
      lengths[out] = lengths[back] = spokes[d];
    }
    rebuild(v + 1, std::move(faces), std::move(twins), lengths);
  }

  void rebuild(Index vertices, std::vector<Triangle> faces, std::vector<Index> twins,
               const std::vector<double>& by_halfedge) {
    Connectivity connectivity =
        *Connectivity::fromGluing(vertices, std::move(faces), std::move(twins));
    std::vector<double> lengths(connectivity.edgeCount());
    for (Index e = 0; e < connectivity.edgeCount(); ++e) {
      lengths[e] = by_halfedge[connectivity.halfedge(e)];
    }
    surface_.emplace(Surface{surface_->name, std::move(connectivity), std::move(lengths)});
  }

  void flipAtRandom() {
    IntrinsicTriangulation triangulation(surface_->connectivity, surface_->lengths);
    const Index wanted = 1 + below(triangulation.halfedgeCount() / 6);
    Index done = 0;
    for (Index n = 0; n < wanted; ++n) {
      const Index h = below(triangulation.halfedgeCount());
      if (!triangulation.canFlip(h)) continue;
      triangulation.flip(h, triangulation.ptolemyDiagonal(h));
      ++done;
    }
    surface_.emplace(
        Surface{surface_->name, triangulation.connectivity(), triangulation.edgeHalfChords()});
    text_ << ", " << done << " flips";
  }

  void scaleVertices() {
    const double range = uniform(0.1, 3);
    std::vector<double> u(surface_->connectivity.vertexCount());
    for (double& value : u) value = uniform(-range, range);
    for (Index e = 0; e < surface_->connectivity.edgeCount(); ++e) {
      const Index h = surface_->connectivity.halfedge(e);
      surface_->lengths[e] *=
          std::exp((u[surface_->connectivity.tail(h)] + u[surface_->connectivity.head(h)]) / 2);
    }
    text_ << ", scaled by e^+-" << range;
  }

  /// Angles of at least 0.3 everywhere; a flat sum of 2 pi chi, or a hyperbolic one above it.
  void placeCones(Index chi, std::vector<double>& target) {
    const Index least = chi > 0 ? 3 : chi == 0 ? 2 : 1;
    const Index count = least + below(6 - least);
    std::vector<Index> at;
    while (static_cast<Index>(at.size()) < count) {
      const Index v = below(static_cast<Index>(target.size()));
      if (std::find(at.begin(), at.end(), v) == at.end()) at.push_back(v);
    }
    const double highest = 2 * kPi - 0.3;
    for (;;) {
      double sum = 0;
      for (const Index v : at) {
        target[v] = uniform(-2 * kPi, highest);
        sum += target[v];
      }
      if (chi < 0 ? sum > 2 * kPi * chi + 0.3 : fits(sum - 2 * kPi * chi, at, highest, target))
        break;
    }
    text_ << ", " << count << " cones";
  }

  static bool fits(double excess, const std::vector<Index>& at, double highest,
                   std::vector<double>& target) {
    for (const Index v : at) {
      target[v] -= excess / static_cast<double>(at.size());
      if (target[v] > highest) return false;
    }
    return true;
  }

  std::mt19937_64 random_;
  std::optional<Surface> surface_;
  std::ostringstream text_;
};

}  // namespace

Result<Surface> readSurface(Context& context, const std::string& path) {
  ASSIGN_OR_RETURN(const TriangleSoup soup, readMeshFile(context, path));
  ASSIGN_OR_RETURN(const PreparedMesh prepared, prepareMesh(context, soup, {}));
  const Connectivity& surface = prepared.mesh.connectivity();
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    if (surface.isBoundaryVertex(v)) return Status{Reason::kNotClosed, path + " has a boundary"};
  }
  ASSIGN_OR_RETURN(MollifiedLengths mollified, mollify(surface, prepared.mesh.edgeLengths()));
  const std::string name = path.substr(path.rfind('/') + 1);
  return Surface{name, surface, std::move(mollified.lengths)};
}

Case makeCase(const Surface& surface, std::uint64_t seed) {
  return Maker(surface, seed).make();
}

Outcome solve(Context& context, const Case& problem) {
  const Surface& surface = problem.surface;
  if (problem.punctured) {
    PuncturedSphereOptions options;
    options.initial_delaunay = problem.initial_delaunay;
    const auto found =
        uniformizePuncturedSphere(context, surface.connectivity, surface.lengths, {}, options);
    if (!found.ok()) return {found.status()};
    const MetricCertificate& judged = found->metric.certificate;
    return {{}, judged.curvature_residual, judged.newton_iterations, judged.flips};
  }
  PrescribeOptions options;
  options.geometry = problem.hyperbolic ? Geometry::kHyperbolic : Geometry::kEuclidean;
  options.initial_delaunay = problem.initial_delaunay;
  const auto found =
      prescribeCurvature(context, surface.connectivity, surface.lengths, problem.target,
                         Unknowns::all(surface.connectivity.vertexCount()), options);
  if (!found.ok()) return {found.status()};
  return {{},
          found->certificate.curvature_residual,
          found->certificate.newton_iterations,
          found->certificate.flips};
}

}  // namespace moduli::stress
