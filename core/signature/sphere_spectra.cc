#include <Eigen/Core>
#include <array>

#include "core/signature/field_samples.h"
#include "core/signature/spectra.h"
#include "core/signature/spherical_harmonics.h"
#include "core/spherical/sphere_map.h"

namespace moduli {
namespace {

/// A triangulated sphere; faces are the radial projections of their chord triangles.
struct SphereDomain {
  using Point = Eigen::Vector3d;
  const Connectivity& surface;
  const Points3& points;

  Point corner(Index f, Index c) const { return points[surface.face(f)[c]]; }
  Point blend(const std::array<double, 3>& w, const Point& a, const Point& b,
              const Point& c) const {
    return (w[0] * a + w[1] * b + w[2] * c).normalized();
  }
  double area(const Point& a, const Point& b, const Point& c) const {
    return signedSolidAngle(a, b, c);
  }
  double distance(const Point& a, const Point& b) const { return (a - b).norm(); }
};

/// Weighted values of the fields at a run of samples, as the harmonics take them.
struct Batch {
  Eigen::MatrixX3d points;
  Eigen::MatrixXd values;
};

Batch makeBatch(const Samples<Eigen::Vector3d>& samples, std::size_t begin, std::size_t end) {
  const auto rows = static_cast<Eigen::Index>(end - begin);
  Batch batch{Eigen::MatrixX3d(rows, 3),
              Eigen::MatrixXd(rows, static_cast<Eigen::Index>(samples.fields.size()))};
  for (Eigen::Index i = 0; i < rows; ++i) {
    const std::size_t at = begin + static_cast<std::size_t>(i);
    batch.points.row(i) = samples.points[at].transpose();
    for (Eigen::Index k = 0; k < batch.values.cols(); ++k) {
      batch.values(i, k) = samples.weights[at] * samples.fields[k][at];
    }
  }
  return batch;
}

}  // namespace

Result<FieldSpectra> sphereSpectra(Context& context, const Connectivity& surface,
                                   const Points3& points, const VertexFields& fields) {
  const SphereDomain domain{surface, points};
  Samples<Eigen::Vector3d> samples =
      Quadrature<SphereDomain>(surface, domain, fields, kFinestLength).build();
  RETURN_IF_ERROR(context.check());
  removeMeans(samples);

  const SphericalHarmonics harmonics(kSpectrumBins);
  ASSIGN_OR_RETURN(const Eigen::MatrixXd coefficients,
                   sumOverSamples(context, samples.points.size(), harmonics.count(), fields.size(),
                                  [&](std::size_t begin, std::size_t end, Eigen::MatrixXd& sums) {
                                    const Batch batch = makeBatch(samples, begin, end);
                                    harmonics.project(batch.points, batch.values, sums);
                                  }));
  FieldSpectra spectra = emptySpectra(fields.size());
  for (int l = 1; l <= kSpectrumBins; ++l) {
    for (int m = -l; m <= l; ++m) {
      addPower(spectra, l, 1, coefficients.row(SphericalHarmonics::index(l, m)));
    }
  }
  return spectra;
}

}  // namespace moduli
