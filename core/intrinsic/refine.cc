#include "core/intrinsic/refine.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "core/intrinsic/delaunay.h"
#include "core/intrinsic/intrinsic_triangulation.h"
#include "core/intrinsic/mollify.h"

namespace moduli {
namespace {

/// Flips make new edges over the limit; what a few rounds leave of them does no harm.
constexpr int kRoundsPerLimit = 4;

Result<RefinedSurface> makeDelaunay(Context& context, const Connectivity& surface,
                                    const std::vector<double>& lengths) {
  RETURN_IF_ERROR(context.check());
  std::vector<double> half_chords = lengths;
  for (double& x : half_chords) x /= 2;
  IntrinsicTriangulation triangulation(surface, half_chords);
  RETURN_IF_ERROR(flipToDelaunayIsometric(context, triangulation).status());
  std::vector<double> flipped = triangulation.edgeHalfChords();
  for (double& x : flipped) x *= 2;
  Connectivity connectivity = triangulation.connectivity();
  // The rounding of flips may leave a needle improper.
  ASSIGN_OR_RETURN(MollifiedLengths proper, mollify(connectivity, std::move(flipped)));
  return RefinedSurface{std::move(connectivity), std::move(proper.lengths)};
}

Status checkLongest(const RefineOptions& options) {
  if (options.longest > 0) return {};
  return {Reason::kInvalidOption, "the longest length of an edge is not positive"};
}

/// `longest` doubled until no edge is longer.
double firstLimit(const std::vector<double>& lengths, double longest) {
  const double most = *std::max_element(lengths.begin(), lengths.end());
  while (longest < most) longest *= 2;
  return longest;
}

/// Per edge.
using Marks = std::vector<bool>;

int marksOf(const Connectivity& surface, const Marks& marks, Index face) {
  int count = 0;
  for (Index h = 3 * face; h < 3 * face + 3; ++h) count += marks[surface.edge(h)] ? 1 : 0;
  return count;
}

/// Marks the third edge of faces with two marked ones until there are none.
void closeMarks(const Connectivity& surface, Marks& marks) {
  std::vector<Index> suspects(surface.faceCount());
  for (Index f = 0; f < surface.faceCount(); ++f) suspects[f] = f;
  while (!suspects.empty()) {
    const Index f = suspects.back();
    suspects.pop_back();
    if (marksOf(surface, marks, f) != 2) continue;
    for (Index h = 3 * f; h < 3 * f + 3; ++h) {
      if (marks[surface.edge(h)]) continue;
      marks[surface.edge(h)] = true;
      if (surface.twin(h) != kNone) suspects.push_back(surface.twin(h) / 3);
    }
  }
}

/// The edges over the limit and those that closing adds; empty if there are none.
Marks edgesOver(const Connectivity& surface, const std::vector<double>& lengths, double limit) {
  Marks marks(lengths.size());
  bool any = false;
  for (std::size_t e = 0; e < marks.size(); ++e) {
    marks[e] = lengths[e] > limit;
    any |= marks[e];
  }
  if (!any) return {};
  closeMarks(surface, marks);
  return marks;
}

Index facesAdded(const Connectivity& surface, const Marks& marks) {
  Index count = 0;
  for (Index f = 0; f < surface.faceCount(); ++f) count += marksOf(surface, marks, f);
  return count;
}

/// From the corner between b and c to the middle of a; a sum of positive terms.
double medianLength(double a, double b, double c) {
  return std::sqrt((b - c) * (b - c) + (b + c - a) * (b + c + a)) / 2;
}

/// Cuts each face with one marked edge in two, with three in four; there are no faces with two.
class Halver {
 public:
  Halver(const Connectivity& surface, const std::vector<double>& lengths, const Marks& marks)
      : given_(surface),
        lengths_(lengths),
        middle_(marks.size(), kNone),
        pieces_(given_.halfedgeCount(), {kNone, kNone}),
        vertex_count_(given_.vertexCount()) {
    for (std::size_t e = 0; e < marks.size(); ++e) {
      if (marks[e]) middle_[e] = vertex_count_++;
    }
  }

  /// May be called once.
  RefinedSurface run() {
    for (Index f = 0; f < given_.faceCount(); ++f) cut(f);
    glueSides();
    Result<Connectivity> surface =
        Connectivity::fromGluing(vertex_count_, std::move(faces_), std::move(twins_));
    if (!surface.ok()) std::abort();  // Halving keeps manifolds.
    std::vector<double> lengths(surface->edgeCount());
    for (Index e = 0; e < surface->edgeCount(); ++e) lengths[e] = sides_[surface->halfedge(e)];
    return {*std::move(surface), std::move(lengths)};
  }

 private:
  /// Returns the first halfedge. Sides run from corner to corner.
  Index addFace(const Triangle& corners, const std::array<double, 3>& sides) {
    const Index first = static_cast<Index>(sides_.size());
    faces_.push_back(corners);
    sides_.insert(sides_.end(), sides.begin(), sides.end());
    twins_.insert(twins_.end(), 3, kNone);
    return first;
  }

