#include "core/matching/unfold_sphere.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "core/matching/ring_mesh.h"
#include "core/matching/ring_place.h"
#include "core/matching/thinning.h"
#include "core/spherical/exact_sign.h"

namespace moduli {
namespace {

using Eigen::Vector3d;

/// Halvings of the way from a neighbour to a point that is in the kernel or on the equator.
constexpr int kHalvings = 40;
/// Whenever so many times more vertices have come back, they are moved to where their faces are
/// least distorted: what is large evens out in few sweeps while few are there.
constexpr double kGrowth = 1.5;
constexpr int kSweeps = 4;
constexpr int kLastSweeps = 16;
/// Relative to the ring's width: less is no way to speak of.
constexpr double kStill = 0.01;
/// Heights of faces above what a motion of the sphere may lose to rounding: three products and sums
/// for each coordinate of three corners, and as much again.
constexpr double kFirm = 64 * std::numeric_limits<double>::epsilon();
/// So many rings of vertices around folded faces are taken out, in turn until there is room.
constexpr std::array<int, 2> kWidenings = {0, 2};
/// How vertices are put back.
enum class Manner : std::uint8_t {
  kNearby,  ///< No farther from where they were than there is need.
  kShaped,  ///< Where their faces are least distorted.
  kAlike,   ///< As if all faces were equilateral, and only then by their shapes.
};

class Unfolding {
 public:
  Unfolding(Context& context, const TriangleMesh& mesh, Points3 points, Index pole)
      : context_(context),
        mesh_(mesh),
        folded_(std::move(points)),
        pole_(pole),
        area_(mesh.area()),
        unit_(std::sqrt(4 * std::numbers::pi / area_)) {}

  Result<Points3> run() {
    const FaceRule is_positive = [&](Index a, Index b, Index c) { return isPositive(a, b, c); };
    if (count(cornersOf(is_positive)) == 0) return std::move(folded_);
    const Context::Stage stage(context_, "unfold");
    const FaceRule is_large = [&](Index a, Index b, Index c) { return isLarge(a, b, c); };
    const FaceRule is_sound = [&](Index a, Index b, Index c) {
      return isPositive(a, b, c) && isLarge(a, b, c);
    };
    // Folds at needles; others are ends of limbs, which doubles do not tell apart.
    if (count(cornersOf(is_large)) == 0) RETURN_IF_ERROR(attempt({}, is_sound, Manner::kNearby));
    std::vector<char> out = cornersOf(is_sound);
    int rings = 0;
    for (const int widening : kWidenings) {
      for (; rings < widening; ++rings) out = widened(out);
      for (const Manner manner : {Manner::kShaped, Manner::kAlike}) {
        if (least_infirm_ == 0) break;
        RETURN_IF_ERROR(attempt(out, is_sound, manner));
      }
    }
    if (least_infirm_ != 0 && pole_ == kNone) RETURN_IF_ERROR(mapAnew());
    if (!best_) {
      return Status(Reason::kFoldedMap, "the map to the sphere folds too many faces",
                    "remesh the surface with fewer thin triangles");
    }
    return *std::move(best_);
  }

 private:
  bool isPositive(Index a, Index b, Index c) const {
    return spherical::orientationSign(folded_[a], folded_[b], folded_[c]) > 0;
  }

  bool isLarge(Index a, Index b, Index c) const {
    if (pole_ != kNone && (a == pole_ || b == pole_ || c == pole_)) return true;
    const auto longest = [&](const std::vector<Vector3d>& p) {
      return std::max({(p[a] - p[b]).norm(), (p[b] - p[c]).norm(), (p[c] - p[a]).norm()});
    };
    return longest(folded_) >= kLeastScale * unit_ * longest(mesh_.positions());
  }

  static std::ptrdiff_t count(const std::vector<char>& set) {
    return std::count(set.begin(), set.end(), 1);
  }

  bool mayMove(const RingMesh& rings, Index v) const { return v != pole_ && !rings.isRim(v); }

  /// Per vertex whether it is at a face that does not obey.
  std::vector<char> cornersOf(const FaceRule& rule) const {
    std::vector<char> corners(mesh_.vertexCount(), 0);
    for (const auto& [a, b, c] : mesh_.connectivity().faces()) {
      if (!rule(a, b, c)) corners[a] = corners[b] = corners[c] = 1;
    }
    return corners;
  }

