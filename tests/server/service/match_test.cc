#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <map>
#include <optional>
#include <set>

#include "core/mesh/samples.h"
#include "core/mesh/write.h"
#include "server/rpc/convert_matching.h"
#include "server/service/request.h"
#include "tests/core/matching/renumbered.h"
#include "tests/server/service/fixture.h"

/// The MatchSurfaces call: what it sends, in whose numbers, what it refuses, and that it stops when
/// told to. What matches are worth is tested beside what computes them.
namespace moduli {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;
using testing::StartsWith;
using Reader = grpc::ClientReader<v1::MatchSurfacesResponse>;

/// An ellipsoid with a lump: no symmetry, but that of its triangulation, an icosahedron's. 252
/// vertices, 500 faces.
TriangleSoup lumpy(double resolution = 5) {
  TriangleSoup soup = *makeSample("sphere", {{"resolution", resolution}, {"seed", 3}});
  for (Eigen::Vector3d& p : soup.vertices) {
    const double lump = std::exp(4 * (p.dot(Eigen::Vector3d(0.6, 0.48, 0.64)) - 1));
    p = Eigen::Vector3d(p.x(), 1.2 * p.y(), 0.9 * p.z()) * (1 + 0.4 * lump);
  }
  return soup;
}

std::string offOf(const TriangleSoup& soup) {
  return *writeMesh(soup, MeshFormat::kOff);
}

v1::MatchSurfacesRequest requestOf(const TriangleSoup& a, const TriangleSoup& b) {
  v1::MatchSurfacesRequest request;
  *request.mutable_a() = inlineSource(offOf(a), "a.off");
  *request.mutable_b() = inlineSource(offOf(b), "b.off");
  return request;
}

v1::LandmarkPair vertexPair(int a, int b, const std::string& name = "") {
  v1::LandmarkPair pair;
  pair.mutable_point()->set_vertex(a);
  pair.mutable_reference()->set_vertex(b);
  pair.set_name(name);
  return pair;
}

/// The distance of similar surfaces is that of singular values, which are equal to the root of what
/// rounding leaves of their squares: 2^-26, some times that.
constexpr double kSimilar = 1e-7;

/// A map as it has arrived.
struct Arrived {
  std::vector<std::int32_t> faces;
  std::vector<double> weights;

  /// The vertex of a surface that a row is, to the last bit; kNone where it is none.
  Index vertex(std::size_t row, const TriangleSoup& of) const {
    for (std::size_t c = 0; c < 3; ++c) {
      if (weights[3 * row + c] == 1) return of.faces[faces[row]][c];
    }
    return kNone;
  }

  Eigen::Vector3d place(std::size_t row, const TriangleSoup& of) const {
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    for (std::size_t c = 0; c < 3; ++c) {
      p += weights[3 * row + c] * of.vertices[of.faces[faces[row]][c]];
    }
    return p;
  }
};

struct Answer {
  Arrived map, inverse;
  v1::SurfaceMatch result;
  int arrays = 0;
  int chunks = 0;
};

template <typename Number>
void append(const std::string& bytes, std::vector<Number>& numbers) {
  const std::size_t before = numbers.size();
  numbers.resize(before + bytes.size() / sizeof(Number));
  if (!bytes.empty()) std::memcpy(numbers.data() + before, bytes.data(), bytes.size());
}

class MatchTest : public ServiceTest {
 protected:
  Result<Answer> call(const v1::MatchSurfacesRequest& request) {
    grpc::ClientContext context;
    const auto reader = peer_->geometry().MatchSurfaces(&context, request);
    Answer answer;
    bool done = false;
    for (v1::MatchSurfacesResponse event; reader->Read(&event);) {
      EXPECT_FALSE(done) << "something comes after the result";
      if (event.has_array()) take(event.array(), answer);
      if (event.has_match()) answer.result = event.match();
      done = event.has_match();
    }
    if (const grpc::Status status = reader->Finish(); !status.ok()) return fromGrpcStatus(status);
    EXPECT_TRUE(done);
    return answer;
  }

