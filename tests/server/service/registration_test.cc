#include <cmath>
#include <cstring>

#include "core/mesh/samples.h"
#include "core/mesh/write.h"
#include "server/rpc/convert_parameterization.h"
#include "server/service/request.h"
#include "tests/server/service/fixture.h"

/// Registration of spheres by the Parameterize call: what is refused before the queue and behind
/// it, in whose name, and what is sent. What the numbers are worth is tested beside what computes
/// them.
namespace moduli {
namespace {

using Options = v1::ParameterizationOptions;
using testing::HasSubstr;
using testing::StartsWith;

/// An ellipsoid with a lump: no symmetry.
TriangleSoup lumpy(double seed = 3) {
  TriangleSoup soup = *makeSample("sphere", {{"resolution", 5}, {"seed", seed}});
  for (Eigen::Vector3d& p : soup.vertices) {
    const double lump = std::exp(4 * (p.dot(Eigen::Vector3d(0.6, 0.48, 0.64)) - 1));
    p = Eigen::Vector3d(p.x(), 1.2 * p.y(), 0.9 * p.z()) * (1 + 0.4 * lump);
  }
  return soup;
}

std::string offOf(const TriangleSoup& soup) {
  return *writeMesh(soup, MeshFormat::kOff);
}

/// One value a vertex of lumpy(), as text.
std::string heights(const TriangleSoup& soup) {
  std::string text;
  for (const Eigen::Vector3d& p : soup.vertices)
    text += std::to_string(p.z() + p.x() * p.y()) + "\n";
  return text;
}

v1::LandmarkPair vertexPair(int a, int b, const std::string& name = "") {
  v1::LandmarkPair pair;
  pair.mutable_point()->set_vertex(a);
  pair.mutable_reference()->set_vertex(b);
  pair.set_name(name);
  return pair;
}

/// A surface onto itself.
v1::ParameterizeRequest selfRequest(const TriangleSoup& soup) {
  v1::ParameterizeRequest request;
  *request.mutable_source() = inlineSource(offOf(soup), "a.off");
  request.mutable_options()->set_target(Options::SPHERE);
  *request.mutable_options()->mutable_registration()->mutable_reference() =
      inlineSource(offOf(soup), "b.off");
  return request;
}

TEST(CheckRegistration, NamesTheFieldThatIsWrong) {
  const v1::ParameterizeRequest good = selfRequest(lumpy());
  const auto field = [&](const std::function<void(Options&)>& damage) {
    Options options = good.options();
    damage(options);
    return checkParameterization(options, "options").field;
  };
  EXPECT_TRUE(checkParameterization(good.options(), "options").ok());
  EXPECT_EQ(field([](Options& o) { o.set_target(Options::FLAT); }), "options.registration");
  EXPECT_EQ(field([](Options& o) {
              for (int i = 0; i < 4; ++i) o.add_mobius();
            }),
            "options.mobius");
  EXPECT_EQ(field([](Options& o) { o.mutable_registration()->clear_reference(); }),
            "options.registration.reference");
  EXPECT_EQ(
      field([](Options& o) { o.mutable_registration()->mutable_reference()->set_digest("123"); }),
      "options.registration.reference.digest");
  EXPECT_EQ(field([](Options& o) { o.mutable_registration()->mutable_field()->set_inline_("1"); }),
            "options.registration.reference_field");
  EXPECT_EQ(field([](Options& o) {
              o.mutable_registration()->mutable_reference_field()->set_inline_("1");
            }),
            "options.registration.field");
  EXPECT_EQ(field([](Options& o) {
              *o.mutable_registration()->add_landmarks() = vertexPair(1, 2);
              o.mutable_registration()->mutable_reference_field()->set_inline_("1");
            }),
            "")
      << "a field to carry alone";
  EXPECT_EQ(
      field([](Options& o) {
        *o.mutable_registration()->add_landmarks() = vertexPair(1, 2);
        o.mutable_registration()->mutable_reference_field()->set_shape("collections/c/shapes/s");
      }),
      "options.registration.reference_field.shape");
}

TEST(CheckRegistration, JudgesLandmarksAndCurves) {
  const auto field = [&](const std::function<void(v1::SphereRegistration&)>& fill) {
    Options options;
    options.set_target(Options::SPHERE);
    options.mutable_registration()->mutable_reference()->set_inline_("OFF");
    fill(*options.mutable_registration());
    return checkParameterization(options, "o").field;
  };
  const auto pair = [&](const std::function<void(v1::SurfacePoint&)>& fill) {
    return field([&](v1::SphereRegistration& r) {
      *r.add_landmarks() = vertexPair(0, 0);
      *r.add_landmarks() = vertexPair(1, 1);
      fill(*r.mutable_landmarks(1)->mutable_reference());
    });
  };
  const auto weights = [](v1::SurfacePoint& p, int face, const std::vector<double>& numbers) {
    p.set_face(face);
    for (const double x : numbers) p.add_barycentric(x);
  };
  const std::string wrong = "o.registration.landmarks[1].reference";
  EXPECT_EQ(pair([](auto&) {}), "");
  EXPECT_EQ(pair([&](auto& p) { weights(p, 3, {0.3333, 0.3333, 0.3333}); }), "");
  EXPECT_EQ(pair([&](auto& p) { weights(p, 3, {0.5, 0.6, -0.1}); }), wrong);
  EXPECT_EQ(pair([&](auto& p) { weights(p, 3, {0.5, 0.6, 0.1}); }), wrong);
  EXPECT_EQ(pair([&](auto& p) { weights(p, 3, {0.5, 0.5}); }), wrong);
  EXPECT_EQ(pair([&](auto& p) { weights(p, -3, {0.5, 0.5, 0}); }), wrong);
  EXPECT_EQ(pair([&](auto& p) { weights(p, 3, {NAN, 0.5, 0.5}); }), wrong);
  EXPECT_EQ(pair([](auto& p) { p.set_vertex(-1); }), wrong);
  EXPECT_EQ(pair([](auto& p) { p.Clear(); }), wrong);
  const auto curve = [&](int count, int a, int b) {
    return field([&](v1::SphereRegistration& r) {
      v1::LandmarkCurve& c = *r.add_curves();
      c.set_count(count);
      for (int i = 0; i < a; ++i) c.add_vertices(i);
      for (int i = 0; i < b; ++i) c.add_reference_vertices(i);
    });
  };
  EXPECT_EQ(curve(5, 2, 3), "");
  EXPECT_EQ(curve(1, 2, 3), "o.registration.curves[0].count");
  EXPECT_EQ(curve(2000000000, 2, 3), "o.registration.curves[0].count");
  EXPECT_EQ(curve(5, 1, 3), "o.registration.curves[0]");
  EXPECT_EQ(field([](v1::SphereRegistration& r) {
              for (int i = 0; i < 2001; ++i) *r.add_landmarks() = vertexPair(i, i);
            }),
            "o.registration");
}

TEST(RegistrationToProto, LeavesOutWhatDoesNotApply) {
  SphereRegistration registration;
  v1::RegistrationResult message = toProto(registration);
  EXPECT_FALSE(message.has_landmark_distance());
  EXPECT_FALSE(message.has_correlation_after());
  EXPECT_FALSE(message.has_field());
  registration.field = ComparedField::kAreaDistortion;
  registration.correlation_after = 0.75;
  registration.max_beltrami = std::nan("");
  message = toProto(registration);
  EXPECT_EQ(message.field(), v1::RegistrationResult::AREA_DISTORTION);
  EXPECT_EQ(message.correlation_after(), 0.75);
  EXPECT_FALSE(message.has_max_beltrami());
}

class RegistrationTest : public ServiceTest {
 protected:
  struct Answer {
    std::map<v1::ArrayChunk::Array, std::vector<double>> arrays;
    v1::Parameterization result;
  };

