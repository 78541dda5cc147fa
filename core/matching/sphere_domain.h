#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/matching/disk_rim.h"
#include "core/matching/surface_walk.h"
#include "core/spherical/exact_sign.h"
#include "core/spherical/sphere_locator.h"

namespace moduli {

/// A point of the surface that is mapped to.
struct Image {
  SurfacePoint point = {};
  Eigen::Vector3d space = Eigen::Vector3d::Zero();  ///< On the surface, in the domain's own unit.
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  ///< On the unit sphere.
};

/// A surface of genus 0 that others are mapped to: in space, where distortion is measured, and on
/// the sphere, where it is decided which way triangles turn. All that a map's search has to know of
/// where it goes: another surface (a disk, the plane of a torus, the Klein model) needs the same
/// functions. Refers to the locator, which must live as long; safe to read from several threads.
///
/// A disk is a sphere with a cap, as DiskRim has it: its boundary is the equator.
class SphereDomain {
 public:
  /// positions: per vertex of the locator's surface. unit: > 0; lengths are counted in it. pole:
  /// the last vertex where the surface is a disk with a cap.
  SphereDomain(const SphereLocator& sphere, const std::vector<Eigen::Vector3d>& positions,
               double unit, Index pole = kNone);

  Image at(const SurfacePoint& point) const;
  /// direction: not 0. A unit vector is kept to the last bit.
  Image at(const Eigen::Vector3d& direction) const;

  /// Straight on over the surface from `start`, as SurfaceWalk; not over the boundary of a disk.
  Image walk(const Image& start, const Eigen::Vector3d& motion, int longest = 256) const;

  /// The point of a disk's boundary above or below which a direction points; not to a pole. A unit
  /// vector of height 0 is kept to the last bit.
  Image onRim(const Eigen::Vector3d& direction) const;
  /// Along a disk's boundary, counter-clockwise where the length is positive. start: on it.
  Image walkRim(const Image& start, double length) const;
  /// The boundary's unit tangent at a point of it, counter-clockwise.
  Eigen::Vector3d rimTangent(const Image& at) const;
  /// The way along the boundary from one point of it counter-clockwise to another.
  double rimWay(const Image& from, const Image& to) const;

  /// Unit normal of a face; 0 where it has no area.
  const Eigen::Vector3d& normal(Index face) const { return walk_.normal(face); }

  /// Whether the three run counter-clockwise, decided without an error.
  static bool isPositive(const Image& a, const Image& b, const Image& c) {
    return spherical::orientationSign(a.direction, b.direction, c.direction) > 0;
  }

  /// Twice the area of the triangle on the sphere over the square of its longest side, chords both:
  /// how far a positive triangle is from turning over. 0 where it is not positive.
  static double clearance(const Image& a, const Image& b, const Image& c);

  const SphereLocator& sphere() const { return sphere_; }

 private:
  const SphereLocator& sphere_;
  Index pole_;
  SurfaceWalk walk_;
  std::optional<DiskRim> rim_;
};

}  // namespace moduli
