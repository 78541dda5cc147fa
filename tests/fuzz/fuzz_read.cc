#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/mesh/deflate.h"
#include "core/mesh/gifti.h"
#include "core/mesh/read.h"
#include "core/mesh/write.h"
#include "tests/fuzz/checks.h"

/// Feeds arbitrary bytes to the reader of one format. Whatever it accepts must be sound, and must
/// come back unchanged through every encoding that keeps doubles; whatever it refuses must say why,
/// where and what to do.
namespace moduli {
namespace {

void checkSound(const TriangleSoup& soup, std::size_t most) {
  require(!soup.faces.empty(), "an accepted file has faces");
  require(soup.faces.size() <= most, "faces are bounded by the input");
  require(soup.vertices.size() <= most, "vertices are bounded by the input");
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

// Tags and doubles come back, too.
void checkGiftiRoundTrip(std::string_view bytes) {
  Context context;
  const auto surface = readGiftiSurface(context, bytes, {});
  require(surface.ok(), "the two doors to a GIFTI surface agree");
  GiftiWriteOptions options;
  options.tags = surface->tags;
  options.doubles = true;
  const auto written = writeGiftiSurface(surface->soup, options);
  if (!written.ok()) return;  // XML has control characters that no tag should have.
  const auto back = readGiftiSurface(context, *written, {});
  require(back.ok(), "a written GIFTI surface can be read");
  require(back->tags.points == surface->tags.points, "tags come back");
  require(back->tags.file == surface->tags.file, "tags of the file come back");
  require(back->soup.faces == surface->soup.faces, "faces come back unchanged");
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
  // Three bytes of text make a corner, one byte of binary; what is compressed may grow so far.
  const bool compressed = format == MeshFormat::kGifti;
  checkSound(*soup, compressed ? InflateAllowance::forFile(bytes.size()).left : bytes.size());
  constexpr std::size_t kMostWritten = 20000;  // For the fuzzer's time.
  if (soup->faces.size() + soup->vertices.size() > kMostWritten) return;
  for (const auto text : {MeshFormat::kObj, MeshFormat::kOff, MeshFormat::kPly}) {
    checkRoundTrip(*soup, text, Encoding::kText);
  }
  checkRoundTrip(*soup, MeshFormat::kPly, Encoding::kBinary);
  if (format == MeshFormat::kGifti) checkGiftiRoundTrip(bytes);
  // STL numbers vertices by first use, as only a mesh read from STL does.
  if (format == MeshFormat::kStl) checkRoundTrip(*soup, format, Encoding::kText);
}

}  // namespace
}  // namespace moduli

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  moduli::fuzz({reinterpret_cast<const char*>(data), size});
  return 0;
}
