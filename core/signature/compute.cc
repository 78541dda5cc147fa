#include "core/signature/compute.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "core/base/text.h"
#include "core/forms/cotan.h"
#include "core/forms/torus_period.h"
#include "core/intrinsic/chordal_metric.h"
#include "core/intrinsic/mollify.h"
#include "core/ricci/uniformize.h"
#include "core/signature/canonical_circles.h"
#include "core/signature/conformal_block.h"
#include "core/signature/conformal_vector.h"
#include "core/signature/descriptor.h"
#include "core/signature/hyperbolic_invariants.h"
#include "core/signature/mean_curvature.h"
#include "core/signature/spectra.h"
#include "core/signature/surface_modes.h"
#include "core/spherical/circle_domain_map.h"
#include "core/spherical/face_frame.h"
#include "core/spherical/robust_map.h"
#include "core/spherical/sphere_map.h"
#include "core/topology/surface_topology.h"

namespace moduli {
namespace {

/// The centring of a sphere map stops at rounding; the form of a torus closes to the rounding of a
/// solve. A thousand times what real meshes leave is a failure.
constexpr double kMaxCenteringResidual = 1e-9;
constexpr double kMaxClosure = 1e-8;
/// On exact forms the area check is the determinant gap of the energy, a discretization error. Past
/// this the harmonic forms do not resemble holomorphic ones and tau says nothing.
constexpr double kMaxRiemannResidual = 0.5;
/// Relative to Im tau; larger bounds are worth a word.
constexpr double kTellingTauError = 0.1;

class SignatureBuilder {
 public:
  SignatureBuilder(Context& context, const PreparedMesh& prepared, const SignatureOptions& options)
      : context_(context),
        surface_(prepared.mesh.connectivity()),
        mesh_(&prepared.mesh),
        options_(options) {
    signature_.certificate.warnings = prepared.warnings;
  }
  SignatureBuilder(Context& context, const IntrinsicSurface& intrinsic,
                   const SignatureOptions& options)
      : context_(context),
        surface_(intrinsic.connectivity),
        intrinsic_(&intrinsic),
        options_(options) {}

  Result<Signature> build() {
    RETURN_IF_ERROR(describeTopology());
    RETURN_IF_ERROR(checkSpaces());
    switch (conformalTypeOf(signature_.topology.genus, signature_.topology.boundary_loops)) {
      case ConformalType::kSphere:
        RETURN_IF_ERROR(signSphere());
        break;
      case ConformalType::kTorus:
        RETURN_IF_ERROR(signTorus());
        break;
      default:
        RETURN_IF_ERROR(signPeriods());
    }
    RETURN_IF_ERROR(describeBody());
    fillConformalVector();
    signature_.timing = context_.timing();
    return std::move(signature_);
  }

 private:
  bool wants(Space space) const { return !options_.space || *options_.space == space; }
  bool wantsFields() const {
    return mesh_ != nullptr && (wants(Space::kMetric) || wants(Space::kShape));
  }
  const Connectivity& surface() const { return surface_; }

  Status describeTopology() {
    const Context::Stage stage(context_, "topology");
    const SurfaceTopology topology = computeTopology(surface());
    SignatureTopology& block = signature_.topology;
    block.vertices = surface().vertexCount();
    block.faces = surface().faceCount();
    block.components = topology.components;
    block.genus = topology.genus;
    block.boundary_loops = static_cast<Index>(topology.boundary_loops.size());
    block.euler_characteristic = topology.euler_characteristic;
    block.area = mesh_ != nullptr ? mesh_->area() : surfaceArea(*intrinsic_);
    if (!std::isfinite(block.area)) {
      return {Reason::kOverflow, "the area of the surface is too large for a double",
              "give the coordinates in larger units"};
    }
    if (block.components == 1) return {};
    return {Reason::kUnsupportedTopology,
            "the surface has " + std::to_string(block.components) + " components instead of 1",
            "sign one of them"};
  }

  /// Without positions there is only the conformal space.
  Status checkSpaces() {
    if (mesh_ != nullptr) return {};
    const std::string why =
        "the metric and shape spaces of intrinsic triangulations are not "
        "available";
    if (!wants(Space::kConformal)) {
      return {Reason::kUnsupportedContent, why,
              "ask for the conformal space, or give the surface as a mesh"};
    }
    if (!options_.space) signature_.certificate.warnings.push_back("SPACES_OMITTED: " + why);
    return {};
  }

