#include "core/mesh/samples.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <set>

#include "core/mesh/sample_tools.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

using Parameters = std::map<std::string, double>;

TriangleSoup sample(const std::string& kind, const Parameters& parameters) {
  auto soup = makeSample(kind, parameters);
  EXPECT_OK(soup);
  return soup.ok() ? *soup : TriangleSoup();
}

// Counted from the faces alone.
struct Counts {
  bool oriented_manifold = true;  // Every directed edge once.
  std::size_t border_edges = 0;
  std::ptrdiff_t euler = 0;
  std::size_t unused_vertices = 0;
};

Counts count(const TriangleSoup& soup) {
  Counts counts;
  std::set<std::pair<Index, Index>> directed;
  std::set<Index> used;
  for (const Triangle& t : soup.faces) {
    for (int c = 0; c < 3; ++c) {
      counts.oriented_manifold &= directed.insert({t[c], t[(c + 1) % 3]}).second;
      used.insert(t[c]);
    }
  }
  for (const auto& [a, b] : directed) counts.border_edges += directed.contains({b, a}) ? 0 : 1;
  const auto edges = (directed.size() + counts.border_edges) / 2;
  counts.euler = static_cast<std::ptrdiff_t>(soup.vertices.size() + soup.faces.size()) -
                 static_cast<std::ptrdiff_t>(edges);
  counts.unused_vertices = soup.vertices.size() - used.size();
  return counts;
}

double volume(const TriangleSoup& soup) {
  double sum = 0;
  for (const Triangle& t : soup.faces) {
    sum += soup.vertices[t[0]].dot(soup.vertices[t[1]].cross(soup.vertices[t[2]])) / 6;
  }
  return sum;
}

Eigen::Vector3d normalOf(const TriangleSoup& soup, const Triangle& t) {
  return (soup.vertices[t[1]] - soup.vertices[t[0]])
      .cross(soup.vertices[t[2]] - soup.vertices[t[0]]);
}

void expectClosed(const TriangleSoup& soup, std::ptrdiff_t euler) {
  const Counts counts = count(soup);
  EXPECT_TRUE(counts.oriented_manifold);
  EXPECT_EQ(counts.border_edges, 0U);
  EXPECT_EQ(counts.euler, euler);
  EXPECT_EQ(counts.unused_vertices, 0U);
  EXPECT_GT(volume(soup), 0);
}

void expectOnSurface(const TriangleSoup& soup,
                     const std::function<double(const Eigen::Vector3d&)>& distance) {
  // Some roundings of unit-sized coordinates.
  for (const Eigen::Vector3d& p : soup.vertices) ASSERT_LE(std::abs(distance(p)), 1e-14) << p;
}

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

constexpr double kSeeds[] = {0, 1, 2};

TEST(Samples, RoundSurfacesAreClosedAndLieOnTheirEquations) {
  for (const double seed : kSeeds) {
    for (const double n : {1.0, 2.0, 7.0}) {
      const Parameters common = {{"resolution", n}, {"seed", seed}};
      const auto with = [&](Parameters more) {
        more.insert(common.begin(), common.end());
        return more;
      };
      const TriangleSoup sphere = sample("sphere", with({{"radius", 2}}));
      EXPECT_EQ(sphere.vertices.size(), static_cast<std::size_t>(10 * n * n + 2));
      expectClosed(sphere, 2);
      expectOnSurface(sphere, [](const auto& p) { return p.norm() / 2 - 1; });
      const TriangleSoup ellipsoid = sample("ellipsoid", with({{"a", 1}, {"b", 2}, {"c", 3}}));
      expectClosed(ellipsoid, 2);
      expectOnSurface(ellipsoid, [](const auto& p) {
        return p.cwiseQuotient(Eigen::Vector3d(1, 2, 3)).norm() - 1;
      });
      const TriangleSoup spheroid = sample("spheroid", with({{"a", 1}, {"c", 2}}));
      expectClosed(spheroid, 2);
      expectOnSurface(spheroid, [](const auto& p) {
        return p.cwiseQuotient(Eigen::Vector3d(1, 1, 2)).norm() - 1;
      });
      const TriangleSoup capsule =
          sample("capped-cylinder", with({{"radius", 0.5}, {"half_length", 2}}));
      expectClosed(capsule, 2);
      expectOnSurface(capsule, [](const Eigen::Vector3d& p) {
        return (p - Eigen::Vector3d(0, 0, std::clamp(p.z(), -2.0, 2.0))).norm() - 0.5;
      });
    }
  }
}

