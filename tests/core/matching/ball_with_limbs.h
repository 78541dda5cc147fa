#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "core/mesh/samples.h"
#include "core/mesh/triangle_mesh.h"

namespace moduli {

/// A unit ball with straight limbs of about a radius of 0.25, each `ratio` times as long as thick,
/// in five directions; its triangles are nearly equilateral. resolution: as the sample sphere's.
/// The layers of a limb repeat the loop that it starts from.
inline TriangleMesh ballWithLimbs(double resolution, double ratio) {
  TriangleSoup soup = *makeSample("sphere", {{"resolution", resolution}, {"seed", 2}});
  const auto round = static_cast<Index>(soup.vertices.size());
  const double cosine = std::cos(0.25);
  const std::vector<Eigen::Vector3d> directions = {
      {1, 0.1, 0.2}, {-0.5, 0.9, 0}, {-0.4, -0.8, 0.3}, {0.1, 0.2, 1}, {0.2, -0.1, -1}};
  for (const Eigen::Vector3d& along : directions) {
    const Eigen::Vector3d d = along.normalized();
    const auto isInside = [&](Index v) {
      return v < round && soup.vertices[v].normalized().dot(d) > cosine;
    };
    const auto border = std::stable_partition(
        soup.faces.begin(), soup.faces.end(),
        [&](const Triangle& f) { return std::none_of(f.begin(), f.end(), isInside); });
    const std::vector<Triangle> cap(border, soup.faces.end());
    soup.faces.erase(border, soup.faces.end());
    std::map<Index, Index> next;
    for (const Triangle& f : cap) {
      for (int c = 0; c < 3; ++c) next[f[c]] = kNone;
    }
    std::map<std::pair<Index, Index>, int> sides;
    for (const Triangle& f : cap) {
      for (int c = 0; c < 3; ++c) ++sides[{f[c], f[(c + 1) % 3]}];
    }
    for (const auto& [side, count] : sides) {
      if (sides.count({side.second, side.first}) == 0) next[side.first] = side.second;
    }
    std::vector<Index> loop;
    for (const auto& [v, w] : next) {
      if (w == kNone || !loop.empty()) continue;
      for (Index u = v; loop.empty() || u != v; u = next[u]) loop.push_back(u);
    }
    double length = 0;
    for (const Index v : loop) length += (soup.vertices[next[v]] - soup.vertices[v]).norm();
    const double step = std::sqrt(0.75) * length / static_cast<double>(loop.size());
    const int layers = static_cast<int>(std::ceil(ratio * length / (std::acos(-1.0) * step)));
    std::vector<Index> here = loop;
    for (int layer = 1; layer <= layers; ++layer) {
      std::vector<Index> there;
      for (const Index v : here) {
        there.push_back(static_cast<Index>(soup.vertices.size()));
        soup.vertices.push_back(Eigen::Vector3d(soup.vertices[v] + step * d));
      }
      for (std::size_t i = 0; i < here.size(); ++i) {
        const std::size_t j = (i + 1) % here.size();
        const Index a = here[i], b = here[j], c = there[j], e = there[i];
        soup.faces.push_back(layer % 2 == 0 ? Triangle{a, b, c} : Triangle{a, b, e});
        soup.faces.push_back(layer % 2 == 0 ? Triangle{a, c, e} : Triangle{b, c, e});
      }
      here = there;
    }
    std::map<Index, Index> end;
    for (std::size_t i = 0; i < loop.size(); ++i) end[loop[i]] = here[i];
    for (const auto& [v, w] : next) {
      if (end.count(v) != 0) continue;
      soup.vertices[v] += layers * step * d;
      end[v] = v;
    }
    for (const Triangle& f : cap) soup.faces.push_back({end[f[0]], end[f[1]], end[f[2]]});
  }
  return *TriangleMesh::fromSoup(std::move(soup));
}

}  // namespace moduli
