#include "core/spherical/beltrami_field.h"

#include <Eigen/Geometry>
#include <cmath>
#include <utility>

namespace moduli::spherical {
namespace {

using Complex = std::complex<double>;

/// Corners of a face in its frame.
std::array<Complex, 3> corners(const FaceFrame& frame) {
  return {Complex(0), Complex(frame.base), Complex(frame.x, frame.y)};
}

/// Square of the unit direction of side c of a frame.
Complex squaredDirection(const FaceFrame& frame, Index c) {
  const auto corner = corners(frame);
  const Complex side = corner[(c + 1) % 3] - corner[c];
  return side * side / std::norm(side);
}

/// The real form [[Re, -Im], [Im, Re]] of a Hermitian matrix, lower triangle.
SparseMatrix realForm(Index size, const std::vector<Eigen::Triplet<Complex>>& lower) {
  std::vector<Eigen::Triplet<double>> entries;
  for (const auto& entry : lower) {
    const int i = entry.row(), j = entry.col();
    const Complex value = entry.value();
    entries.emplace_back(i, j, value.real());
    entries.emplace_back(i + size, j + size, value.real());
    if (i == j) continue;
    // Both (i, j) and its mirror image (j, i) lie in the lower left block.
    entries.emplace_back(i + size, j, value.imag());
    entries.emplace_back(j + size, i, -value.imag());
  }
  SparseMatrix matrix(2 * size, 2 * size);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

Eigen::Vector3d centroid(const Connectivity& surface, const Points3& points, Index f) {
  const auto& [a, b, c] = surface.face(f);
  return (points[a] + points[b] + points[c]) / 3;
}

}  // namespace

FaceMap FaceMap::between(const FaceFrame& from, Complex side01, Complex side02) {
  const Complex corner(from.x, from.y);
  const Complex sum = side01 / from.base;
  const Complex across = (side02 - corner * sum) / Complex(0, -2 * from.y);
  return {sum - across, across};
}

FaceFrame chordFrame(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const Eigen::Vector3d u = b - a;
  const Eigen::Vector3d w = c - a;
  const double base = u.norm();
  return {base, u.dot(w) / base, u.cross(w).norm() / base};
}

std::array<double, 3> bentWeights(const FaceFrame& frame, Complex nu) {
  auto z = corners(frame);
  for (Complex& corner : z) corner += nu * std::conj(corner);
  const double area2 = (std::conj(z[1] - z[0]) * (z[2] - z[0])).imag();
  std::array<double, 3> weights;
  for (int c = 0; c < 3; ++c) {
    const Complex tip = z[(c + 2) % 3];
    weights[c] = 0.5 * (std::conj(z[c] - tip) * (z[(c + 1) % 3] - tip)).real() / area2;
  }
  return weights;
}

Result<BeltramiField> BeltramiField::make(Context& context, const Connectivity& surface,
                                          const Points3& points, double smoothing, double damping) {
  const Index size = surface.faceCount();
  std::vector<FaceFrame> frames;
  std::vector<double> diagonal;
  for (const auto& [a, b, c] : surface.faces()) {
    frames.push_back(chordFrame(points[a], points[b], points[c]));
    diagonal.push_back((1 + damping) * frames.back().area());
  }
  std::vector<Eigen::Triplet<Complex>> entries;
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    const Index h = surface.halfedge(e), t = surface.twin(h);
    const Index f = Connectivity::faceOf(h), g = Connectivity::faceOf(t);
    const double length = (points[surface.head(h)] - points[surface.tail(h)]).norm();
    const double apart = (centroid(surface, points, f) - centroid(surface, points, g)).norm();
    const double weight = smoothing * smoothing * length / apart;
    diagonal[f] += weight;
    diagonal[g] += weight;
    // nu_f / d_f^2 - nu_g / d_g^2: the edge's two directions differ in sign, their squares do not.
    const Complex turn = squaredDirection(frames[f], h % 3) / squaredDirection(frames[g], t % 3);
    entries.emplace_back(std::max(f, g), std::min(f, g), -weight * (f > g ? turn : 1.0 / turn));
  }
  for (Index f = 0; f < size; ++f) entries.emplace_back(f, f, diagonal[f]);
  ASSIGN_OR_RETURN(SpdSolver solver, SpdSolver::make(context, realForm(size, entries)));
  return BeltramiField(surface, std::move(frames), std::move(solver));
}

BeltramiCoefficients BeltramiField::measure(const Points3& points) const {
  BeltramiCoefficients mu;
  mu.reserve(frames_.size());
  for (std::size_t f = 0; f < frames_.size(); ++f) {
    const auto& [a, b, c] = surface_.face(static_cast<Index>(f));
    const FaceFrame image = chordFrame(points[a], points[b], points[c]);
    mu.push_back(FaceMap::between(frames_[f], image.base, {image.x, image.y}).beltrami());
  }
  return mu;
}

Result<BeltramiCoefficients> BeltramiField::smooth(Context& context, const BeltramiCoefficients& mu,
                                                   double bound) const {
  const auto size = static_cast<Eigen::Index>(mu.size());
  Eigen::MatrixXd b(2 * size, 1);
  for (Eigen::Index f = 0; f < size; ++f) {
    b(f, 0) = frames_[f].area() * mu[f].real();
    b(f + size, 0) = frames_[f].area() * mu[f].imag();
  }
  ASSIGN_OR_RETURN(const Eigen::MatrixXd x, solver_.solve(context, b));
  BeltramiCoefficients nu(mu.size());
  for (Eigen::Index f = 0; f < size; ++f) {
    nu[f] = {x(f, 0), x(f + size, 0)};
    nu[f] *= std::min(1.0, bound / std::max(std::abs(nu[f]), bound));
  }
  return nu;
}

}  // namespace moduli::spherical