  /// Every other type: its periods, and no map to a canonical domain yet.
  Status signPeriods() {
    const SignatureTopology& topology = signature_.topology;
    RETURN_IF_ERROR(makeMetric());
    if (!wants(Space::kConformal)) return {};
    ASSIGN_OR_RETURN(CertifiedConformalBlock certified,
                     computeConformalBlock(context_, surface(), topology, lengths_));
    signature_.conformal = std::move(certified.block);
    SignatureCertificate& certificate = signature_.certificate;
    certificate.riemann_bilinear_residual = certified.riemann_bilinear_residual;
    certificate.period_symmetry_residual = certified.period_symmetry_residual;
    certificate.warnings.insert(certificate.warnings.end(), certified.warnings.begin(),
                                certified.warnings.end());
    RETURN_IF_ERROR(addCircles());
    return topology.euler_characteristic < 0 ? certifyHyperbolic() : Status();
  }

  /// Whether discrete conformal maps start from the intrinsic Delaunay triangulation.
  bool startsDelaunay() const {
    const bool euclidean = intrinsic_ == nullptr || intrinsic_->geometry == Geometry::kEuclidean;
    return options_.initial_delaunay && euclidean;
  }

  /// In the units of the lengths; none of an intrinsic surface.
  std::vector<Eigen::Vector3d> unitPositions() const {
    if (mesh_ == nullptr) return {};
    std::vector<Eigen::Vector3d> positions = mesh_->positions();
    for (Eigen::Vector3d& p : positions) {
      for (double& coordinate : p) coordinate = std::ldexp(coordinate, -exponent_);
    }
    return positions;
  }

  /// The other invariants stand without them.
  Status addCircles() {
    if (!signature_.conformal || signature_.conformal->type != ConformalType::kCircleDomain) {
      return {};
    }
    const Result<CircleDomain> domain =
        mapToCircleDomain(context_, surface(), lengths_, unitPositions(), startsDelaunay());
    if (domain.ok()) {
      signature_.conformal->circles = canonicalCircles(domain->circles);
      return {};
    }
    const Reason reason = domain.status().reason();
    if (reason == Reason::kCancelled || reason == Reason::kDeadlineExceeded) {
      return domain.status();
    }
    signature_.certificate.warnings.push_back("CIRCLES_OMITTED: " + domain.status().message());
    return {};
  }

  Status certifyHyperbolic() {
    UniformizeOptions options;
    options.initial_delaunay = startsDelaunay();
    const Result<Uniformization> found = uniformize(context_, surface(), lengths_, options);
    SignatureCertificate& certificate = signature_.certificate;
    if (found.status().reason() == Reason::kNoConvergence) {
      certificate.warnings.push_back("NO_HYPERBOLIC_METRIC: " + found.status().message());
      return {};
    }
    RETURN_IF_ERROR(found.status());
    const MetricCertificate& metric = found->metric.certificate;
    certificate.curvature_residual = metric.curvature_residual;
    certificate.gauss_bonnet_residual = metric.gauss_bonnet_residual;
    certificate.newton_iterations = metric.newton_iterations;
    certificate.flips = metric.flips;
    certificate.smallest_angle = metric.smallest_angle;
    if (!signature_.conformal) return {};
    signature_.conformal->boundary_lengths = geodesicBoundaryLengths(surface(), *found);
    return addGeodesics(found->metric);
  }

  /// The other invariants stand without the group and its closed geodesics.
  Status addGeodesics(const DiscreteMetric& metric) {
    const Context::Stage stage(context_, "geodesics");
    const Result<HyperbolicInvariants> found =
        hyperbolicInvariants(context_, metric, options_.spectrum_length);
    std::vector<std::string>& warnings = signature_.certificate.warnings;
    if (!found.ok()) {
      const Reason reason = found.status().reason();
      if (reason == Reason::kCancelled || reason == Reason::kDeadlineExceeded) {
        return found.status();
      }
      warnings.push_back("GEODESICS_OMITTED: " + found.status().message());
      return {};
    }
    signature_.conformal->generators = found->generators;
    signature_.conformal->length_spectrum = found->lengths;
    signature_.conformal->fenchel_nielsen = found->pants;
    first_lengths_ = found->first_lengths;
    signature_.certificate.relation_residual = found->relation_residual;
    if (!found->geodesics.ok()) {
      warnings.push_back("GEODESICS_OMITTED: " + found->geodesics.message());
      return {};
    }
    signature_.certificate.spectrum_complete_to = found->complete_to;
    const std::optional<double> asked = options_.spectrum_length;
    if (asked && found->complete_to < *asked) {
      warnings.push_back("SPECTRUM_LIMITED: closed geodesics up to " + shortestDouble(*asked) +
                         " are too many to find; up to " + shortestDouble(found->complete_to) +
                         " all are there");
    }
    if (!found->pants) warnings.push_back("PANTS_OMITTED: " + found->pants_curves.message());
    return {};
  }

