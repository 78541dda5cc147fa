#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "core/base/parallel.h"
#include "core/matching/face_distortion.h"
#include "core/matching/plane_step.h"
#include "core/matching/surface_walk.h"
#include "core/matching/whole_map.h"
#include "core/spherical/exact_sign.h"

namespace moduli {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Over all vertices: at every level, and at the last one.
constexpr int kSweeps = 1, kLastSweeps = 2;
/// Vertices that one thread moves before it asks for more.
constexpr std::size_t kTogether = 128;
/// Twice a triangle's area in the plane over the square of its longest side: what is clearer of
/// turning over than this need not be kept from it, and what is less so is not made.
constexpr double kClear = 1e-3, kTooThin = 1e-9;
constexpr int kHalvings = 5;

/// Lines are straight there.
Vector2d inKlein(const Vector3d& place) {
  return place.head<2>() / place[2];
}

/// A place, and where it is in Klein's disk.
struct Corner {
  explicit Corner(const Vector3d& where) : place(where), klein(inKlein(where)) {}

  Vector3d place;
  Vector2d klein;
};

/// Of the square of a triangle's longest side over those of its corners: rounding has no say in the
/// sign of clear triangles larger than that.
constexpr double kLarge = 1e-12;

/// 0 where the triangle is not positive.
double clearanceOf(const Corner& a, const Corner& b, const Corner& c) {
  const Vector2d u = b.klein - a.klein, w = c.klein - a.klein;
  const double longest = std::max({u.squaredNorm(), w.squaredNorm(), (w - u).squaredNorm()});
  const double twice_area = u[0] * w[1] - u[1] * w[0];
  const bool is_sure =
      twice_area > kClear * longest && longest > kLarge * (1 + a.klein.squaredNorm());
  if (!is_sure && spherical::orientationSign(a.place, b.place, c.place) <= 0) return 0;
  return std::max(0.0, twice_area) / longest;
}

/// A map of the vertices that are there, in the plane of a cover.
class CoverRefinement {
 public:
  CoverRefinement(Context& context, const ThinnedSurface& thinned, const TriangleMesh& a,
                  const TriangleMesh& b, const CoverSurface& cover, const CoverMap& map)
      : context_(context),
        a_(a.connectivity()),
        cover_(cover),
        plane_(cover.plane()),
        walk_(b.connectivity(), b.positions(), std::sqrt(b.area())),
        mesh_(thinned.rings),
        positions_(a.positions()),
        vertices_(a.positions().size()) {
    const double unit = std::sqrt(a.area());
    for (Vector3d& p : positions_) p /= unit;
    const Connectivity& coarse = thinned.mesh.connectivity();
    for (Index v = 0; v < coarse.vertexCount(); ++v) {
      Vertex& vertex = vertices_[thinned.vertices[v]];
      vertex.image = map.images[v];
      vertex.place = map.places[v];
      vertex.space = walk_.place(vertex.image);
    }
    for (Index h = 0; h < coarse.halfedgeCount(); ++h) {
      see(thinned.vertices[coarse.tail(h)], thinned.vertices[coarse.head(h)], map.transitions[h]);
    }
    order_ = thinned.vertices;
  }

  Result<CoverMap> run() {
    // Levels of equal ratios, of about twice as many vertices each.
    const double all = static_cast<double>(positions_.size());
    const double here = static_cast<double>(mesh_.vertexCount());
    const double levels = std::max(1.0, std::round(std::log2(all / here)));
    for (double level = 1; level <= levels; ++level) {
      const auto wanted =
          static_cast<Index>(std::lround(here * std::pow(all / here, level / levels)));
      while (mesh_.vertexCount() < wanted) RETURN_IF_ERROR(restoreSome(wanted));
      const std::vector<std::vector<Index>> sets = separatedSets(mesh_, order_);
      for (int sweep = 0; sweep < (level < levels ? kSweeps : kLastSweeps); ++sweep) {
        RETURN_IF_ERROR(context_.check());
        for (const std::vector<Index>& set : sets) relaxTogether(set);
      }
    }
    return whole();
  }

