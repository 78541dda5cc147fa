#include "core/matching/torus_map.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>
#include <string>
#include <utility>

#include "core/forms/cotan.h"
#include "core/matching/target_links.h"
#include "core/matching/torus_correlation.h"
#include "core/topology/tree_cotree.h"

namespace moduli {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix2i;
using Eigen::Vector2d;

/// Entries of markings between short bases that may be nearest: those of modular.cc's words.
constexpr int kMostEntry = 3;

/// A basis of the same lattice and the same orientation whose second vector is at most half the
/// first one long along it, and no shorter.
Matrix2d reducedBasis(Matrix2d basis) {
  if (basis.determinant() < 0) basis.col(1) *= -1;
  for (int n = 0; n < 1000; ++n) {
    const double along = std::round(basis.col(0).dot(basis.col(1)) / basis.col(0).squaredNorm());
    basis.col(1) -= along * basis.col(0);
    if (basis.col(1).squaredNorm() >= basis.col(0).squaredNorm()) break;
    const Vector2d first = basis.col(0);
    basis.col(0) = basis.col(1);
    basis.col(1) = -first;
  }
  return basis;
}

std::complex<double> beltramiOf(const Matrix2d& map) {
  // MATH 9.1: u = (ux, uy), v = (vx, vy) are the rows.
  const std::complex<double> over(map(0, 0) - map(1, 1), map(1, 0) + map(0, 1));
  const std::complex<double> under(map(0, 0) + map(1, 1), map(1, 0) - map(0, 1));
  return over / under;
}

double dilatationOf(const Matrix2d& map) {
  // K + 1 / K = |map|^2 / det, without cancellation: K = (1 + m)^2 / (1 - m^2).
  const double m = std::abs(beltramiOf(map));
  return (1 + m) / (1 - m);
}

/// The vertices in an order in which each has a neighbour before it.
struct VertexTree {
  std::vector<Index> order;
  std::vector<Index> entry;  ///< Per vertex the halfedge that leads to it.
};

VertexTree treeFrom(const Connectivity& surface, Index root) {
  VertexTree tree{{root}, std::vector<Index>(surface.vertexCount(), kNone)};
  std::vector<bool> seen(surface.vertexCount(), false);
  seen[root] = true;
  for (std::size_t n = 0; n < tree.order.size(); ++n) {
    const Index first = surface.outgoing(tree.order[n]);
    Index h = first;
    do {
      const Index v = surface.head(h);
      if (!seen[v]) {
        seen[v] = true;
        tree.entry[v] = h;
        tree.order.push_back(v);
      }
      h = surface.rotate(h);
    } while (h != first);
  }
  return tree;
}

Vector2d shiftOf(const Motion& motion) {
  return motion.topRightCorner<2, 1>();
}

/// The point with the least sum of weighted distances. Weiszfeld's iteration.
Vector2d geometricMedian(const std::vector<Vector2d>& points, const std::vector<double>& weights) {
  Vector2d middle = Vector2d::Zero();
  for (int n = 0; n < 200; ++n) {
    Vector2d sum = Vector2d::Zero();
    double total = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double distance = std::max((points[i] - middle).norm(), 1e-12);
      const double w = n == 0 ? weights[i] : weights[i] / distance;
      sum += w * points[i];
      total += w;
    }
    const Vector2d next = sum / total;
    const double moved = (next - middle).norm();
    middle = next;
    if (moved < 1e-12) break;
  }
  return middle;
}

class AffineMapping {
 public:
  AffineMapping(Context& context, const CoverSurface& a, const CoverSurface& b, TorusShape from,
                TorusShape to)
      : context_(context), a_(a), b_(b), from_(std::move(from)), to_(std::move(to)) {}

  Result<TorusMap> byTargets(const std::vector<SurfacePoint>& targets) {
    ASSIGN_OR_RETURN(const TargetLinks links, linkTargets(context_, a_.surface, b_, targets));
    const Context::Stage stage(context_, "affine");
    Matrix2d sums = Matrix2d::Zero();
    for (int k = 0; k < 2; ++k) {
      for (const Step& step : from_.loops[k]) {
        const Index h = a_.surface.halfedge(step.edge);
        sums.col(k) += step.sign * shiftOf(links.map.transitions[h]);
      }
    }
    // From the loops' basis to the short one.
    const Matrix2d change = from_.loop_periods.inverse() * from_.periods;
    setMarking((to_.periods.inverse() * sums * change).array().round().cast<int>().matrix());
    result_.replaced =
        static_cast<Index>(std::count(links.replaced.begin(), links.replaced.end(), true));
    const std::vector<Vector2d> left = leftovers(links.map);
    const std::vector<double> weights = vertexAreas(a_.surface, unitLengths(a_.lengths));
    const Vector2d shift = geometricMedian(left, weights);
    std::vector<double> distances;
    for (const Vector2d& point : left) distances.push_back((point - shift).norm());
    const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
    std::nth_element(distances.begin(), middle, distances.end());
    result_.offset = *middle;
    // leftovers() is counted from vertex 0 at its target.
    return lay(links.map.images[0].face, links.map.places[0],
               links.map.places[0] + Eigen::Vector3d(shift[0], shift[1], 0));
  }

