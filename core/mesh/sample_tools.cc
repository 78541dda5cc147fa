#include "core/mesh/sample_tools.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <unordered_map>

#include "core/base/text.h"

namespace moduli {
namespace {

// The vertices on the edges of a subdivided soup, shared by the faces at the edge.
class EdgePoints {
 public:
  EdgePoints(TriangleSoup& soup, Index n) : soup_(soup), n_(n) {}

  // The i-th of n steps from a to b.
  Index at(Index a, Index b, Index i) {
    const Index low = std::min(a, b);
    const Index high = std::max(a, b);
    const auto next = static_cast<Index>(soup_.vertices.size());
    const std::uint64_t key = static_cast<std::uint64_t>(low) << 32U | static_cast<unsigned>(high);
    const auto [place, fresh] = first_.try_emplace(key, next);
    for (Index k = 1; fresh && k < n_; ++k) {
      soup_.vertices.emplace_back(((n_ - k) * soup_.vertices[low] + k * soup_.vertices[high]) / n_);
    }
    return place->second + (a == low ? i : n_ - i) - 1;
  }

 private:
  TriangleSoup& soup_;
  Index n_;
  std::unordered_map<std::uint64_t, Index> first_;
};

double smallestHeight(const TriangleSoup& soup, const Triangle& t) {
  const Eigen::Vector3d u = soup.vertices[t[1]] - soup.vertices[t[0]];
  const Eigen::Vector3d v = soup.vertices[t[2]] - soup.vertices[t[0]];
  const double longest = std::max({u.norm(), v.norm(), (v - u).norm()});
  return u.cross(v).norm() / longest;
}

}  // namespace

std::uint64_t SampleRandom::next() {
  state_ += 0x9E3779B97F4A7C15U;
  std::uint64_t z = state_;
  z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
  z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
  return z ^ (z >> 31U);
}

Eigen::Vector3d SampleRandom::inBall() {
  for (;;) {
    const double x = 2 * uniform() - 1;
    const double y = 2 * uniform() - 1;
    const double z = 2 * uniform() - 1;
    if (x * x + y * y + z * z <= 1) return {x, y, z};
  }
}

Status SampleValues::checkPositive(const std::string& name) const {
  const double value = values_.at(name);
  if (value > 0 && std::isfinite(value)) return {};
  return sampleError(name + " is " + shortestDouble(value) + ", but must be positive and finite");
}

Status SampleValues::checkCount(const std::string& name, Index lowest, Index highest) const {
  const double value = values_.at(name);
  if (value >= lowest && value <= highest && value == std::floor(value)) return {};
  return sampleError(name + " is " + shortestDouble(value) + ", but must be a whole number from " +
                     std::to_string(lowest) + " to " + std::to_string(highest));
}

Status checkSampleSize(double faces) {
  constexpr double kMostFaces = 5e7;
  if (faces <= kMostFaces) return {};
  return sampleError("the sample would have " + shortestDouble(faces) + " faces, more than " +
                         shortestDouble(kMostFaces),
                     "lower the resolution");
}

Status sampleError(const std::string& message, const std::string& hint) {
  return {Reason::kInvalidOption, message, hint};
}

TriangleSoup subdivideFaces(const TriangleSoup& base, Index n) {
  TriangleSoup soup;
  soup.vertices = base.vertices;
  soup.faces.reserve(base.faces.size() * n * n);
  EdgePoints edges(soup, n);
  for (const auto& [a, b, c] : base.faces) {
    if (n == 1) break;
    for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
      edges.at(from, to, 1);
    }
  }
  std::vector<Index> index((n + 1) * (n + 2) / 2);
  for (const auto& [a, b, c] : base.faces) {
    // Row i holds the n - i + 1 points at distance i from side ab.
    const auto slot = [n](Index i, Index j) { return i * (n + 1) - i * (i - 1) / 2 + j; };
    for (Index i = 0; i <= n; ++i) {
      for (Index j = 0; i + j <= n; ++j) {
        const Index k = n - i - j;
        Index& vertex = index[slot(i, j)];
        if (k == n || j == n || i == n) {
          vertex = k == n ? a : j == n ? b : c;
        } else if (i == 0) {
          vertex = edges.at(a, b, j);
        } else if (j == 0) {
          vertex = edges.at(a, c, i);
        } else if (k == 0) {
          vertex = edges.at(b, c, i);
        } else {
          vertex = static_cast<Index>(soup.vertices.size());
          soup.vertices.emplace_back(
              (k * base.vertices[a] + j * base.vertices[b] + i * base.vertices[c]) / n);
        }
      }
    }
    for (Index i = 0; i < n; ++i) {
      for (Index j = 0; i + j < n; ++j) {
        soup.faces.push_back({index[slot(i, j)], index[slot(i, j + 1)], index[slot(i + 1, j)]});
        if (i + j + 1 == n) continue;
        soup.faces.push_back(
            {index[slot(i, j + 1)], index[slot(i + 1, j + 1)], index[slot(i + 1, j)]});
      }
    }
  }
  return soup;
}