TEST(Samples, TorusIsAGridOnItsEquation) {
  for (const double seed : kSeeds) {
    const TriangleSoup torus = sample("torus", {{"resolution", 12}, {"seed", seed}});
    EXPECT_EQ(torus.vertices.size(), 24U * 12);
    expectClosed(torus, 0);
    expectOnSurface(torus, [](const Eigen::Vector3d& p) {
      return std::hypot(std::hypot(p.x(), p.y()) - 2, p.z()) - 1;
    });
  }
  EXPECT_EQ(sample("torus", {{"rings", 6}, {"sides", 4}}).faces.size(), 48U);
  const TriangleSoup torus = sample("torus", {{"rings", 6}, {"sides", 4}});
  EXPECT_EQ(torus.faces[0], (Triangle{0, 4, 5}));
  EXPECT_EQ(torus.faces[1], (Triangle{0, 5, 1}));
}

TEST(Samples, DiplotorusIsFlatAtEveryVertex) {
  const Parameters shapes[] = {
      {}, {{"h", 1}}, {{"n", 7}, {"phi", 0.3}, {"h", 1}, {"s", 0}, {"s2", 3}}, {{"resolution", 5}}};
  for (const Parameters& parameters : shapes) {
    const TriangleSoup soup = sample("diplotorus", parameters);
    expectClosed(soup, 0);
    std::vector<double> angle(soup.vertices.size(), 0);
    for (const Triangle& t : soup.faces) {
      for (int c = 0; c < 3; ++c) {
        const Eigen::Vector3d u = soup.vertices[t[(c + 1) % 3]] - soup.vertices[t[c]];
        const Eigen::Vector3d v = soup.vertices[t[(c + 2) % 3]] - soup.vertices[t[c]];
        angle[t[c]] += std::atan2(u.cross(v).norm(), u.dot(v));
      }
    }
    // Six angles, each good to a few roundings over edges of a fifth of a unit.
    for (const double a : angle) EXPECT_NEAR(a, 2 * std::numbers::pi, 1e-13);
  }
}

TEST(Samples, GenusHasSoManyHandles) {
  for (const double seed : kSeeds) {
    for (const double genus : {0.0, 1.0, 2.0, 3.0, 5.0, 10.0, 100.0}) {
      const TriangleSoup soup =
          sample("genus", {{"genus", genus}, {"resolution", genus == 100 ? 2 : 4}, {"seed", seed}});
      expectClosed(soup, 2 - 2 * static_cast<std::ptrdiff_t>(genus));
    }
  }
}

TEST(Samples, GenusVerticesLieOnOneSurfaceWhateverTheResolution) {
  // Old vertices keep their numbers: the coarse ones are among the fine ones.
  const TriangleSoup coarse = sample("genus", {{"genus", 3}, {"resolution", 2}});
  const TriangleSoup fine = sample("genus", {{"genus", 3}, {"resolution", 16}});
  for (std::size_t v = 0; v < coarse.vertices.size(); ++v) {
    EXPECT_LE((coarse.vertices[v] - fine.vertices[v]).norm(), 1e-14);
  }
  // And the irregular ones are vertices of the mesh that is two steps finer.
  const TriangleSoup moved = sample("genus", {{"genus", 3}, {"resolution", 4}, {"seed", 9}});
  std::size_t strays = 0;
  std::size_t unmoved = 0;
  for (std::size_t v = 0; v < moved.vertices.size(); ++v) {
    const auto near = [&](const Eigen::Vector3d& p) {
      return (p - moved.vertices[v]).norm() <= 1e-14;
    };
    strays += std::ranges::any_of(fine.vertices, near) ? 0 : 1;
    unmoved += near(fine.vertices[v]) ? 1 : 0;
  }
  EXPECT_EQ(strays, 0U);
  EXPECT_LT(unmoved, moved.vertices.size() / 2);
}

void expectFlat(const TriangleSoup& soup, std::ptrdiff_t euler, double area) {
  const Counts counts = count(soup);
  EXPECT_TRUE(counts.oriented_manifold);
  EXPECT_EQ(counts.euler, euler);
  EXPECT_EQ(counts.unused_vertices, 0U);
  double sum = 0;
  for (const Triangle& t : soup.faces) {
    EXPECT_GT(normalOf(soup, t).z(), 0);  // Upwards, so that nothing is folded.
    sum += normalOf(soup, t).z() / 2;
  }
  for (const Eigen::Vector3d& p : soup.vertices) EXPECT_EQ(p.z(), 0);
  // Thousands of areas, each good to a few roundings.
  if (area > 0) {
    EXPECT_NEAR(sum, area, 1e-12 * area);
  }
}

