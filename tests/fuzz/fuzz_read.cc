#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/mesh/read.h"
#include "core/mesh/write.h"
#include "tests/fuzz/checks.h"

/// Feeds arbitrary bytes to the reader of one format. Whatever it accepts must be sound, and must
/// come back unchanged through every encoding that keeps doubles; whatever it refuses must say why,
/// where and what to do.
namespace moduli {
namespace {

void checkSound(const TriangleSoup& soup, std::size_t input_size) {
  require(!soup.faces.empty(), "an accepted file has faces");
  // Three bytes of text make a corner, one byte of binary.
  require(soup.faces.size() <= input_size, "faces are bounded by the input");
  require(soup.vertices.size() <= input_size, "vertices are bounded by the input");
  for (const Triangle& t : soup.faces) {
    for (const Index v : t) {
      require(v >= 0 && static_cast<std::size_t>(v) < soup.vertices.size(), "indices are in range");
    }
  }
}

void checkRoundTrip(const TriangleSoup& soup, MeshFormat format, Encoding encoding) {
  const auto bytes = writeMesh(soup, format, encoding);
  require(bytes.ok(), "an accepted mesh can be written");
  Context context;
  const auto back = readMesh(context, *bytes, {});
  require(back.ok(), "what was written can be read, and its format is told from its content");
  require(back->faces == soup.faces, "faces come back unchanged");
  require(back->vertices.size() == soup.vertices.size(), "vertices come back unchanged");
  for (std::size_t v = 0; v < soup.vertices.size(); ++v) {
    for (int i = 0; i < 3; ++i) {
      require(sameBits(back->vertices[v][i], soup.vertices[v][i]), "coordinates keep every bit");
    }
  }
}

void fuzz(std::string_view bytes) {
  const MeshFormat format = *formatFromName(MODULI_FUZZ_FORMAT);
  Context context;
  ReadOptions options;
  options.name = "input";
  options.format = format;
  const auto soup = readMesh(context, bytes, options);
  options.format.reset();
  static_cast<void>(
      readMesh(context, bytes, options).ok());  // Must not crash; any verdict will do.
  if (!soup.ok()) {
    checkRefusal(soup.status());
    return;
  }
  checkSound(*soup, bytes.size());
  for (const auto text : {MeshFormat::kObj, MeshFormat::kOff, MeshFormat::kPly}) {
    checkRoundTrip(*soup, text, Encoding::kText);
  }
  checkRoundTrip(*soup, MeshFormat::kPly, Encoding::kBinary);
  // STL numbers vertices by first use, as only a mesh read from STL does.
  if (format == MeshFormat::kStl) checkRoundTrip(*soup, format, Encoding::kText);
}

}  // namespace
}  // namespace moduli

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  moduli::fuzz({reinterpret_cast<const char*>(data), size});
  return 0;
}
