#include "core/matching/isometric_step.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/base/parallel.h"

namespace moduli {
namespace {

using Eigen::Vector3d;
using Tangents = IsometricStep::Tangents;
using HatGradients = Eigen::Matrix<double, 2, 3>;

/// Weight of staying, beside that of the faces, which is about 8: it moves the solution by nothing,
/// and keeps the matrix regular where a surface turns in itself.
constexpr double kStay = 0.05;
/// Images of faces that are smaller than this part are left to their neighbours.
constexpr double kFlat = 1e-6;
/// Faces that one thread takes before it asks for more.
constexpr std::size_t kTogether = 512;

Tangents tangentsOf(const Vector3d& normal) {
  Tangents tangents = Tangents::Zero();
  if (!(normal.squaredNorm() > 0)) return tangents;
  Vector3d axis = Vector3d::Zero();
  Eigen::Index least = 0;
  normal.cwiseAbs().minCoeff(&least);
  axis[least] = 1;
  tangents.col(0) = normal.cross(axis).normalized();
  tangents.col(1) = normal.cross(tangents.col(0));
  return tangents;
}

/// In a triangle laid into the plane. Needles are as thick as for FaceDistortion.
HatGradients hatGradients(const SpaceTriangle& triangle) {
  int c = 0;  // The corner opposite the longest side.
  double longest = 0;
  for (int i = 0; i < 3; ++i) {
    const double side = (triangle[(i + 2) % 3] - triangle[(i + 1) % 3]).norm();
    if (side > longest) {
      longest = side;
      c = i;
    }
  }
  HatGradients gradients = HatGradients::Zero();
  if (!(longest > 0)) return gradients;
  const Vector3d along = (triangle[(c + 2) % 3] - triangle[(c + 1) % 3]) / longest;
  const Vector3d to = triangle[c] - triangle[(c + 1) % 3];
  const double x = along.dot(to), y = std::max(along.cross(to).norm(), 2e-6 * longest);
  // Corners at (0, 0), (longest, 0), (x, y).
  gradients.col(c) = Eigen::Vector2d(0, 1 / y);
  gradients.col((c + 1) % 3) = Eigen::Vector2d(-1 / longest, (x / longest - 1) / y);
  gradients.col((c + 2) % 3) = Eigen::Vector2d(1 / longest, -x / longest / y);
  return gradients;
}

/// R = J - J^-T of a face and its derivatives by the moves of the corners in their tangent planes.
struct Residual {
  Eigen::Vector4d value;
  Eigen::Matrix<double, 4, 6> derivative;
};

std::optional<Residual> residualOf(const HatGradients& hats, const SpaceTriangle& image,
                                   const std::array<const Tangents*, 3>& tangents) {
  const Vector3d u = image[1] - image[0], w = image[2] - image[0], normal = u.cross(w);
  if (!(normal.squaredNorm() > 0)) return {};
  Eigen::Matrix<double, 2, 3> plane;
  plane.row(0) = u.normalized();
  plane.row(1) = normal.cross(u).normalized();
  Eigen::Matrix2d jacobian = Eigen::Matrix2d::Zero();
  for (int c = 0; c < 3; ++c) {
    jacobian += plane * (image[c] - image[0]) * hats.col(c).transpose();
  }
  const double determinant = jacobian.determinant();
  if (!(determinant > kFlat)) return {};
  const Eigen::Matrix2d back = jacobian.inverse().transpose();  // J^-T
  const Eigen::Matrix2d rest = jacobian - back;
  Residual residual;
  residual.value = Eigen::Map<const Eigen::Vector4d>(rest.data());
  for (int c = 0; c < 3; ++c) {
    const Eigen::Matrix2d along = plane * *tangents[c];
    for (int i = 0; i < 2; ++i) {
      const Eigen::Matrix2d change = along.col(i) * hats.col(c).transpose();
      const Eigen::Matrix2d of_rest = change + back * change.transpose() * back;
      residual.derivative.col(2 * c + i) = Eigen::Map<const Eigen::Vector4d>(of_rest.data());
    }
  }
  return residual;
}

/// Of the six unknowns of a face, two for each corner.
Index unknownOf(const Triangle& face, int p) {
  return 2 * face[p / 2] + p % 2;
}

/// Of the lower triangle of the whole.
std::pair<Index, Index> entryOf(const Triangle& face, int p, int q) {
  const Index i = unknownOf(face, p), j = unknownOf(face, q);
  return {std::max(i, j), std::min(i, j)};
}

/// Calls visit(p, q, n) for the 21 pairs p >= q of six unknowns.
template <typename Visit>
void forLower(const Visit& visit) {
  int n = 0;
  for (int p = 0; p < 6; ++p) {
    for (int q = 0; q <= p; ++q) visit(p, q, n++);
  }
}

}  // namespace

IsometricStep::IsometricStep(const Connectivity& surface, const std::vector<Vector3d>& positions,
                             const std::vector<Attraction>& attractions)
    : surface_(surface), attractions_(attractions), masses_(positions.size(), 0.0) {
  for (const Triangle& face : surface.faces()) {
    const SpaceTriangle triangle = {positions[face[0]], positions[face[1]], positions[face[2]]};
    distortions_.emplace_back(triangle);
    gradients_.push_back(hatGradients(triangle));
    for (const Index v : face) masses_[v] += distortions_.back().area() / 3;
  }
  makePattern();
}

void IsometricStep::makePattern() {
  const auto unknowns = 2 * static_cast<Eigen::Index>(masses_.size());
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(21 * static_cast<std::size_t>(surface_.faceCount()) + 2 * masses_.size());
  for (const Triangle& face : surface_.faces()) {
    forLower([&](int p, int q, int) {
      const auto [row, column] = entryOf(face, p, q);
      entries.emplace_back(row, column, 0.0);
    });
  }
  for (Eigen::Index i = 0; i < unknowns; ++i) entries.emplace_back(i, i, 0.0);
  pattern_.resize(unknowns, unknowns);
  pattern_.setFromTriplets(entries.begin(), entries.end());
  places_.resize(surface_.faceCount());
  const int* const rows = pattern_.innerIndexPtr();
  for (Index f = 0; f < surface_.faceCount(); ++f) {
    forLower([&](int p, int q, int n) {
      const auto [row, column] = entryOf(surface_.face(f), p, q);
      const int *const begin = rows + pattern_.outerIndexPtr()[column],
                       *const end = rows + pattern_.outerIndexPtr()[column + 1];
      places_[f][n] = static_cast<int>(std::lower_bound(begin, end, row) - rows);
    });
  }
}

double IsometricStep::excess(const std::vector<Vector3d>& images) const {
  const auto count = static_cast<std::size_t>(surface_.faceCount());
  std::vector<double> sums((count + kTogether - 1) / kTogether, 0.0);
  parallelBlocks(count, kTogether, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const auto& [i, j, k] = surface_.face(static_cast<Index>(f));
      sums[begin / kTogether] +=
          distortions_[f].energy({images[i], images[j], images[k]}) - 4 * distortions_[f].area();
    }
  });
  double sum = std::accumulate(sums.begin(), sums.end(), 0.0);
  for (std::size_t v = 0; v < attractions_.size(); ++v) {
    const double r2 = (images[v] - attractions_[v].place).squaredNorm(), s2 = scale_ * scale_;
    sum += pull_ * attractions_[v].weight * masses_[v] * r2 * (s2 / (r2 + s2));
  }
  return sum;
}