  Status signSphere() {
    keepConformal(ConformalBlock());  // All spheres are conformally one.
    if (!wantsFields()) return {};
    RETURN_IF_ERROR(makeMetric());
    ASSIGN_OR_RETURN(const SphereMap map, sphereMap());
    RETURN_IF_ERROR(certifySphere(map));
    std::vector<double> canonical(surface().faceCount());
    for (Index f = 0; f < surface().faceCount(); ++f) {
      const auto& [a, b, c] = surface().face(f);
      canonical[f] = std::abs(signedSolidAngle(map.points[a], map.points[b], map.points[c]));
    }
    ASSIGN_OR_RETURN(const VertexFields fields, makeFields(canonical));
    const Context::Stage stage(context_, "spectra");
    ASSIGN_OR_RETURN(FieldSpectra spectra, sphereSpectra(context_, surface(), map.points, fields));
    keepSpectra(std::move(spectra));
    return {};
  }

  Status signTorus() {
    RETURN_IF_ERROR(makeMetric());
    ASSIGN_OR_RETURN(const TorusPeriod period, computeTorusPeriod(context_, surface(), lengths_));
    RETURN_IF_ERROR(certifyTorus(period));
    RETURN_IF_ERROR(describeTorus(period));
    if (!wantsFields()) return {};

    const std::vector<std::complex<double>> corners = layOutTorus(surface(), period);
    ASSIGN_OR_RETURN(const VertexFields fields, makeFields(certifyLayout(corners)));
    const Context::Stage stage(context_, "spectra");
    ASSIGN_OR_RETURN(FieldSpectra spectra,
                     torusSpectra(context_, surface(), corners, period.tau, fields));
    keepSpectra(std::move(spectra));
    return {};
  }

  Status describeTorus(const TorusPeriod& period) {
    ConformalBlock block;
    block.type = ConformalType::kTorus;
    block.tau = period.tau;
    block.tau_error = period.tau_error;
    if (!wants(Space::kConformal)) return {};
    ASSIGN_OR_RETURN(const std::optional<std::string> warning,
                     addEnergySpectrum(context_, period.energy, period.spread, block));
    if (warning) signature_.certificate.warnings.push_back(*warning);
    keepConformal(std::move(block));
    return {};
  }

  void keepConformal(ConformalBlock block) {
    if (wants(Space::kConformal)) signature_.conformal = std::move(block);
  }

  Result<std::vector<double>> polyhedralLengths() {
    if (mesh_ != nullptr) return mesh_->edgeLengths();
    if (intrinsic_->geometry != Geometry::kEuclidean) {
      signature_.certificate.warnings.push_back(
          "CHORDAL_METRIC: periods and their errors are those of the polyhedral surface whose "
          "edges are the chords of these");
    }
    return chordLengths(*intrinsic_);
  }

  Status makeMetric() {
    const Context::Stage stage(context_, "metric");
    ASSIGN_OR_RETURN(std::vector<double> lengths, polyhedralLengths());
    ASSIGN_OR_RETURN(MollifiedLengths mollified, mollify(surface(), std::move(lengths)));
    exponent_ = lengthExponent(mollified.lengths);
    lengths_ = unitLengths(mollified.lengths);
    signature_.certificate.mollification = mollified.relative_shift;
    return {};
  }

  /// The robust map, or the linear one where needles keep that from its end.
  Result<SphereMap> sphereMap() {
    Result<SphereMap> map =
        mapToSphereRobust(context_, surface(), lengths_, unitPositions(), startsDelaunay());
    if (map.status().reason() != Reason::kNoConvergence) return map;
    return mapToSphereLinear(context_, surface(), lengths_);
  }