TEST(Samples, FlatSurfacesHaveTheirHolesAndArea) {
  for (const double seed : kSeeds) {
    const TriangleSoup disk = sample("disk", {{"resolution", 9}, {"seed", seed}});
    expectFlat(disk, 1, 0);
    EXPECT_EQ(count(disk).border_edges, 54U);
    const TriangleSoup annulus =
        sample("annulus", {{"r", 0.2}, {"R", 1}, {"resolution", 5}, {"seed", seed}});
    expectFlat(annulus, 0, 0);
    for (const auto& p : annulus.vertices)
      EXPECT_TRUE(p.norm() >= 0.2 * (1 - 1e-15) && p.norm() <= 1 + 1e-15);
    expectFlat(sample("plate", {{"resolution", 4}, {"seed", seed}}), 0, 12);
    expectFlat(sample("plate", {{"holes", 0}, {"cells_x", 3}, {"cells_y", 2}, {"seed", seed}}), 1,
               6);
    expectFlat(sample("plate", {{"holes", 2},
                                {"hole_width", 1},
                                {"hole_height", 1},
                                {"cells_x", 7},
                                {"resolution", 3},
                                {"seed", seed}}),
               -1, 19);
    expectFlat(sample("plate", {{"holes", 6}, {"resolution", 2}, {"seed", seed}}), -5, 19 * 4 - 24);
  }
}

TEST(Samples, PlateCellsAreCrissCross) {
  const TriangleSoup plate = sample("plate", {{"resolution", 1}});
  EXPECT_EQ(plate.faces.size(), 12U * 4);
  EXPECT_EQ(plate.vertices.size(), 24U + 12);
  EXPECT_EQ(sample("plate", {{"resolution", 3}}).faces.size(), 12U * 4 * 9);
}

TEST(Samples, ASeedChangesTheMeshAndNothingElseDoes) {
  for (const SampleKind& kind : sampleKinds()) {
    const TriangleSoup regular = sample(kind.name, {});
    EXPECT_EQ(regular.vertices, sample(kind.name, {}).vertices);
    if (kind.name == "diplotorus") continue;
    const TriangleSoup one = sample(kind.name, {{"seed", 1}});
    const TriangleSoup again = sample(kind.name, {{"seed", 1}});
    EXPECT_EQ(one.vertices, again.vertices);
    EXPECT_EQ(one.faces, again.faces);
    EXPECT_NE(one.vertices, regular.vertices) << kind.name;
    EXPECT_NE(one.vertices, sample(kind.name, {{"seed", 2}}).vertices) << kind.name;
    EXPECT_EQ(one.vertices.size(), regular.vertices.size());
  }
}

TEST(Samples, TheGeneratorIsSplitmix64) {
  // The published first outputs for this seed.
  SampleRandom random(1234567);
  EXPECT_EQ(random.next(), 6457827717110365317U);
  EXPECT_EQ(random.next(), 3203168211198807973U);
  EXPECT_EQ(random.next(), 9817491932198370423U);
}

TEST(Samples, WrongParametersAreRefusedWithWhatThereIs) {
  const auto hintOf = [](const std::string& kind, const Parameters& parameters) {
    const auto soup = makeSample(kind, parameters);
    EXPECT_THAT(soup, FailsWith(Reason::kInvalidOption));
    EXPECT_FALSE(soup.status().hint().empty()) << soup.status().toString();
    return soup.status().hint();
  };
  EXPECT_THAT(hintOf("cube", {}), testing::HasSubstr("torus, diplotorus, genus"));
  EXPECT_THAT(hintOf("torus", {{"radius", 1}}), testing::HasSubstr("R, r, resolution"));
  for (const double bad : {0.0, -1.0, 2.5, 1e9, kInfinity, -kInfinity, kNan}) {
    for (const SampleKind& kind : sampleKinds()) hintOf(kind.name, {{"resolution", bad}});
  }
  for (const double bad : {0.0, -1.0, kInfinity, kNan}) {
    hintOf("sphere", {{"radius", bad}});
    hintOf("ellipsoid", {{"b", bad}});
    hintOf("annulus", {{"r", bad}});
  }
  hintOf("sphere", {{"seed", -1}});
  hintOf("sphere", {{"seed", 0.5}});
  hintOf("sphere", {{"resolution", 3000}});
  hintOf("torus", {{"r", 2}, {"R", 2}});
  hintOf("torus", {{"sides", 2}});
  hintOf("annulus", {{"r", 1}, {"R", 1}});
  hintOf("annulus", {{"r", 1}, {"R", 1.000000001}});
  hintOf("capped-cylinder", {{"half_length", 1e300}});
  hintOf("genus", {{"genus", 101}});
  hintOf("diplotorus", {{"s2", -1}});
  hintOf("diplotorus", {{"phi", kNan}});
  hintOf("plate", {{"hole_x", 0}});
  hintOf("plate", {{"cells_x", 3}});
  hintOf("plate", {{"holes", 2}, {"hole_step", 2}});
}

}  // namespace
}  // namespace moduli