struct IsometricStep::System {
  SparseMatrix matrix;
  Eigen::VectorXd right;
};

/// All of 0 for a face whose image is flat: the pattern stays.
IsometricStep::FaceTerms IsometricStep::termsOf(Index f, const std::vector<Vector3d>& images,
                                                const std::vector<Tangents>& tangents) const {
  const Triangle& face = surface_.face(f);
  const std::optional<Residual> residual =
      residualOf(gradients_[f], {images[face[0]], images[face[1]], images[face[2]]},
                 {&tangents[face[0]], &tangents[face[1]], &tangents[face[2]]});
  FaceTerms terms{};
  if (!residual) return terms;
  const double weight = 2 * distortions_[f].area();
  const Eigen::Matrix<double, 6, 6> hessian =
      weight * residual->derivative.transpose() * residual->derivative;
  const Eigen::Matrix<double, 6, 1> gradient =
      weight * residual->derivative.transpose() * residual->value;
  forLower([&](int p, int q, int n) { terms.hessian[n] = hessian(p, q); });
  for (int p = 0; p < 6; ++p) terms.right[p] = -gradient[p];
  return terms;
}

IsometricStep::System IsometricStep::systemAt(const std::vector<Vector3d>& images,
                                              const std::vector<Tangents>& tangents) const {
  const auto count = static_cast<Eigen::Index>(images.size());
  std::vector<FaceTerms> terms(surface_.faceCount());
  parallelBlocks(terms.size(), kTogether, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      terms[f] = termsOf(static_cast<Index>(f), images, tangents);
    }
  });
  System system{pattern_, Eigen::VectorXd::Zero(2 * count)};
  double* const values = system.matrix.valuePtr();
  for (Index f = 0; f < surface_.faceCount(); ++f) {
    const Triangle& face = surface_.face(f);
    for (std::size_t n = 0; n < terms[f].hessian.size(); ++n) {
      values[places_[f][n]] += terms[f].hessian[n];
    }
    for (int p = 0; p < 6; ++p) system.right[unknownOf(face, p)] += terms[f].right[p];
  }
  for (Eigen::Index v = 0; v < count; ++v) {
    const Vector3d away = images[v] - attractions_[v].place;
    const double s2 = scale_ * scale_, share = s2 / (s2 + away.squaredNorm());
    const double pull = 2 * pull_ * attractions_[v].weight * masses_[v] * share * share;
    system.right.segment<2>(2 * v) -= pull * tangents[v].transpose() * away;
    for (Eigen::Index i = 2 * v; i < 2 * v + 2; ++i) {
      // The diagonal is the first entry of its column.
      values[pattern_.outerIndexPtr()[i]] += kStay * masses_[v] + pull;
    }
  }
  return system;
}

Result<std::vector<Vector3d>> IsometricStep::operator()(Context& context,
                                                        const std::vector<Vector3d>& images,
                                                        const std::vector<Vector3d>& normals) {
  std::vector<Tangents> tangents;
  for (const Vector3d& normal : normals) tangents.push_back(tangentsOf(normal));
  const System system = systemAt(images, tangents);
  if (solver_) {
    RETURN_IF_ERROR(solver_->refactorize(context, system.matrix));
  } else {
    ASSIGN_OR_RETURN(SpdSolver solver, SpdSolver::make(context, system.matrix));
    solver_.emplace(std::move(solver));
  }
  ASSIGN_OR_RETURN(const Eigen::MatrixXd moves, solver_->solveUnjudged(context, system.right));
  std::vector<Vector3d> steps;
  for (std::size_t v = 0; v < images.size(); ++v) {
    steps.push_back(tangents[v] * moves.col(0).segment<2>(2 * static_cast<Eigen::Index>(v)));
  }
  return steps;
}

}  // namespace moduli
