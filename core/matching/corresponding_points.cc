#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/parallel.h"
#include "core/linalg/dense_product.h"
#include "core/matching/nearest_in_triangle.h"
#include "core/matching/spectral_match.h"

namespace moduli {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t kRows = 512;
// Enough to find the right region.
constexpr Eigen::Index kRoughModes = 60;

/// Calls visit(face, corner of v in it) for all faces around v.
template <typename Visit>
void facesAround(const Connectivity& surface, Index v, const Visit& visit) {
  const Index first = surface.outgoing(v);
  Index h = first;
  do {
    visit(h);
    h = surface.rotate(h);
  } while (h != kNone && h != first);
}

class Finder {
 public:
  Finder(const SpectralSurface& b, Eigen::Index modes)
      : surface_(b.mesh.connectivity()),
        graph_(b.graph),
        samples_(b.fine.vertices),
        places_(b.functions.leftCols(modes).transpose()) {
    rough_.resize(std::min(kRoughModes, modes), static_cast<Eigen::Index>(samples_.size()));
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      rough_.col(static_cast<Eigen::Index>(i)) = places_.col(samples_[i]).head(rough_.rows());
    }
    squares_ = rough_.colwise().squaredNorm();
  }

  /// points: modes x some.
  void find(const MatrixXd& points, SurfacePoint* found) const {
    const MatrixXd products = transposedProduct(rough_, points.topRows(rough_.rows()));
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      Eigen::Index nearest = 0;
      (squares_ - 2 * products.col(i)).minCoeff(&nearest);
      found[i] = pointNear(points.col(i), descend(points.col(i), samples_[nearest]));
    }
  }

 private:
  Index descend(const VectorXd& point, Index from) const {
    double best = (places_.col(from) - point).squaredNorm();
    for (Index at = from;; from = at) {
      for (const auto& [other, length] : graph_.neighbours(from)) {
        const double distance = (places_.col(other) - point).squaredNorm();
        if (!(distance < best)) continue;
        best = distance;
        at = other;
      }
      if (at == from) return at;
    }
  }

  SurfacePoint pointNear(const VectorXd& point, Index vertex) const {
    SurfacePoint nearest;
    double best = std::numeric_limits<double>::infinity();
    facesAround(surface_, vertex, [&](Index h) {
      const auto& [i, j, k] = surface_.face(h / 3);
      const auto weights =
          nearestInTriangle<VectorXd>(point, places_.col(i), places_.col(j), places_.col(k));
      const double distance = (weights[0] * places_.col(i) + weights[1] * places_.col(j) +
                               weights[2] * places_.col(k) - point)
                                  .squaredNorm();
      if (!(distance < best)) return;
      best = distance;
      nearest = {h / 3, weights};
    });
    return nearest;
  }

  const Connectivity& surface_;
  const EdgeGraph& graph_;
  const std::vector<Index>& samples_;
  MatrixXd places_, rough_;
  VectorXd squares_;
};

}  // namespace

Result<std::vector<SurfacePoint>> correspondingPoints(Context& context, const SpectralSurface& a,
                                                      const SpectralSurface& b,
                                                      const MatrixXd& functional) {
  const Context::Stage stage(context, "points");
  const Eigen::Index modes = functional.rows();
  const Finder finder(b, modes);
  const auto count = static_cast<std::size_t>(a.mesh.vertexCount());
  std::vector<SurfacePoint> points(count);
  parallelBlocks(count, kRows, [&](std::size_t begin, std::size_t end) {
    if (!context.check().ok()) return;
    const MatrixXd images =
        functional.transpose() * a.functions
                                     .block(static_cast<Eigen::Index>(begin), 0,
                                            static_cast<Eigen::Index>(end - begin), modes)
                                     .transpose();
    finder.find(images, points.data() + begin);
  });
  RETURN_IF_ERROR(context.check());
  return points;
}

}  // namespace moduli
