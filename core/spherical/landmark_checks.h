#pragma once

#include <string>
#include <vector>

#include "core/spherical/landmark_map.h"

/// What landmarks must fulfil before a map is moved. Internal to this room.
namespace moduli::spherical {

/// Point at fraction t of the shorter great circle arc from a to b. Unit vectors, not opposite.
Eigen::Vector3d alongArc(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double t);

/// Angle between unit vectors, also where it is tiny or near pi.
double angleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b);

/// What messages call landmark i, and landmarks i and j together.
std::string landmarkName(const std::vector<Landmark>& landmarks, std::size_t i);
std::string landmarkNames(const std::vector<Landmark>& landmarks, std::size_t i, std::size_t j);

/// kInvalidOption, by the landmark's name, where one is not on the surface or its target not on
/// the sphere, or two coincide or are sent to one place. O(k^2).
Status checkLandmarks(const Connectivity& surface, const Points3& points,
                      const std::vector<Landmark>& landmarks);

/// kInvalidOption, by the landmark's name, where the arcs from where the landmarks are to their
/// targets cannot be travelled together: one leads to the opposite point, or two travellers meet.
/// Fails with kCancelled and kDeadlineExceeded, too. O(k^2).
Status checkPaths(const Context& context, const Connectivity& surface, const Points3& points,
                  const std::vector<Landmark>& landmarks);

}  // namespace moduli::spherical
