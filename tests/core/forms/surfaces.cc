#include "tests/core/forms/surfaces.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

namespace moduli {
namespace {

constexpr double kPi = std::numbers::pi;

/// Faces, gluing and lengths by halfedge: the form in which triangulations are changed.
struct Gluing {
  std::vector<Triangle> faces;
  std::vector<Index> twin;
  std::vector<double> length;

  void glue(Index a, Index b) {
    twin[a] = b;
    if (b != kNone) twin[b] = a;
  }
};

Gluing unglue(const MetricSurface& given) {
  Gluing result;
  result.faces = given.surface.faces();
  for (Index h = 0; h < given.surface.halfedgeCount(); ++h) {
    result.twin.push_back(given.surface.twin(h));
    result.length.push_back(given.lengths[given.surface.edge(h)]);
  }
  return result;
}

}  // namespace

MetricSurface fromPositions(const std::vector<Eigen::Vector3d>& positions,
                            std::vector<Triangle> faces) {
  auto surface = Connectivity::fromFaces(static_cast<Index>(positions.size()), std::move(faces));
  std::vector<double> lengths(surface->edgeCount());
  for (Index e = 0; e < surface->edgeCount(); ++e) {
    const Index h = surface->halfedge(e);
    lengths[e] = (positions[surface->head(h)] - positions[surface->tail(h)]).norm();
  }
  return {*std::move(surface), std::move(lengths)};
}

MetricSurface fromHalfedges(Index vertex_count, std::vector<Triangle> faces,
                            std::vector<Index> twin, const std::vector<double>& halfedge_lengths) {
  auto surface = Connectivity::fromGluing(vertex_count, std::move(faces), std::move(twin));
  std::vector<double> lengths(surface->edgeCount());
  for (Index e = 0; e < surface->edgeCount(); ++e) {
    lengths[e] = halfedge_lengths[surface->halfedge(e)];
  }
  return {*std::move(surface), std::move(lengths)};
}

MetricSurface torusOfRevolution(double R, double r, int m, int n) {
  std::vector<Eigen::Vector3d> positions;
  std::vector<Triangle> faces;
  const auto id = [&](int i, int j) { return (i % m) * n + j % n; };
  for (int i = 0; i < m; ++i) {
    for (int j = 0; j < n; ++j) {
      const double u = 2 * kPi * i / m;
      const double v = 2 * kPi * j / n;
      const double rho = R + r * std::cos(v);
      positions.emplace_back(rho * std::cos(u), rho * std::sin(u), r * std::sin(v));
      faces.push_back({id(i, j), id(i + 1, j), id(i + 1, j + 1)});
      faces.push_back({id(i, j), id(i + 1, j + 1), id(i, j + 1)});
    }
  }
  return fromPositions(positions, std::move(faces));
}

MetricSurface diplotorus(int n, double phi, double h, int s, int s2) {
  std::vector<Eigen::Vector3d> positions;
  for (int k = 0; k < n; ++k) {
    positions.emplace_back(std::cos(2 * kPi * k / n), std::sin(2 * kPi * k / n), 0);
  }
  for (int k = 0; k < n; ++k) {
    positions.emplace_back(std::cos(2 * kPi * k / n + phi), std::sin(2 * kPi * k / n + phi), h);
  }
  const auto b = [&](int k) { return k % n; };
  const auto t = [&](int k) { return n + (k + 2 * n) % n; };
  std::vector<Triangle> faces;
  for (int k = 0; k < n; ++k) {
    faces.push_back({b(k), b(k + 1), t(k + s)});
    faces.push_back({t(k + s), b(k + 1), t(k + s + 1)});
    faces.push_back({b(k + 1), b(k), t(k + s2)});
    faces.push_back({b(k + 1), t(k + s2), t(k + s2 + 1)});
  }
  return fromPositions(positions, std::move(faces));
}

std::complex<double> diplotorusTau(int n, double phi, double h, int s, int s2) {
  const double a = 2 * std::sin(kPi / n);
  const auto foot = [&](int k) {
    const double l1 = 2 - 2 * std::cos(2 * kPi * k / n + phi) + h * h;
    const double l2 = 2 - 2 * std::cos(2 * kPi * (k - 1) / n + phi) + h * h;
    const double x = (l1 - l2 + a * a) / (2 * a);
    return std::pair(x, std::sqrt(l1 - x * x));
  };
  const auto [x, height] = foot(s);
  const auto [x2, height2] = foot(s2);
  return std::complex<double>((s2 - s) * a + x - x2, height + height2) / (n * a);
}

MetricSurface flatTorus(std::complex<double> tau, int n, int m, double jitter, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<std::complex<double>> offset(n * m);
  for (auto& place : offset) {
    const double x = (2 * uniform(random) - 1) * jitter / n;
    const double y = (2 * uniform(random) - 1) * jitter / m;
    place = x + y * tau;
  }
  const auto vertex = [&](int i, int j) { return (i % n) * m + j % m; };
  const auto place = [&](int i, int j) {
    return static_cast<double>(i) / n + static_cast<double>(j) / m * tau + offset[vertex(i, j)];
  };
  Gluing g;
  g.twin.assign(6 * n * m, kNone);
  std::vector<std::array<Index, 4>> sides(n * m);  // Bottom, right, top, left of each cell.
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < m; ++j) {
      const std::array<std::array<int, 2>, 4> p{{{i, j}, {i + 1, j}, {i + 1, j + 1}, {i, j + 1}}};
      const bool rising = random() % 2 == 0;
      const std::array<std::array<int, 3>, 2> corners =
          rising ? std::array<std::array<int, 3>, 2>{{{0, 1, 2}, {0, 2, 3}}}
                 : std::array<std::array<int, 3>, 2>{{{0, 1, 3}, {1, 2, 3}}};
      const Index h = 3 * static_cast<Index>(g.faces.size());
      for (const auto& c : corners) {
        g.faces.push_back({vertex(p[c[0]][0], p[c[0]][1]), vertex(p[c[1]][0], p[c[1]][1]),
                           vertex(p[c[2]][0], p[c[2]][1])});
        for (int k = 0; k < 3; ++k) {
          const auto& from = p[c[k]];
          const auto& to = p[c[(k + 1) % 3]];
          g.length.push_back(std::abs(place(to[0], to[1]) - place(from[0], from[1])));
        }
      }
      g.glue(rising ? h + 2 : h + 1, rising ? h + 3 : h + 5);
      sides[vertex(i, j)] = rising ? std::array<Index, 4>{h, h + 1, h + 4, h + 5}
                                   : std::array<Index, 4>{h, h + 3, h + 4, h + 2};
    }
  }
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < m; ++j) {
      for (const auto& [mine, next, theirs] :
           {std::array<Index, 3>{1, vertex(i + 1, j), 3}, {2, vertex(i, j + 1), 0}}) {
        const Index a = sides[vertex(i, j)][mine];
        const Index b = sides[next][theirs];
        g.glue(a, b);
        g.length[a] = g.length[b];  // Both round alike, whatever the place of the cell.
      }
    }
  }
  return fromHalfedges(n * m, std::move(g.faces), std::move(g.twin), g.length);
}

