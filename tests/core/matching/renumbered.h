#pragma once

#include <Eigen/Geometry>
#include <numeric>
#include <utility>
#include <vector>

#include "core/mesh/sample_tools.h"
#include "core/mesh/triangle_soup.h"

namespace moduli {

/// A surface with its vertices and faces in another order; per old vertex its new number.
struct Renumbered {
  TriangleSoup soup;
  std::vector<Index> image;
};

inline std::vector<Index> shuffled(std::size_t count, SampleRandom& random) {
  std::vector<Index> order(count);
  std::iota(order.begin(), order.end(), 0);
  for (std::size_t i = count; i > 1; --i) std::swap(order[i - 1], order[random.next() % i]);
  return order;
}

inline Renumbered renumbered(const TriangleSoup& soup, std::uint64_t seed) {
  SampleRandom random(seed);
  Renumbered result;
  result.image = shuffled(soup.vertices.size(), random);
  result.soup.vertices.resize(soup.vertices.size());
  for (std::size_t v = 0; v < soup.vertices.size(); ++v) {
    result.soup.vertices[result.image[v]] = soup.vertices[v];
  }
  for (const Index f : shuffled(soup.faces.size(), random)) {
    const Triangle& face = soup.faces[f];
    const auto first = random.next() % 3;
    Triangle turned;
    for (std::size_t c = 0; c < 3; ++c) turned[c] = result.image[face[(c + first) % 3]];
    result.soup.faces.push_back(turned);
  }
  return result;
}

/// Turned, doubled in size and moved.
inline TriangleSoup moved(TriangleSoup soup) {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  for (Eigen::Vector3d& p : soup.vertices) p = 2 * (turn * p) + Eigen::Vector3d(5, -3, 1);
  return soup;
}

/// In a mirror, oriented outwards again.
inline TriangleSoup mirrored(TriangleSoup soup) {
  for (Eigen::Vector3d& p : soup.vertices) p[0] = -p[0];
  for (Triangle& face : soup.faces) std::swap(face[1], face[2]);
  return soup;
}

}  // namespace moduli