  Result<TorusMap> byShape(const TorusMapOptions& options) {
    const Context::Stage stage(context_, "affine");
    const TorusField first(a_, from_), second(b_, to_);
    const std::vector<Candidate> candidates = nearestMarkings(options.slack);
    TorusAlignment best;
    Matrix2i marking;
    for (const Candidate& candidate : candidates) {
      RETURN_IF_ERROR(context_.check());
      const TorusAlignment found = alignFields(first, second, candidate.marking);
      if (!(found.correlation > best.correlation + 1e-9)) continue;
      best = found;
      marking = candidate.marking;
    }
    setMarking(marking);
    result_.correlation = best.correlation;
    // Lattice coordinates are those of corner 0 of face 0, in both.
    const Index h = a_.surface.outgoing(0);
    const Vector2d place = result_.linear * positionOf(h) + to_.periods * best.shift;
    return lay(0, b_.corners[0], {place[0] + b_.corners[0][0], place[1] + b_.corners[0][1], 1});
  }

 private:
  struct Candidate {
    Matrix2i marking;
    double distance = 0;
  };

  void setMarking(const Matrix2i& marking) {
    result_.marking = marking;
    result_.linear = to_.periods * marking.cast<double>() * from_.periods.inverse();
    result_.beltrami = beltramiOf(result_.linear);
    result_.dilatation = dilatationOf(result_.linear);
    result_.distance = std::atanh(std::abs(result_.beltrami));
  }

  /// By distance; the least and those within the slack.
  std::vector<Candidate> nearestMarkings(double slack) const {
    std::vector<Candidate> all;
    const int m = kMostEntry;
    for (int a = -m; a <= m; ++a) {
      for (int b = -m; b <= m; ++b) {
        for (int c = -m; c <= m; ++c) {
          for (int d = -m; d <= m; ++d) {
            if (a * d - b * c != 1) continue;
            Matrix2i marking;
            marking << a, b, c, d;
            const Matrix2d map = to_.periods * marking.cast<double>() * from_.periods.inverse();
            all.push_back({marking, std::log(dilatationOf(map)) / 2});
          }
        }
      }
    }
    const auto nearer = [](const Candidate& x, const Candidate& y) {
      return x.distance < y.distance;
    };
    std::stable_sort(all.begin(), all.end(), nearer);
    const double most = all.front().distance + slack;
    const auto end =
        std::find_if(all.begin(), all.end(), [&](const Candidate& x) { return x.distance > most; });
    all.erase(end, all.end());
    return all;
  }

  /// Where the targets of vertices are, less where the linear map puts them from vertex 0 at its
  /// own target.
  std::vector<Vector2d> leftovers(const CoverMap& map) const {
    const VertexTree tree = treeFrom(a_.surface, 0);
    std::vector<Vector2d> origin(a_.surface.vertexCount(), Vector2d::Zero());
    std::vector<Vector2d> left(a_.surface.vertexCount(), Vector2d::Zero());
    for (const Index v : tree.order) {
      const Index h = tree.entry[v];
      if (h == kNone) continue;
      const Index u = a_.surface.tail(h);
      // In common coordinates: place + origin.
      origin[v] = origin[u] + shiftOf(map.transitions[h]);
      const Vector2d step = origin[v] - origin[u] + (map.places[v] - map.places[u]).head<2>();
      left[v] = left[u] + step - result_.linear * from_.steps[h];
    }
    return left;
  }

  /// Of the tail of h, along the shortest chain of faces from corner 0 of face 0.
  Vector2d positionOf(Index h) const {
    std::vector<Index> entry(a_.surface.faceCount(), kNone);
    std::vector<Index> queue = {0};
    for (std::size_t n = 0; n < queue.size(); ++n) {
      for (Index k = 3 * queue[n]; k < 3 * queue[n] + 3; ++k) {
        const Index next = a_.surface.twin(k), beyond = Connectivity::faceOf(next);
        if (beyond == 0 || entry[beyond] != kNone) continue;
        entry[beyond] = next;
        queue.push_back(beyond);
      }
    }
    Vector2d place = a_.corners[h].head<2>();
    for (Index f = Connectivity::faceOf(h); f != 0;) {
      const Index exit = a_.surface.twin(entry[f]);
      place += shiftOf(a_.across[exit]);
      f = Connectivity::faceOf(exit);
    }
    return place - a_.corners[0].head<2>();
  }