MetricSurface disphenoidCover(double a, double b, double c) {
  const auto base = Connectivity::fromFaces(4, {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}});
  // Opposite edges of the tetrahedron are equal: 01 and 23 are a, 12 and 03 are b, 02 and 13 are c.
  const auto kind = [&](Index h) {
    const Index v = std::min(base->tail(h), base->head(h));
    const Index w = std::max(base->tail(h), base->head(h));
    return w - v == 2 ? 2 : (v == 0 && w == 1) || (v == 2 && w == 3) ? 0 : 1;
  };
  Gluing g;
  g.twin.assign(24, kNone);
  for (Index sheet = 0; sheet < 2; ++sheet) {
    for (Index h = 0; h < 12; ++h) {
      // The sheets are exchanged across the edges of kind 0: one at each vertex, so that a turn
      // around a vertex leads to the other sheet.
      const Index other = kind(h) == 0 ? 1 - sheet : sheet;
      g.twin[12 * sheet + h] = 12 * other + base->twin(h);
      g.length.push_back(std::array{a, b, c}[kind(h)]);
    }
    g.faces.insert(g.faces.end(), base->faces().begin(), base->faces().end());
  }
  return fromHalfedges(4, std::move(g.faces), std::move(g.twin), g.length);
}

MetricSurface subdivide(const MetricSurface& coarse, int n) {
  const Connectivity& surface = coarse.surface;
  const Index edge_start = surface.vertexCount();
  const Index face_start = edge_start + surface.edgeCount() * (n - 1);
  const Index inside = (n - 1) * (n - 2) / 2;
  // The k-th point along a halfedge, and a point of face f by its steps towards corners 1 and 2.
  const auto onSide = [&](Index h, int k) {
    if (k == 0) return surface.tail(h);
    if (k == n) return surface.head(h);
    const int along = surface.sign(h) > 0 ? k : n - k;
    return edge_start + surface.edge(h) * (n - 1) + along - 1;
  };
  const auto point = [&](Index f, int i, int j) {
    if (j == 0) return onSide(3 * f, i);
    if (i + j == n) return onSide(3 * f + 1, j);
    if (i == 0) return onSide(3 * f + 2, n - j);
    return face_start + f * inside + (j - 1) * (n - 1) - (j - 1) * j / 2 + i - 1;
  };
  // Faces of f: for each row j the upright triangles, each followed by the hanging one next to it.
  const auto upright = [&](Index f, int i, int j) { return f * n * n + j * (2 * n - j) + 2 * i; };
  const auto hanging = [&](Index f, int i, int j) { return upright(f, i, j) + 1; };
  const auto sideHalfedge = [&](Index h, int k) {
    const Index f = h / 3;
    if (h % 3 == 0) return 3 * upright(f, k, 0);
    if (h % 3 == 1) return 3 * upright(f, n - 1 - k, k) + 1;
    return 3 * upright(f, 0, n - 1 - k) + 2;
  };
  Gluing g;
  g.faces.resize(surface.faceCount() * n * n);
  g.twin.assign(3 * g.faces.size(), kNone);
  g.length.resize(3 * g.faces.size());
  for (Index f = 0; f < surface.faceCount(); ++f) {
    std::array<double, 3> side{};
    for (Index c = 0; c < 3; ++c) side[c] = coarse.lengths[surface.edge(3 * f + c)] / n;
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i + j < n; ++i) {
        const Index up = upright(f, i, j);
        g.faces[up] = {point(f, i, j), point(f, i + 1, j), point(f, i, j + 1)};
        for (int c = 0; c < 3; ++c) g.length[3 * up + c] = side[c];
        if (i + j == n - 1) continue;
        const Index down = hanging(f, i, j);
        g.faces[down] = {point(f, i + 1, j), point(f, i + 1, j + 1), point(f, i, j + 1)};
        for (int c = 0; c < 3; ++c) g.length[3 * down + c] = side[(c + 2) % 3];
        g.glue(3 * down, 3 * upright(f, i + 1, j) + 2);
        g.glue(3 * down + 1, 3 * upright(f, i, j + 1));
        g.glue(3 * down + 2, 3 * up + 1);
      }
    }
    for (Index h = 3 * f; h < 3 * f + 3; ++h) {
      if (surface.twin(h) == kNone) continue;
      for (int k = 0; k < n; ++k) {
        g.twin[sideHalfedge(h, k)] = sideHalfedge(surface.twin(h), n - 1 - k);
      }
    }
  }
  return fromHalfedges(face_start + surface.faceCount() * inside, std::move(g.faces),
                       std::move(g.twin), g.length);
}

