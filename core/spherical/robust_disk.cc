#include "core/spherical/robust_disk.h"

#include <algorithm>
#include <utility>

#include "core/forms/cotan.h"
#include "core/ricci/mirror_symmetry.h"
#include "core/spherical/disk_centering.h"
#include "core/spherical/mobius_map.h"
#include "core/spherical/plane_lift.h"

namespace moduli {
namespace {

using Complex = std::complex<double>;

/// Turns a layout that is symmetric about some line until that is the real axis and the first copy
/// above it, up to rounding.
std::vector<Complex> standOnRealAxis(const DoubleCover& cover, Index infinity,
                                     std::vector<Complex> z) {
  Index first = kNone, last = kNone;
  for (Index v = 0; v < static_cast<Index>(z.size()); ++v) {
    if (cover.involution[v] != v || v == infinity) continue;
    if (first == kNone) first = v;
    if (last == kNone || std::abs(z[v] - z[first]) > std::abs(z[last] - z[first])) last = v;
  }
  const Complex origin = z[first];
  Complex turn = std::conj(z[last] - origin);
  turn /= std::abs(turn);
  double above = 0;
  for (Index h = 0; h < 3 * cover.face_count; ++h) {
    const Index v = cover.connectivity.tail(h);
    if (v != infinity) above += std::imag(turn * (z[v] - origin));
  }
  if (above < 0) turn = -turn;
  for (Complex& point : z) point = turn * (point - origin);
  return z;
}

/// The first copy, where each vertex stands in the middle of what it and its mirror image say.
std::vector<Complex> mirrored(const DoubleCover& cover, const std::vector<Complex>& z,
                              Index vertices) {
  std::vector<Complex> half(vertices);
  for (Index v = 0; v < vertices; ++v) half[v] = (z[v] + std::conj(z[cover.involution[v]])) / 2.0;
  return half;
}

/// Half of the weight on each side, and half above.
Complex middle(const std::vector<Complex>& z, const std::vector<double>& weights) {
  std::vector<std::pair<double, double>> values(z.size());
  const auto median = [&](const auto& value) {
    for (std::size_t v = 0; v < z.size(); ++v) values[v] = {value(z[v]), weights[v]};
    return weightedMedian(values);
  };
  const double x = median([](const Complex& w) { return w.real(); });
  // Hyperbolic distances from there up and down the line are logarithms of |z - x|.
  const double y = median([x](const Complex& w) { return std::abs(w - x); });
  return {x, y};
}

Points3 onBothHalves(const Connectivity& surface, const DoubleCover& cover,
                     const std::vector<Complex>& disk) {
  Points3 sphere(cover.involution.size());
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    Eigen::Vector3d point = diskToSphere(disk[v]);
    if (cover.involution[v] == v) {
      point.z() = 0;
    } else {
      sphere[cover.involution[v]] = {point.x(), point.y(), -point.z()};
    }
    sphere[v] = point;
  }
  return sphere;
}

}  // namespace

Eigen::Vector3d diskToSphere(const std::complex<double>& w) {
  const double r2 = std::norm(w);
  return Eigen::Vector3d(2 * w.real(), 2 * w.imag(), 1 - r2) / (1 + r2);
}

std::complex<double> sphereToDisk(const Eigen::Vector3d& point) {
  return std::complex<double>(point.x(), point.y()) / (1 + point.z());
}

Result<IdealDisk> mapToIdealDisk(Context& context, const Connectivity& surface,
                                 const std::vector<double>& lengths,
                                 const std::vector<Eigen::Vector3d>& positions,
                                 bool initial_delaunay, const IdealStart& start) {
  ASSIGN_OR_RETURN(DoubleCover cover, doubleCover(surface));
  std::vector<Eigen::Vector3d> doubled = positions;
  if (!positions.empty()) {
    doubled.resize(cover.involution.size());
    for (Index v = surface.vertexCount(); v < static_cast<Index>(doubled.size()); ++v) {
      doubled[v] = positions[cover.involution[v]];
    }
  }
  PuncturedSphereOptions options;
  options.initial_delaunay = initial_delaunay;
  options.unknowns = mirrorUnknowns(cover);
  options.infinity = start.infinity;
  options.start = start.u;
  ASSIGN_OR_RETURN(PuncturedSphereMetric metric,
                   uniformizePuncturedSphere(context, cover.connectivity,
                                             lengthsOnDouble(cover, lengths), doubled, options));
  const Context::Stage stage(context, "layout");
  const Index infinity = metric.infinity;
  const PuncturedLayout layout = layOutPunctured(metric);
  const std::vector<Complex> turned = standOnRealAxis(cover, infinity, layout.points);
  const std::vector<Complex> half = mirrored(cover, turned, surface.vertexCount());
  const std::vector<double> weights = vertexAreas(surface, lengths);
  std::vector<double> finite = weights;
  finite[infinity] = 0;
  const MobiusMap to_disk = halfPlaneToDisk(middle(half, finite));
  std::vector<Complex> disk(half.size());
  double deviation = 0;
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    disk[v] = v == infinity ? 1 : to_disk(half[v]);
    if (v == infinity || !surface.isBoundaryVertex(v)) continue;
    deviation = std::max(deviation, std::abs(std::abs(to_disk(turned[v])) - 1));
  }
  ASSIGN_OR_RETURN(DiskCentering centered, centerDisk(context, disk, weights));
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    if (surface.isBoundaryVertex(v)) centered.points[v] /= std::abs(centered.points[v]);
  }
  Points3 sphere = onBothHalves(surface, cover, centered.points);
  IdealPolyhedron polyhedron{std::move(sphere), std::move(metric), layout.closure,
                             centered.residual};
  return IdealDisk{std::move(centered.points), std::move(cover), std::move(polyhedron), deviation};
}

}  // namespace moduli
