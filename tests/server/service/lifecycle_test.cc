#include <grpcpp/generic/generic_stub.h>

#include <future>
#include <thread>

#include "tests/server/service/fixture.h"

namespace moduli {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

using LifecycleTest = ServiceTest;

TEST_F(LifecycleTest, TwoServersDoNotShareAPort) {
  ServerOptions second;
  second.listen = server_->address();
  EXPECT_THAT(Server::start(second), FailsWith(Reason::kPortTaken));
  EXPECT_OK(peer_->createCollection("still-there"));
}

TEST_F(LifecycleTest, TwoServersDoNotShareAStore) {
  EXPECT_THAT(Server::start(options_), FailsWith(Reason::kStoreLocked));
}

TEST_F(LifecycleTest, WrongOptionsAreRefusedByName) {
  const auto refused = [](const std::function<void(ServerOptions&)>& spoil) {
    ServerOptions options;
    options.listen = "127.0.0.1:0";
    spoil(options);
    return Server::start(options).status();
  };
  EXPECT_THAT(refused([](ServerOptions& o) { o.listen = "nonsense"; }),
              FailsWith(Reason::kInvalidConfiguration));
  EXPECT_THAT(refused([](ServerOptions& o) { o.listen = "0.0.0.0:0"; }),
              FailsWith(Reason::kInvalidConfiguration));
  EXPECT_OK(refused([](ServerOptions& o) {
    o.listen = "0.0.0.0:0";
    o.insecure = true;
  }));
  EXPECT_THAT(refused([](ServerOptions& o) { o.tls_certificate_file = "/nowhere.pem"; }),
              FailsWith(Reason::kInvalidConfiguration));
  EXPECT_THAT(refused([](ServerOptions& o) { o.token_file = "/nowhere"; }),
              FailsWith(Reason::kInvalidConfiguration));
  const TemporaryFolder folder;
  const std::string junk = folder.file("junk.pem", "junk");
  EXPECT_THAT(refused([&](ServerOptions& o) {
                o.tls_certificate_file = junk;
                o.tls_key_file = junk;
              }),
              FailsWith(Reason::kInvalidConfiguration));
}

TEST_F(LifecycleTest, TheInProcessChannelReachesTheSameServices) {
  Peer inside(server_->inProcessChannel());
  ASSERT_OK(inside.ingest(ingestHeader("c"), {ingestItemOf(0, "s", smallMesh(1))}));
  EXPECT_OK(peer_->getShape("collections/c/shapes/s"));
}

TEST_F(LifecycleTest, AServerWithoutAListenerServesItsOwnProcess) {
  ServerOptions options;
  options.listen.clear();
  auto server = Server::start(options);
  ASSERT_OK(server);
  EXPECT_EQ((*server)->address(), "");
  Peer inside((*server)->inProcessChannel());
  EXPECT_OK(inside.sign(inlineSource(smallMesh(1))));
  const auto digest = inside.upload(largeMesh());
  ASSERT_OK(digest);
  // The deadline holds inside a process as well.
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + milliseconds(200));
  v1::ComputeSignatureRequest request;
  *request.mutable_source() = digestSource(*digest);
  EXPECT_THAT(lastEvent(*inside.geometry().ComputeSignature(&context, request)),
              FailsWith(Reason::kDeadlineExceeded));
}

