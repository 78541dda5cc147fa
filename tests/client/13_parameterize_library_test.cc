#include <csignal>
#include <filesystem>
#include <functional>
#include <limits>

#include "client/cpp/client.h"
#include "client/cpp/connect.h"
#include "tests/client/array_chunk.h"
#include "tests/client/cli_test.h"
#include "tests/client/fake_server.h"

/// Arrays that arrive in chunks, from servers that mean well and from others.
namespace moduli {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using Chunk = v1::ArrayChunk;

/// A square of two triangles, the second of which is not mapped.
std::vector<Chunk> square() {
  return {chunk<double>(Chunk::POSITIONS, 4, 3, {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}),
          chunk<std::int32_t>(Chunk::FACES, 2, 3, {0, 1, 2, 0, 2, 3}),
          chunk<double>(Chunk::POINTS, 3, 2, {0, 0, 1, 0, 1, 1}),
          chunk<std::int32_t>(Chunk::CORNERS, 2, 3, {0, 1, 2, -1, -1, -1})};
}

/// What putting these together fails with; "" if it does not.
std::string assemblyError(const std::vector<Chunk>& chunks) {
  ArrayAssembler assembler;
  for (const Chunk& one : chunks) {
    if (const Status status = assembler.take(one); !status.ok()) {
      EXPECT_EQ(status.reason(), Reason::kInternal);
      return status.message();
    }
  }
  const auto mesh = assembler.finish();
  if (mesh.ok()) return "";
  EXPECT_THAT(mesh, FailsWith(Reason::kInternal));
  return mesh.status().message();
}

std::string errorAfter(const std::function<void(std::vector<Chunk>&)>& damage) {
  std::vector<Chunk> chunks = square();
  damage(chunks);
  return assemblyError(chunks);
}

TEST(ArrayAssembler, PutsPiecesInAnyInterleavingTogether) {
  ArrayAssembler assembler;
  ASSERT_OK(assembler.take(chunk<std::int32_t>(Chunk::CORNERS, 1, 3, {0})));
  ASSERT_OK(assembler.take(chunk<double>(Chunk::POINTS, 3, 2, {0, 0, 1})));
  ASSERT_OK(assembler.take(chunk<std::int32_t>(Chunk::FACES, 1, 3, {2, 0, 1})));
  ASSERT_OK(assembler.take(chunk<double>(Chunk::POINTS, 3, 2, {0, 0.1, 1}, 24)));
  ASSERT_OK(assembler.take(chunk<std::int32_t>(Chunk::CORNERS, 1, 3, {1, 2}, 4)));
  ASSERT_OK(assembler.take(chunk<double>(Chunk::POSITIONS, 3, 3, {0, 0, 0, 1, 0, 0, 1, 1, 0})));
  const auto mesh = assembler.finish();
  ASSERT_OK(mesh);
  EXPECT_THAT(mesh->faces, ElementsAre(2, 0, 1));
  EXPECT_THAT(mesh->corners, ElementsAre(0, 1, 2));
  EXPECT_THAT(mesh->points, ElementsAre(0, 0, 1, 0, 0.1, 1));
  EXPECT_EQ(mesh->positions.size(), 9U);
}

TEST(ArrayAssembler, TakesACarriedFieldAndAnswersWithoutOne) {
  ArrayAssembler plain;
  for (const Chunk& one : square()) ASSERT_OK(plain.take(one));
  const auto without = plain.finish();
  ASSERT_OK(without);
  EXPECT_TRUE(without->carried.empty());
  ArrayAssembler assembler;
  for (const Chunk& one : square()) ASSERT_OK(assembler.take(one));
  ASSERT_OK(assembler.take(chunk<double>(Chunk::CARRIED, 3, 1, {0.5, -2})));
  ASSERT_OK(assembler.take(chunk<double>(Chunk::CARRIED, 3, 1, {7}, 16)));
  const auto mesh = assembler.finish();
  ASSERT_OK(mesh);
  EXPECT_THAT(mesh->carried, ElementsAre(0.5, -2, 7));
  const auto with = [](int rows, const std::vector<double>& numbers) {
    return errorAfter(
        [&](auto& chunks) { chunks.push_back(chunk<double>(Chunk::CARRIED, rows, 1, numbers)); });
  };
  EXPECT_EQ(with(4, {1, 2, 3, 4}), "");
  EXPECT_THAT(with(4, {1, 2, 3}), HasSubstr("CARRIED: ends after 24 of 32 bytes"));
  EXPECT_THAT(with(5, {1, 2, 3, 4, 5}), HasSubstr("CARRIED: has more rows than there are"));
  EXPECT_THAT(with(2, {1, std::numeric_limits<double>::quiet_NaN()}),
              HasSubstr("CARRIED: has a number that is not finite"));
}

TEST(ArrayAssembler, TakesParentsThatLeaveNoFaceOut) {
  ArrayAssembler assembler;
  for (const Chunk& one : square()) ASSERT_OK(assembler.take(one));
  ASSERT_OK(assembler.take(chunk<std::int32_t>(Chunk::PARENTS, 2, 1, {0, 0})));
  const auto mesh = assembler.finish();
  ASSERT_OK(mesh);
  EXPECT_THAT(mesh->parents, ElementsAre(0, 0));
  const auto with = [](int rows, const std::vector<std::int32_t>& numbers) {
    return errorAfter([&](auto& chunks) {
      chunks.push_back(chunk<std::int32_t>(Chunk::PARENTS, rows, 1, numbers));
    });
  };
  EXPECT_EQ(with(2, {0, 1}), "");
  EXPECT_THAT(with(1, {0}), HasSubstr("PARENTS: has not as many rows as there are faces"));
  EXPECT_THAT(with(2, {0, 2}), HasSubstr("PARENTS: leaves faces out"));
  EXPECT_THAT(with(2, {1, 0}), HasSubstr("PARENTS: leaves faces out"));
  EXPECT_THAT(with(2, {-1, 0}), HasSubstr("PARENTS: "));
}

TEST(ArrayAssembler, TakesGeodesicsAndChecksWhoseTheyAre) {
  std::vector<double> rows(3 * 7, 0.25);
  ArrayAssembler assembler;
  for (const Chunk& one : square()) ASSERT_OK(assembler.take(one));
  ASSERT_OK(assembler.take(chunk<double>(Chunk::GEODESICS, 3, 7, rows)));
  auto mesh = assembler.finish();
  ASSERT_OK(mesh);
  EXPECT_EQ(mesh->geodesics, rows);
  v1::ClosedGeodesic& geodesic = *mesh->result.mutable_hyperbolic()->add_geodesics();
  const auto check = [&](int first, int points) {
    geodesic.set_first_point(first);
    geodesic.set_points(points);
    return checkGeodesics(*mesh);
  };
  EXPECT_OK(check(0, 3));
  EXPECT_OK(check(2, 1));
  EXPECT_THAT(check(2, 2), FailsWith(Reason::kInternal));
  EXPECT_THAT(check(-1, 2), FailsWith(Reason::kInternal));
  EXPECT_THAT(check(0, 0), FailsWith(Reason::kInternal));
  EXPECT_THAT(check(std::numeric_limits<int>::max(), std::numeric_limits<int>::max()),
              FailsWith(Reason::kInternal));
  rows[9] = std::numeric_limits<double>::infinity();
  EXPECT_THAT(errorAfter([&](auto& chunks) {
                chunks.push_back(chunk<double>(Chunk::GEODESICS, 3, 7, rows));
              }),
              HasSubstr("GEODESICS: has a number that is not finite"));
  EXPECT_THAT(errorAfter([&](auto& chunks) {
                chunks.push_back(chunk<double>(Chunk::GEODESICS, 7, 3, rows));
              }),
              HasSubstr("GEODESICS: no such array can have 7 x 3 numbers"));
}

TEST(ArrayAssembler, RefusesShapesThatNoArrayHas) {
  EXPECT_EQ(assemblyError(square()), "");
  EXPECT_THAT(errorAfter([](auto& chunks) { chunks[2].set_columns(3); }),
              HasSubstr("POINTS: no such array can have 3 x 3 numbers"));
  EXPECT_THAT(errorAfter([](auto& chunks) { chunks[0].set_rows(-1); }), HasSubstr("POSITIONS: no"));
  EXPECT_THAT(errorAfter([](auto& chunks) { chunks[0].clear_array(); }), HasSubstr("array 0"));
  EXPECT_THAT(errorAfter([](auto& chunks) { chunks[0].set_array(static_cast<Chunk::Array>(9)); }),
              HasSubstr("array 9"));
  EXPECT_THAT(errorAfter([](auto& chunks) {
                chunks[1].set_rows(std::numeric_limits<std::int32_t>::max());
                chunks[3].set_rows(std::numeric_limits<std::int32_t>::max());
              }),
              HasSubstr("FACES: ends after 24 of 25769803764 bytes"))
      << "a promise takes no memory";
}

TEST(ArrayAssembler, RefusesChunksThatDoNotFit) {
  EXPECT_THAT(errorAfter([](auto& chunks) { chunks[1].set_offset(4); }),
              HasSubstr("FACES: a chunk starts at byte 4 instead of 0"));
  EXPECT_THAT(errorAfter([](auto& chunks) {
                chunks[1].set_offset(std::numeric_limits<std::int64_t>::min());
              }),
              HasSubstr("FACES: a chunk starts"));
  EXPECT_THAT(errorAfter([](auto& chunks) { chunks[0].mutable_data()->pop_back(); }),
              HasSubstr("POSITIONS: a chunk of 95 bytes does not fit"));
  EXPECT_THAT(errorAfter([](auto& chunks) { chunks[0].mutable_data()->append(8, '\0'); }),
              HasSubstr("POSITIONS: a chunk of 104 bytes does not fit"));
  EXPECT_THAT(errorAfter([](auto& chunks) {
                chunks[0].set_rows(1 << 20);
                chunks[0].mutable_data()->resize((1 << 20) + 8);
              }),
              HasSubstr("POSITIONS: a chunk of 1048584 bytes does not fit"));
  EXPECT_THAT(errorAfter([](auto& chunks) {
                chunks.push_back(chunk<double>(Chunk::POINTS, 4, 2, {}, 48));
              }),
              HasSubstr("POINTS: changes its shape"));
}

TEST(ArrayAssembler, RefusesArraysThatDoNotGoTogether) {
  EXPECT_THAT(errorAfter([](auto& chunks) { chunks.pop_back(); }),
              HasSubstr("CORNERS: is missing"));
  EXPECT_THAT(errorAfter([](auto& chunks) { chunks[0].mutable_data()->resize(88); }),
              HasSubstr("POSITIONS: ends after 88 of 96 bytes"));
  EXPECT_THAT(errorAfter([](auto& chunks) {
                chunks[3] = chunk<std::int32_t>(Chunk::CORNERS, 1, 3, {0, 1, 2});
              }),
              HasSubstr("CORNERS: has not as many rows"));
  EXPECT_THAT(errorAfter([](auto& chunks) {
                chunks[1] = chunk<std::int32_t>(Chunk::FACES, 2, 3, {0, 1, 2, 0, 2, 4});
              }),
              HasSubstr("FACES: names a vertex that is not there"));
  EXPECT_THAT(errorAfter([](auto& chunks) {
                chunks[1] = chunk<std::int32_t>(Chunk::FACES, 2, 3, {0, 1, 2, 0, 2, -1});
              }),
              HasSubstr("FACES: names a vertex that is not there"));
  EXPECT_THAT(errorAfter([](auto& chunks) {
                chunks[3] = chunk<std::int32_t>(Chunk::CORNERS, 2, 3, {0, 1, 3, -1, -1, -1});
              }),
              HasSubstr("CORNERS: names a point that is not there"));
  EXPECT_THAT(errorAfter([](auto& chunks) {
                chunks[3] = chunk<std::int32_t>(Chunk::CORNERS, 2, 3, {0, 1, 2, -1, 0, -1});
              }),
              HasSubstr("CORNERS: maps a face in part"));
  EXPECT_THAT(errorAfter([](auto& chunks) {
                const double nan = std::numeric_limits<double>::quiet_NaN();
                chunks[2] = chunk<double>(Chunk::POINTS, 3, 2, {0, 0, 1, 0, 1, nan});
              }),
              HasSubstr("POINTS: has a number that is not finite"));
}

/// The messages of a sound answer.
std::vector<v1::ParameterizeResponse> answer() {
  std::vector<v1::ParameterizeResponse> messages(1);
  messages[0].mutable_progress()->set_stage("layout");
  for (const Chunk& one : square()) *messages.emplace_back().mutable_array() = one;
  messages.emplace_back().mutable_parameterization()->mutable_certificate()->set_flips(3);
  return messages;
}

std::unique_ptr<Client> clientOf(const FakeServer& server, ClientOptions options = {}) {
  auto channel = connectTo({.server = server.address()});
  EXPECT_OK(channel);
  return std::make_unique<Client>(*channel, options);
}

TEST(ClientParameterize, GivesTheArraysAndTheResult) {
  const FakeServer server({.parameterization = answer()});
  std::vector<std::string> stages;
  const auto client = clientOf(server, {.progress = [&](const v1::Progress& progress) {
                                 stages.push_back(progress.stage());
                               }});
  const auto mesh = client->parameterize({});
  ASSERT_OK(mesh);
  EXPECT_EQ(mesh->positions.size(), 12U);
  EXPECT_THAT(mesh->corners, ElementsAre(0, 1, 2, -1, -1, -1));
  EXPECT_EQ(mesh->result.certificate().flips(), 3);
  EXPECT_THAT(stages, ElementsAre("layout"));
}

TEST(ClientParameterize, ACallThatBreaksStartsAnew) {
  const FakeServer server({.parameterization = answer(), .break_parameterize_after = 3});
  const auto mesh = clientOf(server)->parameterize({});
  ASSERT_OK(mesh);
  EXPECT_EQ(server.record().parameterize_calls, 2);
  EXPECT_EQ(mesh->faces.size(), 6U) << "nothing of the first call is kept";
}

TEST(ClientParameterize, ABrokenAnswerIsAnErrorAndNotTriedAgain) {
  std::vector<v1::ParameterizeResponse> messages = answer();
  messages[2].mutable_array()->set_offset(7);
  const FakeServer server({.parameterization = messages});
  const auto mesh = clientOf(server)->parameterize({});
  EXPECT_THAT(mesh, FailsWith(Reason::kInternal));
  EXPECT_THAT(mesh.status().message(), HasSubstr("array FACES"));
  EXPECT_EQ(server.record().parameterize_calls, 1);
}

TEST(ClientParameterize, AnAnswerWithoutAResultOrWithMoreIsNone) {
  std::vector<v1::ParameterizeResponse> messages = answer();
  messages.push_back(messages.back());
  EXPECT_THAT(clientOf(FakeServer({.parameterization = messages}))->parameterize({}),
              FailsWith(Reason::kInternal));
  messages.resize(messages.size() - 2);
  EXPECT_THAT(clientOf(FakeServer({.parameterization = messages}))->parameterize({}),
              FailsWith(Reason::kInternal));
  messages = answer();
  messages.erase(messages.begin() + 1);
  EXPECT_THAT(clientOf(FakeServer({.parameterization = messages}))->parameterize({}),
              FailsWith(Reason::kInternal));
}

class ParameterizeRemote : public CliTest {};

TEST_F(ParameterizeRemote, ABrokenAnswerLeavesNoFile) {
  std::vector<v1::ParameterizeResponse> messages = answer();
  messages.erase(messages.begin() + 1);
  const FakeServer server({.parameterization = messages});
  write("a.off", icosahedronOff());
  const ProcessResult result =
      run({"parameterize", "a.off", "--to", "flat", "-o", "out.obj", "--server", server.address()});
  EXPECT_THAT(result, FailsWithOneLine());
  EXPECT_FALSE(exists("out.obj"));
}

TEST_F(ParameterizeRemote, WhatTheServerSentIsWhatIsWritten) {
  const FakeServer server({.parameterization = answer()});
  write("a.off", icosahedronOff());
  EXPECT_THAT(run({"parameterize", "a.off", "--to", "flat", "-o", "out.obj", "--quiet", "--server",
                   server.address()}),
              Succeeds());
  EXPECT_EQ(read("out.obj"),
            "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\n"
            "f 1/1 2/2 3/3\nf 1 3 4\n");
}

TEST_F(ParameterizeRemote, CtrlCLeavesNoFile) {
  const FakeServer hanging({.hang = true});
  write("a.off", icosahedronOff());
  write("made/keep", "");
  const auto running = start({"parameterize", "a.off", "--to", "flat", "-o", "made/out.obj",
                              "--server", hanging.address()});
  ASSERT_TRUE(eventually([&] { return hanging.record().parameterize_calls == 1; }));
  running->signal(SIGINT);
  const ProcessResult result = running->wait(std::chrono::seconds(10));
  EXPECT_THAT(result, FailsWithOneLine());
  EXPECT_THAT(result.err, HasSubstr("interrupted (CANCELLED)"));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(path("made")), {}), 1);
}

}  // namespace
}  // namespace moduli
