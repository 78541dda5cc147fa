#pragma once

#include <complex>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/mesh/triangle_soup.h"
#include "core/spherical/circle.h"

/// The signature of a surface as a plain value, field by field the message Signature of
/// proto/moduli/v1/signature.proto.
namespace moduli {

/// Raised whenever the same mesh would get other numbers than before.
inline constexpr int kDescriptorVersion = 5;

enum class ConformalType : std::uint8_t {
  kSphere,
  kDisk,
  kAnnulus,
  kCircleDomain,
  kTorus,
  kHyperbolic,
  kBordered
};

enum class Space : std::uint8_t { kConformal, kMetric, kShape };

struct SignatureTopology {
  Index vertices = 0, faces = 0, components = 0, genus = 0, boundary_loops = 0;
  Index euler_characteristic = 0;
  bool orientable = true;
  double area = 0;  ///< Squared model units.
};

/// A square matrix of periods, row by row.
struct PeriodEntries {
  Index size = 0;
  std::vector<std::complex<double>> values;  ///< size * size.
};

/// z -> (a z + b) / (conj(b) z + conj(a)), |a|^2 - |b|^2 = 1.
struct DiskIsometry {
  std::complex<double> a = 1, b = 0;
};

/// Fenchel-Nielsen coordinates, 3 g - 3 each, ascending by length; twists as signed lengths.
struct PantsCoordinates {
  std::vector<double> lengths, twists;
};

/// What no change that keeps angles alters. Errors are certified bounds for the polyhedral metric
/// of the mesh. Where there is a boundary, periods are those of the double.
struct ConformalBlock {
  ConformalType type = ConformalType::kSphere;
  std::optional<std::complex<double>> tau;  ///< Torus: reduced to the fundamental domain.
  std::optional<double> tau_error;          ///< Of |tau - exact|.
  std::optional<double> modulus;            ///< Annulus: log(r_out / r_in) / (2 pi).
  std::optional<double> modulus_error;
  /// Hyperbolic, circle domain, bordered: symmetric, Im > 0, Siegel-reduced.
  std::optional<PeriodEntries> period_matrix;
  std::optional<double> period_error;  ///< Of each entry, in the same marking.
  /// All with periods: the kEnergySpectrumLength smallest energies of primitive integer classes,
  /// +-n once, ascending. Empty where their enumeration takes too long.
  std::vector<double> energy_spectrum;
  std::optional<double> energy_spectrum_error;  ///< Of each energy, relative.
  /// Circle domain: the disk less round holes that it maps to, as canonicalCircles has them. No
  /// bound of their errors; empty where the map fails.
  std::vector<Circle> circles;
  /// Negative Euler characteristic, by the hyperbolic metric (of the double): primitive closed
  /// geodesics, ascending, complete up to certificate.spectrum_complete_to.
  std::vector<double> length_spectrum;
  std::vector<DiskIsometry> generators;  ///< Of the group of that surface: A_1 B_1 A_2 B_2 ..
  std::optional<PantsCoordinates> fenchel_nielsen;  ///< Of that surface.
  /// With a boundary too: of the geodesics that the loops become, ascending.
  std::vector<double> boundary_lengths;
};

/// What bending without stretching keeps.
struct MetricBlock {
  /// The first kModeCount positive eigenvalues of the Laplace-Beltrami operator times the area.
  std::vector<double> laplace_spectrum;
  /// Closed genus 0 and 1: power of the log conformal factor per frequency 1 .. kSpectrumBins, see
  /// spectra.h.
  std::vector<double> conformal_factor_spectrum;
};

/// What rigid motion and scaling keep. Closed genus 0 and 1; empty elsewhere.
struct ShapeBlock {
  std::vector<double> mean_curvature_spectrum;
  std::vector<double> cross_spectrum;  ///< Of conformal factor and mean curvature; signed.
};

/// Unit-free vectors whose Euclidean distance is the distance of the space (metric, shape) or a
/// continuous stand-in for it (conformal).
struct SearchVectors {
  std::vector<float> conformal, metric, shape;
};

/// Residuals and quality figures, computed from the final numbers. Empty where one does not apply.
struct SignatureCertificate {
  std::optional<double> riemann_bilinear_residual;
  std::optional<double> period_symmetry_residual;
  std::optional<double> curvature_residual, gauss_bonnet_residual;  ///< Hyperbolic metric, radians.
  std::optional<int> flips;
  std::optional<double> smallest_angle;        ///< Of the hyperbolic triangulation, radians.
  std::optional<double> mode_residual;         ///< Of the Laplace-Beltrami modes, relative.
  std::optional<double> relation_residual;     ///< Of the generators.
  std::optional<double> spectrum_complete_to;  ///< Of the length spectrum.
  std::optional<double> layout_closure;
  std::optional<int> flipped_faces;
  std::optional<double> max_dilatation, mean_dilatation;
  std::optional<int> newton_iterations;
  std::optional<double> mollification;
  std::vector<std::string> warnings;
};

struct Signature {
  SignatureTopology topology;
  std::optional<ConformalBlock> conformal;
  std::optional<MetricBlock> metric;
  std::optional<ShapeBlock> shape;
  SearchVectors vectors;
  int descriptor_version = kDescriptorVersion;
  SignatureCertificate certificate;
  std::map<std::string, double> timing;  ///< Seconds per stage.
};

}  // namespace moduli
