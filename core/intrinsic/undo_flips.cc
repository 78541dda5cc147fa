#include "core/intrinsic/undo_flips.h"

#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

namespace moduli {
namespace {

using Complex = std::complex<double>;

double wrapped(double angle) {
  return std::remainder(angle, 2 * std::numbers::pi);
}

/// From the direction p to q, counter-clockwise.
double turn(Complex p, Complex q) {
  return std::arg(q * std::conj(p));
}

/// The stereographic picture of a plane of curvature K, in which lines through 0 are straight.
class Picture {
 public:
  explicit Picture(Geometry geometry) : geometry_(geometry), curvature_(planeCurvature(geometry)) {}

  /// The point at a distance from 0.
  Complex point(double length, double angle) const {
    const double half = length / 2;
    return std::polar(curvature_ == 0  ? half
                      : curvature_ < 0 ? std::tanh(half)
                                       : std::tan(half),
                      angle);
  }
  /// The direction from p to q at p, and their half chord.
  Complex direction(Complex p, Complex q) const {
    return (q - p) / (1.0 + curvature_ * std::conj(p) * q);
  }
  double distance(Complex p, Complex q) const {
    const double scale = (1 + curvature_ * std::norm(p)) * (1 + curvature_ * std::norm(q));
    return lengthOfHalfChord(geometry_, std::abs(q - p) / std::sqrt(scale));
  }

 private:
  Geometry geometry_;
  double curvature_;
};

/// The two triangles beside an edge, while its flip is undone.
class Undoing {
 public:
  Undoing(Geometry geometry, IntrinsicTriangulation triangulation, SignedTriangles triangles)
      : picture_(geometry),
        triangulation_(std::move(triangulation)),
        lengths_(std::move(triangles.lengths)),
        angles_(std::move(triangles.angles)) {}

  SignedTriangles run() {
    while (!triangulation_.history().empty()) undoLast();
    return {std::move(lengths_), std::move(angles_)};
  }

 private:
  /// The last flipped edge h runs from l to k, with i on its left and j on its right; before its
  /// flip it ran from i to j. All is told from the three sides at l, which is put at 0: their
  /// directions are exact, however short they are. Angles at the others are those before, added or
  /// cut in two.
  void undoLast() {
    const Index h = triangulation_.history().back().halfedge, t = triangulation_.twin(h);
    const Index h1 = Connectivity::next(h), h2 = Connectivity::previous(h);
    const Index t1 = Connectivity::next(t), t2 = Connectivity::previous(t);
    const double ki = lengths_[h1], il = lengths_[h2], lj = lengths_[t1], jk = lengths_[t2];
    const double to_i = angles_[h], to_j = -angles_[t1];
    const Complex i = picture_.point(il, to_i), j = picture_.point(lj, to_j);
    const double at_i = angles_[h2], at_j = angles_[t2];
    const double l_to_j = turn(-std::polar(1.0, to_i), i == j ? 1 : picture_.direction(i, j));
    const double i_to_l = turn(i == j ? -1 : picture_.direction(j, i), -std::polar(1.0, to_j));
    const double at_k = wrapped(angles_[h1] + angles_[t]);
    const double at_l = wrapped(to_i - to_j);
    triangulation_.undoTo(triangulation_.history().size() - 1);
    const double diagonal = picture_.distance(i, j);
    setFace({h, h1, h2}, {diagonal, jk, ki},
            {wrapped(at_i - l_to_j), wrapped(at_j - i_to_l), at_k});
    setFace({t, t1, t2}, {diagonal, il, lj}, {i_to_l, l_to_j, at_l});
  }

  void setFace(const std::array<Index, 3>& sides, const std::array<double, 3>& lengths,
               const std::array<double, 3>& angles) {
    for (int c = 0; c < 3; ++c) {
      lengths_[sides[c]] = lengths[c];
      angles_[sides[c]] = angles[c];
    }
  }

  Picture picture_;
  IntrinsicTriangulation triangulation_;
  std::vector<double> lengths_, angles_;
};

}  // namespace

SignedTriangles undoFlips(Geometry geometry, IntrinsicTriangulation triangulation,
                          SignedTriangles triangles) {
  return Undoing(geometry, std::move(triangulation), std::move(triangles)).run();
}

}  // namespace moduli
