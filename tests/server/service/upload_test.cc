#include <optional>

#include "tests/server/service/fixture.h"

namespace moduli {
namespace {

class UploadTest : public ServiceTest {
 protected:
  v1::QueryUploadResponse query(const std::string& digest) {
    grpc::ClientContext context;
    v1::QueryUploadRequest request;
    request.set_digest(digest);
    v1::QueryUploadResponse response;
    EXPECT_TRUE(peer_->geometry().QueryUpload(&context, request, &response).ok());
    return response;
  }

  /// Sends one stream of messages and returns how it ended.
  Status send(const std::vector<v1::UploadMeshRequest>& messages) {
    grpc::ClientContext context;
    v1::UploadMeshResponse response;
    const auto writer = peer_->geometry().UploadMesh(&context, &response);
    for (const auto& message : messages) {
      if (!writer->Write(message)) break;
    }
    writer->WritesDone();
    return fromGrpcStatus(writer->Finish());
  }

  static v1::UploadMeshRequest chunk(const std::string& bytes, std::size_t from, std::size_t to) {
    v1::UploadMeshRequest message;
    message.set_digest(sha256Hex(bytes));
    message.set_write_offset(static_cast<std::int64_t>(from));
    message.set_data(bytes.substr(from, to - from));
    if (to == bytes.size()) {
      message.set_finish_write(true);
      message.set_total_size(static_cast<std::int64_t>(bytes.size()));
    }
    return message;
  }

  const std::string bytes_ = sampleFile("ellipsoid", {{"resolution", 24}});
  const std::string digest_ = sha256Hex(bytes_);
};

TEST_F(UploadTest, AnUploadedFileIsThereUnderItsDigest) {
  EXPECT_EQ(query(digest_).committed_size(), 0);
  ASSERT_OK(peer_->upload(bytes_));
  EXPECT_TRUE(query(digest_).complete());
  EXPECT_EQ(query(digest_).committed_size(), static_cast<std::int64_t>(bytes_.size()));
}

TEST_F(UploadTest, TheEndOfTheStreamAloneCommitsNothing) {
  auto message = chunk(bytes_, 0, bytes_.size());
  message.set_finish_write(false);
  EXPECT_THAT(send({message}), FailsWith(Reason::kInvalidRequest));
  EXPECT_FALSE(query(digest_).complete());
  EXPECT_EQ(query(digest_).committed_size(), static_cast<std::int64_t>(bytes_.size()));
  EXPECT_THAT(peer_->sign(digestSource(digest_)), FailsWith(Reason::kUploadNotFound));
  // What is there need not be sent again.
  v1::UploadMeshRequest finish;
  finish.set_digest(digest_);
  finish.set_write_offset(static_cast<std::int64_t>(bytes_.size()));
  finish.set_finish_write(true);
  finish.set_total_size(static_cast<std::int64_t>(bytes_.size()));
  EXPECT_OK(send({finish}));
  EXPECT_TRUE(query(digest_).complete());
}

TEST_F(UploadTest, ABrokenStreamIsTakenUpWhereItBroke) {
  constexpr std::size_t kPart = 50'000;
  {
    grpc::ClientContext context;
    v1::UploadMeshResponse response;
    const auto writer = peer_->geometry().UploadMesh(&context, &response);
    ASSERT_TRUE(writer->Write(chunk(bytes_, 0, kPart)));
    ASSERT_TRUE(eventually([&] { return query(digest_).committed_size() == kPart; }));
    context.TryCancel();
    EXPECT_THAT(fromGrpcStatus(writer->Finish()), FailsWith(Reason::kCancelled));
  }
  EXPECT_THAT(send({chunk(bytes_, 0, kPart)}), FailsWith(Reason::kUploadOffsetMismatch));
  const auto there = static_cast<std::size_t>(query(digest_).committed_size());
  ASSERT_EQ(there, kPart);
  ASSERT_OK(send({chunk(bytes_, there, bytes_.size())}));
  EXPECT_OK(peer_->sign(digestSource(digest_)));
}

TEST_F(UploadTest, AnUploadGoesOnAfterARestart) {
  EXPECT_THAT(send({chunk(bytes_, 0, 50'000)}), FailsWith(Reason::kInvalidRequest));
  restart();
  ASSERT_EQ(query(digest_).committed_size(), 50'000);
  ASSERT_OK(send({chunk(bytes_, 50'000, bytes_.size())}));
  EXPECT_TRUE(query(digest_).complete());
}

TEST_F(UploadTest, AFileThatIsThereIsAnsweredFromTheFirstMessageOn) {
  ASSERT_OK(peer_->upload(bytes_));
  grpc::ClientContext context;
  v1::UploadMeshResponse response;
  const auto writer = peer_->geometry().UploadMesh(&context, &response);
  ASSERT_TRUE(writer->Write(chunk(bytes_, 0, 1000)));
  // Neither finished nor half-closed: the server answers by itself.
  ASSERT_OK(fromGrpcStatus(writer->Finish()));
  EXPECT_EQ(response.committed_size(), static_cast<std::int64_t>(bytes_.size()));
}

TEST_F(UploadTest, FalseClaimsCommitNothing) {
  auto other_bytes = chunk(bytes_, 0, bytes_.size());
  (*other_bytes.mutable_data())[100] ^= 1;
  EXPECT_THAT(send({other_bytes}), FailsWith(Reason::kUploadDigestMismatch));
  EXPECT_FALSE(query(digest_).complete());
  auto other_size = chunk(bytes_, 0, bytes_.size());
  other_size.set_total_size(5);
  EXPECT_THAT(send({other_size}), FailsWith(Reason::kUploadOffsetMismatch));
  EXPECT_FALSE(query(digest_).complete());
}

TEST_F(UploadTest, WrongMessagesAreRefused) {
  auto no_digest = chunk(bytes_, 0, 10);
  no_digest.set_digest("0123");
  EXPECT_THAT(send({no_digest}), FailsWith(Reason::kInvalidRequest));
  auto changed = chunk(bytes_, 10, 20);
  changed.set_digest(sha256Hex("other"));
  EXPECT_THAT(send({chunk(bytes_, 0, 10), changed}), FailsWith(Reason::kInvalidRequest));
  const std::string large(3 << 20, 'x');
  EXPECT_THAT(send({chunk(large, 0, 2 << 20)}), FailsWith(Reason::kMessageTooLarge));
  auto negative = chunk(bytes_, 0, 10);
  negative.set_write_offset(-1);
  EXPECT_THAT(send({negative}), FailsWith(Reason::kInvalidRequest));
}

TEST_F(UploadTest, AMessageThatGrpcRefusesCommitsNothing) {
  auto message = chunk(bytes_, 0, bytes_.size());
  message.mutable_data()->resize(9 << 20);
  EXPECT_THAT(send({message}), FailsWith(Reason::kMessageTooLarge));
  EXPECT_EQ(query(digest_).committed_size(), 0);
}

}  // namespace
}  // namespace moduli
