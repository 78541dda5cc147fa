#include <cmath>
#include <map>
#include <unordered_map>

#include "core/mesh/sample_kinds.h"

/// A closed surface of any genus: the boundary of a plate of unit cubes with square holes, as the
/// control mesh of a Catmull-Clark surface. The vertices of every resolution lie on the same limit
/// surface, which is smooth (C2 but for the corners of the cubes, C1 there) and embedded.
namespace moduli {
namespace {

using Quad = std::array<Index, 4>;

/// A closed mesh of quads, oriented outwards.
struct QuadMesh {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Quad> quads;
};

// The cubes that are there: all of a rectangle but every second one of every second row, until the
// holes are used up.
class HolePattern {
 public:
  explicit HolePattern(Index genus)
      : genus_(genus),
        columns_(static_cast<Index>(std::ceil(std::sqrt(genus)))),
        rows_(genus == 0 ? 0 : (genus + columns_ - 1) / columns_) {}
  Index width() const { return 2 * columns_ + 1; }
  Index height() const { return 2 * rows_ + 1; }
  bool isSolid(Index x, Index y) const {
    if (x < 0 || y < 0 || x >= width() || y >= height()) return false;
    return x % 2 == 0 || y % 2 == 0 || y / 2 * columns_ + x / 2 >= genus_;
  }

 private:
  Index genus_;
  Index columns_;
  Index rows_;
};

QuadMesh cubePlate(const HolePattern& pattern) {
  QuadMesh mesh;
  std::map<std::array<Index, 3>, Index> numbers;
  const auto vertexAt = [&](Index x, Index y, Index z) {
    const auto [place, fresh] =
        numbers.try_emplace({x, y, z}, static_cast<Index>(mesh.vertices.size()));
    if (fresh) mesh.vertices.emplace_back(x, y, z);
    return place->second;
  };
  const auto wall = [&](Index x0, Index y0, Index x1, Index y1) {
    mesh.quads.push_back(
        {vertexAt(x0, y0, 0), vertexAt(x1, y1, 0), vertexAt(x1, y1, 1), vertexAt(x0, y0, 1)});
  };
  for (Index y = 0; y < pattern.height(); ++y) {
    for (Index x = 0; x < pattern.width(); ++x) {
      if (!pattern.isSolid(x, y)) continue;
      mesh.quads.push_back({vertexAt(x, y, 1), vertexAt(x + 1, y, 1), vertexAt(x + 1, y + 1, 1),
                            vertexAt(x, y + 1, 1)});
      mesh.quads.push_back({vertexAt(x, y, 0), vertexAt(x, y + 1, 0), vertexAt(x + 1, y + 1, 0),
                            vertexAt(x + 1, y, 0)});
      if (!pattern.isSolid(x, y - 1)) wall(x, y, x + 1, y);
      if (!pattern.isSolid(x + 1, y)) wall(x + 1, y, x + 1, y + 1);
      if (!pattern.isSolid(x, y + 1)) wall(x + 1, y + 1, x, y + 1);
      if (!pattern.isSolid(x - 1, y)) wall(x, y + 1, x, y);
    }
  }
  return mesh;
}

// Sums over the quads around each vertex. In a closed mesh every neighbour along an edge occurs in
// two quads, once after the vertex and once before it.
struct VertexSums {
  std::vector<Index> valence;
  std::vector<Eigen::Vector3d> neighbours;  ///< Along edges, each once.
  std::vector<Eigen::Vector3d> diagonals;   ///< Across quads.