  static void take(const v1::ArrayChunk& chunk, Answer& answer) {
    ++answer.chunks;
    if (chunk.offset() == 0) ++answer.arrays;
    EXPECT_LE(chunk.data().size(), kMaxChunkBytes);
    switch (chunk.array()) {
      case v1::ArrayChunk::IMAGE_FACES:
        return append(chunk.data(), answer.map.faces);
      case v1::ArrayChunk::IMAGE_WEIGHTS:
        return append(chunk.data(), answer.map.weights);
      case v1::ArrayChunk::INVERSE_FACES:
        return append(chunk.data(), answer.inverse.faces);
      case v1::ArrayChunk::INVERSE_WEIGHTS:
        return append(chunk.data(), answer.inverse.weights);
      default:
        ADD_FAILURE() << "an array that no match has: " << chunk.array();
    }
  }

  Status errorOf(const v1::MatchSurfacesRequest& request, Reason reason) {
    const auto answer = call(request);
    EXPECT_THAT(answer, FailsWith(reason));
    return answer.status();
  }
};

bool warns(const v1::SurfaceMatch& result, const std::string& start) {
  const auto& warnings = result.certificate().warnings();
  return std::any_of(warnings.begin(), warnings.end(),
                     [&](const std::string& warning) { return warning.starts_with(start); });
}

TEST(CheckMatch, NamesTheFieldThatIsWrong) {
  v1::MatchOptions options;
  EXPECT_TRUE(checkMatch(options, "options").ok());
  *options.add_landmarks() = vertexPair(1, 2);
  EXPECT_TRUE(checkMatch(options, "options").ok());
  *options.add_landmarks() = vertexPair(-1, 2);
  EXPECT_EQ(checkMatch(options, "options").field, "options.landmarks[1].point");
  *options.mutable_landmarks(1) = vertexPair(1, 2, "m.txt:7");
  options.mutable_landmarks(1)->clear_reference();
  const Refusal refusal = checkMatch(options, "options");
  EXPECT_EQ(refusal.field, "options.landmarks[1].reference");
  EXPECT_EQ(refusal.status.message(), "m.txt:7: a landmark is no point of the second surface");
  options.mutable_landmarks()->RemoveLast();
  options.add_curves()->set_count(1);
  EXPECT_EQ(checkMatch(options, "options").field, "options.curves[0].count");
  options.clear_curves();
  options.add_soft_landmarks();
  EXPECT_EQ(checkMatch(options, "options").field, "options.soft_landmarks[0].point");
  options.clear_soft_landmarks();
  options.add_soft_curves();
  EXPECT_EQ(checkMatch(options, "options").field, "options.soft_curves[0].count");
}

TEST(ConvertMatching, KeepsNumbersAndLeavesOutWhatIsNotFinite) {
  SurfaceMatch match;
  match.method = MatchMethod::kMobius;
  match.distance = 0.25;
  match.report = {0, 1.5, 2.5, HUGE_VAL, 0.125};
  match.cycle_error = 0.0625;
  match.alternatives = {{MatchMethod::kNearIsometry, 0.5}};
  const v1::SurfaceMatch message = toProto(match);
  EXPECT_EQ(message.method(), v1::SurfaceMatch::MOBIUS);
  EXPECT_EQ(message.distance(), 0.25);
  EXPECT_TRUE(message.certificate().has_flipped_faces());
  EXPECT_EQ(message.certificate().mean_dilatation(), 1.5);
  EXPECT_EQ(message.certificate().dilatation_95(), 2.5);
  EXPECT_FALSE(message.certificate().has_max_dilatation());
  EXPECT_EQ(message.certificate().area_distortion(), 0.125);
  EXPECT_EQ(message.certificate().cycle_error(), 0.0625);
  EXPECT_FALSE(message.certificate().has_landmark_error());
  EXPECT_FALSE(message.certificate().has_soft_landmark_error());
  EXPECT_FALSE(message.certificate().has_defect());
  ASSERT_EQ(message.alternatives_size(), 1);
  EXPECT_EQ(message.alternatives(0).method(), v1::SurfaceMatch::NEAR_ISOMETRY);
  EXPECT_EQ(message.alternatives(0).defect(), 0.5);
}

TEST_F(MatchTest, ARenumberedCopyIsMetVertexByVertexInTheNumbersOfTheFiles) {
  // A vertex of nobody in front of A shifts all numbers.
  const TriangleSoup soup = lumpy();
  TriangleSoup a = soup;
  a.vertices.insert(a.vertices.begin(), Eigen::Vector3d(9, 9, 9));
  for (Triangle& face : a.faces) {
    for (Index& v : face) ++v;
  }
  const Renumbered copy = renumbered(soup, 5);
  v1::MatchSurfacesRequest request = requestOf(a, moved(copy.soup));
  request.set_inverse(true);
  const auto answer = call(request);
  ASSERT_OK(answer);
  EXPECT_EQ(answer->arrays, 4);
  EXPECT_EQ(answer->result.method(), v1::SurfaceMatch::SAME_TRIANGULATION);
  EXPECT_EQ(answer->result.certificate().flipped_faces(), 0);
  EXPECT_LT(answer->result.distance(), kSimilar);
  ASSERT_EQ(answer->map.faces.size(), a.vertices.size());
  ASSERT_EQ(answer->map.weights.size(), 3 * a.vertices.size());
  EXPECT_EQ(answer->map.faces[0], -1);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(answer->map.weights[c], 0);
  ASSERT_EQ(answer->inverse.faces.size(), soup.vertices.size());
  for (Index v = 0; v < static_cast<Index>(soup.vertices.size()); ++v) {
    EXPECT_EQ(answer->map.vertex(v + 1, copy.soup), copy.image[v]);
    EXPECT_EQ(answer->inverse.vertex(copy.image[v], a), v + 1);
  }
  EXPECT_TRUE(warns(answer->result, "a.off: NO_IMAGE: 1 vertex of no face"));
  EXPECT_FALSE(warns(answer->result, "b.off: NO_IMAGE"));
  EXPECT_FALSE(answer->result.timing().empty());
}

TEST_F(MatchTest, OtherComponentsHaveRowsWithoutAnImage) {
  // Behind a tetrahedron of another component, nothing has the number that it has when prepared.
  const auto behind = [](const TriangleSoup& soup) {
    TriangleSoup both{{{7, 0, 0}, {8, 0, 0}, {7, 1, 0}, {7, 0, 1}},
                      {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};
    both.vertices.insert(both.vertices.end(), soup.vertices.begin(), soup.vertices.end());
    for (const Triangle& f : soup.faces) both.faces.push_back({f[0] + 4, f[1] + 4, f[2] + 4});
    return both;
  };
  const Renumbered copy = renumbered(lumpy(), 5);
  const TriangleSoup a = behind(lumpy()), b = behind(copy.soup);
  v1::MatchSurfacesRequest request = requestOf(a, b);
  EXPECT_THAT(errorOf(request, Reason::kMultipleComponents).message(), StartsWith("a.off: "));
  request.mutable_prepare()->set_component("largest");
  request.set_inverse(true);
  const auto answer = call(request);
  ASSERT_OK(answer);
  ASSERT_EQ(answer->map.faces.size(), a.vertices.size());
  for (Index v = 0; v < 4; ++v) EXPECT_EQ(answer->map.faces[v], -1);
  for (std::size_t v = 0; v < copy.image.size(); ++v) {
    EXPECT_EQ(answer->map.vertex(v + 4, b), copy.image[v] + 4);
    EXPECT_EQ(answer->inverse.vertex(copy.image[v] + 4, a), static_cast<Index>(v + 4));
  }
}

TEST_F(MatchTest, SendsWhatIsWantedAlone) {
  v1::MatchSurfacesRequest request = requestOf(lumpy(), lumpy());
  auto answer = call(request);
  ASSERT_OK(answer);
  EXPECT_EQ(answer->arrays, 2);
  EXPECT_TRUE(answer->inverse.faces.empty());
  request.set_omit_arrays(true);
  answer = call(request);
  ASSERT_OK(answer);
  EXPECT_EQ(answer->arrays, 0);
  EXPECT_TRUE(answer->result.has_certificate());
}

TEST_F(MatchTest, LargeMapsComeInChunks) {
  // A triangulation without symmetries. No mesh is sent twice.
  const auto digest = peer_->upload(
      sampleFile("capped-cylinder", {{"resolution", 100}, {"half_length", 0.5}, {"seed", 4}}));
  ASSERT_OK(digest);
  v1::MatchSurfacesRequest request;
  *request.mutable_a() = *request.mutable_b() = digestSource(*digest);
  const auto answer = call(request);
  ASSERT_OK(answer);
  EXPECT_EQ(answer->result.method(), v1::SurfaceMatch::SAME_TRIANGULATION);
  EXPECT_EQ(answer->arrays, 2);
  EXPECT_EQ(answer->chunks, 3);
  const std::size_t vertices = answer->map.faces.size();
  EXPECT_EQ(answer->map.weights.size(), 3 * vertices);
  EXPECT_GT(24 * vertices, kMaxChunkBytes);
  EXPECT_FALSE(answer->result.certificate().has_defect()) << "nothing but the triangulation";
}

TEST_F(MatchTest, AFilledHoleIsSpokenOfByTheFacesAroundIt) {
  // B lacks one face, which preparing it adds again: the triangulations agree.
  const TriangleSoup soup = lumpy();
  TriangleSoup open = soup;
  open.faces.erase(open.faces.begin() + 40);
  v1::MatchSurfacesRequest request = requestOf(soup, open);
  EXPECT_THAT(errorOf(request, Reason::kUnsupportedTopology).hint(), HasSubstr("--fill-holes"));
  request.mutable_prepare()->set_fill_holes(0.5);
  request.set_inverse(true);
  const auto answer = call(request);
  ASSERT_OK(answer);
  ASSERT_EQ(answer->map.faces.size(), soup.vertices.size());
  for (std::size_t v = 0; v < soup.vertices.size(); ++v) {
    ASSERT_GE(answer->map.faces[v], 0);
    ASSERT_LT(answer->map.faces[v], static_cast<Index>(open.faces.size()));
    EXPECT_EQ(answer->map.vertex(v, open), static_cast<Index>(v));
    EXPECT_EQ(answer->inverse.vertex(v, soup), static_cast<Index>(v));
  }
}

/// The vertices of all faces that have one of the given ones.
std::set<Index> grown(const TriangleSoup& soup, const std::set<Index>& vertices) {
  std::set<Index> result;
  for (const Triangle& face : soup.faces) {
    const bool found =
        std::any_of(face.begin(), face.end(), [&](Index v) { return vertices.contains(v); });
    if (found) result.insert(face.begin(), face.end());
  }
  return result;
}

TEST_F(MatchTest, PointsWithinAFilledHoleGoToTheNearestPlaceOnItsRim) {
  // B lacks the faces of vertex 100 and of its neighbours, which no file's face has then.
  constexpr Index kMiddle = 100;
  const TriangleSoup soup = lumpy(8);
  const std::set<Index> lost = grown(soup, {kMiddle});
  const std::set<Index> around = grown(soup, lost);
  TriangleSoup open = soup;
  std::erase_if(open.faces, [&](const Triangle& face) {
    return std::any_of(face.begin(), face.end(), [&](Index v) { return lost.contains(v); });
  });
  double longest = 0;  // Of the edges from the neighbours to the rim.
  for (const Triangle& face : soup.faces) {
    for (int c = 0; c < 3; ++c) {
      const Index v = face[c], w = face[(c + 1) % 3];
      if (!around.contains(v) || !around.contains(w)) continue;
      longest = std::max(longest, (soup.vertices[v] - soup.vertices[w]).norm());
    }
  }
  v1::MatchSurfacesRequest request = requestOf(soup, open);
  request.mutable_prepare()->set_fill_holes(1);
  request.set_inverse(true);
  const auto answer = call(request);
  ASSERT_OK(answer);
  EXPECT_EQ(answer->result.certificate().flipped_faces(), 0);
  EXPECT_TRUE(warns(answer->result, "a.off: BESIDE_HOLE: "));
  EXPECT_TRUE(warns(answer->result, numbered("b.off: NO_IMAGE: ", static_cast<int>(lost.size()))));
  for (const Index v : lost) {
    EXPECT_EQ(answer->inverse.faces[v], -1);
    ASSERT_GE(answer->map.faces[v], 0);
    // An edge from its place to the rim, and as much for what the map misses. The other side of the
    // hole is three edges away.
    if (v == kMiddle) continue;
    EXPECT_LT((answer->map.place(v, open) - soup.vertices[v]).norm(), 2 * longest);
  }
}

TEST_F(MatchTest, APinchedVertexIsOneRow) {
  // Two far vertices are one: repair splits it, and both parts are the same vertex of the file.
  TriangleSoup soup = lumpy();
  constexpr Index kKept = 3, kGone = 200;
  for (Triangle& face : soup.faces) std::replace(face.begin(), face.end(), kGone, kKept);
  v1::MatchSurfacesRequest request = requestOf(soup, soup);
  EXPECT_THAT(errorOf(request, Reason::kNonManifoldVertex).message(), StartsWith("a.off: "));
  request.mutable_prepare()->set_repair(true);
  const auto answer = call(request);
  ASSERT_OK(answer);
  for (std::size_t v = 0; v < soup.vertices.size(); ++v) {
    if (v == static_cast<std::size_t>(kGone)) {
      EXPECT_EQ(answer->map.faces[v], -1);
    } else {
      EXPECT_EQ(answer->map.vertex(v, soup), static_cast<Index>(v));
    }
  }
  EXPECT_TRUE(warns(answer->result, "a.off: REPAIRED: "));
  EXPECT_TRUE(warns(answer->result, "b.off: REPAIRED: "));
}

TEST_F(MatchTest, FacesThatRepairTurnsKeepTheOrderOfTheirCorners) {
  const TriangleSoup soup = lumpy();
  TriangleSoup turned = soup;
  for (std::size_t f = 10; f < 200; ++f) std::swap(turned.faces[f][1], turned.faces[f][2]);
  v1::MatchSurfacesRequest request = requestOf(soup, turned);
  request.mutable_prepare()->set_repair(true);
  request.set_inverse(true);
  const auto answer = call(request);
  ASSERT_OK(answer);
  for (std::size_t v = 0; v < soup.vertices.size(); ++v) {
    EXPECT_EQ(answer->map.vertex(v, turned), static_cast<Index>(v));
    EXPECT_EQ(answer->inverse.vertex(v, soup), static_cast<Index>(v));
  }
}

TEST_F(MatchTest, TheMirrorImageIsMetTurnedOver) {
  const TriangleSoup soup = lumpy();
  const Renumbered copy = renumbered(mirrored(soup), 2);
  v1::MatchSurfacesRequest request = requestOf(soup, copy.soup);
  request.mutable_options()->set_mirror(true);
  const auto answer = call(request);
  ASSERT_OK(answer);
  EXPECT_EQ(answer->result.method(), v1::SurfaceMatch::SAME_TRIANGULATION);
  EXPECT_LT(answer->result.distance(), kSimilar);
  for (std::size_t v = 0; v < soup.vertices.size(); ++v) {
    EXPECT_EQ(answer->map.vertex(v, copy.soup), copy.image[v]);
  }
}

TEST_F(MatchTest, LandmarksAndCurvesAreMetInTheNumbersOfTheFiles) {
  const TriangleSoup soup = lumpy();
  const Renumbered copy = renumbered(soup, 5);
  v1::MatchSurfacesRequest request = requestOf(soup, copy.soup);
  for (const int v : {3, 40, 100, 150, 220}) {
    *request.mutable_options()->add_landmarks() = vertexPair(v, copy.image[v]);
  }
  v1::LandmarkCurve& curve = *request.mutable_options()->add_curves();
  curve.set_count(3);
  for (const Index c : {0, 1, 2}) {
    curve.add_vertices(soup.faces[0][c]);
    curve.add_reference_vertices(copy.image[soup.faces[0][c]]);
  }
  const auto answer = call(request);
  ASSERT_OK(answer);
  EXPECT_NE(answer->result.method(), v1::SurfaceMatch::SAME_TRIANGULATION);
  EXPECT_EQ(answer->result.certificate().flipped_faces(), 0);
  for (const int v : {3, 40, 100, 150, 220}) {
    const Eigen::Vector3d there = answer->map.place(v, copy.soup);
    EXPECT_LT((there - soup.vertices[v]).norm(), 1e-9) << "vertex " << v;
  }
}

TEST_F(MatchTest, AStoredShapeIsMatchedToAFile) {
  ASSERT_OK(peer_->createCollection("lumps"));
  ASSERT_OK(peer_->ingest(ingestHeader("lumps"), {ingestItemOf(0, "one", offOf(lumpy()))}));
  v1::MatchSurfacesRequest request = requestOf(lumpy(), lumpy());
  *request.mutable_a() = shapeSource("collections/lumps/shapes/one");
  ASSERT_OK(call(request));
  *request.mutable_b() = shapeSource("collections/lumps/shapes/two");
  EXPECT_THAT(call(request), FailsWith(Reason::kShapeNotFound));
}

TEST_F(MatchTest, FaultsNameTheSurfaceThatHasThem) {
  const v1::MatchSurfacesRequest good = requestOf(lumpy(), lumpy());
  v1::MatchSurfacesRequest request = good;
  *request.mutable_b() = inlineSource("OFF\n1", "b.off");
  EXPECT_THAT(errorOf(request, Reason::kTruncatedFile).message(), StartsWith("b.off:"));
  // Two topologies: both are said.
  *request.mutable_b() = inlineSource(sampleFile("torus", {{"resolution", 6}}), "torus.off");
  EXPECT_THAT(errorOf(request, Reason::kUnsupportedTopology).message(),
              AllOf(HasSubstr("genus 0, closed"), HasSubstr("genus 1, closed")));
  request = good;
  *request.mutable_options()->add_landmarks() = vertexPair(0, 252, "m.txt:4");
  EXPECT_THAT(errorOf(request, Reason::kInvalidOption).message(),
              StartsWith("m.txt:4: on the second surface: a landmark at vertex 252, but the mesh"));
  request = good;
  request.mutable_a()->clear_file_name();
  request.mutable_prepare()->set_component("7");
  EXPECT_THAT(errorOf(request, Reason::kComponentNotFound).message(),
              StartsWith("the first surface: "));
  // The square torus, which has no place in space.
  request = good;
  *request.mutable_b() = inlineSource(
      R"({"format": "moduli-intrinsic-triangulation", "version": 1, "geometry": "euclidean",
          "vertices": 1, "faces": [[0, 0, 0], [0, 0, 0]], "gluing": [[4, 5, 3], [2, 0, 1]],
          "lengths": [[1, 1, 1.4142135623730951], [1.4142135623730951, 1, 1]]})",
      "b.json");
  EXPECT_THAT(errorOf(request, Reason::kUnsupportedContent).message(),
              StartsWith("b.json: an intrinsic triangulation"));
}

