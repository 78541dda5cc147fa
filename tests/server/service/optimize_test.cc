#include <cmath>
#include <cstring>
#include <functional>
#include <map>
#include <utility>

#include "core/mesh/samples.h"
#include "core/mesh/write.h"
#include "core/optimize/named_objectives.h"
#include "moduli/v1/optimize.grpc.pb.h"
#include "server/service/backend.h"
#include "server/service/optimize_request.h"
#include "tests/server/service/fixture.h"

/// The Minimize call: what it sends, what it refuses, and that it stops when told to. What the
/// methods are worth is tested beside them.
namespace moduli {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;
using Options = v1::MinimizeOptions;
using Reader = grpc::ClientReader<v1::MinimizeResponse>;

struct Answer {
  v1::Minimization result;
  v1::AffineDirection direction;
  bool directed = false;
  std::map<v1::ArrayChunk::Array, std::vector<double>> arrays;
  std::map<v1::ArrayChunk::Array, int> rows;
};

class OptimizeTest : public ServiceTest {
 protected:
  std::unique_ptr<v1::OptimizeService::Stub> stub() {
    return v1::OptimizeService::NewStub(peer_->channel());
  }

  Result<Answer> call(const v1::MinimizeRequest& request) {
    grpc::ClientContext context;
    const auto service = stub();
    const auto reader = service->Minimize(&context, request);
    Answer answer;
    bool done = false;
    for (v1::MinimizeResponse event; reader->Read(&event);) {
      EXPECT_FALSE(done) << "something comes after the result";
      if (event.has_array()) take(event.array(), answer);
      if (event.has_minimization()) answer.result = event.minimization();
      if (event.has_direction()) answer.direction = event.direction();
      answer.directed = event.has_direction();
      done = event.has_minimization() || event.has_direction();
    }
    if (const grpc::Status status = reader->Finish(); !status.ok()) return fromGrpcStatus(status);
    EXPECT_TRUE(done);
    return answer;
  }

  static void take(const v1::ArrayChunk& chunk, Answer& answer) {
    EXPECT_LE(chunk.data().size(), kMaxChunkBytes);
    std::vector<double>& numbers = answer.arrays[chunk.array()];
    EXPECT_EQ(static_cast<std::size_t>(chunk.offset()), numbers.size() * sizeof(double));
    answer.rows[chunk.array()] = chunk.rows();
    const std::size_t before = numbers.size();
    numbers.resize(before + chunk.data().size() / sizeof(double));
    std::memcpy(numbers.data() + before, chunk.data().data(), chunk.data().size());
  }