  void glue(Index g, Index h) {
    twins_[g] = h;
    twins_[h] = g;
  }

  void cut(Index f) {
    int first = 0, count = 0;
    for (int c = 2; c >= 0; --c) {
      if (middle_[given_.edge(3 * f + c)] == kNone) continue;
      first = c;
      ++count;
    }
    // From here on the first marked side comes first.
    std::array<Index, 3> h{};
    Triangle v{}, m{};
    std::array<double, 3> l{};
    for (int c = 0; c < 3; ++c) {
      h[c] = 3 * f + (first + c) % 3;
      v[c] = given_.tail(h[c]);
      m[c] = middle_[given_.edge(h[c])];
      l[c] = lengths_[given_.edge(h[c])];
    }
    if (count == 0) {
      const Index whole = addFace(v, l);
      for (int c = 0; c < 3; ++c) pieces_[h[c]] = {whole + c, kNone};
    } else if (count == 1) {
      const double across = medianLength(l[0], l[1], l[2]);
      const Index near = addFace({v[0], m[0], v[2]}, {l[0] / 2, across, l[2]});
      const Index far = addFace({m[0], v[1], v[2]}, {l[0] / 2, l[1], across});
      glue(near + 1, far + 2);
      pieces_[h[0]] = {near, far};
      pieces_[h[1]] = {far + 1, kNone};
      pieces_[h[2]] = {near + 2, kNone};
    } else {
      const Index inner = addFace(m, {l[2] / 2, l[0] / 2, l[1] / 2});
      std::array<Index, 3> corner{};
      for (int c = 0; c < 3; ++c) {
        const int before = (c + 2) % 3;
        corner[c] = addFace({v[c], m[c], m[before]}, {l[c] / 2, l[(c + 1) % 3] / 2, l[before] / 2});
        glue(corner[c] + 1, inner + before);
      }
      for (int c = 0; c < 3; ++c) pieces_[h[c]] = {corner[c], corner[(c + 1) % 3] + 2};
    }
  }

  void glueSides() {
    for (Index h = 0; h < given_.halfedgeCount(); ++h) {
      const Index t = given_.twin(h);
      if (t < h) continue;  // Glued from there, or the boundary.
      const auto &one = pieces_[h], &other = pieces_[t];
      glue(one[0], other[1] == kNone ? other[0] : other[1]);
      if (one[1] != kNone) glue(one[1], other[0]);
    }
  }

  const Connectivity& given_;
  const std::vector<double>& lengths_;
  std::vector<Index> middle_;                 ///< Per edge its new vertex or kNone.
  std::vector<std::array<Index, 2>> pieces_;  ///< Per given halfedge its halves, or itself.
  Index vertex_count_;
  std::vector<Triangle> faces_;
  std::vector<double> sides_;  ///< Per new halfedge.
  std::vector<Index> twins_;
};

}  // namespace

Result<RefinedSurface> refineDelaunay(Context& context, const Connectivity& surface,
                                      const std::vector<double>& lengths,
                                      const RefineOptions& options) {
  RETURN_IF_ERROR(checkLongest(options));
  const Context::Stage stage(context, "refine");
  ASSIGN_OR_RETURN(RefinedSurface metric, makeDelaunay(context, surface, lengths));
  Index added = 0;
  for (double limit = firstLimit(metric.lengths, options.longest); limit > options.longest;) {
    limit /= 2;
    for (int round = 0; round < kRoundsPerLimit; ++round) {
      const Marks marks = edgesOver(metric.surface, metric.lengths, limit);
      if (marks.empty()) break;
      added += facesAdded(metric.surface, marks);
      if (added > options.most_added) return metric;
      const RefinedSurface halved = Halver(metric.surface, metric.lengths, marks).run();
      ASSIGN_OR_RETURN(metric, makeDelaunay(context, halved.surface, halved.lengths));
    }
  }
  return metric;
}

Result<RefinedMesh> refineInSpace(Context& context, RefinedMesh mesh,
                                  const RefineOptions& options) {
  RETURN_IF_ERROR(checkLongest(options));
  const Context::Stage stage(context, "refine");
  Index added = 0;
  for (double limit = firstLimit(mesh.lengths, options.longest); limit > options.longest;) {
    limit /= 2;
    for (;;) {
      RETURN_IF_ERROR(context.check());
      const Marks marks = edgesOver(mesh.surface, mesh.lengths, limit);
      if (marks.empty()) break;
      added += facesAdded(mesh.surface, marks);
      if (added > options.most_added) return mesh;
      for (Index e = 0; e < mesh.surface.edgeCount(); ++e) {
        if (!marks[e]) continue;
        const Index h = mesh.surface.halfedge(e);
        const Eigen::Vector3d p = mesh.positions[mesh.surface.tail(h)];
        mesh.positions.push_back(p + (mesh.positions[mesh.surface.head(h)] - p) / 2);
      }
      RefinedSurface halved = Halver(mesh.surface, mesh.lengths, marks).run();
      mesh.surface = std::move(halved.surface);
      mesh.lengths = std::move(halved.lengths);
    }
  }
  return mesh;
}

}  // namespace moduli