TEST_F(LifecycleTest, ReflectionNamesTheServices) {
  // The request {list_services: ""} and an answer that holds the names.
  const std::string bytes("\x3a\x00", 2);
  const grpc::Slice slice(bytes);
  grpc::ByteBuffer request(&slice, 1), response;
  grpc::ClientContext context;
  grpc::CompletionQueue queue;
  grpc::GenericStub stub(peer_->channel());
  const auto call = stub.PrepareCall(
      &context, "/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo", &queue);
  void* tag = nullptr;
  bool ok = false;
  call->StartCall(nullptr);
  ASSERT_TRUE(queue.Next(&tag, &ok) && ok);
  call->Write(request, nullptr);
  ASSERT_TRUE(queue.Next(&tag, &ok) && ok);
  call->Read(&response, nullptr);
  ASSERT_TRUE(queue.Next(&tag, &ok) && ok);
  grpc::Slice answer;
  ASSERT_TRUE(response.DumpToSingleSlice(&answer).ok());
  const std::string text(reinterpret_cast<const char*>(answer.begin()), answer.size());
  EXPECT_NE(text.find("moduli.v1.GeometryService"), std::string::npos);
  EXPECT_NE(text.find("moduli.v1.OptimizeService"), std::string::npos);
  EXPECT_NE(text.find("moduli.v1.CatalogService"), std::string::npos);
  EXPECT_NE(text.find("grpc.health.v1.Health"), std::string::npos);
  context.TryCancel();
  grpc::Status status;
  call->Finish(&status, nullptr);
  queue.Next(&tag, &ok);
}

TEST_F(LifecycleTest, AnUnknownCallSaysThatTheServerIsTooOld) {
  grpc::ClientContext context;
  const grpc::Slice nothing;
  grpc::ByteBuffer request(&nothing, 1), response;
  std::promise<grpc::Status> done;
  grpc::GenericStub(peer_->channel())
      .UnaryCall(&context, "/moduli.v1.GeometryService/Levitate", {}, &request, &response,
                 [&](grpc::Status status) { done.set_value(status); });
  EXPECT_THAT(fromGrpcStatus(done.get_future().get()), FailsWith(Reason::kServerTooOld));
}

TEST_F(LifecycleTest, AServerThatIsGoneCannotBeReached) {
  server_->drain();
  EXPECT_THAT(peer_->createCollection("c"), FailsWith(Reason::kServerUnreachable));
}

class DrainTest : public ServiceTest {
 protected:
  void SetUp() override {
    ServiceTest::SetUp();
    const auto digest = peer_->upload(largeMesh());
    ASSERT_OK(digest);
    v1::ComputeSignatureRequest request;
    *request.mutable_source() = digestSource(*digest);
    request.set_space(v1::Signature::CONFORMAL);
    reader_ = peer_->geometry().ComputeSignature(&context_, request);
    v1::ComputeSignatureResponse event;
    while (reader_->Read(&event) && event.progress().stage() == "queued") {
    }
  }

  grpc::ClientContext context_;
  std::unique_ptr<grpc::ClientReader<v1::ComputeSignatureResponse>> reader_;
};

TEST_F(DrainTest, RunningWorkIsFinishedAndNewWorkRefused) {
  std::thread drainer([&] { server_->drain(); });
  EXPECT_TRUE(eventually([&] {
    const auto healthy = peer_->healthy("", std::chrono::seconds(1));
    return healthy.ok() && !*healthy;
  })) << "health says NOT_SERVING while calls are under way";
  EXPECT_TRUE(eventually(
      [&] { return peer_->createCollection("c").status().reason() == Reason::kServerDraining; }));
  EXPECT_OK(lastEvent(*reader_));
  drainer.join();
}

TEST_F(DrainTest, ASecondSignalCancelsWhatRuns) {
  std::thread drainer([&] { server_->drain(); });
  eventually(
      [&] { return peer_->createCollection("c").status().reason() == Reason::kServerDraining; });
  server_->cancelAll();
  EXPECT_THAT(lastEvent(*reader_), FailsWith(Reason::kServerDraining));
  drainer.join();
}

class ImpatientDrainTest : public DrainTest {
  void configure(ServerOptions& options) override {
    options.drain_timeout = std::chrono::seconds(0);
  }
};

TEST_F(ImpatientDrainTest, WorkBeyondTheDrainTimeoutIsCancelled) {
  std::thread drainer([&] { server_->drain(); });
  EXPECT_THAT(lastEvent(*reader_), FailsWith(Reason::kServerDraining));
  drainer.join();
}