  Status errorOf(const v1::MinimizeRequest& request, Reason reason) {
    const auto answer = call(request);
    EXPECT_THAT(answer, FailsWith(reason));
    return answer.status();
  }
};

v1::MinimizeRequest requestOf(const std::string& function,
                              Options::Method method = Options::AFFINE_NORMAL) {
  v1::MinimizeRequest request;
  request.mutable_test()->set_name(function);
  request.mutable_options()->set_method(method);
  return request;
}

v1::MinimizeRequest ricciOf(const std::string& bytes,
                            Options::Method method = Options::AFFINE_NORMAL) {
  v1::MinimizeRequest request;
  *request.mutable_ricci()->mutable_source() = inlineSource(bytes);
  request.mutable_options()->set_method(method);
  return request;
}

Eigen::VectorXd pointOf(const Answer& answer) {
  const auto& x = answer.result.x();
  return Eigen::Map<const Eigen::VectorXd>(x.data(), x.size());
}

TEST_F(OptimizeTest, AQuadraticIsMinimizedInOneStepWhateverItsCondition) {
  for (const double condition : {1.0, 1e4}) {
    v1::MinimizeRequest request = requestOf("quadratic");
    request.mutable_test()->set_dimension(5);
    request.mutable_test()->set_condition(condition);
    request.mutable_test()->set_seed(3);
    const auto answer = call(request);
    ASSERT_OK(answer);
    const auto named = makeObjective("quadratic", {5, condition, 3});
    ASSERT_OK(named);
    ASSERT_EQ(answer->result.x_size(), 5);
    // The least eigenvalue is 1: |x - c| is at most the norm of the gradient, 1e-10.
    EXPECT_LT((pointOf(*answer) - *named->minimizer).norm(), 1e-10);
    EXPECT_TRUE(answer->result.converged());
    EXPECT_EQ(answer->result.reason(), v1::Minimization::CONVERGED);
    // The second one, if any, takes rounding out.
    EXPECT_LE(answer->result.iterations(), 2);
    EXPECT_GE(answer->result.iterations(), 1);
    EXPECT_TRUE(answer->arrays.empty());
    EXPECT_TRUE(answer->result.timing().contains("minimize"));
  }
}

TEST_F(OptimizeTest, TheAffineNormalOfTheQuarticIsThatOfTheFormula) {
  v1::MinimizeRequest request = requestOf("quartic");
  request.add_direction_at(1);
  request.add_direction_at(0.7);
  const auto answer = call(request);
  ASSERT_OK(answer);
  ASSERT_TRUE(answer->directed);
  ASSERT_EQ(answer->direction.direction_size(), 2);
  // ((7 + 2 t^4) / 27, (7 t^4 + 2) / (27 t^3)) at (1, t).
  const double t = 0.7, t4 = t * t * t * t;
  EXPECT_NEAR(answer->direction.direction(0), (7 + 2 * t4) / 27, 1e-14);
  EXPECT_NEAR(answer->direction.direction(1), (7 * t4 + 2) / (27 * t * t * t), 1e-14);
  EXPECT_NEAR(answer->direction.direction(0), 0.27704444, 5e-9);
  EXPECT_NEAR(answer->direction.direction(1), 0.39744088, 5e-9);
  // g.d = g.H^{-1} g = (4 / 3) f.
  EXPECT_NEAR(answer->direction.decrease(), 4.0 / 3 * (1 + t4), 1e-13);
  EXPECT_TRUE(answer->direction.convex());
  EXPECT_TRUE(answer->direction.timing().contains("direction"));
}

TEST_F(OptimizeTest, WithAnIndefiniteHessianTheDirectionIsThatOfTheLevelSet) {
  // Rosenbrock's Hessian is [[1200 x^2 - 400 y + 2, -400 x], [-400 x, 200]]: at (0, 1) its entries
  // are -398, 0 and 200, the gradient is (-2, 200).
  v1::MinimizeRequest request = requestOf("rosenbrock");
  request.add_direction_at(0);
  request.add_direction_at(1);
  const auto answer = call(request);
  ASSERT_OK(answer);
  EXPECT_FALSE(answer->direction.convex());
  EXPECT_NEAR(answer->direction.decrease(), std::hypot(2.0, 200.0), 1e-10);
}

TEST_F(OptimizeTest, TraceAndPathComeOnRequestAndFitTheResult) {
  for (const Options::Method method :
       {Options::AFFINE_NORMAL, Options::NEWTON, Options::LBFGS, Options::GRADIENT}) {
    v1::MinimizeRequest request = requestOf("rosenbrock", method);
    request.mutable_options()->set_max_iterations(100000);
    request.mutable_options()->set_tolerance(1e-8);
    request.set_trace(true);
    request.set_path(true);
    const auto answer = call(request);
    ASSERT_OK(answer);
    EXPECT_TRUE(answer->result.converged()) << Options::Method_Name(method);
    EXPECT_EQ(answer->result.method(), method);
    const int rows = answer->result.iterations() + 1;
    EXPECT_EQ(answer->rows.at(v1::ArrayChunk::TRACE), rows);
    EXPECT_EQ(answer->rows.at(v1::ArrayChunk::PATH), rows);
    const std::vector<double>& trace = answer->arrays.at(v1::ArrayChunk::TRACE);
    const std::vector<double>& path = answer->arrays.at(v1::ArrayChunk::PATH);
    EXPECT_EQ(path[0], -1.2);
    EXPECT_EQ(path[1], 1);
    EXPECT_NEAR(trace[1], 24.2, 1e-12);
    for (int row = 0; row < rows; ++row) EXPECT_EQ(trace[7 * row], row);
    EXPECT_EQ(trace[7 * (rows - 1) + 1], answer->result.value());
    EXPECT_EQ(trace[7 * (rows - 1) + 2], answer->result.gradient_norm());
    EXPECT_EQ(path[2 * (rows - 1)], answer->result.x(0));
    EXPECT_EQ(path[2 * (rows - 1) + 1], answer->result.x(1));
  }
}

TEST_F(OptimizeTest, AStartMakesAsManyUnknowns) {
  v1::MinimizeRequest request = requestOf("rosenbrock", Options::NEWTON);
  for (const double x : {-1.2, 1.0, 0.5}) request.mutable_options()->add_start(x);
  const auto answer = call(request);
  ASSERT_OK(answer);
  // Near (1, ..., 1) the Hessian's least eigenvalue is above 0.1: |x - 1| <= 1e-10 / 0.1.
  EXPECT_LT((pointOf(*answer) - Eigen::Vector3d::Ones()).norm(), 1e-9);
}

TEST_F(OptimizeTest, ASearchThatDoesNotConvergeIsAResult) {
  v1::MinimizeRequest request = requestOf("rosenbrock", Options::GRADIENT);
  request.mutable_options()->set_max_iterations(5);
  const auto answer = call(request);
  ASSERT_OK(answer);
  EXPECT_FALSE(answer->result.converged());
  EXPECT_EQ(answer->result.reason(), v1::Minimization::MAX_ITERATIONS);
  EXPECT_EQ(answer->result.iterations(), 5);
  EXPECT_EQ(answer->result.x_size(), 2);
}

TEST_F(OptimizeTest, AllMethodsFindTheMetricOfASurfaceWithTwoHandles) {
  const std::string pretzel = sampleFile("genus", {{"genus", 2}, {"resolution", 3}});
  const auto newton = call(ricciOf(pretzel, Options::NEWTON));
  ASSERT_OK(newton);
  EXPECT_TRUE(newton->result.converged());
  for (const Options::Method method : {Options::AFFINE_NORMAL, Options::LBFGS}) {
    const auto other = call(ricciOf(pretzel, method));
    ASSERT_OK(other);
    EXPECT_TRUE(other->result.converged());
    ASSERT_EQ(other->result.x_size(), newton->result.x_size());
    // Both gradients are below 1e-10; the Hessian's least eigenvalue is of the order of a vertex's
    // share of the area, 4 pi / V, some hundredths.
    EXPECT_LT((pointOf(*other) - pointOf(*newton)).cwiseAbs().maxCoeff(), 1e-8);
  }
}

TEST_F(OptimizeTest, TheScalesOfAFlatTorusHaveTheMeanZero) {
  const std::string torus = sampleFile("torus", {{"resolution", 8}});
  for (const auto scheme :
       {v1::ParameterizationOptions::VERTEX_SCALING, v1::ParameterizationOptions::TANGENTIAL,
        v1::ParameterizationOptions::INVERSIVE_DISTANCE}) {
    v1::MinimizeRequest request = ricciOf(torus);
    request.mutable_ricci()->set_scheme(scheme);
    const auto answer = call(request);
    ASSERT_OK(answer);
    EXPECT_TRUE(answer->result.converged());
    EXPECT_LT(std::abs(pointOf(*answer).mean()), 1e-14);
    // Circles that touch in a lattice of six neighbours each are equal; the others know that the
    // torus of revolution is curved.
    const double size = pointOf(*answer).norm();
    if (scheme == v1::ParameterizationOptions::TANGENTIAL) {
      EXPECT_LT(size, 1e-10);
    } else {
      EXPECT_GT(size, 0.1);
    }
  }
}

TEST_F(OptimizeTest, PointsOfManyUnknownsComeInChunks) {
  const TriangleSoup soup = *makeSample("torus", {{"resolution", 270}});
  ASSERT_GT(soup.vertices.size(), 131072U) << "more than a chunk has room for";
  const auto digest = peer_->upload(*writeMesh(soup, MeshFormat::kOff));
  ASSERT_OK(digest);
  v1::MinimizeRequest request;
  *request.mutable_ricci()->mutable_source() = digestSource(*digest);
  request.mutable_options()->set_max_iterations(0);
  const auto answer = call(request);
  ASSERT_OK(answer);
  EXPECT_EQ(answer->result.x_size(), 0);
  const std::vector<double>& x = answer->arrays.at(v1::ArrayChunk::MINIMIZER);
  EXPECT_EQ(x.size(), soup.vertices.size());
  EXPECT_EQ(answer->rows.at(v1::ArrayChunk::MINIMIZER), static_cast<int>(x.size()));
}

TEST_F(OptimizeTest, SpheresAndDisksAreRefusedForWhatTheyAre) {
  for (const char* kind : {"sphere", "disk"}) {
    const Status status =
        errorOf(ricciOf(sampleFile(kind, {{"resolution", 4}})), Reason::kUnsupportedTopology);
    EXPECT_THAT(status.message(), HasSubstr("Euler characteristic"));
  }
}

TEST_F(OptimizeTest, AStartOnASurfaceHasAnEntryForEachVertex) {
  v1::MinimizeRequest request = ricciOf(sampleFile("torus", {{"resolution", 8}}));
  request.mutable_options()->add_start(0);
  EXPECT_THAT(errorOf(request, Reason::kInvalidOption).message(),
              HasSubstr("the start has 1 entries, ricci has"));
}

TEST(CheckMinimize, NamesTheFieldThatIsWrong) {
  using Request = v1::MinimizeRequest;
  const double nan = std::nan("");
  const std::vector<std::pair<std::string, std::function<void(Request&)>>> faults = {
      {"function", [](Request& r) { r.clear_function(); }},
      {"test.name", [](Request& r) { r.mutable_test()->set_name("cubic"); }},
      {"test.dimension", [](Request& r) { r.mutable_test()->set_dimension(-1); }},
      {"test.dimension", [](Request& r) { r.mutable_test()->set_dimension(1); }},
      {"test.dimension", [](Request& r) { r.mutable_test()->set_dimension(10001); }},
      {"test.condition", [](Request& r) { r.mutable_test()->set_condition(0.5); }},
      {"test.condition", [&](Request& r) { r.mutable_test()->set_condition(nan); }},
      {"test.seed", [](Request& r) { r.mutable_test()->set_seed(-1); }},
      {"options.method",
       [](Request& r) { r.mutable_options()->set_method(static_cast<Options::Method>(9)); }},
      {"options.line_search",
       [](Request& r) {
         r.mutable_options()->set_line_search(static_cast<Options::LineSearch>(9));
       }},
      {"options.tolerance", [](Request& r) { r.mutable_options()->set_tolerance(-1); }},
      {"options.tolerance", [&](Request& r) { r.mutable_options()->set_tolerance(nan); }},
      {"options.max_iterations", [](Request& r) { r.mutable_options()->set_max_iterations(-1); }},
      {"options.max_iterations",
       [](Request& r) { r.mutable_options()->set_max_iterations(1'000'001); }},
      {"options.start[1]",
       [&](Request& r) {
         r.mutable_options()->add_start(1);
         r.mutable_options()->add_start(nan);
       }},
      {"options.start",
       [](Request& r) {
         r.mutable_test()->set_dimension(3);
         r.mutable_options()->add_start(1);
       }},
      {"direction_at",
       [](Request& r) {
         r.mutable_test()->set_dimension(3);
         r.add_direction_at(1);
       }},
      {"trace",
       [](Request& r) {
         for (int i = 0; i < 2; ++i) r.add_direction_at(1);
         r.set_trace(true);
       }},
      {"path",
       [](Request& r) {
         r.mutable_test()->set_dimension(3);
         r.set_path(true);
       }},
      {"ricci.source", [](Request& r) { r.mutable_ricci(); }},
      {"ricci.scheme",
       [](Request& r) {
         *r.mutable_ricci()->mutable_source() = inlineSource("OFF");
         r.mutable_ricci()->set_scheme(static_cast<v1::ParameterizationOptions::Scheme>(9));
       }},
  };
  EXPECT_TRUE(checkMinimize(requestOf("rosenbrock")).ok());
  for (const auto& [field, damage] : faults) {
    Request request = requestOf("rosenbrock");
    damage(request);
    const Refusal refusal = checkMinimize(request);
    EXPECT_FALSE(refusal.ok()) << field;
    EXPECT_EQ(refusal.field, field) << refusal.status.message();
  }
}

TEST_F(OptimizeTest, AnUnknownFunctionIsToldTheKnownOnes) {
  const Status status = errorOf(requestOf("cubic"), Reason::kInvalidOption);
  for (const std::string& name : objectiveNames()) EXPECT_THAT(status.hint(), HasSubstr(name));
}

class OneThreadOptimizeTest : public OptimizeTest {
 protected:
  void configure(ServerOptions& options) override { options.threads = 1; }

