#include "server/service/registering.h"

#include <cmath>
#include <optional>
#include <utility>

#include "core/mesh/vertex_data.h"
#include "server/rpc/convert_parameterization.h"
#include "server/service/landmarks.h"
#include "server/service/signing.h"

namespace moduli {
namespace {

/// Vertices that fill holes get the mean of their neighbours with a value, again and again.
void fillIn(const Connectivity& surface, std::vector<std::optional<double>>& values) {
  bool grows = true;
  while (grows) {
    grows = false;
    std::vector<std::pair<Index, double>> found;
    for (Index v = 0; v < surface.vertexCount(); ++v) {
      if (values[v]) continue;
      double sum = 0;
      int count = 0;
      const Index first = surface.outgoing(v);
      Index h = first;
      do {
        if (const std::optional<double>& value = values[surface.head(h)]) {
          sum += *value;
          ++count;
        }
        h = surface.rotate(h);
      } while (h != kNone && h != first);
      if (count > 0) found.emplace_back(v, sum / count);
    }
    for (const auto& [v, value] : found) values[v] = value;
    grows = !found.empty();
  }
}

/// A field of the file's vertices at those of the surface.
Result<std::vector<double>> readField(Context& context, const Backend& backend,
                                      const v1::MeshSource& source, const Subject& subject) {
  ASSIGN_OR_RETURN(const MeshFile file, loadMesh(context, backend, source));
  const Context::Stage stage(context, "read");
  ASSIGN_OR_RETURN(const VertexData data,
                   readVertexData(context, file.bytes, file.name, subject.inputVertexCount()));
  std::vector<std::optional<double>> values(
      static_cast<std::size_t>(subject.surface().vertexCount()));
  for (Index v = 0; v < subject.surface().vertexCount(); ++v) {
    const Index input = subject.inputVertex(v);
    if (input == kNone) continue;
    if (!std::isfinite(data.values[input])) {
      return Status(Reason::kInvalidOption,
                    file.name + ": the value of vertex " + std::to_string(input) +
                        " is not finite, and is needed for a registration",
                    "give a number for every vertex of the surface");
    }
    values[v] = data.values[input];
  }
  fillIn(subject.surface(), values);
  std::vector<double> field;
  for (const std::optional<double>& value : values) field.push_back(value.value_or(0));
  return field;
}

/// Values of the surface's vertices at those of the file; 0 at vertices of no mapped face.
std::vector<double> atInput(const Subject& subject, const std::vector<double>& values,
                            std::vector<std::string>& warnings) {
  std::vector<std::optional<double>> input(subject.inputVertexCount());
  for (std::size_t v = 0; v < input.size(); ++v) {
    const Index place = subject.places.place[v];
    if (place >= 0) input[v] = values[place];
  }
  for (Index v = 0; v < subject.surface().vertexCount(); ++v) {
    const Index from = subject.inputVertex(v);
    if (from != kNone && !input[from]) input[from] = values[v];
  }
  std::vector<double> result;
  int missing = 0;
  for (const std::optional<double>& value : input) {
    if (!value) ++missing;
    result.push_back(value.value_or(0));
  }
  if (missing > 0) {
    warnings.push_back("NOTHING_CARRIED: " + std::to_string(missing) +
                       (missing == 1 ? " vertex of no face that is mapped has"
                                     : " vertices of no face that is mapped have") +
                       " the carried value 0");
  }
  return result;
}

Result<Parameterization> mapReference(Context& context, const ReferenceSphere& reference,
                                      SphereOptions options) {
  const Subject& subject = reference.subject;
  options.mobius.reset();
  auto map =
      parameterizeSphere(context, subject.surface(), subject.lengths, subject.positions(), options);
  if (!map.ok()) return aboutSurface(reference.name, map.status());
  return map;
}

}  // namespace

Result<ReferenceSphere> loadReference(Context& context, const Backend& backend,
                                      const v1::ParameterizeRequest& request,
                                      const Subject& subject) {
  const v1::SphereRegistration& registration = request.options().registration();
  ReferenceSphere reference;
  reference.name = sourceName(registration.reference(), "the reference");
  auto loaded = loadSubject(context, backend, registration.reference(), request.prepare());
  if (!loaded.ok()) return aboutSurface(reference.name, loaded.status());
  reference.subject = *std::move(loaded);
  reference.options.mirror = registration.mirror();
  if (registration.has_field()) {
    ASSIGN_OR_RETURN(reference.field, readField(context, backend, registration.field(), subject));
  }
  if (registration.has_reference_field()) {
    ASSIGN_OR_RETURN(
        reference.reference_field,
        readField(context, backend, registration.reference_field(), reference.subject));
  }
  const LandmarkSurfaces surfaces{subject, reference.subject, "the reference"};
  ASSIGN_OR_RETURN(reference.options.landmarks,
                   landmarksOnSurfaces(registration.landmarks(), surfaces));
  ASSIGN_OR_RETURN(reference.options.curves, curvesOnSurfaces(registration.curves(), surfaces));
  return reference;
}

Result<RegisteredSphere> registerOnReference(Context& context, const ReferenceSphere& reference,
                                             const Subject& subject, Parameterization map,
                                             const SphereOptions& options) {
  const Subject& other = reference.subject;
  RegisteredSphere result;
  std::optional<Parameterization> sphere =
      asSphere(other.surface(), other.lengths, other.positions());
  const bool is_sphere = sphere.has_value();
  if (!sphere) {
    ASSIGN_OR_RETURN(sphere, mapReference(context, reference, options));
  }
  ASSIGN_OR_RETURN(
      SphereRegistration registered,
      registerSphere(context, {subject.surface(), subject.lengths, map, reference.field},
                     {other.surface(), other.lengths, *sphere, reference.reference_field},
                     reference.options));
  result.result = toProto(registered);
  result.result.set_reference_is_sphere(is_sphere);
  result.map = std::move(map);
  MapCertificate& certificate = result.map.certificate;
  for (const std::string& warning : other.warnings) {
    certificate.warnings.push_back("REFERENCE: " + warning);
  }
  if (!registered.carried.empty()) {
    result.carried = atInput(subject, registered.carried, certificate.warnings);
  }
  result.map.sphere = std::move(registered.points);
  certificate.quality = std::move(registered.quality);
  if (registered.landmarks > 0) certificate.centering_residual.reset();
  return result;
}

}  // namespace moduli
