#include "core/matching/capped_disk.h"

#include <array>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <utility>
#include <vector>

#include "core/forms/cotan.h"
#include "core/intrinsic/mollify.h"
#include "core/linalg/spd_solver.h"
#include "core/matching/unfold_sphere.h"
#include "core/spherical/disk_map.h"
#include "core/spherical/exact_sign.h"
#include "core/spherical/robust_disk.h"
#include "core/topology/surface_topology.h"

namespace moduli {
namespace {

Points3 onHemisphere(const std::vector<std::complex<double>>& points) {
  Points3 result;
  for (const std::complex<double>& w : points) result.push_back(diskToSphere(w));
  result.push_back(-Eigen::Vector3d::UnitZ());
  return result;
}

bool folds(const Connectivity& surface, const Points3& points) {
  for (const auto& [a, b, c] : surface.faces()) {
    if (spherical::orientationSign(points[a], points[b], points[c]) <= 0) return true;
  }
  return false;
}

/// The boundary around the circle by its lengths, and every vertex inside in the middle of its
/// neighbours. Folds nothing in the plane. Source: Tutte 1963.
Result<std::vector<std::complex<double>>> barycentricDisk(Context& context,
                                                          const Connectivity& surface,
                                                          const std::vector<double>& lengths) {
  std::vector<std::complex<double>> points(surface.vertexCount());
  const std::vector<Index> loop = computeTopology(surface).boundary_loops.front();
  double whole = 0, begun = 0;
  for (const Index h : loop) whole += lengths[surface.edge(h)];
  for (const Index h : loop) {
    points[surface.tail(h)] = std::polar(1.0, 2 * std::numbers::pi * begun / whole);
    begun += lengths[surface.edge(h)];
  }
  std::vector<Index> row(surface.vertexCount(), kNone);
  Index rows = 0;
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    if (!surface.isBoundaryVertex(v)) row[v] = rows++;
  }
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(rows, 2);
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    const Index h = surface.halfedge(e), v = surface.tail(h), w = surface.head(h);
    for (const auto& [at, other] : {std::pair(v, w), std::pair(w, v)}) {
      if (row[at] == kNone) continue;
      entries.emplace_back(row[at], row[at], 1);
      if (row[other] == kNone) {
        right.row(row[at]) += Eigen::RowVector2d(points[other].real(), points[other].imag());
      } else if (row[other] < row[at]) {
        entries.emplace_back(row[at], row[other], -1);
      }
    }
  }
  SparseMatrix matrix(rows, rows);
  matrix.setFromTriplets(entries.begin(), entries.end());
  ASSIGN_OR_RETURN(const SpdSolver solver, SpdSolver::make(context, matrix));
  ASSIGN_OR_RETURN(const Eigen::MatrixXd inside, solver.solve(context, right));
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    if (row[v] != kNone) points[v] = {inside(row[v], 0), inside(row[v], 1)};
  }
  return points;
}

}  // namespace

Result<TriangleMesh> cappedDisk(const TriangleMesh& disk) {
  const Connectivity& surface = disk.connectivity();
  TriangleSoup soup{disk.positions(), surface.faces()};
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    if (surface.twin(h) != kNone) continue;
    sum += disk.positions()[surface.tail(h)];
    soup.faces.push_back({surface.head(h), surface.tail(h), disk.vertexCount()});
  }
  const auto count = static_cast<double>(soup.faces.size() - surface.faces().size());
  soup.vertices.emplace_back(sum / count);
  return TriangleMesh::fromSoup(std::move(soup));
}

Result<Points3> unfoldHemisphere(Context& context, const TriangleMesh& capped, Points3 points) {
  const Connectivity& surface = capped.connectivity();
  const Index pole = capped.vertexCount() - 1;
  points[pole] = -Eigen::Vector3d::UnitZ();
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    if (surface.head(h) != pole) continue;
    Eigen::Vector3d& p = points[surface.tail(h)];
    p.z() = 0;
    p.normalize();
  }
  if (!folds(surface, points)) return points;
  return unfoldSphere(context, capped, std::move(points), pole);
}

Result<Points3> conformalHemisphere(Context& context, const TriangleMesh& disk,
                                    const TriangleMesh& capped, bool initial_delaunay) {
  const Connectivity& surface = disk.connectivity();
  ASSIGN_OR_RETURN(MollifiedLengths mollified, mollify(surface, disk.edgeLengths()));
  const std::vector<double> lengths = unitLengths(mollified.lengths);
  using Attempt = Result<std::vector<std::complex<double>>>;
  const auto robust = [&](bool delaunay) -> Attempt {
    ASSIGN_OR_RETURN(IdealDisk map,
                     mapToIdealDisk(context, surface, lengths, disk.positions(), delaunay));
    return std::move(map.points);
  };
  const auto linear = [&]() -> Attempt {
    ASSIGN_OR_RETURN(DiskMap map, mapToDiskLinear(context, surface, lengths));
    return std::move(map.points);
  };
  const std::array<std::function<Attempt()>, 4> ways = {
      [&] { return robust(initial_delaunay); }, [&] { return robust(!initial_delaunay); }, linear,
      [&] { return barycentricDisk(context, surface, lengths); }};
  Status last;
  for (const auto& way : ways) {
    const Attempt points = way();
    Result<Points3> unfolded =
        points.ok() ? unfoldHemisphere(context, capped, onHemisphere(*points)) : points.status();
    last = unfolded.status();
    const bool hopeless =
        last.reason() != Reason::kFoldedMap && last.reason() != Reason::kNoConvergence;
    if (unfolded.ok() || hopeless) return unfolded;
  }
  return last;
}

}  // namespace moduli