  /// Steepest descent, which does not arrive for a long time.
  static v1::MinimizeRequest longRequest() {
    v1::MinimizeRequest request = requestOf("rosenbrock", Options::GRADIENT);
    request.mutable_test()->set_dimension(5000);
    request.mutable_options()->set_max_iterations(1'000'000);
    request.mutable_options()->set_tolerance(0);
    return request;
  }

  static Status endOf(Reader& reader) {
    for (v1::MinimizeResponse event; reader.Read(&event);) EXPECT_FALSE(event.has_minimization());
    return fromGrpcStatus(reader.Finish());
  }
};

TEST_F(OneThreadOptimizeTest, CancellationStopsTheWork) {
  grpc::ClientContext context;
  const auto service = stub();
  const auto reader = service->Minimize(&context, longRequest());
  bool computing = false;
  for (v1::MinimizeResponse event; !computing && reader->Read(&event);) {
    computing = event.progress().stage() == "minimize";
  }
  ASSERT_TRUE(computing);
  context.TryCancel();
  EXPECT_EQ(endOf(*reader).reason(), Reason::kCancelled);
  EXPECT_OK(call(requestOf("quartic"))) << "the thread is free";
}

TEST_F(OneThreadOptimizeTest, ADeadlineStopsTheWork) {
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + milliseconds(400));
  const auto service = stub();
  const auto reader = service->Minimize(&context, longRequest());
  EXPECT_EQ(endOf(*reader).reason(), Reason::kDeadlineExceeded);
  EXPECT_OK(call(requestOf("quartic"))) << "the thread is free";
}

}  // namespace
}  // namespace moduli
