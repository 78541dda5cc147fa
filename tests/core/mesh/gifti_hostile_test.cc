#include <atomic>
#include <chrono>
#include <cstdlib>
#include <new>

#include "core/mesh/gifti.h"
#include "core/mesh/vertex_data.h"
#include "core/mesh/write.h"
#include "tests/core/mesh/freesurfer_bytes.h"
#include "tests/core/mesh/read_helpers.h"

/// Damaged and hostile brain files: no crash, no index out of range, no memory beyond a small
/// multiple of the input or of what compressed parts may grow to.
namespace {

std::atomic<std::size_t> largest_block{0};

void* countedAllocation(std::size_t size) {
  std::size_t largest = largest_block.load();
  while (size > largest && !largest_block.compare_exchange_weak(largest, size)) {
  }
  if (void* block = std::malloc(size)) return block;
  throw std::bad_alloc();
}

}  // namespace

void* operator new(std::size_t size) {
  return countedAllocation(size);
}
void operator delete(void* block) noexcept {
  std::free(block);
}
void operator delete(void* block, std::size_t /*size*/) noexcept {
  std::free(block);
}

namespace moduli {
namespace {

struct Sample {
  MeshFormat format;
  std::string bytes;
};

std::vector<Sample> samples() {
  std::vector<Sample> list;
  for (const auto encoding :
       {GiftiEncoding::kAscii, GiftiEncoding::kBase64, GiftiEncoding::kGzipBase64}) {
    GiftiWriteOptions options;
    options.encoding = encoding;
    options.doubles = encoding == GiftiEncoding::kBase64;
    options.tags.file = {{"Name", "a & b"}};
    list.push_back({MeshFormat::kGifti, *writeGiftiSurface(tetrahedronSoup(), options)});
  }
  list.push_back({MeshFormat::kGifti, gzipBytes(list.back().bytes)});
  list.push_back({MeshFormat::kFreeSurfer, freeSurferSurface(tetrahedronSoup()) + "footer"});
  return list;
}

std::vector<std::string> valueSamples() {
  const VertexData data{{0.5, -1, 2, 3.25}, "sulc"};
  return {*writeGiftiShape(data), gzipBytes(*writeGiftiShape(data)),
          freeSurferValues({0.5F, -1, 2, 3.25F}), "0.5\n-1\n2 # x\n3.25\n"};
}

// What inflating works with at a time; a quarter of a megabyte that does not depend on the input.
constexpr std::size_t kWorkingSpace = std::size_t{1} << 20;

void expectExplained(const Status& status) {
  EXPECT_NE(status.reason(), Reason::kInternal);
  EXPECT_FALSE(status.hint().empty()) << status.toString();
  EXPECT_TRUE(status.message().starts_with("mesh:")) << status.toString();
  EXPECT_EQ(status.message().find('\n'), std::string::npos) << status.toString();
}

void expectSound(const std::string& bytes, std::optional<MeshFormat> format) {
  Context context;
  ReadOptions options;
  options.format = format;
  largest_block = 0;
  const auto soup = readMesh(context, bytes, options);
  EXPECT_LE(largest_block.load(), 16 * bytes.size() + kWorkingSpace);
  if (!soup.ok()) return expectExplained(soup.status());
  const auto count = static_cast<Index>(soup->vertices.size());
  for (const Triangle& t : soup->faces) {
    for (const Index v : t) ASSERT_TRUE(v >= 0 && v < count);
  }
  EXPECT_FALSE(soup->faces.empty());
}

void expectSoundValues(const std::string& bytes) {
  Context context;
  largest_block = 0;
  const auto data = readVertexData(context, bytes, "mesh", 4);
  EXPECT_LE(largest_block.load(), 16 * bytes.size() + kWorkingSpace);
  if (!data.ok()) return expectExplained(data.status());
  EXPECT_EQ(data->values.size(), 4U);
}

class Noise {
 public:
  std::uint32_t below(std::size_t limit) {
    state_ = state_ * 6364136223846793005U + 1442695040888963407U;
    return static_cast<std::uint32_t>((state_ >> 33U) % limit);
  }

