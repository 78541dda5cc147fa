#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

#include "client/cpp/client.h"
#include "client/cpp/connect.h"
#include "client/cpp/minimized_function.h"
#include "tests/client/cli_test.h"
#include "tests/client/xml_check.h"

/// minimize: results as JSON, text, tables and pictures, and what it refuses.
namespace moduli {
namespace {

using testing::HasSubstr;
using testing::IsSupersetOf;
using Chunk = v1::ArrayChunk;

class MinimizeCli : public CliTest {};

std::vector<double> numbersOf(const Json& list) {
  std::vector<double> numbers;
  for (int i = 0; i < list.size(); ++i) numbers.push_back(list.at(i).number());
  return numbers;
}

std::vector<std::vector<double>> rowsOf(const std::string& text) {
  std::vector<std::vector<double>> rows;
  std::istringstream lines(text);
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "iteration,value,gradient_norm,step,decrease,evaluations,factorizations");
  while (std::getline(lines, line)) {
    std::vector<double> row;
    std::istringstream words(line);
    for (std::string word; std::getline(words, word, ',');) {
      row.push_back(std::strtod(word.c_str(), nullptr));
    }
    EXPECT_EQ(row.size(), 7U) << line;
    rows.push_back(row);
  }
  return rows;
}

TEST_F(MinimizeCli, RosenbrockHasItsMinimumAtOne) {
  const Json result = json({"minimize", "rosenbrock"});
  EXPECT_THAT(result.keys(),
              IsSupersetOf({"x", "value", "gradient_norm", "iterations", "evaluations",
                            "factorizations", "converged", "reason", "method", "timing"}));
  EXPECT_TRUE(result["converged"].boolean());
  EXPECT_EQ(result["reason"].string(), "CONVERGED");
  EXPECT_EQ(result["method"].string(), "AFFINE_NORMAL");
  // The Hessian's least eigenvalue at (1, 1) is 0.399, the gradient's norm at most 1e-10.
  for (const double x : numbersOf(result["x"])) EXPECT_NEAR(x, 1, 1e-9);
  EXPECT_LE(result["gradient_norm"].number(), 1e-10);
}

TEST_F(MinimizeCli, EveryMethodAndLineSearchFindsTheMinimumOfAQuadratic) {
  const std::vector<double> least =
      numbersOf(json({"minimize", "quadratic", "--dimension", "4", "--condition", "50"})["x"]);
  ASSERT_EQ(least.size(), 4U);
  for (const char* method : {"affine-normal", "newton", "lbfgs", "gradient"}) {
    for (const char* search : {"backtracking", "exact"}) {
      const Json result =
          json({"minimize", "quadratic", "--dimension", "4", "--condition", "50", "--method",
                method, "--line-search", search, "--max-iterations", "10000"});
      const std::vector<double> x = numbersOf(result["x"]);
      ASSERT_EQ(x.size(), 4U);
      // Of eigenvalues from 1 on, both are within the norm of their gradients.
      for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(x[i], least[i], 2e-10) << method;
    }
  }
}

TEST_F(MinimizeCli, DirectionAtPrintsTheAffineNormalAndNothingElse) {
  const Json result = json({"minimize", "quartic", "--direction-at", "1,0.7"});
  EXPECT_THAT(result.keys(), IsSupersetOf({"direction", "decrease"}));
  EXPECT_FALSE(result.has("x"));
  const std::vector<double> d = numbersOf(result["direction"]);
  ASSERT_EQ(d.size(), 2U);
  EXPECT_NEAR(d[0], 0.27704444, 5e-9);
  EXPECT_NEAR(d[1], 0.39744088, 5e-9);
  const ProcessResult text = run({"minimize", "quartic", "--direction-at", "-1,0.7"});
  EXPECT_THAT(text, Succeeds());
  EXPECT_THAT(text.out, HasSubstr("-0.277044"));
}

TEST_F(MinimizeCli, ANegativeFirstNumberIsAStartInBothSpellings) {
  const Json apart = json({"minimize", "rosenbrock", "--start", "-1.2,1"});
  const Json joined = json({"minimize", "rosenbrock", "--start=-1.2,1"});
  EXPECT_EQ(numbersOf(apart["x"]), numbersOf(joined["x"]));
  EXPECT_EQ(apart["iterations"].number(), json({"minimize", "rosenbrock"})["iterations"].number());
}

TEST_F(MinimizeCli, TheTraceHasARowForTheStartAndForEachIteration) {
  const Json result = json({"minimize", "rosenbrock", "--trace", "trace.csv"});
  const auto rows = rowsOf(read("trace.csv"));
  ASSERT_EQ(static_cast<double>(rows.size()), result["iterations"].number() + 1);
  EXPECT_NEAR(rows.front()[1], 24.2, 1e-12);
  EXPECT_EQ(rows.front()[3], 0);
  // The first step is the natural one; g.d = g.H^{-1} g with g = (-215.6, -88) and
  // H = [[1330, 480], [480, 200]].
  EXPECT_EQ(rows[1][3], 1);
  EXPECT_NEAR(rows[1][4], 1382304.0 / 35600, 1e-11);
  EXPECT_EQ(rows.back()[5], result["evaluations"].number());
  EXPECT_EQ(rows.back()[1], result["value"].number());
  EXPECT_EQ(rows.back()[2], result["gradient_norm"].number());
  for (std::size_t i = 0; i < rows.size(); ++i) EXPECT_EQ(rows[i][0], static_cast<double>(i));
}

TEST_F(MinimizeCli, PicturesAreWhatTheirNamesSay) {
  for (const char* function : {"rosenbrock", "log-barrier", "quadratic"}) {
    for (const char* method : {"affine-normal", "newton", "gradient"}) {
      ASSERT_THAT(run({"minimize", function, "--method", method, "--max-iterations", "100000",
                       "--tolerance", "1e-6", "--picture", "p.svg", "--size", "600x480"}),
                  Succeeds());
      EXPECT_EQ(xmlFault(read("p.svg")), "");
      EXPECT_THAT(read("p.svg"), HasSubstr("level sets"));
    }
  }
  ASSERT_THAT(run({"minimize", "rosenbrock", "--picture", "p.png"}), Succeeds());
  EXPECT_TRUE(read("p.png").starts_with("\x89PNG\r\n\x1a\n"));
  ASSERT_THAT(run({"minimize", "rosenbrock", "--dimension", "9", "--picture", "c.svg"}),
              Succeeds());
  EXPECT_EQ(xmlFault(read("c.svg")), "");
  EXPECT_THAT(read("c.svg"), HasSubstr("norm of the gradient"));
}

TEST_F(MinimizeCli, TheMetricOfAPretzelIsTheSameByAffineNormalsAndByNewton) {
  sample("pretzel.off", {"genus", "genus=2", "resolution=3"});
  const Json newton = json({"minimize", "ricci", "pretzel.off", "--method", "newton"});
  const Json affine = json({"minimize", "ricci", "pretzel.off", "--method", "affine-normal"});
  EXPECT_TRUE(newton["converged"].boolean());
  EXPECT_TRUE(affine["converged"].boolean());
  const std::vector<double> u = numbersOf(newton["x"]), v = numbersOf(affine["x"]);
  ASSERT_EQ(u.size(), v.size());
  ASSERT_FALSE(u.empty());
  double most = 0;
  for (std::size_t i = 0; i < u.size(); ++i) most = std::max(most, std::abs(u[i] - v[i]));
  // Both methods converge quadratically: the last step takes the gradient from below 1e-6 to
  // rounding, some 1e-13, over an eigenvalue of some hundredths.
  EXPECT_LT(most, 1e-10);
  EXPECT_FALSE(exists("xdg/moduli")) << "no store is made";
}

TEST_F(MinimizeCli, ParameterizeTakesEachSolverAndFindsTheSameMetric) {
  sample("ball.off", {"sphere", "resolution=5"});
  write("cones.txt", "0 3.14159265\n1 3.14159265\n2 3.14159265\n3 3.14159265\n");
  std::vector<double> angles;
  for (const char* solver : {"newton", "affine-normal", "lbfgs"}) {
    const Json map = json(
        {"parameterize", "ball.off", "--to", "flat", "--cones", "cones.txt", "--solver", solver});
    EXPECT_LT(map["certificate"]["curvature_residual"].number(), 1e-8) << solver;
    angles.push_back(map["certificate"]["smallest_angle"].number());
  }
  for (const double angle : angles) EXPECT_NEAR(angle, angles.front(), 1e-7);
}

TEST_F(MinimizeCli, ASearchThatDoesNotConvergePrintsItsResultAndExitsWithOne) {
  const ProcessResult text = run({"minimize", "rosenbrock", "--max-iterations", "2"});
  EXPECT_EQ(text.exit_code, 1);
  EXPECT_THAT(text.out, HasSubstr("no: max iterations"));
  EXPECT_THAT(text.err, HasSubstr("not converged, max iterations after 2 iterations"));
  EXPECT_EQ(std::count(text.err.begin(), text.err.end(), '\n'), 1);
  const ProcessResult document = run({"minimize", "rosenbrock", "--max-iterations", "2", "--json"});
  EXPECT_EQ(document.exit_code, 1);
  const Json result = Json::parse(document.out);
  EXPECT_FALSE(result["converged"].boolean());
  EXPECT_EQ(result["x"].size(), 2);
}

TEST_F(MinimizeCli, WrongWordsAreUsageErrorsThatTellTheRightOnes) {
  sample("torus.off", {"torus", "resolution=8"});
  const std::vector<std::pair<std::vector<std::string>, std::string>> wrong = {
      {{"cubic"}, "quadratic, quartic, rosenbrock, log-barrier, log-sum-exp, exp-sum, or ricci"},
      {{"ricci"}, "ricci needs a MESH"},
      {{"quartic", "torus.off"}, "a MESH is that of ricci"},
      {{"rosenbrock", "--dimension", "-3"}, "must be a positive integer"},
      {{"rosenbrock", "--start", "1,x"}, "takes finite numbers"},
      {{"rosenbrock", "--start", "1,nan"}, "takes finite numbers"},
      {{"rosenbrock", "--start", "1,"}, "takes finite numbers"},
      {{"rosenbrock", "--direction-at", "1,2", "--trace", "t.csv"}, "--direction-at does not"},
      {{"rosenbrock", "--repair"}, "is for ricci MESH"},
      {{"ricci", "torus.off", "--seed", "1"}, "is not for ricci"},
      {{"rosenbrock", "--picture", "p.gif"}, ".png or .svg"},
      {{"rosenbrock", "--size", "100x100"}, "--size is that of a --picture"},
      {{"rosenbrock", "--method", "simplex"}, "affine-normal, newton, lbfgs, gradient"}};
  for (auto [words, why] : wrong) {
    words.insert(words.begin(), "minimize");
    const ProcessResult result = run(words);
    EXPECT_THAT(result, IsUsageError());
    EXPECT_THAT(result.err, HasSubstr(why));
  }
}

TEST_F(MinimizeCli, WhatTheServiceRefusesIsOneLine) {
  sample("ball.off", {"sphere", "resolution=4"});
  expectRefusal({"minimize", "ricci", "ball.off"}, "Euler characteristic");
  expectRefusal({"minimize", "rosenbrock", "--dimension", "3", "--start", "1,2"},
                "the start has 2 entries, the function has 3 unknowns");
  expectRefusal({"minimize", "log-barrier", "--start", "-1,1"}, "at the start");
  expectRefusal({"minimize", "quadratic", "--condition", "0.5"}, "condition");
  expectRefusal({"minimize", "ricci", "missing.off"}, "missing.off");
}

TEST_F(MinimizeCli, ATimeoutEndsALongSearch) {
  const ProcessResult result =
      run({"--timeout", "0.5", "minimize", "rosenbrock", "--dimension", "5000", "--method",
           "gradient", "--max-iterations", "1000000", "--tolerance", "0"});
  EXPECT_THAT(result, FailsWithOneLine());
  EXPECT_THAT(result.err, HasSubstr("DEADLINE_EXCEEDED"));
}

TEST_F(MinimizeCli, AServerGivesTheSameResultAsTheProgramAlone) {
  Daemon daemon(path("data"), path(""));
  ASSERT_NE(daemon.address(), "");
  const std::vector<std::string> words{"minimize", "exp-sum", "--dimension", "3", "--json"};
  std::vector<std::string> remote = words;
  remote.insert(remote.end(), {"--server", daemon.address()});
  EXPECT_EQ(numbersOf(json({"minimize", "exp-sum", "--dimension", "3"})["x"]),
            numbersOf(Json::parse(run(remote).out)["x"]));
  const auto channel = connectTo({.server = daemon.address()});
  ASSERT_OK(channel);
  Client client(*channel);
  v1::MinimizeRequest request;
  request.mutable_test()->set_name("rosenbrock");
  request.set_trace(true);
  request.set_path(true);
  const auto answer = client.minimize(request);
  ASSERT_OK(answer);
  EXPECT_EQ(answer->trace.size(), answer->path.size());
  EXPECT_EQ(answer->path.back()[0], answer->result.x(0));
  request.add_direction_at(1);
  request.add_direction_at(2);
  const auto direction = client.affineNormal(request);
  ASSERT_OK(direction);
  EXPECT_EQ(direction->direction_size(), 2);
}

Chunk chunkOf(Chunk::Array array, int columns, const std::vector<double>& numbers) {
  Chunk message;
  message.set_array(array);
  message.set_rows(static_cast<int>(numbers.size()) / columns);
  message.set_columns(columns);
  message.set_data(numbers.data(), numbers.size() * sizeof(double));
  return message;
}

TEST(MinimizeAssembler, TakesLongPointsFromChunksAndJudgesTheRest) {
  v1::MinimizeRequest request;
  MinimizeAssembler sound(request);
  ASSERT_TRUE(sound.take(chunkOf(Chunk::MINIMIZER, 1, {1, 2, 3})).ok());
  const auto function = sound.finish(v1::Minimization());
  ASSERT_OK(function);
  EXPECT_EQ(function->result.x_size(), 3);
  EXPECT_EQ(function->result.x(2), 3);

  MinimizeAssembler empty(request);
  EXPECT_THAT(empty.finish(v1::Minimization()), FailsWith(Reason::kInternal));
  request.set_trace(true);
  request.set_path(true);
  v1::Minimization result;
  result.add_x(1);
  MinimizeAssembler missing(request);
  EXPECT_THAT(missing.finish(result), FailsWith(Reason::kInternal));
  MinimizeAssembler uneven(request);
  ASSERT_TRUE(uneven.take(chunkOf(Chunk::TRACE, 7, {0, 1, 1, 0, 0, 1, 0})).ok());
  ASSERT_TRUE(uneven.take(chunkOf(Chunk::PATH, 2, {0, 1, 2, 3})).ok());
  EXPECT_THAT(uneven.finish(result), FailsWith(Reason::kInternal));
  MinimizeAssembler uncounted(request);
  ASSERT_TRUE(uncounted.take(chunkOf(Chunk::TRACE, 7, {0, 1, 1, 0, 0, -1, 0})).ok());
  ASSERT_TRUE(uncounted.take(chunkOf(Chunk::PATH, 2, {0, 1})).ok());
  EXPECT_THAT(uncounted.finish(result), FailsWith(Reason::kInternal));
}

}  // namespace
}  // namespace moduli
