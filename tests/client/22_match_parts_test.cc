#include <functional>
#include <limits>

#include "client/cli/match_picture.h"
#include "client/cli/vertex_map_file.h"
#include "client/cpp/matched_surfaces.h"
#include "core/mesh/samples.h"
#include "tests/client/array_chunk.h"
#include "tests/core/testing.h"

/// Parts of a match behind the service: arrays put together, the map's file, the picture.
namespace moduli {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using Chunk = v1::ArrayChunk;

/// Two vertices, the second of which goes nowhere.
std::vector<Chunk> sound() {
  return {chunk<std::int32_t>(Chunk::IMAGE_FACES, 2, 1, {7, -1}),
          chunk<double>(Chunk::IMAGE_WEIGHTS, 2, 3, {0.5, 0.25, 0.25}),
          chunk<double>(Chunk::IMAGE_WEIGHTS, 2, 3, {0, 0, 0}, 24)};
}

std::string errorAfter(const std::function<void(std::vector<Chunk>&)>& damage,
                       bool inverse = false) {
  std::vector<Chunk> chunks = sound();
  damage(chunks);
  MatchAssembler assembler(inverse);
  for (const Chunk& one : chunks) {
    if (const Status status = assembler.take(one); !status.ok()) return status.message();
  }
  const auto match = assembler.finish();
  return match.ok() ? "" : match.status().message();
}

TEST(MatchAssembler, PutsPiecesTogether) {
  MatchAssembler assembler(false);
  for (const Chunk& one : sound()) ASSERT_OK(assembler.take(one));
  const auto match = assembler.finish();
  ASSERT_OK(match);
  EXPECT_THAT(match->map.faces, ElementsAre(7, -1));
  EXPECT_THAT(match->map.weights, ElementsAre(0.5, 0.25, 0.25, 0, 0, 0));
  EXPECT_TRUE(match->inverse.faces.empty());
}

TEST(MatchAssembler, RefusesWhatIsNoMap) {
  EXPECT_EQ(errorAfter([](auto&) {}), "");
  EXPECT_THAT(errorAfter([](auto& c) { c.pop_back(); }), HasSubstr("IMAGE_WEIGHTS: ends after 24"));
  EXPECT_THAT(errorAfter([](auto& c) { c.erase(c.begin()); }),
              HasSubstr("IMAGE_FACES: is missing"));
  EXPECT_THAT(errorAfter([](auto&) {}, true), HasSubstr("INVERSE_FACES: is missing"));
  EXPECT_THAT(
      errorAfter([](auto& c) { c[0] = chunk<std::int32_t>(Chunk::IMAGE_FACES, 1, 1, {7}); }),
      HasSubstr("not as many rows"));
  EXPECT_THAT(errorAfter([](auto& c) {
                c[0] = chunk<std::int32_t>(Chunk::IMAGE_FACES, 2, 1, {7, -2});
              }),
              HasSubstr("names no face"));
  const auto weights = [](const std::vector<double>& first) {
    return
        [first](std::vector<Chunk>& c) { c[1] = chunk<double>(Chunk::IMAGE_WEIGHTS, 2, 3, first); };
  };
  EXPECT_THAT(errorAfter(weights({0.5, 0.5, 0.5})), HasSubstr("weights that are none"));
  EXPECT_THAT(errorAfter(weights({1.5, -0.5, 0})), HasSubstr("weights that are none"));
  EXPECT_THAT(errorAfter(weights({std::numeric_limits<double>::quiet_NaN(), 1, 0})),
              HasSubstr("weights that are none"));
  EXPECT_THAT(errorAfter([](auto& c) { c[0].set_array(Chunk::POSITIONS); }), HasSubstr("array 1"));
}

TEST(VertexMapFile, HasALineAVertex) {
  std::string text;
  ASSERT_OK(cli::writeVertexMap({{7, -1}, {0.1, 0.25, 0.65, 0, 0, 0}}, [&](std::string_view piece) {
    text += piece;
    return Status();
  }));
  EXPECT_EQ(text, "vertex,face,b0,b1,b2\n0,7,0.1,0.25,0.65\n1,-1,0,0,0\n");
  EXPECT_THAT(cli::writeVertexMap(
                  {}, [](std::string_view) { return Status(Reason::kFileUnwritable, "full"); }),
              FailsWith(Reason::kFileUnwritable));
}

class MatchPictureTest : public testing::Test {
 protected:
  MatchPictureTest() : soup_(*makeSample("ellipsoid", {{"resolution", 4}})) {
    match_.map.faces.assign(soup_.vertices.size(), 0);
    match_.map.weights.assign(3 * soup_.vertices.size(), 0);
    for (std::size_t f = 0; f < soup_.faces.size(); ++f) {
      for (int c = 0; c < 3; ++c) {
        const auto v = static_cast<std::size_t>(soup_.faces[f][c]);
        match_.map.faces[v] = static_cast<std::int32_t>(f);
        for (int d = 0; d < 3; ++d) match_.map.weights[3 * v + d] = c == d ? 1 : 0;
      }
    }
  }

  Result<std::string> draw(bool mirror = false) const {
    return cli::drawMatch({"a<mesh>&\x01", "b", soup_, soup_, match_, {300, 200}, {}, mirror});
  }

  const TriangleSoup soup_;
  MatchedSurfaces match_;  ///< The identity.
};

TEST_F(MatchPictureTest, IsTheSameTwiceAndAnotherForAnotherMap) {
  const auto picture = draw();
  ASSERT_OK(picture);
  EXPECT_TRUE(picture->starts_with("\x89PNG"));
  EXPECT_EQ(*picture, *draw());
  match_.map.faces[0] = match_.map.faces[100];
  const auto other = draw();
  ASSERT_OK(other);
  EXPECT_NE(*picture, *other);
}

TEST_F(MatchPictureTest, ShowsTheMirrorImageThatIsMappedTo) {
  ASSERT_OK(draw(true));
  EXPECT_NE(*draw(true), *draw());
}

TEST_F(MatchPictureTest, VerticesThatGoNowhereBreakNothing) {
  for (std::size_t v = 0; v < 20; ++v) {
    match_.map.faces[v] = -1;
    for (int c = 0; c < 3; ++c) match_.map.weights[3 * v + c] = 0;
  }
  EXPECT_OK(draw());
}

TEST_F(MatchPictureTest, AMapThatDoesNotFitIsRefused) {
  match_.map.faces[3] = static_cast<std::int32_t>(soup_.faces.size());
  EXPECT_THAT(draw(), FailsWith(Reason::kInternal));
  match_.map.faces[3] = 0;
  match_.map.faces.pop_back();
  EXPECT_THAT(draw(), FailsWith(Reason::kInternal));
}

}  // namespace
}  // namespace moduli
