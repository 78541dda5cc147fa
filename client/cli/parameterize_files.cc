#include "client/cli/parameterize_files.h"

#include <algorithm>
#include <cctype>
#include <optional>
#include <utility>

#include "client/cli/gifti_output.h"
#include "client/cli/map_gltf.h"
#include "client/cli/map_panels.h"
#include "client/cli/map_ply.h"
#include "client/cli/output.h"
#include "client/cli/parameterize_picture.h"
#include "client/cli/texture_layout.h"
#include "client/cli/textured_obj.h"
#include "core/base/text.h"
#include "core/mesh/format.h"
#include "core/mesh/obj_statements.h"

namespace moduli::cli {
namespace {

// ".obj" of "a/B.OBJ".
std::string extensionOf(const std::string& path) {
  const std::size_t dot = path.rfind('.');
  std::string extension = dot == std::string::npos ? "" : path.substr(dot);
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

std::string fileName(const std::string& path) {
  return path.substr(path.rfind('/') + 1);
}

// "a/B" of "a/B.OBJ".
std::string stemOf(const std::string& path) {
  return path.substr(0, path.size() - extensionOf(path).size());
}

std::optional<std::string> checkTexture(const Arguments& arguments) {
  if (!arguments.has("texture")) return std::nullopt;
  const std::string output = arguments.text("output"), extension = extensionOf(output);
  if (extension != ".obj" && extension != ".ply") {
    return "--texture is for --output OUT.obj and OUT.ply; OUT.glb has one in itself";
  }
  if (arguments.text("to") == "sphere") return "a map to the sphere has no points for a --texture";
  const std::string texture = stemOf(output) + ".png";
  if (arguments.text("picture") == texture) {
    return "the --texture of '" + output + "' goes to '" + texture + "', as --picture does";
  }
  if (!isPrintableUtf8(fileName(output))) {
    return "files name each other with --texture, so that their names must be UTF-8 without "
           "control characters";
  }
  return std::nullopt;
}

Result<GiftiTags> giftiTags(const MeshArgument& input, Client& client) {
  ASSIGN_OR_RETURN(const std::string bytes, input.content(client));
  return tagsOf(bytes, input.name());
}

}  // namespace

std::vector<OptionSpec> parameterizeFileOptions() {
  return {
      {.names = "-o,--output",
       .value = "OUT.obj|OUT.glb|OUT.ply",
       .help = "Write the surface with its map; without it the certificate is printed alone. .glb "
               "is binary glTF with a checkerboard, in single precision; .ply has texture points "
               "in single precision. OBJ to OBJ keeps groups, materials and normals. With --to "
               "sphere also "
               "OUT.gii or OUT.gii.gz: a GIFTI surface of radius 1 with the tags of a GIFTI input",
       .completion = Completion::kFile},
      {.names = "--texture",
       .value = "checker",
       .help = "With OUT.obj, write OUT.mtl and OUT.png beside it, with OUT.ply OUT.png: the "
               "checkerboard of pictures; texture points are scaled into the unit square",
       .choices = {"checker"}}};
}

std::optional<std::string> checkParameterizeFiles(const Arguments& arguments) {
  if (auto complaint = checkTexture(arguments)) return complaint;
  if (!arguments.has("output")) return std::nullopt;
  const std::string output = arguments.text("output");
  const std::string extension = extensionOf(output);
  if (extension == ".obj" || extension == ".glb" || extension == ".ply") return std::nullopt;
  if (isGiftiFileName(output)) {
    if (arguments.text("to") == "sphere") return std::nullopt;
    return "GIFTI holds no texture points: .gii is for --to sphere, --output must end in .obj, "
           ".glb or .ply, not '" +
           output + "'";
  }
  return "the result is written as OBJ, glTF or PLY, which hold the map as texture points: "
         "--output "
         "must end in .obj, .glb or .ply (with --to sphere also .gii or .gii.gz), not '" +
         output + "'";
}

ParameterizeFiles::ParameterizeFiles(const Arguments& arguments)
    : arguments_(arguments),
      output_(arguments.text("output")),
      carried_(arguments.text("carried")) {
  if (arguments.has("picture")) picture_file_ = add(arguments.text("picture"));
  if (arguments.has("atlas")) atlas_file_ = add(arguments.text("atlas"));
  if (!carried_.empty()) carried_file_ = add(carried_);
  if (arguments.has("texture")) {
    texture_file_ = add(stemOf(output_) + ".png");
    if (extensionOf(output_) == ".obj") materials_file_ = add(stemOf(output_) + ".mtl");
  }
  if (!output_.empty()) output_file_ = add(output_);
}

FileWriter* ParameterizeFiles::add(const std::string& path) {
  return files_.emplace_back(std::make_unique<FileWriter>(path, true)).get();
}

Status ParameterizeFiles::open() {
  for (const auto& file : files_) RETURN_IF_ERROR(file->open());
  return {};
}

Status ParameterizeFiles::writeTexture(const ParameterizedMesh& mesh) {
  ASSIGN_OR_RETURN(const std::string png, checkerTexture(mesh, fitUnitSquare(mesh)));
  RETURN_IF_ERROR(texture_file_->write(png));
  if (materials_file_ == nullptr) return {};
  return materials_file_->write(texturedMaterials(fileName(stemOf(output_)) + ".png"));
}

Status ParameterizeFiles::writeObj(const ParameterizedMesh& mesh, const MeshArgument& input,
                                   Client& client) {
  TexturedObjOptions options;
  if (materials_file_ != nullptr) {
    options.materials = fileName(stemOf(output_)) + ".mtl";
    options.layout = fitUnitSquare(mesh);
  }
  ASSIGN_OR_RETURN(const std::string bytes, input.content(client));
  ObjStatements statements;
  const bool said = arguments_.has("format");
  if (said ? arguments_.text("format") == "obj"
           : detectFormat(bytes, input.name()) == MeshFormat::kObj) {
    statements = readObjStatements(bytes);
    options.kept = &statements;
  }
  return writeTexturedObj(mesh, options,
                          [this](std::string_view text) { return output_file_->write(text); });
}

Status ParameterizeFiles::writeGlb(const ParameterizedMesh& mesh, const MeshArgument& input,
                                   Client& client) {
  CornerColor colors;
  std::optional<MapPanels> panels;
  if (arguments_.text("draw", "checker") != "checker") {
    ASSIGN_OR_RETURN(const DrawnMap drawn, DrawnMap::open(client, arguments_, input, mesh));
    panels.emplace(drawn.picture());
    colors = [&panels](std::size_t corner) {
      Vec3 weights{};
      weights[corner % 3] = 1;
      return panels->colorAt(static_cast<int>(corner / 3), weights);
    };
  }
  ASSIGN_OR_RETURN(const std::string bytes,
                   parameterizationGltf(mesh, fileName(input.name()), colors));
  return output_file_->write(bytes);
}

Status ParameterizeFiles::writeOutput(const ParameterizedMesh& mesh, const MeshArgument& input,
                                      Client& client) {
  if (texture_file_ != nullptr) RETURN_IF_ERROR(writeTexture(mesh));
  if (isGiftiFileName(output_)) {
    ASSIGN_OR_RETURN(GiftiTags tags, giftiTags(input, client));
    ASSIGN_OR_RETURN(const std::string bytes, sphereGifti(mesh, std::move(tags), output_));
    return output_file_->write(bytes);
  }
  const std::string extension = extensionOf(output_);
  if (extension == ".glb") return writeGlb(mesh, input, client);
  if (extension == ".obj") return writeObj(mesh, input, client);
  const std::string texture = texture_file_ == nullptr ? "" : fileName(stemOf(output_)) + ".png";
  return output_file_->write(parameterizationPly(mesh, texture));
}

Status ParameterizeFiles::write(const ParameterizedMesh& mesh, const MeshArgument& input,
                                Client& client) {
  if (carried_file_ != nullptr) {
    GiftiTags tags;
    if (isGiftiFileName(carried_)) {
      ASSIGN_OR_RETURN(tags, giftiTags(input, client));
    }
    const std::string name = fileName(arguments_.text("reference-field", "area distortion"));
    ASSIGN_OR_RETURN(const std::string bytes, valuesFile(mesh.carried, name, tags, carried_));
    RETURN_IF_ERROR(carried_file_->write(bytes));
  }
  if (atlas_file_ != nullptr) RETURN_IF_ERROR(atlas_file_->write(mesh.atlas));
  if (output_file_ != nullptr) RETURN_IF_ERROR(writeOutput(mesh, input, client));
  if (picture_file_ != nullptr) {
    ASSIGN_OR_RETURN(const DrawnMap drawn, DrawnMap::open(client, arguments_, input, mesh));
    ASSIGN_OR_RETURN(const std::string bytes, drawMap(drawn.picture()));
    RETURN_IF_ERROR(picture_file_->write(bytes));
  }
  for (const auto& file : files_) RETURN_IF_ERROR(file->commit());
  return {};
}

}  // namespace moduli::cli
