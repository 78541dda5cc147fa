#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <new>

#include "core/mesh/write.h"
#include "tests/core/mesh/read_helpers.h"

/// Damaged and hostile bytes: no crash, no index out of range, no memory beyond a small multiple of
/// the input.
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

// The whole literal, zero bytes and all.
template <std::size_t N>
std::string raw(const char (&literal)[N]) {
  return {literal, N - 1};
}

struct Sample {
  MeshFormat format;
  std::string bytes;
};

// A tetrahedron in each format and encoding, and hand-written files with what writers do not write.
std::vector<Sample> samples() {
  std::vector<Sample> list;
  for (const auto format :
       {MeshFormat::kObj, MeshFormat::kOff, MeshFormat::kPly, MeshFormat::kStl}) {
    for (const auto encoding : {Encoding::kText, Encoding::kBinary}) {
      if (auto bytes = writeMesh(tetrahedronSoup(), format, encoding); bytes.ok()) {
        list.push_back({format, *bytes});
      }
    }
  }
  list.push_back(
      {MeshFormat::kObj,
       "\xEF\xBB\xBF# x\nmtllib a\\\nv 0 0 0 1\r\nv 1 0 \\\n0\nvt 0 0\nvn 0 0 1\nv 0 1 0\n"
       "f 1/1/1 2/1/1 -1/1/1\nf 1//1 2//1 3//1\nl 1 2\n"});
  list.push_back(
      {MeshFormat::kOff,
       "# x\nSTCNOFF 4 2 0\n0 0 0 0 0 1 1 1 1 1 .5 .5\n1 0 0 0 0 1 1 1 1 1 .5 .5\n"
       "0 1 0 0 0 1 1 1 1 1 .5 .5\n1 1 0 0 0 1 1 1 1 1 .5 .5\n4 0 1 2 3 255 0 0\n3 0 1 2\n"});
  list.push_back({MeshFormat::kPly,
                  raw("ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty uchar x\n"
                      "property uchar y\nproperty list uchar short t\nproperty uchar z\n"
                      "element face 2\nproperty uchar c\nproperty list ushort uchar "
                      "vertex_index\nend_header\n\0\0\0\0\1\1\1\0\0\0\0\1\0\0"
                      "x\0\3\0\1\2y\0\3\2\1\0")});
  return list;
}

// Whatever comes back is sound: indices in range, or an error that tells why and what to do.
void expectSound(const std::string& bytes, std::optional<MeshFormat> format) {
  Context context;
  ReadOptions options;
  options.format = format;
  largest_block = 0;
  const auto soup = readMesh(context, bytes, options);
  // Eight bytes of text make a vertex of 24 bytes; vectors double as they grow, and small constants
  // (the hash of the welder, an error's text) come on top.
  EXPECT_LE(largest_block.load(), 16 * bytes.size() + 16384);
  if (!soup.ok()) {
    EXPECT_NE(soup.status().reason(), Reason::kInternal);
    EXPECT_FALSE(soup.status().hint().empty()) << soup.status().toString();
    EXPECT_TRUE(soup.status().message().starts_with("mesh:")) << soup.status().toString();
    return;
  }
  const auto count = static_cast<Index>(soup->vertices.size());
  for (const Triangle& t : soup->faces) {
    for (const Index v : t) ASSERT_TRUE(v >= 0 && v < count);
  }
  EXPECT_FALSE(soup->faces.empty());
}

TEST(HostileBytes, TheSamplesThemselvesAreSound) {
  for (const Sample& sample : samples()) {
    Context context;
    ReadOptions options;
    options.format = sample.format;
    largest_block = 0;
    EXPECT_OK(readMesh(context, sample.bytes, options)) << sample.bytes;
    EXPECT_GT(largest_block.load(), 0U);  // The count counts.
    EXPECT_EQ(detectFormat(sample.bytes, ""), sample.format);
  }
}

TEST(HostileBytes, AFileCutAnywhereIsAnErrorOrSound) {
  for (const Sample& sample : samples()) {
    for (std::size_t size = 0; size < sample.bytes.size(); ++size) {
      expectSound(sample.bytes.substr(0, size), sample.format);
      expectSound(sample.bytes.substr(0, size), std::nullopt);
    }
  }
}

