#include "server/service/signing.h"

#include <utility>

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

Result<TriangleSoup> parseMesh(Context& context, const Backend& backend, const MeshFile& file) {
  Context::Stage stage(context, "read");
  ReadOptions options;
  options.format = file.format;
  options.name = file.name;
  options.max_faces = backend.limits.max_faces;
  return readMesh(context, file.bytes, options);
}

Result<Signature> signMesh(Context& context, const Backend& backend, const MeshFile& file,
                           const PrepareOptions& prepare, std::optional<Space> space) {
  std::optional<PreparedMesh> prepared;
  {
    ASSIGN_OR_RETURN(const TriangleSoup soup, parseMesh(context, backend, file));
    Context::Stage stage(context, "prepare");
    ASSIGN_OR_RETURN(prepared, prepareMesh(context, soup, prepare));
  }
  return computeSignature(context, *prepared, {.space = space});
}

}  // namespace moduli
