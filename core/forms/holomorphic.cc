#include "core/forms/holomorphic.h"

#include <Eigen/Cholesky>
#include <array>

#include "core/forms/flat_triangle.h"

namespace moduli {
namespace {

bool pointsForward(const Connectivity& surface, const std::vector<double>& values, Index h) {
  const double value = surface.sign(h) * values[surface.edge(h)];
  return value > 0 || (value == 0 && surface.head(h) > surface.tail(h));
}

}  // namespace

HolomorphicForms holomorphicForms(const ClosedPeriods& closed) {
  const Eigen::MatrixXcd& period = closed.periods.period;
  const Eigen::Index g = period.rows();
  const FormBasis& harmonic = closed.harmonic;
  const auto combined = [&](const RowMajorMatrix& values) -> RowMajor<std::complex<double>> {
    return values.leftCols(g).cast<std::complex<double>>() +
           values.rightCols(g).cast<std::complex<double>>() * period.transpose();
  };
  return {combined(harmonic.potential), harmonic.seam, combined(harmonic.jumps)};
}

std::vector<FormZero> zerosOfForm(const Connectivity& surface, const std::vector<double>& values) {
  std::vector<FormZero> zeros;
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    int changes = 0;
    const Index first = surface.outgoing(v);
    Index h = first;
    do {
      const Index next = surface.rotate(h);
      if (next == kNone) break;
      if (pointsForward(surface, values, h) != pointsForward(surface, values, next)) ++changes;
      h = next;
    } while (h != first);
    if (changes != 2) zeros.push_back({v, 1 - changes / 2});
  }
  return zeros;
}

std::vector<double> realPart(const Connectivity& surface, const HolomorphicForms& forms,
                             const std::vector<std::complex<double>>& c) {
  std::vector<double> values(surface.edgeCount(), 0.0);
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    for (std::size_t k = 0; k < c.size(); ++k) {
      const auto a = static_cast<Eigen::Index>(k);
      values[e] += std::real(c[k] * forms.along(surface, surface.halfedge(e), a));
    }
  }
  return values;
}

Eigen::MatrixXd starByFaces(const Connectivity& surface, const std::vector<double>& lengths,
                            const FormBasis& forms) {
  const Eigen::Index count = forms.count();
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(count, count);
  Eigen::MatrixXd turned = Eigen::MatrixXd::Zero(count, count);
  Eigen::MatrixXd gradients(count, 2);
  for (Index f = 0; f < surface.faceCount(); ++f) {
    const TriangleFrame frame({lengths[surface.edge(3 * f)], lengths[surface.edge(3 * f + 1)],
                               lengths[surface.edge(3 * f + 2)]});
    for (Eigen::Index a = 0; a < count; ++a) {
      std::array<double, 3> along{};
      for (Index c = 0; c < 3; ++c) along[c] = forms.along(surface, 3 * f + c, a);
      gradients.row(a) = frame.gradient(along);
    }
    // The frame is oriented as the face: *(dx) = dy, *(dy) = -dx.
    Eigen::MatrixXd quarter(count, 2);
    quarter << -gradients.col(1), gradients.col(0);
    gram += frame.area() * gradients * gradients.transpose();
    turned += frame.area() * quarter * gradients.transpose();
  }
  return gram.llt().solve(turned.transpose()).transpose();
}

}  // namespace moduli