TEST_F(MatchTest, WrongRequestsNameTheirField) {
  const auto details = [&](const v1::MatchSurfacesRequest& request) {
    grpc::ClientContext context;
    const auto reader = peer_->geometry().MatchSurfaces(&context, request);
    for (v1::MatchSurfacesResponse event; reader->Read(&event);) {
    }
    const grpc::Status status = reader->Finish();
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
    return status.error_details();
  };
  v1::MatchSurfacesRequest request = requestOf(lumpy(), lumpy());
  request.mutable_options()->add_landmarks();
  EXPECT_THAT(details(request), HasSubstr("options.landmarks[0].point"));
  request.mutable_prepare()->set_fill_holes(-1);
  EXPECT_THAT(details(request), HasSubstr("prepare.fill_holes"));
  request.mutable_b()->set_digest("no digest");
  EXPECT_THAT(details(request), HasSubstr("b.digest"));
  request.clear_a();
  EXPECT_THAT(details(request), HasSubstr("set one of inline, digest and shape"));
}

class OneThreadMatchTest : public MatchTest {
 protected:
  void configure(ServerOptions& options) override { options.threads = 1; }

  /// Two surfaces of 81,920 faces that no triangulation matches: seconds.
  v1::MatchSurfacesRequest largeRequest() {
    v1::MatchSurfacesRequest request;
    const auto digest = peer_->upload(offOf(lumpy(64)));
    EXPECT_OK(digest);
    *request.mutable_a() = *request.mutable_b() = digestSource(*digest);
    request.mutable_options()->set_same_triangulation(false);
    return request;
  }