  explicit VertexSums(const QuadMesh& mesh)
      : valence(mesh.vertices.size(), 0),
        neighbours(mesh.vertices.size(), Eigen::Vector3d::Zero()),
        diagonals(mesh.vertices.size(), Eigen::Vector3d::Zero()) {
    for (const Quad& q : mesh.quads) {
      for (int c = 0; c < 4; ++c) {
        ++valence[q[c]];
        neighbours[q[c]] += mesh.vertices[q[(c + 1) % 4]];
        diagonals[q[c]] += mesh.vertices[q[(c + 2) % 4]];
      }
    }
  }
};

// One Catmull-Clark step. Old vertices keep their numbers; edge points and face points follow.
QuadMesh subdivide(const QuadMesh& mesh) {
  QuadMesh fine;
  const VertexSums sums(mesh);
  fine.vertices.reserve(4 * mesh.vertices.size());
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    // (F + 2 R + (k - 3) P) / k, with the averages F of face points and R of edge midpoints.
    const double k = sums.valence[v];
    const Eigen::Vector3d& p = mesh.vertices[v];
    const Eigen::Vector3d faces = (k * p + 2 * sums.neighbours[v] + sums.diagonals[v]) / (4 * k);
    const Eigen::Vector3d middles = (p + sums.neighbours[v] / k) / 2;
    fine.vertices.emplace_back((faces + 2 * middles + (k - 3) * p) / k);
  }
  std::unordered_map<std::uint64_t, Index> edge_points;
  edge_points.reserve(2 * mesh.quads.size());
  const auto edgePoint = [&](Index a, Index b) -> Index& {
    const auto low = static_cast<std::uint64_t>(std::min(a, b));
    const auto [place, fresh] = edge_points.try_emplace(low << 32U | unsigned(std::max(a, b)),
                                                        static_cast<Index>(fine.vertices.size()));
    if (fresh) fine.vertices.emplace_back((mesh.vertices[a] + mesh.vertices[b]) / 4);
    return place->second;
  };
  std::vector<Quad> edges(mesh.quads.size());
  for (std::size_t f = 0; f < mesh.quads.size(); ++f) {
    for (int c = 0; c < 4; ++c)
      edges[f][c] = edgePoint(mesh.quads[f][c], mesh.quads[f][(c + 1) % 4]);
  }
  for (std::size_t f = 0; f < mesh.quads.size(); ++f) {
    const Quad& q = mesh.quads[f];
    const Quad& e = edges[f];
    const auto centre = static_cast<Index>(fine.vertices.size());
    const Eigen::Vector3d p =
        (mesh.vertices[q[0]] + mesh.vertices[q[1]] + mesh.vertices[q[2]] + mesh.vertices[q[3]]) / 4;
    fine.vertices.push_back(p);
    for (int c = 0; c < 4; ++c) {
      fine.vertices[e[c]] += p / 4;
      fine.quads.push_back({q[c], e[c], centre, e[(c + 3) % 4]});
    }
  }
  return fine;
}

// Where the vertices of a Catmull-Clark mesh end up after infinitely many steps.
std::vector<Eigen::Vector3d> limitPositions(const QuadMesh& mesh) {
  const VertexSums sums(mesh);
  std::vector<Eigen::Vector3d> limit;
  limit.reserve(mesh.vertices.size());
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const double k = sums.valence[v];
    limit.emplace_back((k * k * mesh.vertices[v] + 4 * sums.neighbours[v] + sums.diagonals[v]) /
                       (k * (k + 5)));
  }
  return limit;
}

// Moves each of the first `count` vertices to a random neighbour, or leaves it, on the same
// surface two subdivisions finer: by a quarter of an edge at most.
std::vector<Eigen::Vector3d> movedPositions(const QuadMesh& mesh, SampleRandom& random) {
  const std::size_t count = mesh.vertices.size();
  const QuadMesh fine = subdivide(subdivide(mesh));
  const std::vector<Eigen::Vector3d> limit = limitPositions(fine);
  std::vector<std::vector<Index>> choices(count);
  for (std::size_t v = 0; v < count; ++v) choices[v].push_back(static_cast<Index>(v));
  for (const Quad& q : fine.quads) {
    for (int c = 0; c < 4; ++c) {
      if (static_cast<std::size_t>(q[c]) < count) choices[q[c]].push_back(q[(c + 1) % 4]);
    }
  }
  std::vector<Eigen::Vector3d> positions;
  positions.reserve(count);
  for (const std::vector<Index>& choice : choices) {
    positions.push_back(limit[choice[random.next() % choice.size()]]);
  }
  return positions;
}

}  // namespace

Result<TriangleSoup> makeGenus(const SampleValues& values) {
  constexpr Index kMostGenus = 100;
  constexpr Index kMostSteps = 1024;
  RETURN_IF_ERROR(values.checkCount("genus", 0, kMostGenus));
  RETURN_IF_ERROR(values.checkCount("resolution", 1, kMostSteps));
  QuadMesh mesh = cubePlate(HolePattern(values.count("genus")));
  Index steps = 1;
  while (steps < values.count("resolution")) steps *= 2;
  const bool irregular = values.seed() != 0;
  const double quads = static_cast<double>(mesh.quads.size()) * steps * steps;
  RETURN_IF_ERROR(checkSampleSize(2 * quads * (irregular ? 16 : 1)));

  for (Index done = 1; done < steps; done *= 2) mesh = subdivide(mesh);
  SampleRandom random(values.seed());
  TriangleSoup soup;
  soup.vertices = irregular ? movedPositions(mesh, random) : limitPositions(mesh);
  soup.faces.reserve(2 * mesh.quads.size());
  for (const Quad& q : mesh.quads) appendQuad(soup.faces, q, irregular ? &random : nullptr);
  return soup;
}

}  // namespace moduli
