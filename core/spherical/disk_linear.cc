#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "core/forms/cotan.h"
#include "core/spherical/disk_finish.h"
#include "core/spherical/disk_map.h"
#include "core/spherical/face_frame.h"
#include "core/spherical/mirror_laplacian.h"
#include "core/spherical/mobius_map.h"
#include "core/spherical/plane_lift.h"

namespace moduli {
namespace {

using spherical::MirrorLaplacian;
using spherical::MirrorSystem;
using spherical::Parity;
using Complex = std::complex<double>;
using PlanePoints = std::vector<Complex>;

/// Each chart reaches past its half of the disk, and six relaxations are enough, as on the sphere:
/// what the held vertices have wrong comes back as at most 0.2 of itself.
constexpr double kReach = 1.5;
constexpr int kRelaxations = 6;

std::vector<double> part(const PlanePoints& z, double (*take)(const Complex&)) {
  std::vector<double> values(z.size());
  std::transform(z.begin(), z.end(), values.begin(), take);
  return values;
}
double realPart(const Complex& z) {
  return z.real();
}
double imaginaryPart(const Complex& z) {
  return z.imag();
}

PlanePoints joined(const std::vector<double>& u, const std::vector<double>& v) {
  PlanePoints z(u.size());
  for (std::size_t i = 0; i < z.size(); ++i) z[i] = {u[i], v[i]};
  return z;
}

/// Stretches the half plane so that the faces are conformal in the mean. The mirror image brings
/// the same metrics mirrored, so that the mean is diagonal (compare the sphere's linear map).
void removeMeanDilatation(const Connectivity& surface, const std::vector<FaceFrame>& frames,
                          PlanePoints& z) {
  double along = 0, across = 0;
  for (Index f = 0; f < surface.faceCount(); ++f) {
    const auto& [a, b, c] = surface.face(f);
    const FaceFrame& frame = frames[f];
    const Complex x = (z[b] - z[a]) / frame.base;
    const Complex y = ((z[c] - z[a]) - frame.x * x) / frame.y;
    const double determinant = std::abs((std::conj(x) * y).imag());
    const double uu = (x.imag() * x.imag() + y.imag() * y.imag()) / determinant;
    const double vv = (x.real() * x.real() + y.real() * y.real()) / determinant;
    if (!std::isfinite(uu) || !std::isfinite(vv)) continue;
    along += frame.area() * uu;
    across += frame.area() * vv;
  }
  if (!(along > 0) || !(across > 0)) return;
  const double stretch = std::sqrt(std::sqrt(along / across));
  for (Complex& w : z) w = {w.real() * stretch, w.imag() / stretch};
}

/// From the half plane to the disk, with half of the area on each side of two geodesics through 0.
MobiusMap balancedCayley(const PlanePoints& z, const std::vector<double>& areas) {
  const auto median = [&](const auto& value) {
    std::vector<std::pair<double, double>> values(z.size());
    for (std::size_t i = 0; i < z.size(); ++i) values[i] = {value(z[i]), areas[i]};
    return weightedMedian(std::move(values));
  };
  const double middle = median(realPart);
  return halfPlaneToDisk({middle, median([&](const Complex& w) { return std::abs(w - middle); })});
}

/// From the disk to the half plane around a point of the circle, which goes to 0; its opposite goes
/// to infinity, and the geodesic between them to |z| = 1.
MobiusMap halfPlaneAround(const Complex& pole) {
  const Complex i(0, 1);
  // The determinant of (-i, i pole; 1, pole) is -2 i pole.
  const Complex scale = 1.0 / std::sqrt(-2.0 * i * pole);
  return {-i * scale, i * pole * scale, scale, pole * scale};
}

/// A half plane around a point of the circle, in which the vertices near to it move.
struct HalfChart {
  MobiusMap map, back;
  MirrorSystem even, odd;