  Result<Answer> call(const v1::ParameterizeRequest& request) {
    grpc::ClientContext context;
    const auto reader = peer_->geometry().Parameterize(&context, request);
    Answer answer;
    for (v1::ParameterizeResponse event; reader->Read(&event);) {
      if (event.array().data().size() >= sizeof(double)) {
        std::vector<double>& numbers = answer.arrays[event.array().array()];
        const std::size_t before = numbers.size();
        numbers.resize(before + event.array().data().size() / sizeof(double));
        std::memcpy(numbers.data() + before, event.array().data().data(),
                    event.array().data().size());
      }
      if (event.has_parameterization()) answer.result = event.parameterization();
    }
    if (const grpc::Status status = reader->Finish(); !status.ok()) return fromGrpcStatus(status);
    return answer;
  }

  std::string errorOf(const v1::ParameterizeRequest& request, Reason reason) {
    const auto answer = call(request);
    EXPECT_THAT(answer, FailsWith(reason));
    return answer.status().message();
  }
};

TEST_F(RegistrationTest, ASurfaceLiesOnItselfWithItsFieldCarried) {
  // A vertex of nobody in front shifts all numbers.
  TriangleSoup soup = lumpy();
  TriangleSoup shifted = soup;
  shifted.vertices.insert(shifted.vertices.begin(), Eigen::Vector3d(9, 9, 9));
  for (Triangle& face : shifted.faces) {
    for (Index& v : face) ++v;
  }
  v1::ParameterizeRequest request = selfRequest(soup);
  *request.mutable_source() = inlineSource(offOf(shifted), "a.off");
  v1::SphereRegistration& registration = *request.mutable_options()->mutable_registration();
  registration.mutable_field()->set_inline_("nan\n" + heights(soup));
  const auto digest = peer_->upload(heights(soup));
  ASSERT_OK(digest);
  registration.mutable_reference_field()->set_digest(*digest);
  const auto answer = call(request);
  ASSERT_OK(answer);
  const v1::RegistrationResult& result = answer->result.registration();
  EXPECT_EQ(result.field(), v1::RegistrationResult::GIVEN);
  EXPECT_NEAR(result.correlation_after(), 1, 1e-9);
  EXPECT_FALSE(result.reference_is_sphere());
  EXPECT_EQ(answer->result.certificate().flipped_faces(), 0);
  ASSERT_TRUE(answer->arrays.contains(v1::ArrayChunk::CARRIED));
  const std::vector<double>& carried = answer->arrays.at(v1::ArrayChunk::CARRIED);
  ASSERT_EQ(carried.size(), shifted.vertices.size());
  EXPECT_EQ(carried[0], 0) << "a vertex of nobody";
  for (std::size_t v = 0; v < soup.vertices.size(); ++v) {
    const Eigen::Vector3d& p = soup.vertices[v];
    // Six decimals in the text, and the slope times what the rotation misses.
    EXPECT_NEAR(carried[v + 1], p.z() + p.x() * p.y(), 1e-4);
  }
  const auto& warnings = answer->result.certificate().warnings();
  EXPECT_TRUE(std::any_of(warnings.begin(), warnings.end(), [](const std::string& warning) {
    return warning.starts_with("NOTHING_CARRIED: 1 vertex");
  }));
}

TEST_F(RegistrationTest, LandmarksAreMetInTheNumbersOfTheFiles) {
  const TriangleSoup soup = lumpy();
  v1::ParameterizeRequest request = selfRequest(soup);
  v1::SphereRegistration& registration = *request.mutable_options()->mutable_registration();
  for (const int v : {3, 40, 100, 150}) *registration.add_landmarks() = vertexPair(v, v);
  v1::LandmarkPair& within = *registration.add_landmarks();
  for (v1::SurfacePoint* point : {within.mutable_point(), within.mutable_reference()}) {
    point->set_face(200);
    for (const double weight : {0.2, 0.3, 0.5}) point->add_barycentric(weight);
  }
  v1::LandmarkCurve& curve = *registration.add_curves();
  curve.set_count(4);
  for (const int c : {0, 1}) {
    curve.add_vertices(soup.faces[0][c]);
    curve.add_reference_vertices(soup.faces[0][c]);
  }
  const auto answer = call(request);
  ASSERT_OK(answer);
  const v1::RegistrationResult& result = answer->result.registration();
  EXPECT_EQ(result.landmarks(), 9);
  EXPECT_LT(result.landmark_distance(), 1e-9);
  // The surface onto itself: there is nothing to bend.
  EXPECT_LT(result.mean_beltrami(), 1e-9);
  EXPECT_FALSE(result.has_correlation_after());
  EXPECT_FALSE(answer->arrays.contains(v1::ArrayChunk::CARRIED));
}

TEST_F(RegistrationTest, ASphereIsTakenAsItIs) {
  const TriangleSoup soup = lumpy();
  TriangleSoup sphere = *makeSample("sphere", {{"resolution", 5}, {"seed", 3}});
  v1::ParameterizeRequest request = selfRequest(soup);
  v1::SphereRegistration& registration = *request.mutable_options()->mutable_registration();
  *registration.mutable_reference() = inlineSource(offOf(sphere), "sphere.off");
  for (const int v : {3, 40, 100}) *registration.add_landmarks() = vertexPair(v, v);
  const auto answer = call(request);
  ASSERT_OK(answer);
  EXPECT_TRUE(answer->result.registration().reference_is_sphere());
  const std::vector<double>& points = answer->arrays.at(v1::ArrayChunk::POSITIONS);
  for (const int v : {3, 40, 100}) {
    const Eigen::Vector3d p(points[3 * v], points[3 * v + 1], points[3 * v + 2]);
    EXPECT_LT((p - sphere.vertices[v].normalized()).norm(), 1e-9);
  }
}

TEST_F(RegistrationTest, FaultsNameTheFileThatHasThem) {
  const TriangleSoup soup = lumpy();
  const auto with = [&](const std::function<void(v1::SphereRegistration&)>& damage) {
    v1::ParameterizeRequest request = selfRequest(soup);
    damage(*request.mutable_options()->mutable_registration());
    return request;
  };
  EXPECT_THAT(errorOf(with([](auto& r) {
                        *r.mutable_reference() =
                            inlineSource(sampleFile("torus", {{"resolution", 5}}), "torus.off");
                      }),
                      Reason::kUnsupportedTopology),
              StartsWith("torus.off: "));
  EXPECT_THAT(
      errorOf(with([](auto& r) { *r.mutable_reference() = inlineSource("OFF\n1", "b.off"); }),
              Reason::kTruncatedFile),
      StartsWith("b.off:"));
  const auto fields = [&](const std::string& here, const std::string& there) {
    return with([&](auto& r) {
      *r.mutable_field() = inlineSource(here, "a.txt");
      *r.mutable_reference_field() = inlineSource(there, "b.txt");
    });
  };
  EXPECT_THAT(errorOf(fields(heights(soup), "1\n2\n"), Reason::kUnsupportedContent),
              StartsWith("b.txt:"));
  std::string holes = heights(soup);
  holes.replace(0, holes.find('\n'), "nan");
  EXPECT_THAT(errorOf(fields(holes, heights(soup)), Reason::kInvalidOption),
              StartsWith("a.txt: the value of vertex 0 is not finite"));
  const auto count = static_cast<int>(soup.vertices.size());
  EXPECT_THAT(
      errorOf(with([&](auto& r) { *r.add_landmarks() = vertexPair(count, 0, "m.txt:4"); }),
              Reason::kInvalidOption),
      HasSubstr("m.txt:4: a landmark at vertex " + std::to_string(count) + ", but the mesh"));
  EXPECT_THAT(errorOf(with([&](auto& r) { *r.add_landmarks() = vertexPair(0, count, "m.txt:4"); }),
                      Reason::kInvalidOption),
              StartsWith("m.txt:4: on the reference: a landmark at vertex"));
  EXPECT_THAT(errorOf(with([&](auto& r) {
                        v1::LandmarkPair& pair = *r.add_landmarks();
                        pair = vertexPair(0, 0, "m.txt:5");
                        pair.mutable_reference()->set_face(99999);
                        for (const double x : {1, 0, 0})
                          pair.mutable_reference()->add_barycentric(x);
                      }),
                      Reason::kInvalidOption),
              StartsWith("m.txt:5: on the reference: a landmark in face 99999, but the mesh has"));
  EXPECT_THAT(errorOf(with([&](auto& r) {
                        *r.add_landmarks() = vertexPair(1, 2, "m.txt:1");
                        *r.add_landmarks() = vertexPair(1, 3, "m.txt:2");
                      }),
                      Reason::kInvalidOption),
              StartsWith("m.txt:1 and m.txt:2 coincide"));
  EXPECT_THAT(errorOf(with([&](auto& r) {
                        v1::LandmarkCurve& curve = *r.add_curves();
                        curve.set_count(3);
                        curve.set_name("m.txt:6");
                        for (const int v : {0, 0}) curve.add_vertices(v);
                        for (const int v : {0, 0}) curve.add_reference_vertices(v);
                      }),
                      Reason::kInvalidOption),
              StartsWith("m.txt:6: no edge joins vertices 0 and 0"));
}

class RegistrationLimitTest : public RegistrationTest {
  void configure(ServerOptions& options) override { options.max_faces = 600; }
};

TEST_F(RegistrationLimitTest, TheLimitHoldsForTheReference) {
  v1::ParameterizeRequest request = selfRequest(lumpy());
  ASSERT_LE(lumpy().faces.size(), 600U);
  *request.mutable_options()->mutable_registration()->mutable_reference() =
      inlineSource(sampleFile("sphere", {{"resolution", 20}}), "large.off");
  EXPECT_THAT(errorOf(request, Reason::kMeshTooLarge), StartsWith("large.off"));
}

class RegistrationTimeTest : public RegistrationTest {
  void configure(ServerOptions& options) override { options.threads = 1; }
};

TEST_F(RegistrationTimeTest, ADeadlineIsAnsweredInTime) {
  const auto digest = peer_->upload(sampleFile("sphere", {{"resolution", 90}}));
  ASSERT_OK(digest);
  v1::ParameterizeRequest request = selfRequest(lumpy());
  *request.mutable_source() = digestSource(*digest);
  request.mutable_options()->mutable_registration()->mutable_reference()->set_digest(*digest);
  grpc::ClientContext context;
  const auto begin = std::chrono::steady_clock::now();
  context.set_deadline(std::chrono::system_clock::now() + std::chrono::milliseconds(400));
  const auto reader = peer_->geometry().Parameterize(&context, request);
  for (v1::ParameterizeResponse event; reader->Read(&event);) {
  }
  EXPECT_THAT(fromGrpcStatus(reader->Finish()), FailsWith(Reason::kDeadlineExceeded));
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(400 + 500));
  EXPECT_TRUE(eventually([&] { return peer_->sign(inlineSource(smallMesh(1))).ok(); },
                         std::chrono::seconds(10)));
}

}  // namespace
}  // namespace moduli
