#include "client/cli/parameterize_files.h"

#include <algorithm>
#include <cctype>
#include <optional>
#include <utility>

#include "client/cli/gifti_output.h"
#include "client/cli/map_gltf.h"
#include "client/cli/map_panels.h"
#include "client/cli/output.h"
#include "client/cli/parameterize_picture.h"
#include "client/cli/textured_obj.h"

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

Result<GiftiTags> giftiTags(const MeshArgument& input, Client& client) {
  ASSIGN_OR_RETURN(const std::string bytes, input.content(client));
  return tagsOf(bytes, input.name());
}

}  // namespace

std::vector<OptionSpec> parameterizeFileOptions() {
  return {{.names = "-o,--output",
           .value = "OUT.obj|OUT.glb",
           .help =
               "Write the surface with its map; without it the certificate is printed alone. .glb "
               "is binary glTF with a checkerboard, in single precision. With --to sphere also "
               "OUT.gii or OUT.gii.gz: a GIFTI surface of radius 1 with the tags of a GIFTI input",
           .completion = Completion::kFile}};
}

std::optional<std::string> checkParameterizeFiles(const Arguments& arguments) {
  if (!arguments.has("output")) return std::nullopt;
  const std::string output = arguments.text("output");
  const std::string extension = extensionOf(output);
  if (extension == ".obj" || extension == ".glb") return std::nullopt;
  if (isGiftiFileName(output)) {
    if (arguments.text("to") == "sphere") return std::nullopt;
    return "GIFTI holds no texture points: .gii is for --to sphere, --output must end in .obj or "
           ".glb, not '" +
           output + "'";
  }
  return "the result is written as OBJ or glTF, which hold the map as texture points: --output "
         "must end in .obj or .glb (with --to sphere also .gii or .gii.gz), not '" +
         output + "'";
}

ParameterizeFiles::ParameterizeFiles(const Arguments& arguments)
    : arguments_(arguments),
      output_(arguments.text("output")),
      carried_(arguments.text("carried")) {
  if (arguments.has("picture")) picture_file_ = add(arguments.text("picture"));
  if (arguments.has("atlas")) atlas_file_ = add(arguments.text("atlas"));
  if (!carried_.empty()) carried_file_ = add(carried_);
  if (!output_.empty()) output_file_ = add(output_);
}

FileWriter* ParameterizeFiles::add(const std::string& path) {
  return files_.emplace_back(std::make_unique<FileWriter>(path, true)).get();
}

Status ParameterizeFiles::open() {
  for (const auto& file : files_) RETURN_IF_ERROR(file->open());
  return {};
}

Status ParameterizeFiles::writeOutput(const ParameterizedMesh& mesh, const MeshArgument& input,
                                      Client& client) {
  if (isGiftiFileName(output_)) {
    ASSIGN_OR_RETURN(GiftiTags tags, giftiTags(input, client));
    ASSIGN_OR_RETURN(const std::string bytes, sphereGifti(mesh, std::move(tags), output_));
    return output_file_->write(bytes);
  }
  if (extensionOf(output_) == ".glb") {
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
  return writeTexturedObj(mesh,
                          [this](std::string_view text) { return output_file_->write(text); });
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
