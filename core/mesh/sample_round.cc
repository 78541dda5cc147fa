#include <cmath>
#include <numbers>

#include "core/mesh/sample_kinds.h"

/// Spheres and what comes of them.
namespace moduli {
namespace {

constexpr Index kMostSteps = 4000;

TriangleSoup icosahedron() {
  const double t = std::numbers::phi;
  return {{{-1, t, 0},
           {1, t, 0},
           {-1, -t, 0},
           {1, -t, 0},
           {0, -1, t},
           {0, 1, t},
           {0, -1, -t},
           {0, 1, -t},
           {t, 0, -1},
           {t, 0, 1},
           {-t, 0, -1},
           {-t, 0, 1}},
          {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
           {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
           {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};
}

// The icosahedron, each edge cut into `resolution` parts, blown up to the unit sphere.
Result<TriangleSoup> unitSphere(const SampleValues& values) {
  RETURN_IF_ERROR(values.checkCount("resolution", 1, kMostSteps));
  const Index n = values.count("resolution");
  RETURN_IF_ERROR(checkSampleSize(20.0 * n * n));
  TriangleSoup soup = subdivideFaces(icosahedron(), n);
  for (Eigen::Vector3d& p : soup.vertices) p.normalize();
  if (values.seed() != 0) {
    SampleRandom random(values.seed());
    moveVertices(soup, random,
                 [](Index, const Eigen::Vector3d& moved) { return moved.normalized().eval(); });
  }
  return soup;
}

Result<TriangleSoup> scaledSphere(const SampleValues& values, const Eigen::Vector3d& axes) {
  ASSIGN_OR_RETURN(TriangleSoup soup, unitSphere(values));
  for (Eigen::Vector3d& p : soup.vertices) p = p.cwiseProduct(axes).eval();
  return soup;
}

// The nearest point of a capped cylinder.
Eigen::Vector3d projectToCapsule(const Eigen::Vector3d& p, double radius, double half_length) {
  const Eigen::Vector3d centre(0, 0, std::clamp(p.z(), -half_length, half_length));
  return centre + radius * (p - centre).normalized();
}

}  // namespace

Result<TriangleSoup> makeSphere(const SampleValues& values) {
  RETURN_IF_ERROR(values.checkPositive("radius"));
  return scaledSphere(values, Eigen::Vector3d::Constant(values["radius"]));
}

Result<TriangleSoup> makeEllipsoid(const SampleValues& values) {
  for (const char* name : {"a", "b", "c"}) RETURN_IF_ERROR(values.checkPositive(name));
  return scaledSphere(values, {values["a"], values["b"], values["c"]});
}

Result<TriangleSoup> makeSpheroid(const SampleValues& values) {
  for (const char* name : {"a", "c"}) RETURN_IF_ERROR(values.checkPositive(name));
  return scaledSphere(values, {values["a"], values["a"], values["c"]});
}

// Rings from the north pole to the south pole: 4 more vertices on each ring of the cap, 4 n on the
// rings of the tube, whose rows are as high as those of the caps.
Result<TriangleSoup> makeCappedCylinder(const SampleValues& values) {
  for (const char* name : {"radius", "half_length"}) RETURN_IF_ERROR(values.checkPositive(name));
  RETURN_IF_ERROR(values.checkCount("resolution", 1, kMostSteps));
  const double radius = values["radius"];
  const double half_length = values["half_length"];
  const Index n = values.count("resolution");
  const double step = std::numbers::pi / 2 / n;
  const double wanted_rows = std::max(1.0, std::round(2 * half_length / (radius * step)));
  RETURN_IF_ERROR(checkSampleSize(8.0 * n * n + 8.0 * n * wanted_rows));
  const auto rows = static_cast<Index>(wanted_rows);

  SampleRandom random(values.seed());
  constexpr Index kSectors = 4;
  RingStack rings(values.seed() != 0 ? &random : nullptr);
  rings.add({{0, 0, half_length + radius}});
  for (Index j = 1; j <= n; ++j) {
    // The equator's cosine is not exactly zero; its height must be.
    const double height = j == n ? 0 : radius * std::cos(j * step);
    rings.add(circleRing(radius * std::sin(j * step), half_length + height, kSectors * j),
              kSectors);
  }
  for (Index i = 1; i < rows; ++i) {
    rings.add(circleRing(radius, half_length * (1 - 2.0 * i / rows), kSectors * n));
  }
  for (Index j = n; j >= 1; --j) {
    const double height = j == n ? 0 : radius * std::cos(j * step);
    rings.add(circleRing(radius * std::sin(j * step), -half_length - height, kSectors * j),
              kSectors);
  }
  rings.add({{0, 0, -half_length - radius}}, kSectors);
  TriangleSoup soup = rings.take();
  if (values.seed() != 0) {
    moveVertices(soup, random, [&](Index, const Eigen::Vector3d& moved) {
      return projectToCapsule(moved, radius, half_length);
    });
  }
  return soup;
}

}  // namespace moduli
