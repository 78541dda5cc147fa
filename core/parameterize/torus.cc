#include "core/parameterize/torus.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <optional>
#include <string>
#include <utility>

#include "core/base/text.h"
#include "core/intrinsic/mollify.h"
#include "core/parameterize/flat_faces.h"
#include "core/parameterize/genus_zero.h"
#include "core/parameterize/layout.h"
#include "core/parameterize/torus_lattice.h"
#include "core/ricci/uniformize.h"
#include "core/topology/cut_graph.h"
#include "core/topology/surface_topology.h"

namespace moduli {
namespace {

using Complex = std::complex<double>;

constexpr double kMaxHolonomy = 1e-7;
constexpr const char* kMap = "the map to the plane";

Status checkTopology(const SurfaceTopology& topology) {
  if (topology.components == 1 && topology.boundary_loops.empty() && topology.genus == 1) return {};
  std::string what = "genus " + std::to_string(topology.genus);
  if (topology.components > 1) what = std::to_string(topology.components) + " components";
  if (!topology.boundary_loops.empty()) what += " and a boundary";
  return {Reason::kUnsupportedTopology,
          "a fundamental parallelogram is that of a closed connected surface of genus 1, and this "
          "one has " +
              what,
          targetOf(topology)};
}

class TorusMapping {
 public:
  TorusMapping(Context& context, const Connectivity& surface, const std::vector<double>& lengths,
               const TorusOptions& options)
      : context_(context), surface_(surface), lengths_(lengths), options_(options) {}

  Result<Parameterization> run() {
    ASSIGN_OR_RETURN(FlatFaces faces, findFaces());
    const Context::Stage stage(context_, "layout");
    RETURN_IF_ERROR(context_.check());
    ASSIGN_OR_RETURN(TorusLattice lattice, latticeOfTorus(faces.surface, faces.charts));
    RETURN_IF_ERROR(layOutDomain(faces.surface, lattice));
    RETURN_IF_ERROR(judge(faces, lattice));
    result_.subdivision = std::move(faces.subdivision);
    return std::move(result_);
  }

 private:
  /// The faces in the flat metric: from either starting triangulation, or of the one asked for,
  /// cut. (The other one's metric may be far from the surface's where that has caps.)
  Result<FlatFaces> findFaces() {
    std::optional<Uniformization> folding;
    Index folded = 0;
    for (const bool initial_delaunay : {options_.initial_delaunay, !options_.initial_delaunay}) {
      ASSIGN_OR_RETURN(Uniformization found,
                       uniformize(context_, surface_, lengths_, {initial_delaunay}));
      FlatFaces faces = flatFaces(surface_, found.metric);
      if (faces.folded == 0) {
        certify(found.metric.certificate);
        return faces;
      }
      if (folding) break;
      folded = faces.folded;
      folding = std::move(found);
    }
    certify(folding->metric.certificate);
    if (!options_.refine) {
      return foldedMap(kMap, folded, surface_.faceCount(), "--refine auto cuts these faces");
    }
    ASSIGN_OR_RETURN(FlatFaces refined, refineFlatFaces(context_, surface_, folding->metric));
    if (refined.folded == 0) return refined;
    return foldedMap(kMap, refined.folded, refined.surface.faceCount(),
                     "its limbs are thinner than doubles tell apart");
  }

  void certify(const MetricCertificate& metric) {
    MapCertificate& certificate = result_.certificate;
    certificate.curvature_residual = metric.curvature_residual;
    certificate.gauss_bonnet_residual = metric.gauss_bonnet_residual;
    certificate.smallest_angle = metric.smallest_angle;
    certificate.newton_iterations = metric.newton_iterations;
    certificate.flips = metric.flips;
  }

  Status layOutDomain(const Connectivity& surface, TorusLattice& lattice) {
    TorusDomain& torus = result_.torus.emplace();
    torus.generators = lattice.generators;
    torus.tau = lattice.tau;
    torus.walks = shortCut(surface, lattice).walks;
    std::vector<bool> seam(surface.edgeCount(), false);
    Index base = 0;
    if (!torus.walks[0].empty()) {
      base = surface.tail(torus.walks[0].front());
      for (const auto& walk : torus.walks) {
        for (const Index h : walk) seam[surface.edge(h)] = true;
      }
    }
    std::optional<std::vector<LatticeVector>> lift;
    if (!torus.walks[0].empty()) lift = liftFaces(surface, lattice.shift, seam);
    torus.is_parallelogram = lift.has_value();
    if (!lift) {
      torus.walks = {};
      seam.assign(surface.edgeCount(), false);
      ASSIGN_OR_RETURN(const TreeCotree trees, computeTreeCotree(surface));
      for (const Index e : cutGraph(surface, trees)) seam[e] = true;
      lift = liftFaces(surface, lattice.shift, seam);
    }
    if (!lift) return {Reason::kInternal, "a cut torus is no disk"};
    placeFaces(surface, lattice, seam, *std::move(lift), base);
    return {};
  }

