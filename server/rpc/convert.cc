#include "server/rpc/convert.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <string>

#include "core/signature/conformal_block.h"

namespace moduli {
namespace {

// Far above any signature of ours; guards the indexes against hostile ones.
constexpr int kMaxArray = 4096;
constexpr int kMaxMatrix = kMaxPeriodGenus;
// The double of a circle domain with b circles has genus b - 1.
constexpr int kMaxCircles = kMaxPeriodGenus + 1;

v1::Topology toProto(const SurfaceCounts& counts) {
  v1::Topology topology;
  topology.set_vertices(counts.vertices);
  topology.set_faces(counts.faces);
  topology.set_components(counts.components);
  if (counts.genus) topology.set_genus(*counts.genus);
  topology.set_boundary_loops(counts.boundary_loops);
  topology.set_euler_characteristic(counts.euler_characteristic);
  topology.set_orientable(counts.orientable);
  topology.set_area(counts.area);
  return topology;
}

v1::Topology toProto(const SignatureTopology& topology) {
  v1::Topology message;
  message.set_vertices(topology.vertices);
  message.set_faces(topology.faces);
  message.set_components(topology.components);
  message.set_genus(topology.genus);
  message.set_boundary_loops(topology.boundary_loops);
  message.set_euler_characteristic(topology.euler_characteristic);
  message.set_orientable(topology.orientable);
  message.set_area(topology.area);
  return message;
}

/// Both enums name the same things, ours from 0 and the message's from 1.
template <typename Message, typename Core>
Message shifted(Core value) {
  return static_cast<Message>(static_cast<int>(value) + 1);
}

v1::Defect::Kind toProto(DefectKind kind) {
  v1::Defect::Kind message = v1::Defect::KIND_UNSPECIFIED;
  v1::Defect::Kind_Parse(std::string(defectName(kind)), &message);
  return message;
}

static_assert(static_cast<int>(ConformalType::kSphere) + 1 == v1::ConformalBlock::SPHERE);
static_assert(static_cast<int>(ConformalType::kBordered) + 1 == v1::ConformalBlock::BORDERED);
static_assert(static_cast<int>(Space::kConformal) + 1 == v1::Signature::CONFORMAL);
static_assert(static_cast<int>(Space::kShape) + 1 == v1::Signature::SHAPE);
static_assert(static_cast<int>(MeshFormat::kObj) + 1 == v1::MeshSource::OBJ);
static_assert(static_cast<int>(MeshFormat::kFreeSurfer) + 1 == v1::MeshSource::FREESURFER);

template <typename Numbers>
bool sound(const Numbers& numbers) {
  return numbers.size() <= kMaxArray &&
         std::all_of(numbers.begin(), numbers.end(), [](auto x) { return std::isfinite(x); });
}

/// What an index takes: squares of larger numbers would overflow float32.
bool soundVector(const google::protobuf::RepeatedField<float>& vector) {
  return vector.size() <= kMaxArray && std::all_of(vector.begin(), vector.end(), [](float x) {
           return std::abs(x) <= 1e38F;  // False for NaN, too.
         });
}

bool sound(const v1::ComplexMatrix& matrix) {
  return matrix.size() >= 1 && matrix.size() <= kMaxMatrix &&
         matrix.entries_size() == matrix.size() * matrix.size() &&
         std::all_of(matrix.entries().begin(), matrix.entries().end(), [](const v1::Complex& z) {
           return std::isfinite(z.re()) && std::isfinite(z.im());
         });
}

bool sound(const google::protobuf::RepeatedPtrField<v1::Circle>& circles) {
  return circles.size() <= kMaxCircles &&
         std::all_of(circles.begin(), circles.end(), [](const v1::Circle& circle) {
           return std::isfinite(circle.center().re()) && std::isfinite(circle.center().im()) &&
                  std::isfinite(circle.radius()) && circle.radius() > 0;
         });
}

bool sound(const google::protobuf::RepeatedPtrField<v1::DiskIsometry>& isometries) {
  return isometries.size() <= 2 * kMaxMatrix &&
         std::all_of(isometries.begin(), isometries.end(), [](const v1::DiskIsometry& isometry) {
           return std::isfinite(isometry.a().re()) && std::isfinite(isometry.a().im()) &&
                  std::isfinite(isometry.b().re()) && std::isfinite(isometry.b().im());
         });
}

Status checkSignature(const v1::Signature& message) {
  const auto refuse = [](const std::string& what) {
    return Status(Reason::kInvalidRequest, "not a signature: " + what,
                  "give a signature as ComputeSignature returns it");
  };
  if (!message.has_topology()) return refuse("it has no topology");
  const v1::Topology& topology = message.topology();
  if (topology.vertices() < 0 || topology.faces() < 0 || topology.components() < 0 ||
      topology.genus() < 0 || topology.boundary_loops() < 0) {
    return refuse("a count is negative");
  }
  if (!std::isfinite(topology.area())) return refuse("its area is not finite");
  if (message.descriptor_version() < 1) return refuse("it has no descriptor version");
  if (message.has_conformal()) {
    const v1::ConformalBlock& block = message.conformal();
    if (block.type() < v1::ConformalBlock::SPHERE || block.type() > v1::ConformalBlock::BORDERED) {
      return refuse("its conformal block has no known type");
    }
    if (block.type() == v1::ConformalBlock::TORUS && !block.has_tau()) {
      return refuse("a torus without tau");
    }
    if (block.has_tau() && (!std::isfinite(block.tau().re()) || !std::isfinite(block.tau().im()) ||
                            block.tau().im() <= 0)) {
      return refuse("tau is not in the upper half-plane");
    }
    if (!std::isfinite(block.tau_error()) || !std::isfinite(block.modulus_error()) ||
        !std::isfinite(block.period_error()) || !std::isfinite(block.energy_spectrum_error())) {
      return refuse("an error of its conformal block is not finite");
    }
    if (block.has_modulus() && !(std::isfinite(block.modulus()) && block.modulus() > 0)) {
      return refuse("its modulus is not a positive number");
    }
    if (block.has_period_matrix() && !sound(block.period_matrix())) {
      return refuse("its period matrix has a wrong size or entries that are not finite");
    }
    if (!sound(block.energy_spectrum()) ||
        std::any_of(block.energy_spectrum().begin(), block.energy_spectrum().end(),
                    [](double energy) { return energy <= 0; })) {
      return refuse("its energy spectrum holds what is not a positive number, or too much");
    }
    if (!sound(block.circles())) {
      return refuse("a circle has no finite centre or no positive radius, or there are too many");
    }
    if (!sound(block.length_spectrum()) ||
        std::any_of(block.length_spectrum().begin(), block.length_spectrum().end(),
                    [](double length) { return length <= 0; })) {
      return refuse("its length spectrum holds what is not a positive number, or too much");
    }
    if (!sound(block.boundary_lengths()) ||
        std::any_of(block.boundary_lengths().begin(), block.boundary_lengths().end(),
                    [](double length) { return length <= 0; })) {
      return refuse("a boundary length is not a positive number, or there are too many");
    }
    if (!sound(block.generators())) {
      return refuse("a generator is not finite, or there are too many");
    }
    const v1::FenchelNielsen& pants = block.fenchel_nielsen();
    if (!sound(pants.lengths()) || !sound(pants.twists()) ||
        pants.lengths_size() != pants.twists_size()) {
      return refuse("its Fenchel-Nielsen coordinates are not finite, or not as many of each kind");
    }
  }
  const v1::SearchVectors& vectors = message.vectors();
  if (!sound(message.metric().conformal_factor_spectrum()) ||
      !sound(message.metric().laplace_spectrum()) ||
      !sound(message.shape().mean_curvature_spectrum()) ||
      !sound(message.shape().cross_spectrum())) {
    return refuse("an array holds a number that is not finite, or too many of them");
  }
  if (!soundVector(vectors.conformal()) || !soundVector(vectors.metric()) ||
      !soundVector(vectors.shape())) {
    return refuse("a vector holds a number that is not finite or above 1e38, or too many of them");
  }
  return {};
}

template <typename From, typename To>
void append(const From& from, To& to) {
  to.Add(from.begin(), from.end());
}

v1::SignatureCertificate toProto(const SignatureCertificate& certificate) {
  v1::SignatureCertificate message;
  if (certificate.riemann_bilinear_residual) {
    message.set_riemann_bilinear_residual(*certificate.riemann_bilinear_residual);
  }
  if (certificate.period_symmetry_residual) {
    message.set_period_symmetry_residual(*certificate.period_symmetry_residual);
  }
  if (certificate.curvature_residual) {
    message.set_curvature_residual(*certificate.curvature_residual);
  }
  if (certificate.gauss_bonnet_residual) {
    message.set_gauss_bonnet_residual(*certificate.gauss_bonnet_residual);
  }
  if (certificate.flips) message.set_flips(*certificate.flips);
  if (certificate.smallest_angle) message.set_smallest_angle(*certificate.smallest_angle);
  if (certificate.relation_residual) {
    message.set_relation_residual(*certificate.relation_residual);
  }
  if (certificate.spectrum_complete_to) {
    message.set_spectrum_complete_to(*certificate.spectrum_complete_to);
  }
  if (certificate.mode_residual) message.set_mode_residual(*certificate.mode_residual);
  if (certificate.layout_closure) message.set_layout_closure(*certificate.layout_closure);
  if (certificate.flipped_faces) message.set_flipped_faces(*certificate.flipped_faces);
  if (certificate.max_dilatation) message.set_max_dilatation(*certificate.max_dilatation);
  if (certificate.mean_dilatation) message.set_mean_dilatation(*certificate.mean_dilatation);
  if (certificate.newton_iterations) message.set_newton_iterations(*certificate.newton_iterations);
  if (certificate.mollification) message.set_mollification(*certificate.mollification);
  for (const std::string& warning : certificate.warnings) message.add_warnings(warning);
  return message;
}

SignatureCertificate fromProto(const v1::SignatureCertificate& message) {
  SignatureCertificate certificate;
  if (message.has_riemann_bilinear_residual()) {
    certificate.riemann_bilinear_residual = message.riemann_bilinear_residual();
  }
  if (message.has_period_symmetry_residual()) {
    certificate.period_symmetry_residual = message.period_symmetry_residual();
  }
  if (message.has_curvature_residual()) {
    certificate.curvature_residual = message.curvature_residual();
  }
  if (message.has_gauss_bonnet_residual()) {
    certificate.gauss_bonnet_residual = message.gauss_bonnet_residual();
  }
  if (message.has_flips()) certificate.flips = message.flips();
  if (message.has_smallest_angle()) certificate.smallest_angle = message.smallest_angle();
  if (message.has_relation_residual()) {
    certificate.relation_residual = message.relation_residual();
  }
  if (message.has_spectrum_complete_to()) {
    certificate.spectrum_complete_to = message.spectrum_complete_to();
  }
  if (message.has_mode_residual()) certificate.mode_residual = message.mode_residual();
  if (message.has_layout_closure()) certificate.layout_closure = message.layout_closure();
  if (message.has_flipped_faces()) certificate.flipped_faces = message.flipped_faces();
  if (message.has_max_dilatation()) certificate.max_dilatation = message.max_dilatation();
  if (message.has_mean_dilatation()) certificate.mean_dilatation = message.mean_dilatation();
  if (message.has_newton_iterations()) certificate.newton_iterations = message.newton_iterations();
  if (message.has_mollification()) certificate.mollification = message.mollification();
  certificate.warnings.assign(message.warnings().begin(), message.warnings().end());
  return certificate;
}

SignatureTopology fromProto(const v1::Topology& message) {
  SignatureTopology topology;
  topology.vertices = message.vertices();
  topology.faces = message.faces();
  topology.components = message.components();
  topology.genus = message.genus();
  topology.boundary_loops = message.boundary_loops();
  topology.euler_characteristic = message.euler_characteristic();
  topology.orientable = message.orientable();
  topology.area = message.area();
  return topology;
}

ConformalBlock fromProto(const v1::ConformalBlock& message) {
  ConformalBlock block;
  block.type = static_cast<ConformalType>(static_cast<int>(message.type()) - 1);
  if (message.has_tau()) block.tau = {message.tau().re(), message.tau().im()};
  if (message.has_tau_error()) block.tau_error = message.tau_error();
  if (message.has_modulus()) block.modulus = message.modulus();
  if (message.has_modulus_error()) block.modulus_error = message.modulus_error();
  if (message.has_period_matrix()) {
    PeriodEntries& entries = block.period_matrix.emplace();
    entries.size = message.period_matrix().size();
    for (const v1::Complex& z : message.period_matrix().entries()) {
      entries.values.emplace_back(z.re(), z.im());
    }
  }
  if (message.has_period_error()) block.period_error = message.period_error();
  block.energy_spectrum.assign(message.energy_spectrum().begin(), message.energy_spectrum().end());
  if (message.has_energy_spectrum_error()) {
    block.energy_spectrum_error = message.energy_spectrum_error();
  }
  for (const v1::Circle& circle : message.circles()) {
    block.circles.push_back({{circle.center().re(), circle.center().im()}, circle.radius()});
  }
  block.length_spectrum.assign(message.length_spectrum().begin(), message.length_spectrum().end());
  if (message.has_fenchel_nielsen()) {
    const v1::FenchelNielsen& pants = message.fenchel_nielsen();
    block.fenchel_nielsen = {{pants.lengths().begin(), pants.lengths().end()},
                             {pants.twists().begin(), pants.twists().end()}};
  }
  block.boundary_lengths.assign(message.boundary_lengths().begin(),
                                message.boundary_lengths().end());
  for (const v1::DiskIsometry& isometry : message.generators()) {
    block.generators.push_back(
        {{isometry.a().re(), isometry.a().im()}, {isometry.b().re(), isometry.b().im()}});
  }
  return block;
}

v1::ConformalBlock toProto(const ConformalBlock& block) {
  v1::ConformalBlock message;
  message.set_type(shifted<v1::ConformalBlock::Type>(block.type));
  if (block.tau) {
    message.mutable_tau()->set_re(block.tau->real());
    message.mutable_tau()->set_im(block.tau->imag());
  }
  if (block.tau_error) message.set_tau_error(*block.tau_error);
  if (block.modulus) message.set_modulus(*block.modulus);
  if (block.modulus_error) message.set_modulus_error(*block.modulus_error);
  if (block.period_matrix) {
    v1::ComplexMatrix& matrix = *message.mutable_period_matrix();
    matrix.set_size(block.period_matrix->size);
    for (const std::complex<double>& value : block.period_matrix->values) {
      v1::Complex& entry = *matrix.add_entries();
      entry.set_re(value.real());
      entry.set_im(value.imag());
    }
  }
  if (block.period_error) message.set_period_error(*block.period_error);
  append(block.energy_spectrum, *message.mutable_energy_spectrum());
  if (block.energy_spectrum_error) {
    message.set_energy_spectrum_error(*block.energy_spectrum_error);
  }
  for (const Circle& circle : block.circles) *message.add_circles() = toProto(circle);
  append(block.length_spectrum, *message.mutable_length_spectrum());
  if (block.fenchel_nielsen) {
    v1::FenchelNielsen& pants = *message.mutable_fenchel_nielsen();
    append(block.fenchel_nielsen->lengths, *pants.mutable_lengths());
    append(block.fenchel_nielsen->twists, *pants.mutable_twists());
  }
  append(block.boundary_lengths, *message.mutable_boundary_lengths());
  for (const DiskIsometry& isometry : block.generators) {
    *message.add_generators() = moduli::toProto(isometry.a, isometry.b);
  }
  return message;
}

}  // namespace

v1::Inspection toProto(const Inspection& inspection, const std::vector<RepairAction>& repair) {
  v1::Inspection message;
  message.set_valid(inspection.valid);
  *message.mutable_topology() = toProto(inspection.counts);
  for (const Defect& defect : inspection.defects) {
    v1::Defect& one = *message.add_defects();
    one.set_kind(toProto(defect.kind));
    one.set_severity(isBlocking(defect.kind) ? v1::Defect::BLOCKING : v1::Defect::WARNING);
    one.set_count(defect.count);
    append(defect.elements, *one.mutable_elements());
    one.set_message(defect.message);
  }
  for (const RepairAction& action : repair) {
    v1::RepairAction& one = *message.add_repair();
    one.set_action(action.action);
    one.set_count(action.count);
  }
  return message;
}

v1::DiskIsometry toProto(const std::complex<double>& a, const std::complex<double>& b) {
  v1::DiskIsometry message;
  message.mutable_a()->set_re(a.real());
  message.mutable_a()->set_im(a.imag());
  message.mutable_b()->set_re(b.real());
  message.mutable_b()->set_im(b.imag());
  return message;
}

v1::Circle toProto(const Circle& circle) {
  v1::Circle message;
  message.mutable_center()->set_re(circle.center.real());
  message.mutable_center()->set_im(circle.center.imag());
  message.set_radius(circle.radius);
  return message;
}

v1::Signature toProto(const Signature& signature) {
  v1::Signature message;
  *message.mutable_topology() = toProto(signature.topology);
  if (signature.conformal) {
    *message.mutable_conformal() = toProto(*signature.conformal);
  }
  if (signature.metric) {
    append(signature.metric->conformal_factor_spectrum,
           *message.mutable_metric()->mutable_conformal_factor_spectrum());
    append(signature.metric->laplace_spectrum,
           *message.mutable_metric()->mutable_laplace_spectrum());
  }
  if (signature.shape) {
    message.mutable_shape();
    append(signature.shape->mean_curvature_spectrum,
           *message.mutable_shape()->mutable_mean_curvature_spectrum());
    append(signature.shape->cross_spectrum, *message.mutable_shape()->mutable_cross_spectrum());
  }
  append(signature.vectors.conformal, *message.mutable_vectors()->mutable_conformal());
  append(signature.vectors.metric, *message.mutable_vectors()->mutable_metric());
  append(signature.vectors.shape, *message.mutable_vectors()->mutable_shape());
  message.set_descriptor_version(signature.descriptor_version);
  *message.mutable_certificate() = toProto(signature.certificate);
  message.mutable_timing()->insert(signature.timing.begin(), signature.timing.end());
  return message;
}

Result<Signature> fromProto(const v1::Signature& message) {
  RETURN_IF_ERROR(checkSignature(message));
  Signature signature;
  signature.topology = fromProto(message.topology());
  if (message.has_conformal()) signature.conformal = fromProto(message.conformal());
  if (message.has_metric()) {
    const v1::MetricBlock& from = message.metric();
    MetricBlock& block = signature.metric.emplace();
    block.conformal_factor_spectrum.assign(from.conformal_factor_spectrum().begin(),
                                           from.conformal_factor_spectrum().end());
    block.laplace_spectrum.assign(from.laplace_spectrum().begin(), from.laplace_spectrum().end());
  }
  if (message.has_shape()) {
    const v1::ShapeBlock& from = message.shape();
    ShapeBlock& block = signature.shape.emplace();
    block.mean_curvature_spectrum.assign(from.mean_curvature_spectrum().begin(),
                                         from.mean_curvature_spectrum().end());
    block.cross_spectrum.assign(from.cross_spectrum().begin(), from.cross_spectrum().end());
  }
  const v1::SearchVectors& vectors = message.vectors();
  signature.vectors.conformal.assign(vectors.conformal().begin(), vectors.conformal().end());
  signature.vectors.metric.assign(vectors.metric().begin(), vectors.metric().end());
  signature.vectors.shape.assign(vectors.shape().begin(), vectors.shape().end());
  signature.descriptor_version = message.descriptor_version();
  signature.certificate = fromProto(message.certificate());
  signature.timing.insert(message.timing().begin(), message.timing().end());
  return signature;
}

v1::SignatureDistances toProto(const SignatureDistances& distances) {
  v1::SignatureDistances message;
  if (distances.conformal) message.set_conformal(*distances.conformal);
  if (distances.metric) message.set_metric(*distances.metric);
  if (distances.shape) message.set_shape(*distances.shape);
  return message;
}

SignatureDistances fromProto(const v1::SignatureDistances& message) {
  SignatureDistances distances;
  if (message.has_conformal()) distances.conformal = message.conformal();
  if (message.has_metric()) distances.metric = message.metric();
  if (message.has_shape()) distances.shape = message.shape();
  return distances;
}

v1::MeshSource::Format toProto(MeshFormat format) {
  return shifted<v1::MeshSource::Format>(format);
}

std::optional<MeshFormat> fromProto(v1::MeshSource::Format format) {
  if (format < v1::MeshSource::OBJ || format > v1::MeshSource::FREESURFER) return {};
  return static_cast<MeshFormat>(static_cast<int>(format) - 1);
}

v1::Signature::Space toProto(Space space) {
  return shifted<v1::Signature::Space>(space);
}

std::optional<Space> fromProto(v1::Signature::Space space) {
  if (space < v1::Signature::CONFORMAL || space > v1::Signature::SHAPE) return {};
  return static_cast<Space>(static_cast<int>(space) - 1);
}

v1::PrepareOptions toProto(const PrepareOptions& options) {
  v1::PrepareOptions message;
  message.set_repair(options.repair.repair);
  if (options.repair.fill_holes) message.set_fill_holes(*options.repair.fill_holes);
  message.set_component(options.component);
  return message;
}

PrepareOptions fromProto(const v1::PrepareOptions& message) {
  PrepareOptions options;
  options.repair.repair = message.repair();
  if (message.has_fill_holes()) options.repair.fill_holes = message.fill_holes();
  options.component = message.component();
  return options;
}

}  // namespace moduli
