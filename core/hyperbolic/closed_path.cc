#include "core/hyperbolic/closed_path.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/hyperbolic/axis.h"

namespace moduli {
namespace {

constexpr double kOnAxis = 1e-9;
constexpr double kSameElement = 1e-6;

constexpr double kBeyond = 0.1;

/// Off the point of an axis that is nearest to 0, at a signed distance, positive on the left.
Complex besideFoot(const Axis& axis, double distance) {
  const double height = std::sqrt(1 + axis.time * axis.time);
  const double time = std::cosh(distance) * height + std::sinh(distance) * axis.time;
  const Complex space =
      (std::cosh(distance) * axis.time / height + std::sinh(distance)) * axis.space;
  return space / (1 + time);
}

class Follower {
 public:
  Follower(const HyperbolicTriangles& triangles, const Development& development,
           const Su11& element)
      : triangles_(triangles), surface_(triangles.surface), crossing_(development.crossing) {
    face_ = development.root;
    const Su11& placed = development.placed[face_];
    element_ = renormalized(inverse(placed) * element * placed);
    look();
  }

  Result<std::vector<PathStep>> run(Context& context) {
    const std::size_t most = 1000 + 50 * static_cast<std::size_t>(surface_.faceCount());
    RETURN_IF_ERROR(goToAxis(context, most));
    // Around vertices on the axis the way need not come back to where it was first looked for: it
    // is begun anew after ever longer ways.
    std::vector<PathStep> steps;
    Index first_face = face_;
    Su11 first_element = element_;
    std::size_t longest = kFirstWay;
    for (std::size_t n = 0; n < most; ++n) {
      if (n % kStepsPerCheck == 0) RETURN_IF_ERROR(context.check());
      steps.push_back(step());
      if (face_ == first_face &&
          distanceUpToSign(element_, first_element) < kSameElement * std::abs(element_.a)) {
        return repeated(steps, translationLength(element_));
      }
      if (steps.size() < longest) continue;
      longest *= 2;
      steps.clear();
      first_face = face_;
      first_element = element_;
    }
    return lost();
  }

 private:
  static constexpr std::size_t kStepsPerCheck = 4096;
  static constexpr std::size_t kFirstWay = 1024;
  static constexpr double kShortestTurn = 1e-8;

  static Status lost() {
    return {Reason::kInternal, "a closed geodesic cannot be followed across the faces"};
  }

  /// Powers of an element look the same after each turn: so many that they are of this length.
  Result<std::vector<PathStep>> repeated(const std::vector<PathStep>& turn, double length) const {
    double once = 0;
    for (std::size_t i = 0; i < turn.size(); ++i) {
      const PathStep& next = turn[(i + 1) % turn.size()];
      once += hyperbolicDistance(place(turn[i].entry, turn[i].fraction),
                                 place(surface_.twin(next.entry), 1 - next.fraction));
    }
    if (!(once > kShortestTurn)) return lost();
    std::vector<PathStep> steps = turn;
    for (double way = 1.5 * once; way < length; way += once) {
      steps.insert(steps.end(), turn.begin(), turn.end());
    }
    return steps;
  }

  /// In the coordinates of the face of h.
  Complex place(Index h, double fraction) const {
    return imageOf(cornerFrame(triangles_, h), std::tanh(fraction * triangles_.lengths[h] / 2));
  }

  /// Brings the axis and the corners' sides of it up to date.
  void look() {
    axis_ = axisOf(element_);
    for (int c = 0; c < 3; ++c) {
      const Su11 frame = cornerFrame(triangles_, 3 * face_ + c);
      side_[c] = sideOf(axis_, imageOf(frame, 0.0));
    }
  }

  bool isLeft(int c) const { return side_[c] > -kOnAxis; }
  void judgeCorners() {
    for (int c = 0; c < 3; ++c) left_[c] = isLeft(c);
  }

  /// The side of the face through which the axis leaves it; kNone where it misses the face.
  Index exit() const {
    for (int c = 0; c < 3; ++c) {
      if (!left_[c] && left_[(c + 1) % 3]) return 3 * face_ + c;
    }
    return kNone;
  }

  /// To a face that the axis passes, on the way to a point on its other side.
  Status goToAxis(Context& context, std::size_t most) {
    judgeCorners();
    if (exit() != kNone) return {};
    Complex goal = besideFoot(axis_, left_[0] ? -kBeyond : kBeyond);
    for (std::size_t n = 0; n < most; ++n) {
      if (n % kStepsPerCheck == 0) RETURN_IF_ERROR(context.check());
      const Index h = sideTowards(goal, static_cast<int>(n % 3));
      if (h == kNone) break;
      goal = imageOf(inverse(crossing_[h]), goal);
      cross(h);
      judgeCorners();
      if (exit() != kNone) return {};
    }
    return lost();
  }

  /// A side that a point lies behind; kNone where it is in the face. Sides are tried from `first`
  /// on.
  Index sideTowards(Complex point, int first) const {
    for (int n = 0; n < 3; ++n) {
      const Index h = 3 * face_ + (first + n) % 3;
      if (imageOf(inverse(cornerFrame(triangles_, h)), point).imag() < 0) return h;
    }
    return kNone;
  }

  /// On into the next face.
  PathStep step() {
    const Index h = exit();
    const double fraction = fractionAlong(h);
    cross(h);
    // The ends of the side that it comes through keep the sides that they had.
    const Index entry = surface_.twin(h);
    const int apex = (entry + 2) % 3;
    left_[entry % 3] = true;
    left_[(entry + 1) % 3] = false;
    left_[apex] = isLeft(apex);
    return {entry, 1 - fraction};
  }

  double fractionAlong(Index h) const {
    const double length = triangles_.lengths[h];
    const double tail = std::max(0.0, -side_[h % 3]), head = std::max(0.0, side_[(h + 1) % 3]);
    if (!(tail > 0)) return 0;
    if (!(head > 0)) return 1;
    // sinh of the ways to the ends are as the sinh of their distances from the axis.
    const double way = std::atanh(tail * std::sinh(length) / (head + tail * std::cosh(length)));
    return std::min(1.0, way / length);
  }

  void cross(Index h) {
    face_ = Connectivity::faceOf(surface_.twin(h));
    element_ = renormalized(inverse(crossing_[h]) * element_ * crossing_[h]);
    look();
  }

  const HyperbolicTriangles& triangles_;
  const Connectivity& surface_;
  const std::vector<Su11>& crossing_;
  Index face_ = 0;
  Su11 element_;  ///< In the coordinates of the face.
  Axis axis_;
  std::array<double, 3> side_;  ///< sinh of the corners' distances, positive on the left.
  std::array<bool, 3> left_;    ///< On which side they are taken to be.
};

}  // namespace

Result<std::vector<PathStep>> followGeodesic(Context& context, const HyperbolicTriangles& triangles,
                                             const Development& development, const Su11& element) {
  return Follower(triangles, development, element).run(context);
}

}  // namespace moduli