  Result<PlanePoints> relax(Context& context, PlanePoints points) const {
    for (Complex& w : points) w = map(w);
    ASSIGN_OR_RETURN(const std::vector<double> u, even.solve(context, part(points, realPart)));
    ASSIGN_OR_RETURN(const std::vector<double> v, odd.solve(context, part(points, imaginaryPart)));
    points = joined(u, v);
    for (Complex& w : points) w = back(w);
    return points;
  }
};

class LinearDiskMap {
 public:
  LinearDiskMap(const Connectivity& surface, const std::vector<double>& lengths)
      : surface_(surface), lengths_(unitLengths(lengths)), areas_(vertexAreas(surface, lengths_)) {
    const std::vector<double> face_areas = faceAreas(surface, lengths_);
    for (Index f = 0; f < surface.faceCount(); ++f) {
      frames_.push_back(frameFromSides(lengths_[surface.edge(3 * f)],
                                       lengths_[surface.edge(3 * f + 1)],
                                       lengths_[surface.edge(3 * f + 2)], face_areas[f]));
    }
  }

  Result<DiskMap> compute(Context& context) {
    ASSIGN_OR_RETURN(const MirrorLaplacian laplacian,
                     MirrorLaplacian::make(context, surface_, lengths_));
    ASSIGN_OR_RETURN(PlanePoints points, startFromDipole(context, laplacian));
    RETURN_IF_ERROR(relaxCharts(context, laplacian, std::move(points)));
    best_->flips = laplacian.flips();
    return std::move(*best_);
  }

 private:
  /// Twice with one pair of factorizations: the first map shows where the pole belongs.
  Result<PlanePoints> startFromDipole(Context& context, const MirrorLaplacian& laplacian) {
    std::vector<bool> moves(surface_.vertexCount(), true);
    moves[0] = false;
    ASSIGN_OR_RETURN(const MirrorSystem even,
                     MirrorSystem::make(context, laplacian, Parity::kEven, moves));
    for (Index v = 0; v < surface_.vertexCount(); ++v) moves[v] = !surface_.isBoundaryVertex(v);
    ASSIGN_OR_RETURN(const MirrorSystem odd,
                     MirrorSystem::make(context, laplacian, Parity::kOdd, moves));
    const Index first = bestBoundary(
        [&](Index h) { return frames_[h / 3].quality() * lengths_[surface_.edge(h)]; });
    ASSIGN_OR_RETURN(const DiskMap map, mapWithPole(context, even, odd, first));
    const Index central = bestBoundary([&](Index h) {
      const double image = std::abs(map.points[surface_.head(h)] - map.points[surface_.tail(h)]);
      return image / lengths_[surface_.edge(h)] * frames_[h / 3].quality();
    });
    ASSIGN_OR_RETURN(DiskMap better, mapWithPole(context, even, odd, central));
    const Complex pole =
        better.points[surface_.tail(central)] + better.points[surface_.head(central)];
    pole_ = std::abs(pole) > 0 ? pole / std::abs(pole) : better.points[surface_.tail(central)];
    PlanePoints points = better.points;
    ASSIGN_OR_RETURN(
        best_, spherical::withTipsReset(context, surface_, lengths_, areas_, std::move(better)));
    return points;
  }

  /// The boundary halfedge with the highest score; the lowest among equals.
  template <typename Score>
  Index bestBoundary(const Score& score) const {
    Index best = kNone;
    double highest = -1;
    for (Index e = 0; e < surface_.edgeCount(); ++e) {
      if (!surface_.isBoundaryEdge(e)) continue;
      const double value = score(surface_.halfedge(e));
      if (best == kNone || value > highest) {
        highest = value;
        best = surface_.halfedge(e);
      }
    }
    return best;
  }

  /// The half-plane map with a dipole at a boundary edge, in the disk and centred. The sources are
  /// the gradients of the hat functions on the edge's face and on its mirror image.
  Result<DiskMap> mapWithPole(Context& context, const MirrorSystem& even, const MirrorSystem& odd,
                              Index h) const {
    const double length = lengths_[surface_.edge(h)];
    const double height = 2 * frames_[h / 3].area() / length;
    const std::vector<double> zero(surface_.vertexCount(), 0.0);
    std::vector<double> source = zero;
    source[surface_.tail(h)] = 0.5 / length;
    source[surface_.head(h)] = -0.5 / length;
    ASSIGN_OR_RETURN(const std::vector<double> u, even.solve(context, zero, source));
    source = zero;
    source[surface_.tail(Connectivity::previous(h))] = 0.5 / height;
    ASSIGN_OR_RETURN(const std::vector<double> v, odd.solve(context, zero, source));
    PlanePoints z = joined(u, v);
    removeMeanDilatation(surface_, frames_, z);
    const MobiusMap toDisk = balancedCayley(z, areas_);
    for (Complex& w : z) w = toDisk(w);
    return spherical::centeredDiskMap(context, surface_, lengths_, areas_, z);
  }