void RingStack::add(const std::vector<Eigen::Vector3d>& ring, Index sectors) {
  const auto start = static_cast<Index>(soup_.vertices.size());
  const auto size = static_cast<Index>(ring.size());
  soup_.vertices.insert(soup_.vertices.end(), ring.begin(), ring.end());
  if (last_start_ != kNone) connect(last_start_, last_size_, start, size, sectors);
  last_start_ = start;
  last_size_ = size;
}

void RingStack::close() {
  connectEqual(last_start_, 0, last_size_);
}

void RingStack::connect(Index a, Index a_size, Index b, Index b_size, Index sectors) {
  if (a_size == b_size) return connectEqual(a, b, a_size);
  // In each sector the longer side has one step more than the shorter one.
  const bool growing = a_size < b_size;
  const Index steps = std::max(a_size, b_size) / sectors;
  const Index shorter = growing ? a : b;
  const Index longer = growing ? b : a;
  const Index short_size = std::min(a_size, b_size);
  const Index long_size = std::max(a_size, b_size);
  for (Index k = 0; k < sectors; ++k) {
    const auto at_short = [&](Index i) { return shorter + (k * (steps - 1) + i) % short_size; };
    const auto at_long = [&](Index i) { return longer + (k * steps + i) % long_size; };
    for (Index i = 0; i < steps; ++i) {
      Triangle t = {at_short(i), at_long(i), at_long(i + 1)};
      if (!growing) std::swap(t[1], t[2]);
      soup_.faces.push_back(t);
      if (i + 1 == steps) continue;
      t = {at_short(i), at_long(i + 1), at_short(i + 1)};
      if (!growing) std::swap(t[1], t[2]);
      soup_.faces.push_back(t);
    }
  }
}

void RingStack::connectEqual(Index a, Index b, Index size) {
  for (Index i = 0; i < size; ++i) {
    const Index next = (i + 1) % size;
    appendQuad(soup_.faces, {a + i, b + i, b + next, a + next}, random_);
  }
}

std::vector<Eigen::Vector3d> circleRing(double radius, double z, Index count) {
  std::vector<Eigen::Vector3d> ring;
  ring.reserve(count);
  for (Index i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * i / count;
    ring.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
  }
  return ring;
}

void appendQuad(std::vector<Triangle>& faces, const std::array<Index, 4>& quad,
                SampleRandom* random) {
  const auto& [a, b, c, d] = quad;
  if (random != nullptr && (random->next() >> 63U) != 0) {
    faces.push_back({a, b, d});
    faces.push_back({b, c, d});
  } else {
    faces.push_back({a, b, c});
    faces.push_back({a, c, d});
  }
}

void moveVertices(TriangleSoup& soup, SampleRandom& random,
                  const std::function<Eigen::Vector3d(Index, const Eigen::Vector3d&)>& project) {
  std::vector<double> room(soup.vertices.size(), std::numeric_limits<double>::infinity());
  for (const Triangle& t : soup.faces) {
    const double height = smallestHeight(soup, t);
    for (const Index v : t) room[v] = std::min(room[v], height);
  }
  for (std::size_t v = 0; v < soup.vertices.size(); ++v) {
    const Eigen::Vector3d moved = soup.vertices[v] + 0.25 * room[v] * random.inBall();
    soup.vertices[v] = project(static_cast<Index>(v), moved);
  }
}

double signedVolume6(const TriangleSoup& soup) {
  double sum = 0;
  const Eigen::Vector3d origin = soup.vertices.front();
  for (const Triangle& t : soup.faces) {
    const Eigen::Vector3d a = soup.vertices[t[0]] - origin;
    const Eigen::Vector3d b = soup.vertices[t[1]] - origin;
    sum += a.dot(b.cross(soup.vertices[t[2]] - origin));
  }
  return sum;
}

}  // namespace moduli