  /// The lowest image of `base` goes to 0.
  void placeFaces(const Connectivity& surface, TorusLattice& lattice, const std::vector<bool>& seam,
                  std::vector<LatticeVector> lift, Index base) {
    std::vector<LatticeVector> shift(surface.halfedgeCount());
    LatticeVector lowest{1 << 20, 1 << 20};
    for (Index h = 0; h < surface.halfedgeCount(); ++h) {
      shift[h] = h % 3 == 0 ? lift[h / 3] : shift[h - 1] + lattice.shift[h - 1];
      if (surface.tail(h) != base) continue;
      lowest = {std::min(lowest.m, shift[h].m), std::min(lowest.n, shift[h].n)};
    }
    const Complex origin = lattice.place[base];
    std::vector<Complex> placed(surface.halfedgeCount());
    for (Index h = 0; h < surface.halfedgeCount(); ++h) {
      placed[h] = (lattice.place[surface.tail(h)] - origin) + lattice.at(shift[h] - lowest);
    }
    PlanarLayout layout = sewCorners(surface, seam, placed);
    result_.points = std::move(layout.points);
    result_.corner = std::move(layout.corner);
  }

  Status judge(const FlatFaces& faces, const TorusLattice& lattice) {
    MapCertificate& certificate = result_.certificate;
    certificate.holonomy_residual = std::max(lattice.residual, lattice.area_residual);
    certificate.islands = 1;
    const std::vector<double> lengths =
        faces.subdivision ? subdividedLengths(surface_, lengths_, *faces.subdivision, faces.surface)
                          : lengths_;
    certificate.quality = measurePlaneMap(faces.surface, lengths, result_.points, result_.corner);
    if (certificate.quality.flipped_faces > 0) {
      return foldedMap(kMap, certificate.quality.flipped_faces, faces.surface.faceCount(),
                       "its limbs are thinner than doubles tell apart");
    }
    if (*certificate.holonomy_residual <= kMaxHolonomy) return {};
    return {Reason::kResidualTooLarge,
            "the flat torus fits its lattice up to " +
                shortestDouble(*certificate.holonomy_residual) +
                " of its size (allowed: " + shortestDouble(kMaxHolonomy) + ")",
            "remesh parts that are thin"};
  }

  Context& context_;
  const Connectivity& surface_;
  const std::vector<double>& lengths_;
  const TorusOptions& options_;
  Parameterization result_;
};

}  // namespace

Result<Parameterization> parameterizeTorus(Context& context, const Connectivity& surface,
                                           const std::vector<double>& lengths,
                                           const TorusOptions& options) {
  RETURN_IF_ERROR(checkTopology(computeTopology(surface)));
  ASSIGN_OR_RETURN(const MollifiedLengths mollified, mollify(surface, lengths));
  ASSIGN_OR_RETURN(Parameterization result,
                   TorusMapping(context, surface, mollified.lengths, options).run());
  result.certificate.mollification = mollified.relative_shift;
  return result;
}

std::vector<std::array<int, 2>> tilesOf(const TorusDomain& torus,
                                        const std::vector<Complex>& points, Complex lower,
                                        Complex upper) {
  const auto [a, b] = torus.generators;
  double left = points[0].real(), right = left, low = points[0].imag(), high = low;
  for (const Complex& point : points) {
    left = std::min(left, point.real());
    right = std::max(right, point.real());
    low = std::min(low, point.imag());
    high = std::max(high, point.imag());
  }
  const auto between = [](double from, double to) {
    return std::pair(static_cast<int>(std::ceil(from)), static_cast<int>(std::floor(to)));
  };
  const auto [first, last] =
      between((lower.imag() - high) / b.imag(), (upper.imag() - low) / b.imag());
  std::vector<std::array<int, 2>> tiles;
  for (int n = first; n <= last; ++n) {
    const auto [from, to] = between((lower.real() - right - n * b.real()) / a.real(),
                                    (upper.real() - left - n * b.real()) / a.real());
    for (int m = from; m <= to; ++m) tiles.push_back({m, n});
  }
  return tiles;
}

}  // namespace moduli
