#include <Eigen/Core>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "core/signature/field_samples.h"
#include "core/signature/spectra.h"

namespace moduli {
namespace {

using Complex = std::complex<double>;

/// C / (Z + tau Z), scaled to area 4 pi.
struct TorusDomain {
  using Point = Complex;
  const std::vector<Complex>& corners;
  double scale;

  Point corner(Index f, Index c) const { return scale * corners[3 * f + c]; }
  Point blend(const std::array<double, 3>& w, Point a, Point b, Point c) const {
    return w[0] * a + w[1] * b + w[2] * c;
  }
  double area(Point a, Point b, Point c) const {
    return 0.5 * std::abs(std::imag(std::conj(b - a) * (c - a)));
  }
  double distance(Point a, Point b) const { return std::abs(a - b); }
};

/// The waves exp(2 pi i (a s + b t)) at z = s + t tau for one a and b = first, first + 1, ...
struct WaveRow {
  int a = 0;
  int first = 0;
  std::vector<double> frequencies;
};

/// One of every pair of opposite waves, up to the last frequency that has a share in the spectrum.
std::vector<WaveRow> waves(Complex tau) {
  constexpr double kLargest = (kSpectrumBins + 1.0) * (kSpectrumBins + 2.0);
  // mu = pi |b - a tau|^2 / Im tau on the torus of area 4 pi.
  const double reach = std::sqrt(kLargest * tau.imag() / std::numbers::pi);
  const int last = static_cast<int>(reach / tau.imag());
  std::vector<WaveRow> rows;
  for (int a = 0; a <= last; ++a) {
    const double middle = a * tau.real();
    const double width = std::sqrt(std::max(0.0, reach * reach - std::norm(a * tau.imag())));
    WaveRow row;
    row.a = a;
    row.first = a == 0 ? 1 : static_cast<int>(std::ceil(middle - width));
    for (int b = row.first; b <= middle + width; ++b) {
      const double mu = std::numbers::pi *
                        std::norm(static_cast<double>(b) - static_cast<double>(a) * tau) /
                        tau.imag();
      row.frequencies.push_back(std::sqrt(mu + 0.25) - 0.5);
    }
    if (!row.frequencies.empty()) rows.push_back(std::move(row));
  }
  return rows;
}

/// Sums values * exp(-2 pi i (a s + b t)); rows of sums: cosine and sine part of each wave in turn.
class WaveTransform {
 public:
  WaveTransform(const Samples<Complex>& samples, const std::vector<WaveRow>& rows, Complex tau,
                double scale)
      : samples_(samples), rows_(rows), tau_(tau), scale_(scale) {}

  void add(std::size_t begin, std::size_t end, Eigen::MatrixXd& sums) const {
    const auto n = static_cast<Eigen::Index>(end - begin);
    const auto fields = static_cast<Eigen::Index>(samples_.fields.size());
    Eigen::ArrayXd s(n), t(n);
    Eigen::MatrixXd values(n, fields);
    for (Eigen::Index i = 0; i < n; ++i) {
      const std::size_t at = begin + static_cast<std::size_t>(i);
      t[i] = samples_.points[at].imag() / (scale_ * tau_.imag());
      s[i] = samples_.points[at].real() / scale_ - t[i] * tau_.real();
      for (Eigen::Index k = 0; k < fields; ++k) {
        values(i, k) = samples_.weights[at] * samples_.fields[k][at];
      }
    }
    const Eigen::ArrayXd step_angle = 2 * std::numbers::pi * t;
    const Eigen::ArrayXd step_cosine = step_angle.cos();
    const Eigen::ArrayXd step_sine = step_angle.sin();
    Eigen::Index at = 0;
    for (const WaveRow& row : rows_) {
      const Eigen::ArrayXd angle = 2 * std::numbers::pi * (row.a * s + row.first * t);
      const auto count = static_cast<Eigen::Index>(row.frequencies.size());
      Eigen::MatrixXd wave(n, 2 * count);
      wave.col(0) = angle.cos();
      wave.col(1) = angle.sin();
      for (Eigen::Index j = 1; j < count; ++j) {
        const auto cosine = wave.col(2 * j - 2).array();
        const auto sine = wave.col(2 * j - 1).array();
        wave.col(2 * j) = cosine * step_cosine - sine * step_sine;
        wave.col(2 * j + 1) = cosine * step_sine + sine * step_cosine;
      }
      // One field at a time: its sums do not depend, to the last bit, on who else is there.
      for (Eigen::Index k = 0; k < fields; ++k) {
        sums.col(k).segment(at, 2 * count).noalias() += wave.transpose() * values.col(k);
      }
      at += 2 * count;
    }
  }

 private:
  const Samples<Complex>& samples_;
  const std::vector<WaveRow>& rows_;
  Complex tau_;
  double scale_;
};

void addWave(FieldSpectra& spectra, double frequency, const Eigen::RowVectorXd& mode) {
  const int below = static_cast<int>(std::floor(frequency));
  if (below < 1) {
    addPower(spectra, 1, 1, mode);
    return;
  }
  const double past = frequency - below;
  addPower(spectra, below, 1 - past, mode);
  addPower(spectra, below + 1, past, mode);
}

}  // namespace

Result<FieldSpectra> torusSpectra(Context& context, const Connectivity& surface,
                                  const std::vector<Complex>& corners, Complex tau,
                                  const VertexFields& fields) {
  const double scale = std::sqrt(4 * std::numbers::pi / tau.imag());
  const TorusDomain domain{corners, scale};
  Samples<Complex> samples =
      Quadrature<TorusDomain>(surface, domain, fields, kFinestLength).build();
  RETURN_IF_ERROR(context.check());
  removeMeans(samples);

  const std::vector<WaveRow> rows = waves(tau);
  Eigen::Index count = 0;
  for (const WaveRow& row : rows) count += 2 * static_cast<Eigen::Index>(row.frequencies.size());
  const WaveTransform transform(samples, rows, tau, scale);
  ASSIGN_OR_RETURN(const Eigen::MatrixXd sums,
                   sumOverSamples(context, samples.points.size(), count, fields.size(),
                                  [&](std::size_t begin, std::size_t end, Eigen::MatrixXd& out) {
                                    transform.add(begin, end, out);
                                  }));
  // The orthonormal real waves are sqrt(2 / area) cos and sin.
  const double unit = 1 / std::sqrt(2 * std::numbers::pi);
  FieldSpectra spectra = emptySpectra(fields.size());
  Eigen::Index at = 0;
  for (const WaveRow& row : rows) {
    for (const double frequency : row.frequencies) {
      addWave(spectra, frequency, unit * sums.row(at++));
      addWave(spectra, frequency, unit * sums.row(at++));
    }
  }
  return spectra;
}

}  // namespace moduli
