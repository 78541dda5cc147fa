#include <algorithm>
#include <map>
#include <utility>

#include "client/cli/command.h"
#include "client/cli/session.h"
#include "core/base/text.h"
#include "core/intrinsic/intrinsic_json.h"
#include "core/intrinsic/intrinsic_samples.h"
#include "core/mesh/deflate.h"
#include "core/mesh/samples.h"
#include "core/mesh/write.h"

/// sample.
namespace moduli::cli {
namespace {

/// Meshes, then intrinsic triangulations.
const std::vector<SampleKind>& allKinds() {
  static const std::vector<SampleKind> kinds = [] {
    std::vector<SampleKind> list = sampleKinds();
    const auto& more = intrinsicSampleKinds();
    list.insert(list.end(), more.begin(), more.end());
    return list;
  }();
  return kinds;
}

bool isIntrinsic(const std::string& name) {
  return std::ranges::any_of(intrinsicSampleKinds(),
                             [&](const SampleKind& kind) { return kind.name == name; });
}

const SampleKind* findKind(const std::string& name) {
  const auto& kinds = allKinds();
  const auto found = std::find_if(kinds.begin(), kinds.end(),
                                  [&](const SampleKind& kind) { return kind.name == name; });
  return found == kinds.end() ? nullptr : &*found;
}

std::string kindNames() {
  std::string names;
  for (const SampleKind& kind : allKinds()) names += (names.empty() ? "" : " ") + kind.name;
  return names;
}

std::string parameterNames(const SampleKind& kind) {
  std::string names;
  for (const auto& parameter : kind.parameters)
    names += (names.empty() ? "" : " ") + parameter.name;
  return names.empty() ? "none" : names;
}

std::optional<std::string> checkParameter(const SampleKind& kind, const std::string& word) {
  const std::size_t sign = word.find('=');
  if (sign == std::string::npos) return "'" + word + "' must look like NAME=NUMBER";
  const std::string name = word.substr(0, sign);
  const bool known = std::any_of(kind.parameters.begin(), kind.parameters.end(),
                                 [&](const auto& parameter) { return parameter.name == name; });
  if (!known) {
    return kind.name + " has no parameter '" + name + "'; it has " + parameterNames(kind);
  }
  if (!parseDouble(word.substr(sign + 1))) return "'" + word + "' is not a number";
  return std::nullopt;
}

std::optional<MeshFormat> outputFormat(const Arguments& arguments) {
  if (arguments.has("format")) return formatFromName(arguments.text("format"));
  return formatFromExtension(arguments.text("output"));
}

std::optional<std::string> checkSample(const Arguments& arguments) {
  if (arguments.has("list")) return std::nullopt;
  if (!arguments.has("KIND")) return "KIND is missing; there are " + kindNames();
  const SampleKind* kind = findKind(arguments.text("KIND"));
  if (kind == nullptr) {
    return "there is no kind '" + arguments.text("KIND") + "'; there are " + kindNames();
  }
  for (const std::string& word : arguments.all("NAME=NUMBER")) {
    if (auto complaint = checkParameter(*kind, word)) return complaint;
  }
  if (!arguments.has("output")) return "-o FILE is missing";
  if (!outputFormat(arguments)) {
    return "the extension of " + arguments.text("output") +
           " tells no format; give --format obj, off, ply, stl, json or gifti";
  }
  if (isIntrinsic(kind->name) && outputFormat(arguments) != MeshFormat::kJson) {
    return kind->name + " has no positions in space; give -o FILE.json";
  }
  if (arguments.has("binary") && outputFormat(arguments) == MeshFormat::kJson) {
    return "--binary is for ply, stl and gifti";
  }
  return std::nullopt;
}

std::string kindsReport() {
  std::string text;
  for (const SampleKind& kind : allKinds()) {
    text += kind.name + ": " + kind.meaning + "\n";
    for (const SampleParameter& parameter : kind.parameters) {
      std::string name = parameter.name;
      name.resize(std::max<std::size_t>(name.size(), 12), ' ');
      text += "  " + name + " " + parameter.meaning + " (" + brief(parameter.default_value) + ")\n";
    }
  }
  return text;
}

std::string kindsJson() {
  JsonWriter json;
  json.open("{").key("kinds").open("[");
  for (const SampleKind& kind : allKinds()) {
    json.open("{").key("name").string(kind.name).key("meaning").string(kind.meaning);
    json.key("parameters").open("[");
    for (const SampleParameter& parameter : kind.parameters) {
      json.open("{").key("name").string(parameter.name);
      json.key("default_value").number(parameter.default_value);
      json.key("meaning").string(parameter.meaning).close("}");
    }
    json.close("]").close("}");
  }
  json.close("]").close("}");
  return json.finish();
}

/// A sample as a file and what is in it.
struct Sample {
  std::string bytes;
  std::size_t vertices = 0, faces = 0;
};

Result<Sample> intrinsicSample(const IntrinsicSurface& surface) {
  return Sample{writeIntrinsicJson(surface),
                static_cast<std::size_t>(surface.connectivity.vertexCount()),
                static_cast<std::size_t>(surface.connectivity.faceCount())};
}

/// Any mesh can be written without its positions, too.
Result<Sample> meshSample(TriangleSoup soup, const std::string& output, MeshFormat format,
                          Encoding encoding) {
  if (format == MeshFormat::kJson) {
    ASSIGN_OR_RETURN(const TriangleMesh mesh, TriangleMesh::fromSoup(std::move(soup)));
    return intrinsicSample(forgetPositions(mesh));
  }
  Result<std::string> bytes = writeMesh(soup, format, encoding);
  if (!bytes.ok()) return about(output, bytes.status());
  // x.gii.gz is x.gii, compressed as a whole.
  if (format == MeshFormat::kGifti && output.ends_with(".gz")) bytes = gzipBytes(*bytes);
  return Sample{*std::move(bytes), soup.vertices.size(), soup.faces.size()};
}

Result<Sample> makeFile(const std::string& kind, const Arguments& arguments) {
  if (isIntrinsic(kind)) {
    ASSIGN_OR_RETURN(const IntrinsicSurface surface, makeIntrinsicSample(kind));
    return intrinsicSample(surface);
  }
  std::map<std::string, double> parameters;
  for (const std::string& word : arguments.all("NAME=NUMBER")) {
    const std::size_t sign = word.find('=');
    parameters[word.substr(0, sign)] = *parseDouble(word.substr(sign + 1));
  }
  Result<TriangleSoup> soup = makeSample(kind, parameters);
  if (!soup.ok()) return about(kind, soup.status());
  return meshSample(*std::move(soup), arguments.text("output"), *outputFormat(arguments),
                    arguments.has("binary") ? Encoding::kBinary : Encoding::kText);
}

std::string sampleJson(const std::string& kind, const std::string& file, MeshFormat format,
                       const Sample& sample) {
  JsonWriter json;
  json.open("{").key("kind").string(kind).key("file").string(file);
  json.key("format").string(formatName(format));
  json.key("vertices").number(static_cast<double>(sample.vertices));
  json.key("faces").number(static_cast<double>(sample.faces)).close("}");
  return json.finish();
}

Status runSample(Session& session, const Arguments& arguments) {
  if (arguments.has("list")) return session.print(session.json() ? kindsJson() : kindsReport());
  const std::string kind = arguments.text("KIND");
  const std::string output = arguments.text("output");
  ASSIGN_OR_RETURN(const Sample sample, makeFile(kind, arguments));
  if (output == "-") return session.print(sample.bytes);
  RETURN_IF_ERROR(about(output, writeFile(output, sample.bytes)));
  if (session.json()) {
    return session.print(sampleJson(kind, output, *outputFormat(arguments), sample));
  }
  if (session.quiet()) return {};
  return session.print(
      output + ": " + counted(static_cast<long long>(sample.vertices), "vertex", "vertices") +
      ", " + counted(static_cast<long long>(sample.faces), "face", "faces") + "\n");
}

std::vector<std::string> kindChoices() {
  std::vector<std::string> choices;
  for (const SampleKind& kind : allKinds()) choices.push_back(kind.name);
  return choices;
}

}  // namespace

std::vector<CommandSpec> sampleCommands() {
  return {
      {.path = "sample",
       .summary = "Write a test surface whose shape is known exactly",
       .details = "Kinds and their parameters, with defaults in parentheses:\n\n" + kindsReport() +
                  "\nAs .json a surface is written without its positions: its intrinsic "
                  "triangulation.",
       .arguments = {{.name = "KIND",
                      .help = "Kind of surface",
                      .min = 0,
                      .completion = Completion::kNothing,
                      .choices = kindChoices()},
                     {.name = "NAME=NUMBER",
                      .help = "Its parameters",
                      .min = 0,
                      .max = -1,
                      .completion = Completion::kNothing}},
       .options = {{.names = "-o,--output",
                    .value = "FILE",
                    .help = "Where to; '-' for standard output. The extension tells the format",
                    .completion = Completion::kFile},
                   {.names = "--format",
                    .value = "FORMAT",
                    .help = "Write this format whatever the extension",
                    .choices = {"obj", "off", "ply", "stl", "json", "gifti"}},
                   {.names = "--binary",
                    .value = "",
                    .help = "Binary PLY or STL, compressed GIFTI"},
                   {.names = "--list", .value = "", .help = "List the kinds"}},
       .check = checkSample,
       .run = runSample,
       .examples = "moduli sample torus -o torus.off\nmoduli sample sphere resolution=40 seed=7 "
                   "-o - --format ply\nmoduli sample klein -o klein.json"}};
}

}  // namespace moduli::cli