 private:
  struct Vertex {
    SurfacePoint image;
    Vector3d place = Vector3d::Zero(), space = Vector3d::Zero();
    /// Per neighbour: from the coordinates of its image's face to those of the own one's.
    std::vector<std::pair<Index, Motion>> seen;
  };

  /// From the coordinates of the face that a walk has come to, to those of its first.
  struct Way {
    void cross(Index h) {
      motion = motion * cover.across[h];
      any = true;
    }

    const CoverSurface& cover;
    Motion motion = Motion::Identity();
    bool any = false;
  };

  Motion& transition(Index v, Index w) {
    auto& seen = vertices_[v].seen;
    return std::find_if(seen.begin(), seen.end(), [&](const auto& e) { return e.first == w; })
        ->second;
  }

  void see(Index v, Index w, const Motion& motion) { vertices_[v].seen.emplace_back(w, motion); }

  void forget(Index v, Index w) {
    std::erase_if(vertices_[v].seen, [&](const auto& entry) { return entry.first == w; });
  }

  /// The ring of a vertex in the coordinates of its image's face.
  std::vector<Corner> ringSeen(Index v) {
    std::vector<Corner> corners;
    corners.reserve(mesh_.ring(v).size());
    for (const Index w : mesh_.ring(v)) {
      corners.emplace_back(Vector3d(transition(v, w) * vertices_[w].place));
    }
    return corners;
  }

  static double clearance(const Vector3d& place, const std::vector<Corner>& ring) {
    const Corner corner(place);
    double least = kClear;
    for (std::size_t i = 0; i < ring.size() && least > 0; ++i) {
      const Corner& next = ring[i + 1 == ring.size() ? 0 : i + 1];
      least = std::min(least, clearanceOf(corner, ring[i], next));
    }
    return least;
  }

  /// A vertex that comes back, as it is found.
  struct Arrival {
    Index v = kNone, kept = kNone;
    bool has_place = false;
    Vertex vertex = {};
    std::vector<Motion> transitions = {};  ///< Per neighbour.
  };

