#pragma once

#include <Eigen/Core>
#include <complex>

/// Which way triangles turn, decided without an error.
namespace moduli::spherical {

/// Sign of the determinant of three points of the sphere: 1 where a, b, c run counter-clockwise
/// seen from outside, 0 in one plane with the centre. Exact for the given doubles (products below
/// 1e-290 apart); 0 where a coordinate is not finite. O(1), by a filter first.
int orientationSign(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c);

/// The same in the plane: 1 where a, b, c run counter-clockwise, 0 on one line.
int orientationSign(const std::complex<double>& a, const std::complex<double>& b,
                    const std::complex<double>& c);

}  // namespace moduli::spherical