  Status certifySphere(const SphereMap& map) {
    SignatureCertificate& certificate = signature_.certificate;
    if (map.quality.flipped_faces > 0) {
      certificate.warnings.push_back("FOLDED_MAP: the map to the sphere folds " +
                                     std::to_string(map.quality.flipped_faces) +
                                     " faces; the spectra depend on it a little");
    }
    certificate.flipped_faces = map.quality.flipped_faces;
    certificate.max_dilatation = map.quality.max_dilatation;
    certificate.mean_dilatation = map.quality.mean_dilatation;
    certificate.newton_iterations = map.newton_iterations;
    if (map.centering_residual <= kMaxCenteringResidual &&
        std::isfinite(map.quality.max_dilatation)) {
      return {};
    }
    return {Reason::kResidualTooLarge,
            "the map to the sphere is centred to " + shortestDouble(map.centering_residual) +
                " only, or squeezes a face to nothing",
            "remesh the surface; parts of it are too thin for double precision"};
  }

  Status certifyTorus(const TorusPeriod& period) {
    SignatureCertificate& certificate = signature_.certificate;
    certificate.riemann_bilinear_residual = period.riemann_residual;
    certificate.layout_closure = period.closure_residual;
    if (!(period.riemann_residual <= kMaxRiemannResidual)) {
      return {Reason::kResidualTooLarge,
              "the area check of the holomorphic form fails by " +
                  shortestDouble(period.riemann_residual) +
                  " (allowed: " + shortestDouble(kMaxRiemannResidual) + ")",
              "remesh the surface more finely"};
    }
    if (!(period.closure_residual <= kMaxClosure)) {
      return {Reason::kResidualTooLarge,
              "the holomorphic form closes only to " + shortestDouble(period.closure_residual) +
                  " of a mean edge (allowed: " + shortestDouble(kMaxClosure) + ")",
              "remesh the surface with fewer thin triangles"};
    }
    if (period.tau_error > kTellingTauError * period.tau.imag()) {
      certificate.warnings.push_back("COARSE_MESH: tau is certain only to " +
                                     shortestDouble(period.tau_error));
    }
    return {};
  }

  /// Counts folded faces of the layout and measures its dilatation. Returns the faces' canonical
  /// areas.
  std::vector<double> certifyLayout(const std::vector<std::complex<double>>& corners) {
    const std::vector<double> areas = faceAreas(surface(), lengths_);
    std::vector<double> canonical(surface().faceCount());
    Index flipped = 0;
    double largest = 1, weighted = 0, total = 0;
    for (Index f = 0; f < surface().faceCount(); ++f) {
      const std::complex<double> u = corners[3 * f + 1] - corners[3 * f];
      const std::complex<double> w = corners[3 * f + 2] - corners[3 * f];
      const double doubled = std::imag(std::conj(u) * w);
      if (!(doubled > 0)) ++flipped;
      canonical[f] = std::abs(doubled) / 2;
      const double base = std::abs(u);
      const double k = dilatation(
          frameFromSides(lengths_[surface().edge(3 * f)], lengths_[surface().edge(3 * f + 1)],
                         lengths_[surface().edge(3 * f + 2)], areas[f]),
          {base, std::real(std::conj(u) * w) / base, std::abs(doubled) / base});
      largest = std::max(largest, k);
      weighted += areas[f] * k;
      total += areas[f];
    }
    SignatureCertificate& certificate = signature_.certificate;
    certificate.flipped_faces = flipped;
    if (std::isfinite(largest)) {
      certificate.max_dilatation = largest;
      certificate.mean_dilatation = weighted / total;
    }
    if (flipped > 0) {
      certificate.warnings.push_back("FOLDED_MAP: the flat layout folds " +
                                     std::to_string(flipped) +
                                     " faces; tau does not depend on it, the spectra do a little");
    }
    return canonical;
  }

