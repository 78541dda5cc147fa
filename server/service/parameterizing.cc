#include "server/service/parameterizing.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <numeric>
#include <string>
#include <utility>
#include <variant>

#include "core/intrinsic/chordal_metric.h"
#include "core/intrinsic/intrinsic_surface.h"
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

/// The surface of a request, ready to be mapped, and how the file numbers it. Either a mesh (`soup`
/// as read, `prepared` from it) or an intrinsic triangulation, which has no other numbers.
struct Subject {
  TriangleSoup soup;
  std::optional<PreparedMesh> prepared;
  std::optional<IntrinsicSurface> intrinsic;
  std::vector<Index> input_corners;  ///< Of `prepared`.
  std::vector<double> lengths;
  VertexPlaces places;
  std::vector<std::string> warnings;

  const Connectivity& surface() const {
    return prepared ? prepared->mesh.connectivity() : intrinsic->connectivity;
  }
};

Result<Subject> meshSubject(Context& context, TriangleSoup soup, const PrepareOptions& options) {
  const Context::Stage stage(context, "prepare");
  Subject subject;
  subject.soup = std::move(soup);
  ASSIGN_OR_RETURN(subject.prepared, prepareMesh(context, subject.soup, options));
  const PreparedMesh& prepared = *subject.prepared;
  subject.input_corners = inputCorners(subject.soup, prepared);
  subject.places = findVertexPlaces(subject.soup, prepared, subject.input_corners);
  subject.lengths = prepared.mesh.edgeLengths();
  subject.warnings = prepared.warnings;
  for (const RepairAction& action : prepared.actions) {
    subject.warnings.push_back("REPAIRED: " + action.action + " (" + std::to_string(action.count) +
                               ")");
  }
  return subject;
}

Result<Subject> intrinsicSubject(IntrinsicSurface surface, const PrepareOptions& options) {
  RETURN_IF_ERROR(checkIntrinsicPrepare(options));
  Subject subject;
  ASSIGN_OR_RETURN(subject.lengths, chordLengths(surface));
  if (surface.geometry != Geometry::kEuclidean) {
    subject.warnings.emplace_back(
        "CHORDAL_METRIC: what is mapped is the polyhedral surface whose edges are the chords of "
        "these");
  }
  const auto vertices = static_cast<std::size_t>(surface.connectivity.vertexCount());
  subject.places.place.resize(vertices);
  std::iota(subject.places.place.begin(), subject.places.place.end(), 0);
  subject.places.used.assign(vertices, true);
  subject.intrinsic = std::move(surface);
  return subject;
}

Result<Subject> loadSubject(Context& context, const Backend& backend,
                            const v1::ParameterizeRequest& request) {
  ASSIGN_OR_RETURN(const MeshFile file, loadMesh(context, backend, request.source()));
  // Taken from where it is: GCC 12 takes the parts of a moved variant for uninitialized.
  Result<ParsedSurface> parsed = parseSurface(context, backend, file);
  RETURN_IF_ERROR(parsed.status());
  const PrepareOptions options = fromProto(request.prepare());
  if (auto* intrinsic = std::get_if<IntrinsicSurface>(&*parsed)) {
    return intrinsicSubject(std::move(*intrinsic), options);
  }
  return meshSubject(context, std::move(std::get<TriangleSoup>(*parsed)), options);
}

Result<FlatOptions> flatOptions(const v1::ParameterizationOptions& message,
                                const Subject& subject) {
  FlatOptions options = fromProto(message);
  ASSIGN_OR_RETURN(options.cones,
                   conesOnSurface(message.cones(), subject.surface(), subject.places));
  ASSIGN_OR_RETURN(options.boundary, boundaryRule(message.boundary(), message.cones(),
                                                  options.cones, subject.surface()));
  return options;
}

/// The map of the prepared mesh, as one of the input's faces.
void mapBack(Subject subject, const FlatParameterization& map, ParameterizedSurface& surface) {
  surface.positions = std::move(subject.soup.vertices);
  surface.faces = std::move(subject.soup.faces);
  surface.corners.assign(surface.faces.size(), {kNone, kNone, kNone});
  std::vector<Index> number(map.points.size(), kNone);
  for (std::size_t h = 0; h < subject.input_corners.size(); ++h) {
    const Index corner = subject.input_corners[h];
    if (corner == kNone) continue;
    number[map.corner[h]] = 0;
    surface.corners[corner / 3][corner % 3] = map.corner[h];
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

/// A surface without positions is what is laid out: a vertex for every point.
void standInPlane(const FlatParameterization& map, ParameterizedSurface& surface) {
  surface.points = map.points;
  for (const std::complex<double>& z : map.points) {
    surface.positions.emplace_back(z.real(), z.imag(), 0);
  }
  for (std::size_t h = 0; h < map.corner.size(); h += 3) {
    surface.corners.push_back({map.corner[h], map.corner[h + 1], map.corner[h + 2]});
  }
  surface.faces = surface.corners;
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
  ASSIGN_OR_RETURN(Subject subject, loadSubject(context, backend, request));
  ASSIGN_OR_RETURN(const FlatOptions options, flatOptions(request.options(), subject));
  ASSIGN_OR_RETURN(FlatParameterization map,
                   parameterizeFlat(context, subject.surface(), subject.lengths, options));
  ParameterizedSurface surface;
  std::vector<std::string>& warnings = map.certificate.warnings;
  warnings.insert(warnings.begin(), subject.warnings.begin(), subject.warnings.end());
  surface.result.set_target(request.options().target());
  *surface.result.mutable_certificate() = toProto(map.certificate);
  surface.result.mutable_timing()->insert(context.timing().begin(), context.timing().end());
  if (request.omit_arrays()) return surface;
  if (subject.intrinsic) {
    standInPlane(map, surface);
  } else {
    mapBack(std::move(subject), map, surface);
  }
  return surface;
}

std::function<std::optional<v1::ParameterizeResponse>()> parameterizationParts(
    std::shared_ptr<const ParameterizedSurface> surface, bool omit_arrays) {
  const auto parts = std::make_shared<Parts>(std::move(surface), omit_arrays);
  return [parts] { return parts->next(); };
}

}  // namespace moduli