  /// Vertices of no common edge, side by side.
  Status restoreSome(Index wanted) {
    RETURN_IF_ERROR(context_.check());
    std::vector<Arrival> arrivals;
    for (const auto& [v, kept] : restoreSeparated(mesh_, wanted - mesh_.vertexCount())) {
      arrivals.push_back({v, kept});
    }
    parallelBlocks(arrivals.size(), kTogether, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) place(arrivals[i]);
    });
    for (Arrival& arrival : arrivals) {
      if (!arrival.has_place) {
        return {Reason::kFoldedMap, "vertex " + std::to_string(arrival.v) +
                                        " finds no place that folds no face: the map is thinner "
                                        "there than doubles tell apart"};
      }
      join(arrival);
      order_.push_back(arrival.v);
    }
    parallelBlocks(arrivals.size(), kTogether, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) relax(arrivals[i].v, 1);
    });
    return {};
  }

  void place(Arrival& arrival) {
    const auto [v, kept] = std::pair(arrival.v, arrival.kept);
    const std::vector<Index>& ring = mesh_.ring(v);
    // As `kept`, which is in the ring, sees it.
    std::vector<Motion> to;
    std::vector<Vector3d> places;
    for (const Index w : ring) {
      to.push_back(w == kept ? Motion::Identity() : transition(kept, w));
      places.push_back(to.back() * vertices_[w].place);
    }
    const auto at =
        static_cast<std::size_t>(std::find(ring.begin(), ring.end(), kept) - ring.begin());
    const Vector3d place = placeIn(v, places, at);
    arrival.has_place = place[2] > 0;
    if (!arrival.has_place) return;
    const CoverArrival end = walkStraight(cover_, vertices_[kept].image.face, places[at], place);
    arrival.vertex.image = cover_.pointAt(end.face, end.place);
    arrival.vertex.place = end.place;
    arrival.vertex.space = walk_.place(arrival.vertex.image);
    const Motion back = plane_.inverse(end.motion);
    for (const Motion& motion : to) {
      arrival.transitions.push_back(plane_.normalized(Motion(back * motion)));
    }
  }

  /// Takes its place among its neighbours.
  void join(Arrival& arrival) {
    const auto [v, kept] = std::pair(arrival.v, arrival.kept);
    const std::vector<Index>& ring = mesh_.ring(v);
    vertices_[v] = std::move(arrival.vertex);
    const auto at =
        static_cast<std::size_t>(std::find(ring.begin(), ring.end(), kept) - ring.begin());
    const std::size_t n = ring.size();
    for (std::size_t i = 0; i < n; ++i) {
      if (i != at && i != (at + 1) % n && i != (at + n - 1) % n) {
        forget(kept, ring[i]);
        forget(ring[i], kept);
      }
      see(v, ring[i], arrival.transitions[i]);
      see(ring[i], v, plane_.inverse(arrival.transitions[i]));
    }
  }

  /// In the kernel of a ring: 0 where no double is.
  Vector3d placeIn(Index v, const std::vector<Vector3d>& ring, std::size_t kept) const {
    const Vector3d mean = plane_.normalized(meanOf(v, ring));
    const std::vector<Corner> corners(ring.begin(), ring.end());
    if (clearance(mean, corners) > kTooThin) return mean;
    // Close to `kept` the kernel is a sector between the two neighbours they share; its bisector
    // leads into it.
    const std::size_t n = ring.size();
    const Vector2d origin = inKlein(ring[kept]);
    const Vector2d left = (inKlein(ring[(kept + 1) % n]) - origin).normalized();
    const Vector2d right = (inKlein(ring[(kept + n - 1) % n]) - origin).normalized();
    Vector2d middle = left + right;
    if (right[0] * left[1] - right[1] * left[0] > 0) middle = -middle;
    if (middle.norm() < 1e-6) middle = Vector2d(-left[1], left[0]);
    middle.normalize();
    double reach = 0, clearest = 0;
    for (const Vector3d& w : ring) reach = std::max(reach, (inKlein(w) - origin).norm());
    Vector3d best = Vector3d::Zero();
    for (int halving = 0; halving < 50; ++halving, reach /= 2) {
      const Vector2d trial = origin + reach * middle;
      if (!plane_.isFlat() && !(trial.norm() < 1)) continue;
      const Vector3d place = plane_.normalized(Vector3d(trial[0], trial[1], 1));
      const double clear = clearance(place, corners);
      if (clearest > 0 && !(clear > clearest)) break;
      if (!(clear > clearest)) continue;
      clearest = clear;
      best = place;
    }
    return best;
  }

  /// By mean value coordinates, as the surface before the map has them. Source: Floater 2003.
  Vector3d meanOf(Index v, const std::vector<Vector3d>& places) const {
    const std::vector<Index>& ring = mesh_.ring(v);
    const std::size_t n = ring.size();
    std::vector<double> half_tangent(n);
    for (std::size_t i = 0; i < n; ++i) {
      const Vector3d p = positions_[ring[i]] - positions_[v];
      const Vector3d q = positions_[ring[(i + 1) % n]] - positions_[v];
      const double cosine = p.dot(q) + p.norm() * q.norm();
      half_tangent[i] = cosine > 0 ? std::min(p.cross(q).norm() / cosine, 1e3) : 1e3;
    }
    Vector3d sum = Vector3d::Zero();
    for (std::size_t i = 0; i < n; ++i) {
      const double length = (positions_[ring[i]] - positions_[v]).norm();
      const double weight = (half_tangent[i] + half_tangent[(i + n - 1) % n]) /
                            std::max(length, std::numeric_limits<double>::min());
      sum += weight * places[i];
    }
    return sum;
  }

  /// Vertices of a separated set look at their rings alone, and change nothing that another one
  /// sees: the outcome is the same on any number of threads.
  void relaxTogether(const std::vector<Index>& set) {
    parallelBlocks(set.size(), kTogether, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) relax(set[i], kOverRelaxation);
    });
  }

  /// A step of Newton's method in the surface, so many times as long, and shorter until its faces
  /// stay positive and their energy falls.
  void relax(Index v, double times) {
    Vertex& vertex = vertices_[v];
    const std::vector<Index>& ring = mesh_.ring(v);
    const std::size_t n = ring.size();
    std::vector<FaceDistortion> faces;
    faces.reserve(n);
    Vector3d gradient = Vector3d::Zero();
    Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
    double longest = 0, before = 0;
    const auto triangle = [&](const Vector3d& at, std::size_t i) -> SpaceTriangle {
      return {at, vertices_[ring[i]].space, vertices_[ring[i + 1 == n ? 0 : i + 1]].space};
    };
    for (std::size_t i = 0; i < n; ++i) {
      faces.emplace_back(SpaceTriangle{positions_[v], positions_[ring[i]],
                                       positions_[ring[i + 1 == n ? 0 : i + 1]]});
      before += faces.back().differentiate(triangle(vertex.space, i), gradient, hessian);
      longest = std::max(longest, (vertices_[ring[i]].space - vertex.space).squaredNorm());
    }
    const double reach = 2 * std::sqrt(longest);
    Vector3d step = stepInPlane(walk_.normal(vertex.image.face), gradient, hessian);
    const double enough = 1e-13 * before;
    if (!(-gradient.dot(step) / 2 > enough)) return;
    step *= times;
    if (step.norm() > reach) step *= reach / step.norm();
    std::vector<Corner> seen;
    for (int halving = 0; halving < kHalvings; ++halving, step /= 3) {
      Way way{cover_};
      const SurfacePoint image = walk_(vertex.image, step, 256, [&way](Index h) { way.cross(h); });
      const Vector3d space = walk_.place(image);
      double after = 0;
      for (std::size_t i = 0; i < n; ++i) after += faces[i].energy(triangle(space, i));
      if (!(before - after > enough)) continue;
      if (seen.empty()) seen = ringSeen(v);
      const Vector3d place = cover_.place(image);
      const double then = clearance(way.any ? Vector3d(way.motion * place) : place, seen);
      if (!(then > 0) || (then < kClear && then < clearance(vertex.place, seen))) continue;
      if (way.any) follow(v, way.motion);
      vertex.image = image;
      vertex.place = place;
      vertex.space = space;
      return;
    }
  }

  /// way: from the coordinates of v's new face to those of the old one.
  void follow(Index v, const Motion& way) {
    const Motion back = plane_.inverse(way);
    for (auto& [w, motion] : vertices_[v].seen) {
      motion = plane_.normalized(Motion(back * motion));
      transition(w, v) = plane_.inverse(motion);
    }
  }

  Result<CoverMap> whole() {
    CoverMap result;
    for (const Vertex& vertex : vertices_) {
      result.images.push_back(vertex.image);
      result.places.push_back(vertex.place);
    }
    for (Index h = 0; h < a_.halfedgeCount(); ++h) {
      result.transitions.push_back(transition(a_.tail(h), a_.head(h)));
    }
    const Index folded = countFolded(a_, result);
    if (folded == 0) return result;
    return Status(Reason::kFoldedMap, std::to_string(folded) + " faces of the map are folded");
  }

  Context& context_;
  const Connectivity& a_;
  const CoverSurface& cover_;
  const CoverPlane plane_;
  const SurfaceWalk walk_;
  RingMesh mesh_;
  std::vector<Vector3d> positions_;  ///< Of a, of area 1.
  std::vector<Vertex> vertices_;
  std::vector<Index> order_;  ///< Those that are there.
};

}  // namespace

Result<CoverMap> mapWhole(Context& context, const ThinnedSurface& thinned, const TriangleMesh& a,
                          const TriangleMesh& b, const CoverSurface& cover, const CoverMap& map) {
  const Context::Stage stage(context, "whole");
  return CoverRefinement(context, thinned, a, b, cover, map).run();
}

}  // namespace moduli