  /// Log conformal factor and, if asked for, mean curvature, at the vertices, both for the surface
  /// and the canonical domain scaled to area 4 pi. canonical: area of each face there.
  Result<VertexFields> makeFields(const std::vector<double>& canonical) {
    const Context::Stage stage(context_, "fields");
    RETURN_IF_ERROR(context_.check());
    const std::vector<double> areas = vertexAreas(surface(), lengths_);
    std::vector<double> image(surface().vertexCount(), 0.0);
    double total = 0, image_total = 0;
    for (Index f = 0; f < surface().faceCount(); ++f) {
      for (const Index v : surface().face(f)) image[v] += canonical[f] / 3;
      image_total += canonical[f];
    }
    for (const double area : areas) total += area;

    VertexFields fields;
    std::vector<double> factor(surface().vertexCount(), 0.0);
    for (Index v = 0; v < surface().vertexCount(); ++v) {
      // A vertex whose faces shrink to nothing carries no weight, whatever stands here.
      if (image[v] > 0)
        factor[v] = 0.5 * (std::log(areas[v] / total) - std::log(image[v] / image_total));
    }
    fields.push_back(std::move(factor));
    if (wants(Space::kShape)) {
      std::vector<double> curvature = integratedMeanCurvature(*mesh_);
      const double scale = std::sqrt(total / (4 * std::numbers::pi));
      for (Index v = 0; v < surface().vertexCount(); ++v) {
        curvature[v] = std::ldexp(curvature[v], -exponent_) * (scale / areas[v]);
      }
      fields.push_back(std::move(curvature));
    }
    return fields;
  }

  void keepSpectra(FieldSpectra spectra) {
    metric_.conformal_factor_spectrum = std::move(spectra.first);
    shape_.mean_curvature_spectrum = std::move(spectra.second);
    shape_.cross_spectrum = std::move(spectra.cross);
  }

  static std::vector<float> narrowed(const std::vector<double>& numbers) {
    return {numbers.begin(), numbers.end()};
  }

  /// The metric and shape spaces, of every topology: from the modes of the surface, and its place
  /// in space. The other spaces stand without them.
  Status describeBody() {
    if (!wantsFields()) return {};
    const Status status = addDescriptors();
    const Reason reason = status.reason();
    const bool stopped = reason == Reason::kCancelled || reason == Reason::kDeadlineExceeded;
    if (status.ok() || stopped || options_.space) return status;
    signature_.metric.reset();
    signature_.shape.reset();
    signature_.vectors = {};
    signature_.certificate.warnings.push_back("SPACES_OMITTED: " + status.message());
    return {};
  }

  Status addDescriptors() {
    ASSIGN_OR_RETURN(const SurfaceModes modes, surfaceModes(context_, surface(), lengths_));
    signature_.certificate.mode_residual = modes.largest_residual;
    metric_.laplace_spectrum.assign(modes.values.begin(), modes.values.end());
    SearchVectors& vectors = signature_.vectors;
    if (wants(Space::kMetric)) {
      signature_.metric = metric_;
      vectors.metric = narrowed(weighParts(metricParts(modes)));
    }
    if (!wants(Space::kShape)) return {};
    ASSIGN_OR_RETURN(const std::vector<DescriptorPart> parts,
                     shapeParts(context_, *mesh_, lengths_, modes));
    signature_.shape = shape_;
    vectors.shape = narrowed(weighParts(parts));
    return {};
  }

  void fillConformalVector() {
    if (!signature_.conformal) return;
    signature_.vectors.conformal =
        narrowed(conformalVector(*signature_.conformal, signature_.topology, first_lengths_));
  }

  Context& context_;
  const Connectivity& surface_;
  const TriangleMesh* mesh_ = nullptr;           ///< One of the two.
  const IntrinsicSurface* intrinsic_ = nullptr;  ///< No positions: no metric and shape spaces.
  const SignatureOptions& options_;
  std::vector<double> lengths_;  ///< Per edge, in units of 2^exponent_ model units.
  int exponent_ = 0;
  std::vector<double> first_lengths_;  ///< Of closed geodesics, for the vector.
  MetricBlock metric_;
  ShapeBlock shape_;
  Signature signature_;
};

}  // namespace

Result<Signature> computeSignature(Context& context, const PreparedMesh& prepared,
                                   const SignatureOptions& options) {
  return SignatureBuilder(context, prepared, options).build();
}

Result<Signature> computeIntrinsicSignature(Context& context, const IntrinsicSurface& surface,
                                            const SignatureOptions& options) {
  return SignatureBuilder(context, surface, options).build();
}

}  // namespace moduli
