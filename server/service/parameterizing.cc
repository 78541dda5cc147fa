#include "server/service/parameterizing.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <utility>

#include "core/mesh/input_corners.h"
#include "core/mesh/prepare.h"
#include "server/rpc/convert.h"
#include "server/rpc/convert_parameterization.h"
#include "server/service/cones.h"
#include "server/service/signing.h"

namespace moduli {
namespace {

// What is sent is what stands in memory.
static_assert(std::endian::native == std::endian::little);
static_assert(sizeof(Eigen::Vector3d) == 3 * sizeof(double));
static_assert(sizeof(std::complex<double>) == 2 * sizeof(double));
static_assert(sizeof(Triangle) == 3 * sizeof(std::int32_t));

/// The map of the prepared mesh, as one of the input's faces.
void mapBack(const std::vector<Index>& input_corners, const FlatParameterization& map,
             ParameterizedSurface& surface) {
  surface.corners.assign(surface.faces.size(), {kNone, kNone, kNone});
  std::vector<Index> number(map.points.size(), kNone);
  for (std::size_t h = 0; h < input_corners.size(); ++h) {
    if (input_corners[h] == kNone) continue;
    number[map.corner[h]] = 0;
    surface.corners[input_corners[h] / 3][input_corners[h] % 3] = map.corner[h];
  }
  // Points that only faces in filled holes have are nobody's.
  for (std::size_t p = 0; p < number.size(); ++p) {
    if (number[p] == kNone) continue;
    number[p] = static_cast<Index>(surface.points.size());
    surface.points.push_back(map.points[p]);
  }
  for (Triangle& face : surface.corners) {
    for (Index& point : face) point = point == kNone ? kNone : number[point];
  }
}

void addWarnings(const PreparedMesh& prepared, FlatCertificate& certificate) {
  std::vector<std::string> warnings = prepared.warnings;
  for (const RepairAction& action : prepared.actions) {
    warnings.push_back("REPAIRED: " + action.action + " (" + std::to_string(action.count) + ")");
  }
  certificate.warnings.insert(certificate.warnings.begin(), warnings.begin(), warnings.end());
}

/// One array of a parameterization: its shape, and its bytes in memory.
struct ArrayView {
  v1::ArrayChunk::Array array;
  std::size_t rows;
  int columns;
  const char* bytes;
  std::size_t size;
};

template <typename Row>
ArrayView viewOf(v1::ArrayChunk::Array array, int columns, const std::vector<Row>& rows) {
  return {array, rows.size(), columns, reinterpret_cast<const char*>(rows.data()),
          rows.size() * sizeof(Row)};
}

/// Hands out the messages of a parameterization one after the other.
class Parts {
 public:
  Parts(std::shared_ptr<const ParameterizedSurface> surface, bool omit_arrays)
      : surface_(std::move(surface)), array_(omit_arrays ? kArrays : 0) {}

  std::optional<v1::ParameterizeResponse> next() {
    if (done_) return {};
    v1::ParameterizeResponse response;
    if (array_ == kArrays) {
      *response.mutable_parameterization() = surface_->result;
      done_ = true;
      return response;
    }
    fill(view(), *response.mutable_array());
    return response;
  }

 private:
  static constexpr std::size_t kArrays = 4;

  ArrayView view() const {
    const std::array<ArrayView, kArrays> views = {
        viewOf(v1::ArrayChunk::POSITIONS, 3, surface_->positions),
        viewOf(v1::ArrayChunk::FACES, 3, surface_->faces),
        viewOf(v1::ArrayChunk::POINTS, 2, surface_->points),
        viewOf(v1::ArrayChunk::CORNERS, 3, surface_->corners)};
    return views[array_];
  }

  // The next piece of an array; an empty one has one, too, for the sake of its shape.
  void fill(const ArrayView& view, v1::ArrayChunk& chunk) {
    const std::size_t length = std::min(kMaxChunkBytes, view.size - offset_);
    chunk.set_array(view.array);
    chunk.set_rows(static_cast<std::int32_t>(view.rows));
    chunk.set_columns(view.columns);
    chunk.set_offset(static_cast<std::int64_t>(offset_));
    if (length > 0) chunk.set_data(view.bytes + offset_, length);
    offset_ += length;
    if (offset_ < view.size) return;
    offset_ = 0;
    ++array_;
  }

  std::shared_ptr<const ParameterizedSurface> surface_;
  std::size_t array_ = 0;
  std::size_t offset_ = 0;
  bool done_ = false;
};

}  // namespace

Result<ParameterizedSurface> parameterizeMesh(Context& context, const Backend& backend,
                                              const v1::ParameterizeRequest& request) {
  ASSIGN_OR_RETURN(const MeshFile file, loadMesh(context, backend, request.source()));
  ASSIGN_OR_RETURN(TriangleSoup soup, parseMesh(context, backend, file));
  std::optional<PreparedMesh> prepared;
  {
    const Context::Stage stage(context, "prepare");
    ASSIGN_OR_RETURN(prepared, prepareMesh(context, soup, fromProto(request.prepare())));
  }
  const Connectivity& mesh = prepared->mesh.connectivity();
  const std::vector<Index> input_corners = inputCorners(soup, *prepared);

  FlatOptions options = fromProto(request.options());
  const ConeMessages& cones = request.options().cones();
  ASSIGN_OR_RETURN(options.cones,
                   conesOnSurface(cones, mesh, findVertexPlaces(soup, *prepared, input_corners)));
  ASSIGN_OR_RETURN(options.boundary,
                   boundaryRule(request.options().boundary(), cones, options.cones, mesh));
  ASSIGN_OR_RETURN(FlatParameterization map,
                   parameterizeFlat(context, mesh, prepared->mesh.edgeLengths(), options));

  ParameterizedSurface surface;
  if (!request.omit_arrays()) {
    surface.positions = std::move(soup.vertices);
    surface.faces = std::move(soup.faces);
    mapBack(input_corners, map, surface);
  }
  addWarnings(*prepared, map.certificate);
  surface.result.set_target(request.options().target());
  *surface.result.mutable_certificate() = toProto(map.certificate);
  surface.result.mutable_timing()->insert(context.timing().begin(), context.timing().end());
  return surface;
}

std::function<std::optional<v1::ParameterizeResponse>()> parameterizationParts(
    std::shared_ptr<const ParameterizedSurface> surface, bool omit_arrays) {
  const auto parts = std::make_shared<Parts>(std::move(surface), omit_arrays);
  return [parts] { return parts->next(); };
}

}  // namespace moduli
