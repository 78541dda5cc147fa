#include <cstring>

#include "core/mesh/samples.h"
#include "core/mesh/write.h"
#include "tests/server/service/fixture.h"

/// The Parameterize call: what it sends, what it refuses, and that it stops when told to. What the
/// numbers are worth is tested beside what computes them.
namespace moduli {
namespace {

using Options = v1::ParameterizationOptions;
using std::chrono::milliseconds;
using testing::HasSubstr;
using Clock = std::chrono::steady_clock;
using Reader = grpc::ClientReader<v1::ParameterizeResponse>;

/// An array as it has arrived.
struct Received {
  int rows = -1;
  int columns = 0;
  std::string bytes;

  template <typename Number>
  std::vector<Number> numbers() const {
    std::vector<Number> result(bytes.size() / sizeof(Number));
    std::memcpy(result.data(), bytes.data(), bytes.size());
    return result;
  }
};

struct Answer {
  std::map<v1::ArrayChunk::Array, Received> arrays;
  v1::Parameterization result;
};

v1::ParameterizeRequest flatRequest(const v1::MeshSource& source) {
  v1::ParameterizeRequest request;
  *request.mutable_source() = source;
  request.mutable_options()->set_target(Options::FLAT);
  return request;
}

std::string flatTorus(int resolution) {
  return sampleFile("torus", {{"resolution", resolution}});
}

class ParameterizeTest : public ServiceTest {
 protected:
  Result<Answer> call(const v1::ParameterizeRequest& request) {
    grpc::ClientContext context;
    const auto reader = peer_->geometry().Parameterize(&context, request);
    Answer answer;
    v1::ParameterizeResponse event;
    bool done = false;
    while (reader->Read(&event)) {
      EXPECT_FALSE(done) << "something comes after the result";
      if (event.has_array()) take(event.array(), answer);
      if (event.has_parameterization()) {
        answer.result = event.parameterization();
        done = true;
      }
    }
    if (const grpc::Status status = reader->Finish(); !status.ok()) return fromGrpcStatus(status);
    EXPECT_TRUE(done);
    return answer;
  }