namespace {

using Weights = std::array<double, 3>;

/// Puts vertices into the faces that `pick` names, at the barycentric coordinates that `choose`
/// draws. Each time the face keeps its number and two more are added.
template <typename Pick, typename Choose>
MetricSurface insertAt(const MetricSurface& coarse, int count, const Pick& pick,
                       const Choose& choose) {
  Gluing g = unglue(coarse);
  Index vertices = coarse.surface.vertexCount();
  for (int step = 0; step < count; ++step) {
    const Index f = pick(step, static_cast<Index>(g.faces.size()));
    const double a = g.length[3 * f];
    const double b = g.length[3 * f + 1];
    const double c = g.length[3 * f + 2];
    const std::complex<double> apex_of = [&] {
      const double x = (a * a + c * c - b * b) / (2 * a);
      return std::complex<double>(x, std::sqrt(std::max(0.0, c * c - x * x)));
    }();
    const std::array<std::complex<double>, 3> corner{0.0, a, apex_of};
    const Weights weight = choose();
    const std::complex<double> place =
        weight[0] * corner[0] + weight[1] * corner[1] + weight[2] * corner[2];
    const std::array<double, 3> to{std::abs(place - corner[0]), std::abs(place - corner[1]),
                                   std::abs(place - corner[2])};
    const Triangle old = g.faces[f];
    const std::array<Index, 3> outside{g.twin[3 * f], g.twin[3 * f + 1], g.twin[3 * f + 2]};
    const std::array<double, 3> side{a, b, c};
    const auto end = static_cast<Index>(g.faces.size());
    const std::array<Index, 3> fan{f, end, end + 1};
    g.faces.resize(g.faces.size() + 2);
    g.twin.resize(3 * g.faces.size(), kNone);
    g.length.resize(3 * g.faces.size());
    for (int k = 0; k < 3; ++k) {
      const Index h = 3 * fan[k];
      g.faces[fan[k]] = {old[k], old[(k + 1) % 3], vertices};
      g.length[h] = side[k];
      g.length[h + 1] = to[(k + 1) % 3];
      g.length[h + 2] = to[k];
      g.glue(h + 1, 3 * fan[(k + 1) % 3] + 2);
    }
    for (int k = 0; k < 3; ++k) {
      // A side may be glued to another side of the same face.
      if (outside[k] != kNone && outside[k] / 3 == f) {
        g.twin[3 * fan[k]] = 3 * fan[outside[k] % 3];
      } else {
        g.glue(3 * fan[k], outside[k]);
      }
    }
    ++vertices;
  }
  return fromHalfedges(vertices, std::move(g.faces), std::move(g.twin), g.length);
}

}  // namespace