 private:
  std::uint64_t state_ = 7;
};

std::string damaged(std::string bytes, Noise& noise) {
  const std::string_view likely = "0123456789 -<>/=\"&;#\n\rAZz+\xFF\x80";
  for (std::uint32_t k = noise.below(4) + 1; k > 0 && !bytes.empty(); --k) {
    const std::uint32_t place = noise.below(bytes.size());
    const char value = noise.below(2) != 0 ? likely[noise.below(likely.size())]
                                           : static_cast<char>(noise.below(256));
    switch (noise.below(3)) {
      case 0:
        bytes[place] = value;
        break;
      case 1:
        bytes.insert(place, 1, value);
        break;
      default:
        bytes.erase(place, 1 + noise.below(8));
    }
  }
  return bytes;
}

TEST(HostileBrainFiles, TheSamplesThemselvesAreSound) {
  for (const Sample& sample : samples()) {
    Context context;
    largest_block = 0;
    EXPECT_OK(readMesh(context, sample.bytes, {}));
    EXPECT_GT(largest_block.load(), 0U);  // The count counts.
    EXPECT_EQ(detectFormat(sample.bytes, ""), sample.format);
  }
  for (const std::string& bytes : valueSamples()) {
    Context context;
    EXPECT_OK(readVertexData(context, bytes, "mesh", 4));
  }
}

TEST(HostileBrainFiles, AFileCutAnywhereIsAnError) {
  for (const Sample& sample : samples()) {
    // The last byte of the text is a line end, and the footer of FreeSurfer may be missing.
    const std::size_t spare = sample.format == MeshFormat::kFreeSurfer ? 6
                              : sample.bytes.starts_with("<")          ? 1
                                                                       : 0;
    for (std::size_t size = 0; size + spare < sample.bytes.size(); ++size) {
      Context context;
      ReadOptions options;
      options.format = sample.format;
      const auto soup = readMesh(context, sample.bytes.substr(0, size), options);
      ASSERT_FALSE(soup.ok()) << size;
      expectExplained(soup.status());
      // A cut within the document type reads as a syntax error, and so does half a magic word.
      constexpr std::size_t kProlog = 120;
      if (size >= kProlog) {
        EXPECT_THAT(soup, FailsWith(Reason::kTruncatedFile));
      }
      expectSound(sample.bytes.substr(0, size), std::nullopt);
    }
  }
}

TEST(HostileBrainFiles, ChangedBytesAreAnErrorOrSound) {
  Noise noise;
  for (const Sample& sample : samples()) {
    for (int round = 0; round < 2000; ++round) {
      expectSound(damaged(sample.bytes, noise), sample.format);
    }
  }
  for (const std::string& bytes : valueSamples()) {
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      expectSoundValues(bytes.substr(0, size));
    }
    for (int round = 0; round < 2000; ++round) expectSoundValues(damaged(bytes, noise));
  }
}

TEST(HostileBrainFiles, EveryFlippedBitIsAnErrorOrSound) {
  for (const Sample& sample : samples()) {
    for (std::size_t i = 0; i < sample.bytes.size(); ++i) {
      for (int bit = 0; bit < 8; ++bit) {
        std::string bytes = sample.bytes;
        bytes[i] = static_cast<char>(bytes[i] ^ (1 << bit));
        expectSound(bytes, sample.format);
      }
    }
  }
}

TEST(HostileBrainFiles, RandomBytesAreNoSurface) {
  Noise noise;
  for (int round = 0; round < 500; ++round) {
    std::string bytes(noise.below(500), '\0');
    for (char& c : bytes) c = static_cast<char>(noise.below(256));
    for (const std::string& beginning :
         {std::string(), std::string("\xFF\xFF\xFE"), std::string("\xFF\xFF\xFF"),
          std::string("\x1F\x8B\x08\0\0\0\0\0\0\3", 10), std::string("<GIFTI>")}) {
      for (const auto format : {MeshFormat::kGifti, MeshFormat::kFreeSurfer}) {
        expectSound(beginning + bytes, format);
      }
      expectSoundValues(beginning + bytes);
    }
  }
}

// Zeros in a thousandth of their size.
std::string zeros(std::size_t count) {
  return deflateBytes(std::string(count, '\0'));
}

// No block beyond what may be inflated from a small file, in a string whose room doubles, or as
// doubles of float32.
constexpr std::size_t kMostInflated = std::size_t{64} << 20;

TEST(HostileBrainFiles, CompressedNumbersCannotFillTheMemory) {
  constexpr std::size_t kRows = 20'000'000;
  ArrayText points = tetrahedronPoints();
  points.dimensions = std::to_string(kRows) + " 3";
  points.encoding = "GZipBase64Binary";
  points.data = encodeBase64(zeros(12 * kRows));
  const std::string file = tetrahedronGifti(points);
  const std::string packed = gzipBytes(file);
  for (const std::string& bytes : {file, packed}) {
    largest_block = 0;
    EXPECT_THAT(parse(bytes, "a.gii"),
                FailsAt(Reason::kCountTooLarge,
                        "a.gii:4: array 'NIFTI_INTENT_POINTSET': the compressed bytes expand"));
    EXPECT_LE(largest_block.load(), kMostInflated);
  }
}

TEST(HostileBrainFiles, AGzippedFileCannotFillTheMemory) {
  std::string file = tetrahedronGifti();
  file.insert(file.find("</GIFTI>"), std::string(std::size_t{200} << 20, ' '));
  const std::string packed = gzipBytes(file);
  ASSERT_LT(packed.size(), std::size_t{1} << 18);
  largest_block = 0;
  EXPECT_THAT(parse(packed, "a.gii.gz"),
              FailsAt(Reason::kCountTooLarge, "a.gii.gz: byte 0: the compressed bytes expand"));
  EXPECT_LE(largest_block.load(), kMostInflated);
}

TEST(HostileBrainFiles, LongTagsAndDeepNestingTakeNoTime) {
  const auto start = std::chrono::steady_clock::now();
  std::string deep;
  for (int i = 0; i < 1'000'000; ++i) deep += "<GIFTI>";
  EXPECT_THAT(parse(deep, "a.gii"), FailsWith(Reason::kSyntaxError));
  const std::string longest(std::size_t{30} << 20, 'x');
  EXPECT_OK(parse(giftiFile(tetrahedronPoints().text() + tetrahedronTriangles().text(),
                            "<!--" + longest + "-->"),
                  "a.gii"));
  EXPECT_THAT(parse("<GIFTI a=\"" + longest, "a.gii"), FailsWith(Reason::kTruncatedFile));
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));
}

}  // namespace
}  // namespace moduli
