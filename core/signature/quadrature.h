#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/mesh/connectivity.h"

/// Quadrature of piecewise linear fields over a triangulated canonical domain, the unit sphere or a
/// flat torus, fine enough for functions that vary on the scale of a given length.
namespace moduli {

/// Fields on vertices: one, or two that are transformed together.
using VertexFields = std::vector<std::vector<double>>;

/// Sample points with weights; fields[k][i] is the k-th field at point i.
template <typename Point>
struct Samples {
  std::vector<Point> points;
  std::vector<double> weights;
  VertexFields fields;
};

/// A node that carries no weight says nothing: fields may be undefined where the canonical domain
/// has no area.
template <typename Point>
void addSample(Samples<Point>& samples, const Point& point, double weight,
               const std::array<double, 2>& values) {
  if (!(weight > 0)) return;
  samples.points.push_back(point);
  samples.weights.push_back(weight);
  for (std::size_t k = 0; k < samples.fields.size(); ++k) samples.fields[k].push_back(values[k]);
}

/// Builds samples by the rule of the edge midpoints, exact for quadratic functions on flat
/// triangles. Faces with an edge longer than `fine` are cut into a grid of small ones; edges
/// shorter than fine / 8 hand their weight to their ends, half to each (relative error below
/// (1/8)^2 / 8 for waves of unit length `fine`).
///
/// Domain knows the geometry:
///   Point corner(f, c)                     where a face's corner lies
///   Point blend(p, a, b, c)                p[0] a + p[1] b + p[2] c, on the domain
///   double area(a, b, c), distance(a, b)   of domain points
template <typename Domain>
class Quadrature {
 public:
  using Point = typename Domain::Point;

  Quadrature(const Connectivity& surface, const Domain& domain, const VertexFields& fields,
             double fine)
      : surface_(surface), domain_(domain), fields_(fields), fine_(fine) {
    samples_.fields.resize(fields.size());
  }

  Samples<Point> build() {
    std::vector<double> edge_weight(surface_.edgeCount(), 0.0);
    for (Index f = 0; f < surface_.faceCount(); ++f) {
      const std::array<Point, 3> p = {domain_.corner(f, 0), domain_.corner(f, 1),
                                      domain_.corner(f, 2)};
      const double longest = std::max({domain_.distance(p[0], p[1]), domain_.distance(p[1], p[2]),
                                       domain_.distance(p[2], p[0])});
      if (longest > fine_) {
        addGrid(f, p, static_cast<int>(std::ceil(longest / fine_)));
      } else {
        const double third = domain_.area(p[0], p[1], p[2]) / 3;
        for (Index h = 3 * f; h < 3 * f + 3; ++h) edge_weight[surface_.edge(h)] += third;
      }
    }
    addEdges(edge_weight);
    return std::move(samples_);
  }

 private:
  std::array<double, 2> cornerValues(Index v) const {
    return {fields_[0][v], fields_.size() > 1 ? fields_[1][v] : 0};
  }

  void addEdges(const std::vector<double>& edge_weight) {
    std::vector<double> vertex_weight(surface_.vertexCount(), 0.0);
    for (Index e = 0; e < surface_.edgeCount(); ++e) {
      const Index h = surface_.halfedge(e);
      const Point a = domain_.corner(Connectivity::faceOf(h), h % 3);
      const Point b = domain_.corner(Connectivity::faceOf(h), (h + 1) % 3);
      if (8 * domain_.distance(a, b) < fine_) {
        vertex_weight[surface_.tail(h)] += edge_weight[e] / 2;
        vertex_weight[surface_.head(h)] += edge_weight[e] / 2;
        continue;
      }
      const auto first = cornerValues(surface_.tail(h));
      const auto second = cornerValues(surface_.head(h));
      addSample(samples_, domain_.blend({0.5, 0.5, 0}, a, b, a), edge_weight[e],
                {(first[0] + second[0]) / 2, (first[1] + second[1]) / 2});
    }
    for (Index v = 0; v < surface_.vertexCount(); ++v) {
      const Index h = surface_.outgoing(v);
      addSample(samples_, domain_.corner(Connectivity::faceOf(h), h % 3), vertex_weight[v],
                cornerValues(v));
    }
  }

  /// Cuts a face into n^2 small ones and gives each small edge's midpoint its weight. Grid points
  /// are counted in halves of a small edge: (i, j) is the point (1 - (i + j) / 2n, i / 2n, j / 2n).
  void addGrid(Index f, const std::array<Point, 3>& p, int n) {
    const int side = 2 * n + 1;
    const auto at = [&](int i, int j) {
      const double u = i / (2.0 * n);
      const double v = j / (2.0 * n);
      return domain_.blend({1 - u - v, u, v}, p[0], p[1], p[2]);
    };
    std::vector<double> weight(static_cast<std::size_t>(side) * side, 0.0);
    const auto addSmall = [&](int i0, int j0, int i1, int j1, int i2, int j2) {
      const double third = domain_.area(at(i0, j0), at(i1, j1), at(i2, j2)) / 3;
      weight[(i0 + i1) / 2 * side + (j0 + j1) / 2] += third;
      weight[(i1 + i2) / 2 * side + (j1 + j2) / 2] += third;
      weight[(i2 + i0) / 2 * side + (j2 + j0) / 2] += third;
    };
    for (int i = 0; i < 2 * n; i += 2) {
      for (int j = 0; i + j < 2 * n; j += 2) {
        addSmall(i, j, i + 2, j, i, j + 2);
        if (i + j + 4 <= 2 * n) addSmall(i + 2, j, i + 2, j + 2, i, j + 2);
      }
    }
    const Triangle& face = surface_.face(f);
    const std::array<std::array<double, 2>, 3> value = {
        cornerValues(face[0]), cornerValues(face[1]), cornerValues(face[2])};
    for (int i = 0; i < side; ++i) {
      for (int j = 0; i + j < side; ++j) {
        const double u = i / (2.0 * n);
        const double v = j / (2.0 * n);
        std::array<double, 2> blended{};
        for (int k = 0; k < 2; ++k) {
          blended[k] = (1 - u - v) * value[0][k] + u * value[1][k] + v * value[2][k];
        }
        addSample(samples_, at(i, j), weight[i * side + j], blended);
      }
    }
  }

  const Connectivity& surface_;
  const Domain& domain_;
  const VertexFields& fields_;
  double fine_;
  Samples<Point> samples_;
};

}  // namespace moduli
