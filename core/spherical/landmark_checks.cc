#include "core/spherical/landmark_checks.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace moduli::spherical {
namespace {

/// Landmarks nearer to each other than this are one.
constexpr double kSame = 1e-9;
/// Two landmarks meet on their way if they come this near, in terms of their distance at the ends.
constexpr double kMeeting = 1e-3;
constexpr int kSamples = 32;

/// The smallest distance of two travellers: the best sample, refined by golden sections.
double nearestMeeting(const Eigen::Vector3d& a, const Eigen::Vector3d& a_target,
                      const Eigen::Vector3d& b, const Eigen::Vector3d& b_target) {
  const auto distance = [&](double t) {
    return (alongArc(a, a_target, t) - alongArc(b, b_target, t)).norm();
  };
  int best = 0;
  for (int i = 1; i <= kSamples; ++i) {
    if (distance(double(i) / kSamples) < distance(double(best) / kSamples)) best = i;
  }
  double low = std::max(0.0, (best - 1.0) / kSamples);
  double high = std::min(1.0, (best + 1.0) / kSamples);
  constexpr double kGolden = 0.6180339887498949;
  for (int i = 0; i < 40; ++i) {
    const double left = high - kGolden * (high - low), right = low + kGolden * (high - low);
    (distance(left) < distance(right) ? high : low) =
        distance(left) < distance(right) ? right : left;
  }
  return distance(0.5 * (low + high));
}

}  // namespace

Eigen::Vector3d alongArc(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double t) {
  const Eigen::Vector3d across = b - b.dot(a) * a;
  if (across.norm() == 0) return a;
  const double angle = t * angleBetween(a, b);
  return (std::cos(angle) * a + std::sin(angle) * across.normalized()).normalized();
}

double angleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return 2 * std::atan2((a - b).norm(), (a + b).norm());
}

std::string landmarkName(const std::vector<Landmark>& landmarks, std::size_t i) {
  return landmarks[i].name.empty() ? "landmark " + std::to_string(i) : landmarks[i].name;
}

std::string landmarkNames(const std::vector<Landmark>& landmarks, std::size_t i, std::size_t j) {
  if (!landmarks[i].name.empty() && !landmarks[j].name.empty()) {
    return landmarks[i].name + " and " + landmarks[j].name;
  }
  return "landmarks " + std::to_string(i) + " and " + std::to_string(j);
}

Status checkLandmarks(const Connectivity& surface, const Points3& points,
                      const std::vector<Landmark>& landmarks) {
  Points3 starts;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    RETURN_IF_ERROR(checkSurfacePoint(surface, landmarks[i].point, landmarkName(landmarks, i)));
    if (!(std::abs(landmarks[i].target.norm() - 1) <= 1e-6)) {
      return {Reason::kInvalidOption,
              landmarkName(landmarks, i) + " has a target that is not on the unit sphere"};
    }
    starts.push_back(spherePoint(surface, points, landmarks[i].point));
    for (std::size_t j = 0; j < i; ++j) {
      if ((starts[i] - starts[j]).norm() <= kSame) {
        return {Reason::kInvalidOption,
                landmarkNames(landmarks, j, i) + " coincide on the surface"};
      }
      if ((landmarks[i].target.normalized() - landmarks[j].target.normalized()).norm() <= kSame) {
        return {Reason::kInvalidOption,
                landmarkNames(landmarks, j, i) + " are sent to the same place"};
      }
    }
  }
  return {};
}

Status checkPaths(const Context& context, const Connectivity& surface, const Points3& points,
                  const std::vector<Landmark>& landmarks) {
  Points3 start, end;
  std::vector<double> travel;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    RETURN_IF_ERROR(context.check());
    start.push_back(spherePoint(surface, points, landmarks[i].point));
    end.push_back(landmarks[i].target.normalized());
    travel.push_back(angleBetween(start[i], end[i]));
    if (travel[i] > std::numbers::pi - 1e-6) {
      return {Reason::kInvalidOption,
              landmarkName(landmarks, i) + " is sent to the opposite point of the sphere",
              "turn the map first, by an alignment"};
    }
    for (std::size_t j = 0; j < i; ++j) {
      const double apart = std::min((start[i] - start[j]).norm(), (end[i] - end[j]).norm());
      // Who starts farther apart than both travel cannot meet.
      if (apart > 1.1 * (travel[i] + travel[j])) continue;
      if (nearestMeeting(start[i], end[i], start[j], end[j]) > kMeeting * apart) continue;
      return {Reason::kInvalidOption,
              landmarkNames(landmarks, j, i) + " cross: they meet on their way",
              "turn the map first, by an alignment, or check that they are not exchanged"};
    }
  }
  return {};
}

}  // namespace moduli::spherical