  static Status endOf(Reader& reader) {
    for (v1::MatchSurfacesResponse event; reader.Read(&event);) {
    }
    return fromGrpcStatus(reader.Finish());
  }

  bool computingThreadIsFree() {
    return eventually([&] { return peer_->sign(inlineSource(smallMesh(1))).ok(); },
                      std::chrono::seconds(10));
  }
};

TEST_F(OneThreadMatchTest, CancellationStopsTheWork) {
  grpc::ClientContext context;
  const auto reader = peer_->geometry().MatchSurfaces(&context, largeRequest());
  bool computing = false;
  for (v1::MatchSurfacesResponse event; !computing && reader->Read(&event);) {
    const std::string& stage = event.progress().stage();
    computing = event.has_progress() && stage != "queued" && stage != "load" && stage != "read" &&
                stage != "prepare";
  }
  ASSERT_TRUE(computing);
  context.TryCancel();
  EXPECT_THAT(endOf(*reader), FailsWith(Reason::kCancelled));
  EXPECT_TRUE(computingThreadIsFree());
}

TEST_F(OneThreadMatchTest, ADeadlineStopsTheWork) {
  const v1::MatchSurfacesRequest request = largeRequest();
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + milliseconds(600));
  const auto reader = peer_->geometry().MatchSurfaces(&context, request);
  EXPECT_THAT(endOf(*reader), FailsWith(Reason::kDeadlineExceeded));
  EXPECT_TRUE(computingThreadIsFree());
}

class MatchLimitTest : public MatchTest {
  void configure(ServerOptions& options) override { options.max_faces = 600; }
};

TEST_F(MatchLimitTest, TheLimitHoldsForBothSurfaces) {
  EXPECT_THAT(errorOf(requestOf(lumpy(), lumpy(8)), Reason::kMeshTooLarge).message(),
              StartsWith("b.off"));
  EXPECT_THAT(errorOf(requestOf(lumpy(8), lumpy()), Reason::kMeshTooLarge).message(),
              StartsWith("a.off"));
}

}  // namespace
}  // namespace moduli
