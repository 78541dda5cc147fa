#include "core/hyperbolic/straight_faces.h"

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/topology/surface_topology.h"

namespace moduli {
namespace {

double wrapped(double angle) {
  return std::remainder(angle, 2 * std::numbers::pi);
}

/// The direction from one point to another, in coordinates where the first is at 0. Points that are
/// but rounding apart are subtracted first: there and back it is then one direction.
Complex direction(Complex from, Complex to) {
  return (to - from) / (1.0 - std::conj(from) * to);
}

/// From the direction p to q, counter-clockwise.
double turn(Complex p, Complex q) {
  return std::arg(q * std::conj(p));
}

/// The two triangles beside an edge, while its flip is undone.
class Undoing {
 public:
  explicit Undoing(const DiscreteMetric& metric)
      : triangulation_(metric.triangulation), angles_(metric.angles) {
    for (const double x : metric.half_chords) {
      lengths_.push_back(lengthOfHalfChord(Geometry::kHyperbolic, x));
    }
  }

  StraightFaces run() {
    while (!triangulation_.history().empty()) undoLast();
    return {triangulation_.connectivity(), std::move(lengths_), std::move(angles_)};
  }

 private:
  /// The last flipped edge h runs from l to k, with i on its left and j on its right; before its
  /// flip it ran from i to j.
  void undoLast() {
    const Index h = triangulation_.history().back().halfedge, t = triangulation_.twin(h);
    const Index h1 = Connectivity::next(h), h2 = Connectivity::previous(h);
    const Index t1 = Connectivity::next(t), t2 = Connectivity::previous(t);
    const double ki = lengths_[h1], il = lengths_[h2], lj = lengths_[t1], jk = lengths_[t2];
    // Around l, at 0. Loops that can be shrunk to a point have no direction; they get any, the same
    // in both of their faces, which only angles know. So all is told from the three sides at l, and
    // angles at the others are those before, cut in two.
    const double at_i = angles_[h2], at_j = angles_[t2];
    const Complex to_i = std::polar(1.0, angles_[h]), to_j = std::polar(1.0, -angles_[t1]);
    const Complex i = std::tanh(il / 2) * to_i, j = std::tanh(lj / 2) * to_j;
    const double from_l = turn(-to_i, i == j ? 1 : direction(i, j));
    const double to_l = turn(i == j ? -1 : direction(j, i), -to_j);
    const double at_k = wrapped(angles_[h1] + angles_[t]);
    const double at_l = wrapped(angles_[h] + angles_[t1]);
    triangulation_.undoTo(triangulation_.history().size() - 1);
    const double diagonal = hyperbolicDistance(i, j);
    setFace({h, h1, h2}, {diagonal, jk, ki}, {wrapped(at_i - from_l), wrapped(at_j - to_l), at_k});
    setFace({t, t1, t2}, {diagonal, il, lj}, {to_l, from_l, at_l});
  }

  void setFace(const std::array<Index, 3>& sides, const std::array<double, 3>& lengths,
               const std::array<double, 3>& angles) {
    for (int c = 0; c < 3; ++c) {
      lengths_[sides[c]] = lengths[c];
      angles_[sides[c]] = angles[c];
    }
  }

  IntrinsicTriangulation triangulation_;
  std::vector<double> lengths_, angles_;
};

}  // namespace

StraightFaces straightFaces(const DiscreteMetric& metric) {
  return Undoing(metric).run();
}

std::vector<double> boundaryLengths(const Connectivity& surface,
                                    const std::vector<double>& lengths) {
  std::vector<double> sums;
  const SurfaceTopology topology = computeTopology(surface);
  for (const std::vector<Index>& loop : topology.boundary_loops) {
    double sum = 0;
    for (const Index h : loop) sum += lengths[h];
    sums.push_back(sum);
  }
  return sums;
}

}  // namespace moduli