  static void take(const v1::ArrayChunk& chunk, Answer& answer) {
    Received& array = answer.arrays[chunk.array()];
    EXPECT_LE(chunk.data().size(), 1U << 20);
    EXPECT_EQ(chunk.offset(), static_cast<std::int64_t>(array.bytes.size()));
    EXPECT_TRUE(array.rows < 0 || array.rows == chunk.rows());
    array.rows = chunk.rows();
    array.columns = chunk.columns();
    array.bytes += chunk.data();
  }
};

TEST_F(ParameterizeTest, SendsTheWholeSurfaceAndAPointForEveryCorner) {
  // 45,000 vertices: positions and faces take several chunks each.
  const auto answer = call(flatRequest(digestSource(*peer_->upload(flatTorus(150)))));
  ASSERT_OK(answer);
  ASSERT_EQ(answer->arrays.size(), 4U);
  const Received& positions = answer->arrays.at(v1::ArrayChunk::POSITIONS);
  const Received& faces = answer->arrays.at(v1::ArrayChunk::FACES);
  const Received& points = answer->arrays.at(v1::ArrayChunk::POINTS);
  const Received& corners = answer->arrays.at(v1::ArrayChunk::CORNERS);
  EXPECT_EQ(positions.rows, 45000);
  EXPECT_EQ(positions.bytes.size(), 45000U * 3 * 8);
  EXPECT_EQ(faces.rows, 90000);
  EXPECT_EQ(faces.bytes.size(), 90000U * 3 * 4);
  EXPECT_EQ(points.columns, 2);
  EXPECT_EQ(points.bytes.size(), static_cast<std::size_t>(points.rows) * 2 * 8);
  EXPECT_EQ(corners.rows, faces.rows);
  for (const std::int32_t corner : corners.numbers<std::int32_t>()) {
    ASSERT_GE(corner, 0);
    ASSERT_LT(corner, points.rows);
  }
  EXPECT_EQ(answer->result.target(), Options::FLAT);
  EXPECT_FALSE(answer->result.refined());
  EXPECT_EQ(answer->result.certificate().flipped_faces(), 0);
  EXPECT_TRUE(answer->result.timing().contains("read"));
}

TEST_F(ParameterizeTest, LeavesTheArraysOutOnRequest) {
  v1::ParameterizeRequest request = flatRequest(inlineSource(flatTorus(8)));
  request.set_omit_arrays(true);
  const auto answer = call(request);
  ASSERT_OK(answer);
  EXPECT_TRUE(answer->arrays.empty());
  EXPECT_TRUE(answer->result.has_certificate());
}

TEST_F(ParameterizeTest, IsTheSameFromEverySourceAndInEveryRun) {
  const std::string bytes = flatTorus(10);
  const auto digest = peer_->upload(bytes);
  ASSERT_OK(digest);
  ASSERT_OK(peer_->ingest(ingestHeader("c"), {ingestItemOf(0, "s", bytes)}));
  const auto from_bytes = call(flatRequest(inlineSource(bytes)));
  ASSERT_OK(from_bytes);
  for (const auto& source : {digestSource(*digest), shapeSource("collections/c/shapes/s")}) {
    const auto other = call(flatRequest(source));
    ASSERT_OK(other);
    for (const auto& [name, array] : from_bytes->arrays) {
      EXPECT_TRUE(array.bytes == other->arrays.at(name).bytes) << name;
    }
  }
}

TEST_F(ParameterizeTest, FacesOfOtherComponentsAndVerticesOfNobodyStayWithoutPoints) {
  auto soup = makeSample("torus", {{"resolution", 6}});  // 72 vertices, 144 faces.
  ASSERT_OK(soup);
  for (const double x : {9, 10, 11, 12}) soup->vertices.emplace_back(x, x * x, 0);
  soup->faces.push_back({72, 73, 74});
  const auto text = writeMesh(*soup, MeshFormat::kOff);
  ASSERT_OK(text);
  v1::ParameterizeRequest request = flatRequest(inlineSource(*text));
  request.mutable_prepare()->set_component("largest");
  const auto answer = call(request);
  ASSERT_OK(answer);
  EXPECT_EQ(answer->arrays.at(v1::ArrayChunk::POSITIONS).rows, 76);
  EXPECT_EQ(answer->arrays.at(v1::ArrayChunk::FACES).rows, 145);
  const auto corners = answer->arrays.at(v1::ArrayChunk::CORNERS).numbers<std::int32_t>();
  ASSERT_EQ(corners.size(), 435U);
  for (std::size_t i = 0; i < corners.size(); ++i) EXPECT_EQ(corners[i] == -1, i >= 432) << i;
}

TEST_F(ParameterizeTest, ConesAreRefusedInTheNumbersOfTheFile) {
  v1::ParameterizeRequest request = flatRequest(inlineSource(flatTorus(6)));
  v1::Cone& cone = *request.mutable_options()->add_cones();
  cone.set_vertex(72);
  cone.set_curvature(1);
  const auto answer = call(request);
  EXPECT_THAT(answer, FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(answer.status().message(), HasSubstr("vertex 72"));
  cone.set_vertex(71);
  EXPECT_THAT(call(request), FailsWith(Reason::kInvalidOption)) << "a sum of 1 on a torus";
}

TEST_F(ParameterizeTest, WrongRequestsNameTheirField) {
  const auto details = [&](const v1::ParameterizeRequest& request) {
    grpc::ClientContext context;
    const auto reader = peer_->geometry().Parameterize(&context, request);
    for (v1::ParameterizeResponse event; reader->Read(&event);) {
    }
    const grpc::Status status = reader->Finish();
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
    return status.error_details();
  };
  v1::ParameterizeRequest request = flatRequest(inlineSource(flatTorus(6)));
  request.mutable_options()->clear_target();
  EXPECT_THAT(details(request), HasSubstr("options.target"));
  request.mutable_options()->set_target(Options::FLAT);
  request.mutable_options()->add_cones()->set_vertex(-5);
  EXPECT_THAT(details(request), HasSubstr("options.cones[0].vertex"));
  request.mutable_prepare()->set_component("biggest");
  EXPECT_THAT(details(request), HasSubstr("prepare.component"));
  request.clear_source();
  EXPECT_THAT(details(request), HasSubstr("source"));
}

class OneThreadTest : public ParameterizeTest {
 protected:
  void configure(ServerOptions& options) override { options.threads = 1; }

  /// A torus of 160,000 faces, which takes seconds.
  v1::ParameterizeRequest largeRequest() {
    const auto digest = peer_->upload(flatTorus(200));
    EXPECT_OK(digest);
    return flatRequest(digestSource(*digest));
  }

  static bool readUntil(Reader& reader,
                        const std::function<bool(const v1::ParameterizeResponse&)>& found) {
    for (v1::ParameterizeResponse event; reader.Read(&event);) {
      if (found(event)) return true;
    }
    return false;
  }

  static Status endOf(Reader& reader) {
    for (v1::ParameterizeResponse event; reader.Read(&event);) {
    }
    return fromGrpcStatus(reader.Finish());
  }

  bool computingThreadIsFree() {
    return eventually([&] { return peer_->sign(inlineSource(smallMesh(1))).ok(); },
                      std::chrono::seconds(10));
  }
};

// A loaded test machine may let a thread wait this long; the promise itself is 100 ms.
constexpr milliseconds kSlack(400);

TEST_F(OneThreadTest, CancellationIsAnsweredInTimeAndStopsTheWork) {
  const v1::ParameterizeRequest request = largeRequest();
  grpc::ClientContext context;
  const auto reader = peer_->geometry().Parameterize(&context, request);
  ASSERT_TRUE(readUntil(*reader, [](const auto& event) {
    const std::string& stage = event.progress().stage();
    return event.has_progress() && stage != "queued" && stage != "load" && stage != "read" &&
           stage != "prepare";
  }));
  const auto begin = Clock::now();
  context.TryCancel();
  EXPECT_THAT(endOf(*reader), FailsWith(Reason::kCancelled));
  EXPECT_LT(Clock::now() - begin, milliseconds(100) + kSlack);
  EXPECT_TRUE(computingThreadIsFree());
}

TEST_F(OneThreadTest, ADeadlineIsAnsweredInTime) {
  const v1::ParameterizeRequest request = largeRequest();
  grpc::ClientContext context;
  const auto begin = Clock::now();
  context.set_deadline(std::chrono::system_clock::now() + milliseconds(300));
  const auto reader = peer_->geometry().Parameterize(&context, request);
  EXPECT_THAT(endOf(*reader), FailsWith(Reason::kDeadlineExceeded));
  EXPECT_LT(Clock::now() - begin, milliseconds(300 + 100) + kSlack);
  EXPECT_TRUE(computingThreadIsFree());
}

TEST_F(OneThreadTest, AReaderThatDoesNotReadKeepsNoComputingThread) {
  const auto digest = peer_->upload(flatTorus(150));
  ASSERT_OK(digest);
  grpc::ClientContext context;
  const auto reader = peer_->geometry().Parameterize(&context, flatRequest(digestSource(*digest)));
  ASSERT_TRUE(readUntil(*reader, [](const auto& event) { return event.has_array(); }));
  EXPECT_TRUE(computingThreadIsFree());
  // And one that goes away in the middle of the arrays ends the call.
  context.TryCancel();
  EXPECT_THAT(endOf(*reader), FailsWith(Reason::kCancelled));
}

class SmallLimitTest : public ParameterizeTest {
  void configure(ServerOptions& options) override { options.max_faces = 100; }
};

TEST_F(SmallLimitTest, MeshesAboveTheLimitAreRefused) {
  EXPECT_THAT(call(flatRequest(inlineSource(flatTorus(6)))), FailsWith(Reason::kMeshTooLarge));
}

class TokenTest : public ParameterizeTest {
  void configure(ServerOptions& options) override {
    options.token_file = folder_.file("tokens", sha256Hex("sesame") + " reader\n");
  }
};

TEST_F(TokenTest, AReaderMayCallAndAStrangerMayNot) {
  EXPECT_THAT(call(flatRequest(inlineSource(flatTorus(6)))), FailsWith(Reason::kUnauthenticated));
  grpc::ClientContext context;
  context.AddMetadata("authorization", "Bearer sesame");
  const auto reader =
      peer_->geometry().Parameterize(&context, flatRequest(inlineSource(flatTorus(6))));
  for (v1::ParameterizeResponse event; reader->Read(&event);) {
  }
  EXPECT_TRUE(reader->Finish().ok());
}

}  // namespace
}  // namespace moduli
