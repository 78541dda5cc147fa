#include "server/service/signing.h"

#include <utility>

#include "core/intrinsic/intrinsic_json.h"
#include "core/mesh/read.h"
#include "core/signature/compute.h"
#include "server/rpc/convert.h"
#include "server/service/request.h"

namespace moduli {

Result<MeshFile> loadMesh(Context& context, const Backend& backend, const v1::MeshSource& source) {
  Context::Stage stage(context, "load");
  MeshFile file;
  file.format = fromProto(source.format());
  if (!source.file_name().empty()) file.name = source.file_name();
  if (source.has_inline_()) {
    file.bytes = source.inline_();
    return file;
  }
  std::string digest = source.digest();
  if (source.has_shape()) {
    ASSIGN_OR_RETURN(const Catalog* catalog, backend.catalog());
    ASSIGN_OR_RETURN(const ShapePath path, parseShapeName(source.shape()));
    ASSIGN_OR_RETURN(const ShapeRecord shape,
                     catalog->getShape(path.collection, path.shape, ShapeView::kSummary));
    digest = shape.digest;
    file.format = shape.format;
    file.name = shape.file_name.empty() ? shape.name : shape.file_name;
  }
  ASSIGN_OR_RETURN(file.bytes, backend.store->meshes().read(digest));
  return file;
}

Result<ParsedSurface> parseSurface(Context& context, const Backend& backend, const MeshFile& file) {
  Context::Stage stage(context, "read");
  const auto format = file.format ? file.format : detectFormat(file.bytes, file.name);
  const std::size_t max_faces = backend.limits.max_faces;
  if (format == MeshFormat::kJson) {
    ASSIGN_OR_RETURN(IntrinsicSurface surface,
                     readIntrinsicJson(context, file.bytes, {file.name, max_faces}));
    return ParsedSurface(std::move(surface));
  }
  ReadOptions options;
  options.format = format;
  options.name = file.name;
  options.max_faces = max_faces;
  ASSIGN_OR_RETURN(TriangleSoup soup, readMesh(context, file.bytes, options));
  return ParsedSurface(std::move(soup));
}

Status checkIntrinsicPrepare(const PrepareOptions& prepare) {
  const auto refuse = [](const std::string& option) {
    return Status(Reason::kInvalidOption,
                  option + " needs positions in space, which an intrinsic triangulation has not",
                  "leave " + option + " out, or give the surface as a mesh");
  };
  if (prepare.repair.repair) return refuse("--repair");
  if (prepare.repair.fill_holes) return refuse("--fill-holes");
  const std::string& component = prepare.component;
  if (component.empty() || component == "largest" || component == "all" || component == "0")
    return {};
  return {Reason::kComponentNotFound,
          "there is no component " + component + ": an intrinsic triangulation has one",
          "leave --component out"};
}

Result<Signature> signMesh(Context& context, const Backend& backend, const MeshFile& file,
                           const PrepareOptions& prepare, const SignatureOptions& options) {
  std::optional<PreparedMesh> prepared;
  {
    ASSIGN_OR_RETURN(const ParsedSurface parsed, parseSurface(context, backend, file));
    if (const auto* intrinsic = std::get_if<IntrinsicSurface>(&parsed)) {
      RETURN_IF_ERROR(checkIntrinsicPrepare(prepare));
      return computeIntrinsicSignature(context, *intrinsic, options);
    }
    Context::Stage stage(context, "prepare");
    ASSIGN_OR_RETURN(prepared, prepareMesh(context, std::get<TriangleSoup>(parsed), prepare));
  }
  return computeSignature(context, *prepared, options);
}

}  // namespace moduli