TEST_F(LifecycleTest, AnIngestUnderWayIsAnsweredUpToTheDrain) {
  grpc::ClientContext context;
  const auto stream = peer_->catalog().IngestShapes(&context);
  v1::IngestShapesRequest request;
  *request.mutable_header() = ingestHeader("c");
  ASSERT_TRUE(stream->Write(request));
  *request.mutable_item() = ingestItemOf(0, "s", smallMesh(0));
  ASSERT_TRUE(stream->Write(request));
  v1::IngestShapesResponse outcome;
  ASSERT_TRUE(stream->Read(&outcome));
  EXPECT_EQ(outcome.outcome(), v1::IngestShapesResponse::ADDED);
  // The stream stays open, and yet the server ends well before its 30 s of patience.
  const auto begin = Clock::now();
  server_->drain();
  EXPECT_LT(Clock::now() - begin, std::chrono::seconds(10));
  EXPECT_FALSE(stream->Read(&outcome));
  EXPECT_THAT(fromGrpcStatus(stream->Finish()), FailsWith(Reason::kServerDraining));
  restart();
  EXPECT_EQ(peer_->listShapes("c")->size(), 1U);
}

class TokenTest : public ServiceTest {
 protected:
  void configure(ServerOptions& options) override {
    options.token_file = folder_.file("tokens", sha256Hex("r") + " reader\n" + sha256Hex("w") +
                                                    " writer\n" + sha256Hex("a") + " admin\n");
  }

  template <typename Call>
  Status as(const std::string& token, Call call) {
    grpc::ClientContext context;
    if (!token.empty()) context.AddMetadata("authorization", "Bearer " + token);
    return fromGrpcStatus(call(context));
  }
};

TEST_F(TokenTest, EveryCallAsksForItsRole) {
  const auto info = [&](grpc::ClientContext& context) {
    v1::ServerInfo response;
    return peer_->geometry().GetServerInfo(&context, {}, &response);
  };
  const auto create = [&](grpc::ClientContext& context) {
    v1::CreateCollectionRequest request;
    request.set_collection_id("c");
    v1::Collection response;
    return peer_->catalog().CreateCollection(&context, request, &response);
  };
  const auto remove = [&](grpc::ClientContext& context) {
    v1::DeleteCollectionRequest request;
    request.set_name("collections/c");
    v1::DeleteCollectionResponse response;
    return peer_->catalog().DeleteCollection(&context, request, &response);
  };
  const auto inspect = [&](grpc::ClientContext& context) {
    v1::InspectMeshRequest request;
    *request.mutable_source() = inlineSource(smallMesh(0));
    const auto reader = peer_->geometry().InspectMesh(&context, request);
    v1::InspectMeshResponse event;
    while (reader->Read(&event)) {
    }
    return reader->Finish();
  };
  const auto upload = [&](grpc::ClientContext& context) {
    v1::UploadMeshResponse response;
    const auto writer = peer_->geometry().UploadMesh(&context, &response);
    writer->WritesDone();
    return writer->Finish();
  };
  const auto ingest = [&](grpc::ClientContext& context) {
    const auto stream = peer_->catalog().IngestShapes(&context);
    stream->WritesDone();
    return stream->Finish();
  };
  for (const char* token : {"", "stranger"}) {
    EXPECT_THAT(as(token, info), FailsWith(Reason::kUnauthenticated));
    EXPECT_THAT(as(token, create), FailsWith(Reason::kUnauthenticated));
    EXPECT_THAT(as(token, inspect), FailsWith(Reason::kUnauthenticated));
    EXPECT_THAT(as(token, upload), FailsWith(Reason::kUnauthenticated));
    EXPECT_THAT(as(token, ingest), FailsWith(Reason::kUnauthenticated));
  }
  EXPECT_OK(as("r", info));
  EXPECT_OK(as("r", inspect));
  EXPECT_THAT(as("r", create), FailsWith(Reason::kPermissionDenied));
  EXPECT_THAT(as("r", ingest), FailsWith(Reason::kPermissionDenied));
  EXPECT_OK(as("w", create));
  EXPECT_THAT(as("w", remove), FailsWith(Reason::kPermissionDenied));
  EXPECT_OK(as("a", remove));
  // Health is for load balancers, which have no tokens.
  EXPECT_OK(peer_->healthy("", std::chrono::seconds(1)));
}

}  // namespace
}  // namespace moduli
