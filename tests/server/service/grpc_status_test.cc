#include "server/rpc/grpc_status.h"

#include "core/base/text.h"
#include "moduli/v1/error.pb.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

TEST(GrpcStatus, EveryReasonTravelsThereAndBack) {
  for (int i = 1; i <= static_cast<int>(Reason::kInternal); ++i) {
    const Status status(static_cast<Reason>(i), "what is wrong", "what to do");
    const grpc::Status sent = toGrpcStatus(status);
    EXPECT_EQ(static_cast<int>(sent.error_code()), static_cast<int>(status.code()));
    const Status back = fromGrpcStatus(sent);
    EXPECT_EQ(back.reason(), status.reason());
    EXPECT_EQ(back.message(), status.message());
    EXPECT_EQ(back.hint(), status.hint());
  }
  EXPECT_TRUE(toGrpcStatus(Status()).ok());
  EXPECT_OK(fromGrpcStatus(grpc::Status::OK));
}

TEST(GrpcStatus, DetailsSayWhatTheStatusSays) {
  const grpc::Status sent = toGrpcStatus({Reason::kInvalidName, "bad name", ""}, "source.shape");
  v1::RpcStatus rpc;
  ASSERT_TRUE(rpc.ParseFromString(sent.error_details()));
  EXPECT_EQ(rpc.code(), sent.error_code());
  EXPECT_EQ(rpc.message(), sent.error_message());
  ASSERT_EQ(rpc.details_size(), 2);
  EXPECT_EQ(rpc.details(0).type_url(), "type.googleapis.com/google.rpc.ErrorInfo");
  EXPECT_EQ(rpc.details(1).type_url(), "type.googleapis.com/google.rpc.BadRequest");
  v1::ErrorInfo info;
  ASSERT_TRUE(info.ParseFromString(rpc.details(0).value()));
  EXPECT_EQ(info.reason(), "INVALID_NAME");
  EXPECT_EQ(info.domain(), "moduli");
  v1::BadRequest request;
  ASSERT_TRUE(request.ParseFromString(rpc.details(1).value()));
  ASSERT_EQ(request.field_violations_size(), 1);
  EXPECT_EQ(request.field_violations(0).field(), "source.shape");
  EXPECT_EQ(request.field_violations(0).description(), "bad name");
}

TEST(GrpcStatus, ExhaustionSaysWhenToRetry) {
  EXPECT_GT(retryDelay(toGrpcStatus({Reason::kQueueFull, "full"})).count(), 0);
  EXPECT_EQ(retryDelay(toGrpcStatus({Reason::kInvalidName, "bad"})).count(), 0);
}

TEST(GrpcStatus, FailuresOfGrpcItselfAreToldApart) {
  const auto reason = [](grpc::StatusCode code) {
    return fromGrpcStatus(grpc::Status(code, "from below")).reason();
  };
  EXPECT_EQ(reason(grpc::StatusCode::UNAVAILABLE), Reason::kServerUnreachable);
  EXPECT_EQ(reason(grpc::StatusCode::UNIMPLEMENTED), Reason::kServerTooOld);
  EXPECT_EQ(reason(grpc::StatusCode::RESOURCE_EXHAUSTED), Reason::kMessageTooLarge);
  EXPECT_EQ(reason(grpc::StatusCode::DEADLINE_EXCEEDED), Reason::kDeadlineExceeded);
  EXPECT_EQ(reason(grpc::StatusCode::CANCELLED), Reason::kCancelled);
  EXPECT_EQ(reason(grpc::StatusCode::UNKNOWN), Reason::kInternal);
  // The same codes with our details keep our reasons.
  EXPECT_EQ(fromGrpcStatus(toGrpcStatus({Reason::kServerDraining, "draining"})).reason(),
            Reason::kServerDraining);
}

TEST(GrpcStatus, AReasonOfANewerServerKeepsItsName) {
  v1::ErrorInfo info;
  info.set_reason("MOON_TOO_FULL");
  info.set_domain("moduli");
  v1::RpcStatus rpc;
  auto& any = *rpc.add_details();
  any.set_type_url("type.googleapis.com/google.rpc.ErrorInfo");
  any.set_value(info.SerializeAsString());
  const Status status = fromGrpcStatus(
      grpc::Status(grpc::StatusCode::FAILED_PRECONDITION, "it howls", rpc.SerializeAsString()));
  EXPECT_EQ(status.reason(), Reason::kInternal);
  EXPECT_EQ(status.message(), "MOON_TOO_FULL: it howls");
}

TEST(GrpcStatus, HostileWordsStayWithinTheTrailers) {
  std::string words(100'000, 'x');
  words[3] = '\xff';
  words[4] = '\n';
  const grpc::Status sent = toGrpcStatus({Reason::kSyntaxError, words, words});
  // gRPC percent-encodes the message and sends the details in base64, in 8 KiB altogether.
  EXPECT_LT(3 * sent.error_message().size() + sent.error_details().size() * 4 / 3, 8000U);
  EXPECT_TRUE(isPrintableUtf8(sent.error_message()));
  EXPECT_EQ(sent.error_message().substr(0, 6), "xxx??x");
}

TEST(GrpcStatus, CuttingNeverSplitsACharacter) {
  std::string words;
  for (int i = 0; i < 100; ++i) words += "é";
  for (std::size_t limit = 10; limit < 20; ++limit) {
    const std::string cut = printable(words, limit);
    EXPECT_LE(cut.size(), limit);
    EXPECT_TRUE(isPrintableUtf8(cut)) << limit;
    EXPECT_TRUE(cut.ends_with("..."));
  }
}

}  // namespace
}  // namespace moduli