MetricSurface insertVertices(const MetricSurface& coarse, int count, double margin, unsigned seed) {
  std::mt19937 random(seed);
  const auto pick = [&](int, Index faces) { return static_cast<Index>(random() % faces); };
  return insertAt(coarse, count, pick, [&] {
    const double r = std::sqrt(uniform(random));
    const double t = uniform(random);
    const double free = 1 - 3 * margin;
    return Weights{margin + free * (1 - r), margin + free * r * (1 - t), margin + free * r * t};
  });
}

MetricSurface insertNearEdges(const MetricSurface& coarse, double height, unsigned seed) {
  std::mt19937 random(seed);
  const auto pick = [](int step, Index) { return static_cast<Index>(step); };
  return insertAt(coarse, coarse.surface.faceCount(), pick, [&] {
    const double t = 0.2 + 0.6 * uniform(random);
    return Weights{(1 - height) * (1 - t), (1 - height) * t, height};
  });
}

MetricSurface insertNearCorners(const MetricSurface& coarse, double distance, unsigned seed) {
  std::mt19937 random(seed);
  const auto pick = [](int step, Index) { return static_cast<Index>(step); };
  return insertAt(coarse, coarse.surface.faceCount(), pick, [&] {
    const double t = 0.2 + 0.6 * uniform(random);
    return Weights{1 - distance, distance * (1 - t), distance * t};
  });
}