  /// Nothing where too few vertices move or are held for anything useful to come of it.
  Result<std::optional<HalfChart>> makeChart(Context& context, const MirrorLaplacian& laplacian,
                                             const PlanePoints& points, const Complex& pole) const {
    const MobiusMap map = halfPlaneAround(pole);
    std::vector<bool> even_moves(points.size()), odd_moves(points.size());
    std::size_t inside = 0, held = 0;
    for (Index v = 0; v < surface_.vertexCount(); ++v) {
      even_moves[v] = std::abs(map(points[v])) < kReach;
      odd_moves[v] = even_moves[v] && !surface_.isBoundaryVertex(v);
      if (odd_moves[v]) ++inside;
      if (!even_moves[v]) ++held;
    }
    if (inside < 1 || held < 2) return std::optional<HalfChart>();
    ASSIGN_OR_RETURN(MirrorSystem even,
                     MirrorSystem::make(context, laplacian, Parity::kEven, even_moves));
    ASSIGN_OR_RETURN(MirrorSystem odd,
                     MirrorSystem::make(context, laplacian, Parity::kOdd, odd_moves));
    return std::optional<HalfChart>(HalfChart{map, map.inverse(), std::move(even), std::move(odd)});
  }

  Status relaxCharts(Context& context, const MirrorLaplacian& laplacian, PlanePoints points) {
    std::array<std::optional<HalfChart>, 2> charts;
    for (int side = 0; side < 2; ++side) {
      ASSIGN_OR_RETURN(charts[side],
                       makeChart(context, laplacian, points, side == 0 ? pole_ : -pole_));
      if (!charts[side]) return {};
    }
    for (int step = 1; step <= kRelaxations; ++step) {
      ASSIGN_OR_RETURN(points, charts[(step - 1) % 2]->relax(context, std::move(points)));
      // To centre and measure costs as much as two relaxations: the start, a map that both charts
      // have mended once, and the last one are enough to choose from.
      if (step == 2 || step == kRelaxations) RETURN_IF_ERROR(consider(context, points, step));
    }
    return {};
  }

  /// Centres a candidate and keeps it if it has fewer folds, mended ones too, or as many and less
  /// dilatation.
  Status consider(Context& context, const PlanePoints& points, int step) {
    Result<DiskMap> map = spherical::centeredDiskMap(context, surface_, lengths_, areas_, points);
    if (map.ok()) {
      map = spherical::withTipsReset(context, surface_, lengths_, areas_, *std::move(map));
    }
    RETURN_IF_ERROR(context.check());
    if (!map.ok()) return {};
    const Index folds = map->quality.flipped_faces + map->reset_tips;
    const Index least = best_->quality.flipped_faces + best_->reset_tips;
    if (folds > least) return {};
    if (folds == least && !(map->quality.mean_dilatation < best_->quality.mean_dilatation)) {
      return {};
    }
    best_ = *std::move(map);
    best_->iterations = step;
    return {};
  }

  const Connectivity& surface_;
  std::vector<double> lengths_;
  std::vector<double> areas_;
  std::vector<FaceFrame> frames_;
  Complex pole_ = 1;
  std::optional<DiskMap> best_;
};

}  // namespace

Result<DiskMap> mapToDiskLinear(Context& context, const Connectivity& surface,
                                const std::vector<double>& lengths) {
  RETURN_IF_ERROR(spherical::checkDisk(surface));
  const Context::Stage stage(context, "disk map");
  ASSIGN_OR_RETURN(DiskMap map, LinearDiskMap(surface, lengths).compute(context));
  RETURN_IF_ERROR(spherical::checkUnfolded(surface, map));
  return map;
}

}  // namespace moduli
