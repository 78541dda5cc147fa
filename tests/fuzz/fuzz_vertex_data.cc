#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/mesh/vertex_data.h"
#include "tests/fuzz/checks.h"

/// Feeds arbitrary bytes to the reader of one number a vertex. What it accepts has as many values
/// as asked for and comes back from a GIFTI file; what it refuses says why, where and what to do.
namespace moduli {
namespace {

// The seeds have four values.
constexpr std::size_t kVertices = 4;

void fuzz(std::string_view bytes) {
  Context context;
  const auto data = readVertexData(context, bytes, "input", kVertices);
  if (!data.ok()) {
    checkRefusal(data.status());
    return;
  }
  require(data->values.size() == kVertices, "there is one value a vertex");
  GiftiWriteOptions options;
  options.doubles = true;
  const auto written = writeGiftiShape(*data, options);
  if (!written.ok()) return;  // XML has control characters that no name should have.
  const auto back = readVertexData(context, *written, "input", kVertices);
  require(back.ok(), "a written GIFTI file can be read");
  for (std::size_t v = 0; v < kVertices; ++v) {
    require(sameBits(back->values[v], data->values[v]), "values keep every bit");
  }
  require(back->name == data->name, "the name comes back");
}

}  // namespace
}  // namespace moduli

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  moduli::fuzz({reinterpret_cast<const char*>(data), size});
  return 0;
}