MetricSurface flipEdges(const MetricSurface& given, int count, unsigned seed) {
  std::mt19937 random(seed);
  Gluing g = unglue(given);
  for (int step = 0; step < count; ++step) {
    // h = a -> b of face abc and its twin of face bad become the diagonal of adbc between d and c.
    const auto h = static_cast<Index>(random() % g.twin.size());
    const Index t = g.twin[h];
    if (t == kNone || t / 3 == h / 3) continue;
    const Index bc = Connectivity::next(h);
    const Index ca = Connectivity::previous(h);
    const Index ad = Connectivity::next(t);
    const Index db = Connectivity::previous(t);
    const double base = g.length[h];
    const auto apex = [&](double left, double right) {
      const double x = (base * base + left * left - right * right) / (2 * base);
      return std::complex<double>(x, std::sqrt(std::max(0.0, left * left - x * x)));
    };
    const std::complex<double> c = apex(g.length[ca], g.length[bc]);
    const std::complex<double> d = std::conj(apex(g.length[ad], g.length[db]));
    const std::complex<double> diagonal = c - d;
    const double spare = 0.05 * base * std::abs(diagonal);
    if ((std::conj(diagonal) * -d).imag() < spare) continue;
    if ((std::conj(diagonal) * (base - d)).imag() > -spare) continue;

    const Index f = h / 3;
    const Index k = t / 3;
    const auto corner = [&](Index e) { return g.faces[e / 3][e % 3]; };
    const Triangle first{corner(h), corner(db), corner(ca)};
    const Triangle second{corner(db), corner(t), corner(ca)};
    const std::array<Index, 4> old{ad, ca, db, bc};
    const std::array<Index, 4> place{3 * f, 3 * f + 2, 3 * k, 3 * k + 1};
    std::array<Index, 4> outside{};
    std::array<double, 4> length{};
    for (int i = 0; i < 4; ++i) {
      outside[i] = g.twin[old[i]];
      length[i] = g.length[old[i]];
      for (int j = 0; j < 4; ++j) {
        if (g.twin[old[i]] == old[j]) outside[i] = place[j];
      }
    }
    g.faces[f] = first;
    g.faces[k] = second;
    for (int i = 0; i < 4; ++i) {
      g.glue(place[i], outside[i]);
      g.length[place[i]] = length[i];
    }
    g.glue(3 * f + 1, 3 * k + 2);
    g.length[3 * f + 1] = g.length[3 * k + 2] = std::abs(diagonal);
  }
  return fromHalfedges(given.surface.vertexCount(), std::move(g.faces), std::move(g.twin),
                       g.length);
}

MetricSurface renumber(const MetricSurface& given, unsigned seed) {
  std::mt19937 random(seed);
  const auto permutation = [&](Index size) {
    std::vector<Index> result(size);
    std::iota(result.begin(), result.end(), 0);
    for (Index k = size - 1; k > 0; --k) {
      std::swap(result[k], result[static_cast<Index>(random() % (k + 1))]);
    }
    return result;
  };
  const std::vector<Index> vertex = permutation(given.surface.vertexCount());
  const std::vector<Index> face = permutation(given.surface.faceCount());
  std::vector<Index> image(given.surface.halfedgeCount());
  for (Index f = 0; f < given.surface.faceCount(); ++f) {
    const auto turn = static_cast<Index>(random() % 3);
    for (Index c = 0; c < 3; ++c) image[3 * f + c] = 3 * face[f] + (c + turn) % 3;
  }
  Gluing g;
  g.faces.resize(given.surface.faceCount());
  g.twin.assign(image.size(), kNone);
  g.length.resize(image.size());
  for (Index h = 0; h < given.surface.halfedgeCount(); ++h) {
    g.faces[image[h] / 3][image[h] % 3] = vertex[given.surface.tail(h)];
    if (given.surface.twin(h) != kNone) g.twin[image[h]] = image[given.surface.twin(h)];
    g.length[image[h]] = given.lengths[given.surface.edge(h)];
  }
  return fromHalfedges(given.surface.vertexCount(), std::move(g.faces), std::move(g.twin),
                       g.length);
}

MetricSurface mirror(const MetricSurface& given) {
  // Corner c of a face becomes corner 2 - c; the side c -> c + 1 becomes 1 - c -> 2 - c.
  const auto image = [](Index h) { return h - h % 3 + (4 - h % 3) % 3; };
  Gluing g;
  g.twin.assign(given.surface.halfedgeCount(), kNone);
  g.length.resize(given.surface.halfedgeCount());
  for (const Triangle& face : given.surface.faces()) g.faces.push_back({face[2], face[1], face[0]});
  for (Index h = 0; h < given.surface.halfedgeCount(); ++h) {
    if (given.surface.twin(h) != kNone) g.twin[image(h)] = image(given.surface.twin(h));
    g.length[image(h)] = given.lengths[given.surface.edge(h)];
  }
  return fromHalfedges(given.surface.vertexCount(), std::move(g.faces), std::move(g.twin),
                       g.length);
}

MetricSurface scale(MetricSurface given, double factor) {
  for (double& length : given.lengths) length *= factor;
  return given;
}

}  // namespace moduli