  std::vector<char> widened(const std::vector<char>& set) const {
    std::vector<char> wide = set;
    for (const auto& [a, b, c] : mesh_.connectivity().faces()) {
      if (set[a] != 0 || set[b] != 0 || set[c] != 0) wide[a] = wide[b] = wide[c] = 1;
    }
    return wide;
  }

  /// Takes `out` out, and whatever else stands in the way of faces that obey the rule; and puts all
  /// of it back where there is room.
  Status attempt(const std::vector<char>& out, const FaceRule& rule, Manner manner) {
    RETURN_IF_ERROR(context_.check());
    ASSIGN_OR_RETURN(RingMesh rings, RingMesh::make(mesh_.connectivity(), pole_));
    points_ = folded_;
    if (!out.empty()) RETURN_IF_ERROR(thin(rings, out));
    if (!thinUntil(rings, mesh_.positions(), rule)) return {};
    return restoreAll(rings, rule, manner);
  }

  /// By the graph alone, from a tetrahedron, then as little distorted as some sweeps make it.
  Status mapAnew() {
    RETURN_IF_ERROR(context_.check());
    ASSIGN_OR_RETURN(RingMesh rings, RingMesh::make(mesh_.connectivity()));
    RETURN_IF_ERROR(thin(rings, std::vector<char>(mesh_.vertexCount(), 1)));
    const FaceRule none = [](Index, Index, Index) { return false; };
    thinUntil(rings, mesh_.positions(), none);
    if (rings.vertexCount() != 4) return {};
    points_.assign(mesh_.vertexCount(), Vector3d::Zero());
    const auto first = [&] {
      Index v = 0;
      while (!rings.isPresent(v)) ++v;
      return v;
    }();
    points_[first] = Vector3d::UnitZ();
    for (int i = 0; i < 3; ++i) {
      const double angle = 2 * std::numbers::pi * i / 3;
      points_[rings.ring(first)[i]] =
          Vector3d(std::sqrt(8.0) * std::cos(angle), std::sqrt(8.0) * std::sin(angle), -1) / 3;
    }
    return restoreAll(rings, none, Manner::kAlike);
  }

  /// Evenly, as far as that goes: what comes back in the opposite order finds room.
  Status thin(RingMesh& rings, const std::vector<char>& out) {
    std::vector<char> movable = out;
    for (Index v = 0; v < mesh_.vertexCount(); ++v) {
      if (!mayMove(rings, v)) movable[v] = 0;
    }
    const auto moving = static_cast<Index>(count(movable));
    const FaceRule any = [](Index, Index, Index) { return true; };
    return thinEvenly(context_, rings, mesh_.positions(), movable, any,
                      mesh_.vertexCount() - moving);
  }

  Status restoreAll(RingMesh& rings, const FaceRule& rule, Manner manner) {
    moved_.clear();
    manner_ = manner;
    std::size_t next = 8;
    while (rings.vertexCount() < mesh_.vertexCount()) {
      if (rings.vertexCount() % 1024 == 0) RETURN_IF_ERROR(context_.check());
      const RingMesh::Collapse last = rings.restore();
      if (!place(rings, last, rule)) return {};
      if (manner == Manner::kNearby || moved_.size() < next) continue;
      sweep(rings, kSweeps);
      next = static_cast<std::size_t>(kGrowth * static_cast<double>(moved_.size()));
    }
    if (manner == Manner::kAlike) keep(rings);
    if (manner != Manner::kNearby) {
      manner_ = Manner::kShaped;
      sweep(rings, kLastSweeps);
    }
    keep(rings);
    return {};
  }

  /// What has the fewest faces that a rotation could fold by its rounding.
  void keep(const RingMesh& rings) {
    Index infirm = 0;
    for (const Index v : moved_) {
      const std::vector<Index>& ring = rings.ring(v);
      for (std::size_t i = 0; i < ring.size(); ++i) {
        const Vector3d &p = points_[v], &a = points_[ring[i]];
        const Vector3d& b = points_[ring[(i + 1) % ring.size()]];
        const double longest = std::max({(p - a).norm(), (p - b).norm(), (a - b).norm()});
        if (!(p.dot((a - p).cross(b - p)) > kFirm * longest)) ++infirm;
      }
    }
    // What is less distorted comes later.
    if (best_ && infirm > least_infirm_) return;
    best_ = points_;
    least_infirm_ = infirm;
  }