  /// Puts vertex 0 to a place in the coordinates of a face, and all others by the linear map.
  Result<TorusMap> lay(Index face, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    const Connectivity& surface = a_.surface;
    CoverMap& map = result_.map;
    map.images.resize(surface.vertexCount());
    map.places.resize(surface.vertexCount());
    const auto put = [&](Index v, Index f, const Eigen::Vector3d& start,
                         const Eigen::Vector3d& goal) {
      const CoverArrival end = walkStraight(b_, f, start, goal);
      map.images[v] = b_.pointAt(end.face, end.place);
      map.places[v] = end.place;
    };
    put(0, face, from, to);
    const VertexTree tree = treeFrom(surface, 0);
    for (std::size_t n = 1; n < tree.order.size(); ++n) {
      if (n % 4096 == 0) RETURN_IF_ERROR(context_.check());
      const Index v = tree.order[n], u = surface.tail(tree.entry[v]);
      const Vector2d step = result_.linear * from_.steps[tree.entry[v]];
      put(v, map.images[u].face, map.places[u],
          map.places[u] + Eigen::Vector3d(step[0], step[1], 0));
    }
    map.transitions.assign(surface.halfedgeCount(), Motion::Identity());
    for (Index h = 0; h < surface.halfedgeCount(); ++h) {
      const Vector2d step = result_.linear * from_.steps[h];
      map.transitions[h].topRightCorner<2, 1>() =
          (map.places[surface.tail(h)] - map.places[surface.head(h)]).head<2>() + step;
    }
    const Index folded = countFolded(surface, map);
    if (folded > 0) {
      return Status(Reason::kFoldedMap,
                    "the affine map turns over " + std::to_string(folded) + " of " +
                        std::to_string(surface.faceCount()) + " faces",
                    "simplify limbs that are long and thin");
    }
    return std::move(result_);
  }

  Context& context_;
  const CoverSurface &a_, &b_;
  TorusShape from_, to_;
  TorusMap result_;
};

}  // namespace

std::complex<double> periodRatio(const Matrix2d& periods) {
  return std::complex<double>(periods(0, 1), periods(1, 1)) /
         std::complex<double>(periods(0, 0), periods(1, 0));
}

Result<TorusShape> torusShape(const CoverSurface& cover) {
  const Connectivity& surface = cover.surface;
  if (cover.geometry != Geometry::kEuclidean || surface.eulerCharacteristic() != 0) {
    return Status(Reason::kUnsupportedTopology, "affine maps are those of tori");
  }
  ASSIGN_OR_RETURN(const TreeCotree trees, computeTreeCotree(surface));
  std::vector<Walk> loops = homologyBasis(surface, trees);
  TorusShape shape;
  shape.steps.resize(surface.halfedgeCount());
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    // As the two faces have it: their mean.
    const Index h = surface.halfedge(e), t = surface.twin(h);
    const auto step = [&](Index k) -> Vector2d {
      return (cover.corners[Connectivity::next(k)] - cover.corners[k]).head<2>();
    };
    shape.steps[h] = (step(h) - step(t)) / 2;
    shape.steps[t] = -shape.steps[h];
  }
  for (int k = 0; k < 2; ++k) {
    Vector2d sum = Vector2d::Zero();
    for (const Step& step : loops[k]) sum += step.sign * shape.steps[surface.halfedge(step.edge)];
    shape.loop_periods.col(k) = sum;
    shape.loops[k] = std::move(loops[k]);
  }
  shape.periods = reducedBasis(shape.loop_periods);
  return shape;
}

Result<TorusMap> affineTorusMap(Context& context, const CoverSurface& a, const CoverSurface& b,
                                const std::vector<SurfacePoint>& targets,
                                const TorusMapOptions& options) {
  ASSIGN_OR_RETURN(TorusShape from, torusShape(a));
  ASSIGN_OR_RETURN(TorusShape to, torusShape(b));
  AffineMapping mapping(context, a, b, std::move(from), std::move(to));
  return targets.empty() ? mapping.byShape(options) : mapping.byTargets(targets);
}

}  // namespace moduli
