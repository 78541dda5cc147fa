#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/intrinsic/chordal_metric.h"
#include "core/intrinsic/intrinsic_json.h"
#include "core/mesh/read.h"
#include "tests/fuzz/checks.h"

/// Feeds arbitrary bytes to the reader of intrinsic triangulations. Whatever it accepts must be a
/// connected surface of proper triangles that comes back unchanged when it is written; whatever it
/// refuses must say why, where and what to do.
namespace moduli {
namespace {

void checkSound(const IntrinsicSurface& surface, std::size_t input_size) {
  const Connectivity& c = surface.connectivity;
  require(c.faceCount() > 0, "an accepted file has faces");
  require(static_cast<std::size_t>(c.halfedgeCount()) <= input_size,
          "faces are bounded by the input");
  require(surface.lengths.size() == static_cast<std::size_t>(c.edgeCount()), "a length an edge");
  for (const double length : surface.lengths) {
    require(length > 0 && std::isfinite(length), "lengths are positive and finite");
  }
  for (Index f = 0; f < c.faceCount(); ++f) {
    require(!isBrokenTriangle(surface.sides(f)), "faces are proper triangles");
  }
  const Inspection inspection = inspectSurface(surface);
  require(inspection.valid && inspection.counts.components == 1, "the surface is connected");
  require(inspection.counts.area >= 0, "the area is a number");
  const auto chords = chordLengths(surface);
  require(chords.ok() || !chords.status().hint().empty(), "a refusal says what to do");
}

void checkRoundTrip(const IntrinsicSurface& surface) {
  const std::string bytes = writeIntrinsicJson(surface);
  require(detectFormat(bytes, "") == MeshFormat::kJson, "the format is told from the content");
  require(looksLikeIntrinsicJson(bytes), "the kind is told from the beginning");
  Context context;
  const auto back = readIntrinsicJson(context, bytes);
  require(back.ok(), "what was written can be read");
  require(back->geometry == surface.geometry, "the geometry comes back unchanged");
  require(back->connectivity.faces() == surface.connectivity.faces(), "faces come back unchanged");
  for (Index h = 0; h < surface.connectivity.halfedgeCount(); ++h) {
    require(back->connectivity.twin(h) == surface.connectivity.twin(h),
            "the gluing comes back unchanged");
  }
  for (std::size_t e = 0; e < surface.lengths.size(); ++e) {
    require(sameBits(back->lengths[e], surface.lengths[e]), "lengths keep every bit");
  }
}

void fuzz(std::string_view bytes) {
  Context context;
  ReadOptions mesh;
  mesh.name = "input";
  mesh.format = MeshFormat::kJson;
  checkRefusal(readMesh(context, bytes, mesh).status());  // No positions, whatever it is.
  IntrinsicJsonOptions options;
  options.name = "input";
  const auto surface = readIntrinsicJson(context, bytes, options);
  if (!surface.ok()) {
    checkRefusal(surface.status());
    return;
  }
  checkSound(*surface, bytes.size());
  checkRoundTrip(*surface);
}

}  // namespace
}  // namespace moduli

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  moduli::fuzz({reinterpret_cast<const char*>(data), size});
  return 0;
}