TEST(HostileBytes, ABinaryFileCutAnywhereIsAnError) {
  for (const auto format : {MeshFormat::kPly, MeshFormat::kStl}) {
    const auto bytes = writeMesh(tetrahedronSoup(), format, Encoding::kBinary);
    ASSERT_OK(bytes);
    for (std::size_t size = 0; size < bytes->size(); ++size) {
      Context context;
      ReadOptions options;
      options.format = format;
      EXPECT_FALSE(readMesh(context, bytes->substr(0, size), options).ok()) << size;
    }
  }
}

class Noise {
 public:
  std::uint32_t below(std::uint32_t limit) {
    state_ = state_ * 6364136223846793005U + 1442695040888963407U;
    return static_cast<std::uint32_t>((state_ >> 33U) % limit);
  }

 private:
  std::uint64_t state_ = 7;
};

TEST(HostileBytes, ChangedBytesAreAnErrorOrSound) {
  Noise noise;
  const std::string_view likely = "0123456789 -+./#\\\n\rvfenaiIOF\xFF\x80";
  for (const Sample& sample : samples()) {
    for (int round = 0; round < 2000; ++round) {
      std::string bytes = sample.bytes;
      for (std::uint32_t k = noise.below(4) + 1; k > 0; --k) {
        const std::uint32_t place = noise.below(static_cast<std::uint32_t>(bytes.size()));
        const auto any = static_cast<char>(noise.below(256));
        const char value = noise.below(2) != 0
                               ? likely[noise.below(static_cast<std::uint32_t>(likely.size()))]
                               : any;
        switch (noise.below(3)) {
          case 0:
            bytes[place] = value;
            break;
          case 1:
            bytes.insert(place, 1, value);
            break;
          default:
            bytes.erase(place, 1 + noise.below(8));
            if (bytes.empty()) bytes.assign(1, value);
        }
      }
      expectSound(bytes, sample.format);
    }
  }
}

TEST(HostileBytes, RandomBytesAreNoMesh) {
  Noise noise;
  for (int round = 0; round < 500; ++round) {
    std::string bytes(noise.below(500), '\0');
    for (char& c : bytes) c = static_cast<char>(noise.below(256));
    expectSound(bytes, std::nullopt);
    for (const auto format :
         {MeshFormat::kObj, MeshFormat::kOff, MeshFormat::kPly, MeshFormat::kStl}) {
      expectSound(bytes, format);
    }
  }
}

TEST(HostileBytes, HugeCountsTakeNoMemory) {
  for (const std::string count : {"1000000000", "2000000000", "2147483647", "2147483648",
                                  "4294967295", "9223372036854775807", "99999999999999999999"}) {
    expectSound("OFF\n" + count + " 1 0\n0 0 0\n", MeshFormat::kOff);
    expectSound("OFF\n3 " + count + " 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", MeshFormat::kOff);
    expectSound("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n" + count + " 0 1 2\n", MeshFormat::kOff);
    expectSound("v 0 0 0\nf " + count + " 1 1\n", MeshFormat::kObj);
    for (const std::string format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
      for (const bool many_faces : {false, true}) {
        const std::string face_count = many_faces ? count : "1";
        const std::string vertex_count = many_faces ? "3" : count;
        expectSound("ply\nformat " + format + " 1.0\nelement vertex " + vertex_count +
                        "\nproperty char x\nproperty char y\nproperty char z\nelement face " +
                        face_count +
                        "\nproperty list int int "
                        "vertex_indices\nend_header\n\0\0\0\0\0\0\0\0\0\xFF\xFF\xFF",
                    MeshFormat::kPly);
      }
    }
  }
}

TEST(HostileBytes, CornersThatCollideInAHashTakeNoTime) {
  // Coordinates in arithmetic progression, the usual undoing of weak hashes: 60,000 corners would
  // take minutes if they met in one chain.
  TriangleSoup soup;
  for (Index i = 0; i < 60000; ++i) soup.vertices.emplace_back(i * 0x1p20, 0, i * 0x1p-20);
  for (Index i = 0; i + 2 < 60000; i += 3) soup.faces.push_back({i, i + 1, i + 2});
  const auto bytes = writeMesh(soup, MeshFormat::kStl, Encoding::kBinary);
  ASSERT_OK(bytes);
  const auto start = std::chrono::steady_clock::now();
  const auto read = parse(*bytes, "x.stl");
  ASSERT_OK(read);
  EXPECT_EQ(read->vertices, soup.vertices);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5));
}

}  // namespace
}  // namespace moduli
