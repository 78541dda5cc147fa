#include "client/cli/registration.h"

#include <array>
#include <utility>

#include "client/cli/gifti_output.h"
#include "client/cli/landmark_file.h"

namespace moduli::cli {
namespace {

/// What goes with --reference alone.
constexpr std::array<const char*, 5> kCompanions = {"mirror", "landmarks", "field",
                                                    "reference-field", "carried"};

/// Up to four files share one request, which has room for 8 MiB: larger ones are uploaded.
constexpr std::uint64_t kInlineShare = 1ULL << 20;

}  // namespace

std::vector<OptionSpec> registrationOptions() {
  return {
      {.names = "--reference",
       .value = "MESH",
       .help = "With --to sphere: lays the sphere onto that of this surface, which is mapped "
               "likewise unless it is a sphere already (such as lh.sphere)",
       .completion = Completion::kFile},
      {.names = "--mirror",
       .value = "",
       .help = "With --reference: lays it onto the mirror image, from one hemisphere of a brain to "
               "the other"},
      {.names = "--landmarks",
       .value = "FILE",
       .help = "With --reference: pairs of points that have to meet, MESH first: lines 'vertexA "
               "vertexB', 'faceA b0 b1 b2 faceB b0 b1 b2' (weights of the corners) or 'curve "
               "COUNT: a1 a2 ... : b1 b2 ...' (paths of vertices, resampled to COUNT pairs)",
       .completion = Completion::kFile},
      {.names = "--field",
       .value = "FILE",
       .help = "With --reference: a value at each vertex of MESH (FreeSurfer's lh.sulc, a GIFTI "
               "shape, text). Without landmarks the rotation is that under which it is most like "
               "--reference-field; with landmarks they are compared. Without either, how much the "
               "maps change areas takes their place. Without --reference a --picture shows it",
       .completion = Completion::kFile},
      {.names = "--reference-field",
       .value = "FILE",
       .help = "With --reference: the same at each vertex of the reference",
       .completion = Completion::kFile},
      {.names = "--carried",
       .value = "OUT",
       .help = "With --reference: writes the reference's field, carried to the vertices of MESH, "
               "as GIFTI (.shape.gii, .gii) or text (.txt)",
       .completion = Completion::kFile}};
}

std::optional<std::string> checkRegistrationArguments(const Arguments& arguments) {
  if (arguments.has("reference") && arguments.text("to") != "sphere") {
    return "--reference is for --to sphere";
  }
  // A field alone is what a picture shows.
  const bool shown =
      arguments.has("field") && arguments.has("picture") && !arguments.has("reference");
  for (const std::string companion : kCompanions) {
    if (companion == "field" && shown) continue;
    if (arguments.has(companion) && arguments.text("to") != "sphere") {
      return "--" + companion + " is for --to sphere with --reference";
    }
    if (arguments.has(companion) && !arguments.has("reference")) {
      return "--" + companion + " needs the surface to register to: --reference MESH";
    }
  }
  if (!arguments.has("reference")) return std::nullopt;
  if (arguments.has("mobius")) {
    return "--mobius would move a sphere that --reference has put in its place";
  }
  if (arguments.text("reference") == "-" && arguments.text("MESH") == "-") {
    return "standard input can be one of MESH and --reference, not both";
  }
  const bool field = arguments.has("field"), other = arguments.has("reference-field");
  if (field && !other) return "--field needs what it is compared with: --reference-field FILE";
  if (other && !field && !arguments.has("landmarks")) {
    return "--reference-field needs what it is compared with, --field FILE, or --landmarks";
  }
  if (!arguments.has("carried")) return std::nullopt;
  if (!other && arguments.has("landmarks")) {
    return "--carried writes the reference's field: give --reference-field FILE";
  }
  if (arguments.text("carried") == arguments.text("output")) {
    return "--carried and --output name the same file";
  }
  if (isValuesFileName(arguments.text("carried"))) return std::nullopt;
  return "--carried writes GIFTI or text: the name must end in .gii, .gii.gz or .txt, not '" +
         arguments.text("carried") + "'";
}

Result<std::optional<RegistrationFiles::Values>> RegistrationFiles::openValues(
    const Arguments& arguments, const std::string& key) {
  std::optional<Values> values;
  if (!arguments.has(key)) return values;
  const std::string path = arguments.text(key);
  auto bytes = MeshBytes::ofFile(path);
  if (bytes.status().reason() == Reason::kFileNotFound) {
    return Status(Reason::kFileNotFound, bytes.status().message(),
                  "check the path given to --" + key);
  }
  RETURN_IF_ERROR(bytes.status());
  values.emplace(Values{path, *std::move(bytes)});
  return values;
}

Result<RegistrationFiles> RegistrationFiles::open(const Session& session,
                                                  const Arguments& arguments) {
  RegistrationFiles files;
  if (!arguments.has("reference")) return files;
  if (arguments.has("landmarks")) {
    files.landmark_file_ = arguments.text("landmarks");
    ASSIGN_OR_RETURN(files.landmarks_, readLandmarks(files.landmark_file_));
  }
  files.landmarks_.set_mirror(arguments.has("mirror"));
  ASSIGN_OR_RETURN(files.reference_, MeshArgument::open(session, arguments.text("reference"), ""));
  ASSIGN_OR_RETURN(files.field_, openValues(arguments, "field"));
  ASSIGN_OR_RETURN(files.reference_field_, openValues(arguments, "reference-field"));
  return files;
}

std::uint64_t RegistrationFiles::inlineLimit() const {
  return wanted() ? kInlineShare : Client::kInlineLimit;
}

Result<v1::SphereRegistration> RegistrationFiles::message(Client& client) const {
  v1::SphereRegistration message = landmarks_;
  ASSIGN_OR_RETURN(*message.mutable_reference(), reference_->source(client, kInlineShare));
  constexpr auto kAny = v1::MeshSource::FORMAT_UNSPECIFIED;
  if (field_) {
    ASSIGN_OR_RETURN(*message.mutable_field(),
                     client.sendMesh(field_->bytes, field_->name, kAny, kInlineShare));
  }
  if (reference_field_) {
    ASSIGN_OR_RETURN(
        *message.mutable_reference_field(),
        client.sendMesh(reference_field_->bytes, reference_field_->name, kAny, kInlineShare));
  }
  return message;
}

std::string RegistrationFiles::subjectOf(const Status& status, const std::string& otherwise) const {
  if (!wanted()) return otherwise;
  std::vector<std::string> names = {reference_->name(), landmark_file_};
  if (reference_->stored()) names.push_back(reference_->resource());
  if (field_) names.push_back(field_->name);
  if (reference_field_) names.push_back(reference_field_->name);
  for (const std::string& name : names) {
    if (!name.empty() && status.message().starts_with(name + ":")) return name;
  }
  return otherwise;
}

}  // namespace moduli::cli
