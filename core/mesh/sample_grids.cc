#include <cmath>
#include <numbers>

#include "core/mesh/sample_kinds.h"

/// Surfaces made of rings: torus of revolution, flat annulus, flat disk.
namespace moduli {
namespace {

constexpr Index kMostSteps = 20000;
constexpr double kTurn = 2 * std::numbers::pi;

Eigen::Vector3d onCircle(const Eigen::Vector3d& p, double radius) {
  return radius * Eigen::Vector3d(p.x(), p.y(), 0).normalized();
}

// A count that is either given or, when 0, taken from the resolution.
Result<Index> countOr(const SampleValues& values, const std::string& name, double otherwise) {
  if (values[name] != 0) {
    RETURN_IF_ERROR(values.checkCount(name, 3, kMostSteps));
    return values.count(name);
  }
  RETURN_IF_ERROR(checkSampleSize(otherwise));
  return static_cast<Index>(std::max(3.0, std::round(otherwise)));
}

}  // namespace

Result<TriangleSoup> makeTorus(const SampleValues& values) {
  for (const char* name : {"R", "r"}) RETURN_IF_ERROR(values.checkPositive(name));
  const double big = values["R"];
  const double small = values["r"];
  if (small >= big) return sampleError("r must be smaller than R");
  RETURN_IF_ERROR(values.checkCount("resolution", 3, kMostSteps));
  const double k = values["resolution"];
  ASSIGN_OR_RETURN(const Index rings, countOr(values, "rings", 2 * k));
  ASSIGN_OR_RETURN(const Index sides, countOr(values, "sides", k));
  RETURN_IF_ERROR(checkSampleSize(2.0 * rings * sides));

  SampleRandom random(values.seed());
  RingStack stack(values.seed() != 0 ? &random : nullptr);
  std::vector<Eigen::Vector3d> ring(sides);
  for (Index i = 0; i < rings; ++i) {
    const double u = kTurn * i / rings;
    for (Index j = 0; j < sides; ++j) {
      const double v = kTurn * j / sides;
      const double distance = big + small * std::cos(v);
      ring[j] = {distance * std::cos(u), distance * std::sin(u), small * std::sin(v)};
    }
    stack.add(ring);
  }
  stack.close();
  TriangleSoup soup = stack.take();
  if (values.seed() != 0) {
    moveVertices(soup, random, [&](Index, const Eigen::Vector3d& moved) {
      const Eigen::Vector3d centre = onCircle(moved, big);
      return (centre + small * (moved - centre).normalized()).eval();
    });
  }
  return soup;
}

// Radii grow by a constant factor, so that cells are nearly square everywhere.
Result<TriangleSoup> makeAnnulus(const SampleValues& values) {
  for (const char* name : {"R", "r"}) RETURN_IF_ERROR(values.checkPositive(name));
  const double outer = values["R"];
  const double inner = values["r"];
  if (inner >= outer) return sampleError("r must be smaller than R");
  RETURN_IF_ERROR(values.checkCount("resolution", 1, kMostSteps));
  const Index rows = values.count("resolution");
  const double ratio = std::log(outer / inner);
  ASSIGN_OR_RETURN(const Index sides, countOr(values, "sides", kTurn / ratio * rows));
  RETURN_IF_ERROR(checkSampleSize(2.0 * rows * sides));

  SampleRandom random(values.seed());
  RingStack stack(values.seed() != 0 ? &random : nullptr);
  for (Index i = 0; i <= rows; ++i) {
    const double radius = i == rows ? outer : inner * std::exp(ratio * i / rows);
    stack.add(circleRing(radius, 0, sides));
  }
  TriangleSoup soup = stack.take();
  if (values.seed() != 0) {
    moveVertices(soup, random, [&](Index v, const Eigen::Vector3d& moved) {
      if (v < sides) return onCircle(moved, inner);
      if (v >= rows * sides) return onCircle(moved, outer);
      return Eigen::Vector3d(moved.x(), moved.y(), 0);
    });
  }
  return soup;
}

Result<TriangleSoup> makeDisk(const SampleValues& values) {
  RETURN_IF_ERROR(values.checkPositive("radius"));
  RETURN_IF_ERROR(values.checkCount("resolution", 1, kMostSteps));
  const double radius = values["radius"];
  const Index rows = values.count("resolution");
  constexpr Index kSectors = 6;
  RETURN_IF_ERROR(checkSampleSize(6.0 * rows * rows));

  RingStack stack(nullptr);
  stack.add({{0, 0, 0}});
  for (Index j = 1; j <= rows; ++j) {
    stack.add(circleRing(radius * j / rows, 0, kSectors * j), kSectors);
  }
  TriangleSoup soup = stack.take();
  if (values.seed() != 0) {
    SampleRandom random(values.seed());
    const auto rim = static_cast<Index>(soup.vertices.size()) - kSectors * rows;
    moveVertices(soup, random, [&](Index v, const Eigen::Vector3d& moved) {
      return v >= rim ? onCircle(moved, radius) : Eigen::Vector3d(moved.x(), moved.y(), 0);
    });
  }
  return soup;
}

}  // namespace moduli
