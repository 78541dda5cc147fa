#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "core/mesh/samples.h"
#include "core/mesh/write.h"
#include "tests/core/mesh/read_helpers.h"

namespace moduli {
namespace {

struct Case {
  MeshFormat format;
  Encoding encoding;
};
constexpr Case kDoubleCases[] = {{MeshFormat::kObj, Encoding::kText},
                                 {MeshFormat::kOff, Encoding::kText},
                                 {MeshFormat::kPly, Encoding::kText},
                                 {MeshFormat::kPly, Encoding::kBinary}};

// Bit patterns from a generator of our own: every exponent, both signs, denormals.
std::vector<double> anyDoubles(std::size_t count) {
  std::vector<double> values = {0.0,
                                -0.0,
                                1.0,
                                0.1,
                                -1.0 / 3,
                                5e-324,
                                -2.2250738585072009e-308,
                                std::numeric_limits<double>::min(),
                                std::numeric_limits<double>::max(),
                                std::numeric_limits<double>::lowest(),
                                std::nextafter(1.0, 2.0),
                                9007199254740993.0,
                                1e23,
                                8.5e22,
                                std::numeric_limits<double>::infinity(),
                                -std::numeric_limits<double>::infinity()};
  std::uint64_t state = 1;
  while (values.size() < count) {
    state = state * 6364136223846793005U + 1442695040888963407U;
    const double value = std::bit_cast<double>(state ^ (state >> 31U));
    if (!std::isnan(value)) values.push_back(value);
  }
  return values;
}

TriangleSoup soupOf(const std::vector<double>& values) {
  TriangleSoup soup;
  for (std::size_t i = 0; i + 2 < values.size(); i += 3) {
    soup.vertices.emplace_back(values[i], values[i + 1], values[i + 2]);
  }
  const auto count = static_cast<Index>(soup.vertices.size());
  for (Index i = 0; i + 2 < count; ++i) soup.faces.push_back({i, i + 2, i + 1});
  return soup;
}

void expectSameBits(const TriangleSoup& a, const TriangleSoup& b) {
  ASSERT_EQ(a.vertices.size(), b.vertices.size());
  for (std::size_t v = 0; v < a.vertices.size(); ++v) {
    for (int i = 0; i < 3; ++i) {
      ASSERT_EQ(std::bit_cast<std::uint64_t>(a.vertices[v][i]),
                std::bit_cast<std::uint64_t>(b.vertices[v][i]))
          << a.vertices[v][i] << " " << b.vertices[v][i];
    }
  }
  EXPECT_EQ(a.faces, b.faces);
}

Result<TriangleSoup> thereAndBack(const TriangleSoup& soup, Case how) {
  ASSIGN_OR_RETURN(const std::string bytes, writeMesh(soup, how.format, how.encoding));
  return parse(bytes, std::string("x.").append(formatName(how.format)));
}

TEST(RoundTrip, EveryDoubleSurvivesToTheLastBit) {
  const TriangleSoup soup = soupOf(anyDoubles(30000));
  for (const Case& how : kDoubleCases) {
    const auto back = thereAndBack(soup, how);
    ASSERT_OK(back);
    expectSameBits(soup, *back);
  }
}

TEST(RoundTrip, NotANumberStaysOne) {
  TriangleSoup soup = tetrahedronSoup();
  soup.vertices[1][2] = std::numeric_limits<double>::quiet_NaN();
  for (const Case& how : kDoubleCases) {
    const auto back = thereAndBack(soup, how);
    ASSERT_OK(back);
    EXPECT_TRUE(std::isnan(back->vertices[1][2]));
  }
}

TEST(RoundTrip, TextStlKeepsDoublesAndNumbersByFirstUse) {
  // Vertices distinct and in order of first use, as STL numbers them.
  TriangleSoup soup;
  std::vector<double> values = anyDoubles(3000);
  std::ranges::sort(values);
  const auto zeros = std::ranges::unique(values);  // 0.0 and -0.0 are one corner in STL.
  values.erase(zeros.begin(), zeros.end());
  for (std::size_t i = 0; i + 2 < values.size(); i += 3) {
    soup.vertices.emplace_back(values[i], values[i + 1], values[i + 2]);
  }
  const auto count = static_cast<Index>(soup.vertices.size());
  for (Index i = 0; i + 2 < count; ++i) soup.faces.push_back({i, i + 1, i + 2});
  const auto back = thereAndBack(soup, {MeshFormat::kStl, Encoding::kText});
  ASSERT_OK(back);
  expectSameBits(soup, *back);
}

TEST(RoundTrip, BinaryStlKeepsFloats) {
  TriangleSoup soup;
  std::uint32_t state = 1;
  while (soup.vertices.size() < 999) {
    Eigen::Vector3d p;
    for (double& x : p) {
      state = state * 1664525U + 1013904223U;
      x = std::bit_cast<float>((state ^ (state >> 15U)) & 0xFF7FFFFFU);  // Never NaN or infinite.
    }
    soup.vertices.push_back(p);
  }
  for (Index i = 0; i + 2 < 999; ++i) soup.faces.push_back({i, i + 1, i + 2});
  const auto back = thereAndBack(soup, {MeshFormat::kStl, Encoding::kBinary});
  ASSERT_OK(back);
  expectSameBits(soup, *back);
}

TEST(RoundTrip, WritingWhatWasReadGivesTheSameBytes) {
  const auto soup = makeSample("torus", {{"resolution", 10}, {"seed", 5}});
  ASSERT_OK(soup);
  for (const auto format :
       {MeshFormat::kObj, MeshFormat::kOff, MeshFormat::kPly, MeshFormat::kStl}) {
    for (const auto encoding : {Encoding::kText, Encoding::kBinary}) {
      const auto bytes = writeMesh(*soup, format, encoding);
      if (!bytes.ok()) continue;
      const auto back = parse(*bytes, std::string("x.").append(formatName(format)));
      ASSERT_OK(back);
      const auto again = writeMesh(*back, format, encoding);
      ASSERT_OK(again);
      EXPECT_TRUE(*again == *bytes) << formatName(format);
    }
  }
}

TEST(RoundTrip, SharedMeshesComeBackUnchanged) {
  MODULI_NEED_SHARED_MESH(first, "genus1/cfwen__torus.off");
  for (const std::string& path : sharedMeshes("genus1")) {
    Context context;
    const auto soup = readMeshFile(context, path);
    ASSERT_OK(soup) << first;
    for (const Case& how : kDoubleCases) {
      const auto back = thereAndBack(*soup, how);
      ASSERT_OK(back);
      expectSameBits(*soup, *back);
    }
  }
}

}  // namespace
}  // namespace moduli
