#include "core/intrinsic/delaunay.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "core/base/parallel.h"
#include "core/intrinsic/geometry.h"

namespace moduli {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr double kTie = 1e-12;
constexpr std::size_t kGrain = 8192;
constexpr std::size_t kFlipsPerCheck = 4096;
/// Flips per edge that no surface needs; only a cycle caused by rounding makes more.
constexpr std::size_t kMaxFlipsPerEdge = 1000;

Index next(Index h) {
  return Connectivity::next(h);
}
Index previous(Index h) {
  return Connectivity::previous(h);
}

/// Cosine of the angle between a and b, opposite x; factored, for needles lose it in the squares,
/// and in quotients, for squares leave the range of a double.
double oppositeCosine(double x, double a, double b) {
  const double large = std::max(a, b), small = std::min(a, b);
  return (((large - x) / large) * ((large + x) / small) + small / large) / 2;
}

/// What the rounding of three sides does to that cosine.
double cosineRounding(double x, double a, double b) {
  const double longest = std::max({x, a, b});
  return (longest / a) * (longest / b);
}

/// The loop that both kinds of flips share. Metric: `double half(h)`, the half chord to judge by,
/// and `double flipped(h)`, what to store for the other diagonal.
template <typename Metric>
class Flipper {
 public:
  Flipper(Context& context, IntrinsicTriangulation& triangulation, const Metric& metric)
      : context_(context), triangulation_(triangulation), metric_(metric) {}

  Result<std::size_t> runEverywhere() {
    findBad();
    return run({});
  }

  /// suspects: judged after those that are known to be bad.
  Result<std::size_t> run(std::vector<Index> suspects) {
    bad_.insert(bad_.end(), suspects.begin(), suspects.end());
    const std::size_t limit = kMaxFlipsPerEdge * triangulation_.halfedgeCount();
    std::size_t flips = 0;
    while (!bad_.empty()) {
      const Index h = bad_.back();
      bad_.pop_back();
      if (delaunay(h)) continue;
      const Index t = triangulation_.twin(h);
      triangulation_.flip(h, metric_.flipped(triangulation_, h));
      for (const Index g : {next(h), previous(h), next(t), previous(t)}) bad_.push_back(g);
      if (++flips % kFlipsPerCheck == 0) RETURN_IF_ERROR(context_.check());
      if (flips > limit) {
        return Status{Reason::kNoConvergence,
                      "Delaunay flips did not end after " + std::to_string(flips),
                      "triangles are too thin for double precision; remesh the surface"};
      }
    }
    return flips;
  }

 private:
  double half(Index h) const { return metric_.half(triangulation_, h); }

  bool delaunay(Index h) const {
    if (!triangulation_.canFlip(h)) return true;
    const Index t = triangulation_.twin(h);
    const double e = half(h), a = half(next(h)), b = half(previous(h));
    const double c = half(next(t)), d = half(previous(t));
    return delaunaySlack(e, a, b, c, d) >= -slackTolerance(e, a, b, c, d);
  }

  /// All edges are judged in parallel, each from its lower halfedge; flips follow one by one.
  void findBad() {
    const auto count = static_cast<std::size_t>(triangulation_.halfedgeCount());
    std::vector<std::vector<Index>> found((count + kGrain - 1) / kGrain);
    parallelBlocks(count, kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n) {
        const auto h = static_cast<Index>(n);
        if (triangulation_.twin(h) > h && !delaunay(h)) found[begin / kGrain].push_back(h);
      }
    });
    for (const std::vector<Index>& block : found)
      bad_.insert(bad_.end(), block.begin(), block.end());
  }

  Context& context_;
  IntrinsicTriangulation& triangulation_;
  const Metric& metric_;
  std::vector<Index> bad_;
};

struct EuclideanMetric {
  double half(const IntrinsicTriangulation& t, Index h) const { return t.halfChord(h); }
  double flipped(const IntrinsicTriangulation& t, Index h) const {
    const Index g = t.twin(h);
    return isometricDiagonal(Geometry::kEuclidean, t.halfChord(h), t.halfChord(previous(h)),
                             t.halfChord(next(h)), t.halfChord(previous(g)), t.halfChord(next(g)));
  }
};

struct ScaledMetric {
  const std::vector<double>& scale;
  double half(const IntrinsicTriangulation& t, Index h) const {
    return t.halfChord(h) * (scale[t.tail(h)] * scale[t.head(h)]);
  }
  double flipped(const IntrinsicTriangulation& t, Index h) const { return t.ptolemyDiagonal(h); }
};

}  // namespace

double delaunaySlack(double edge, double a, double b, double c, double d) {
  return oppositeCosine(edge, a, b) + oppositeCosine(edge, c, d);
}

double slackTolerance(double edge, double a, double b, double c, double d) {
  return kTie + 8 * kEpsilon * (cosineRounding(edge, a, b) + cosineRounding(edge, c, d));
}

bool isDelaunay(const IntrinsicTriangulation& triangulation, Index h) {
  if (!triangulation.canFlip(h)) return true;
  const auto half = [&](Index g) { return triangulation.halfChord(g); };
  const Index t = triangulation.twin(h);
  const double e = half(h), a = half(next(h)), b = half(previous(h));
  const double c = half(next(t)), d = half(previous(t));
  return delaunaySlack(e, a, b, c, d) >= -slackTolerance(e, a, b, c, d);
}

Result<std::size_t> flipToDelaunayIsometric(Context& context,
                                            IntrinsicTriangulation& triangulation) {
  const EuclideanMetric metric;
  return Flipper<EuclideanMetric>(context, triangulation, metric).runEverywhere();
}

Result<std::size_t> flipToDelaunayPtolemy(Context& context, IntrinsicTriangulation& triangulation,
                                          const std::vector<double>& scale) {
  const ScaledMetric metric{scale};
  return Flipper<ScaledMetric>(context, triangulation, metric).runEverywhere();
}

Result<std::size_t> flipToDelaunayPtolemy(Context& context, IntrinsicTriangulation& triangulation,
                                          const std::vector<double>& scale,
                                          std::vector<Index> suspects) {
  const ScaledMetric metric{scale};
  return Flipper<ScaledMetric>(context, triangulation, metric).run(std::move(suspects));
}

}  // namespace moduli