  PlacedRing ringOf(const RingMesh& rings, Index v) const {
    const bool alike = manner_ == Manner::kAlike;
    // Of faces that are alike the areas are numbers: there are twice as many as vertices.
    const double area = alike ? 2.0 * rings.vertexCount() : area_;
    const double least_scale = alike ? 1 : kLeastScale;
    return {v, rings.ring(v), mesh_.positions(), points_, area, least_scale, alike};
  }

  bool place(const RingMesh& rings, const RingMesh::Collapse& last, const FaceRule& rule) {
    const Index v = last.removed;
    const PlacedRing ring = ringOf(rings, v);
    if (mayStay(ring, rule)) return true;
    const std::optional<Vector3d> p =
        rings.isRim(v) ? onRim(rings, last) : kernelCentre(ring, points_[last.kept]);
    if (!p) return false;
    points_[v] = *p;
    if (!mayMove(rings, v)) return true;
    moved_.push_back(v);
    points_[v] = manner_ == Manner::kNearby ? towards(ring, *p) : leastDistorted(ring, *p);
    return true;
  }

  /// Whether a vertex may be where it was, by its faces there and not among others that have moved;
  /// or whatever they are, if it is to be nearby.
  bool mayStay(const PlacedRing& ring, const FaceRule& rule) {
    const Vector3d& here = points_[ring.vertex] = folded_[ring.vertex];
    if (!isInKernel(ring, here)) return false;
    if (manner_ == Manner::kNearby) return true;
    for (std::size_t i = 0; i < ring.ring.size(); ++i) {
      const Index a = ring.ring[i], b = ring.ring[(i + 1) % ring.ring.size()];
      if (points_[a] != folded_[a] || !rule(ring.vertex, a, b)) return false;
    }
    return true;
  }

  /// Half of the way that is needed to a point of the kernel, and as much again.
  Vector3d towards(const PlacedRing& ring, const Vector3d& inside) const {
    const Vector3d& old = folded_[ring.vertex];
    for (const double share : {0.25, 0.5, 0.75}) {
      const Vector3d p = (old + share * (inside - old)).normalized();
      if (isInKernel(ring, p)) return p;
    }
    return inside;
  }

  /// On the equator, between the neighbours there.
  std::optional<Vector3d> onRim(const RingMesh& rings, const RingMesh::Collapse& last) const {
    const PlacedRing ring = ringOf(rings, last.removed);
    const Vector3d& from = points_[last.kept];
    for (const Index other : ring.ring) {
      if (other == last.kept || !rings.isRim(other)) continue;
      for (double share = 0.5; share > std::ldexp(1.0, -kHalvings); share /= 2) {
        // Of height 0, as both are.
        const Vector3d p = (from + share * (points_[other] - from)).normalized();
        if (isInKernel(ring, p)) return p;
      }
    }
    return {};
  }

  /// Moves what has moved once to where its faces are least distorted, until that is no way.
  void sweep(const RingMesh& rings, int sweeps) {
    for (int n = 0; n < sweeps; ++n) {
      double farthest = 0;
      for (const Index v : moved_) {
        const Vector3d p = leastDistorted(ringOf(rings, v), points_[v]);
        double width = 0;
        for (const Index w : rings.ring(v)) width = std::max(width, (points_[w] - p).norm());
        farthest = std::max(farthest, (p - points_[v]).norm() / width);
        points_[v] = p;
      }
      if (farthest < kStill) return;
    }
  }

  Context& context_;
  const TriangleMesh& mesh_;
  Points3 folded_;
  Index pole_;
  double area_, unit_;
  Points3 points_;
  std::vector<Index> moved_;  ///< Of those that are back.
  Manner manner_ = Manner::kNearby;
  std::optional<Points3> best_;
  Index least_infirm_ = kNone;
};

}  // namespace

Result<Points3> unfoldSphere(Context& context, const TriangleMesh& mesh, Points3 points,
                             Index pole) {
  RETURN_IF_ERROR(context.check());
  return Unfolding(context, mesh, std::move(points), pole).run();
}

}  // namespace moduli
