#include "server/store/upload_store.h"

#include <atomic>
#include <thread>
#include <vector>

#include "tests/server/store/store_testing.h"

namespace moduli {
namespace {

using testing::HasSubstr;

constexpr Timestamp kFarFuture{std::chrono::hours(24 * 365 * 100)};

class UploadStoreTest : public testing::Test {
 protected:
  void SetUp() override { reopen(); }

  void reopen(std::int64_t max_bytes = 1 << 20) {
    uploads_.reset();
    meshes_.reset();
    auto meshes = MeshStore::open({folder_.path() / "meshes", {}});
    ASSERT_OK(meshes);
    meshes_ = *std::move(meshes);
    auto uploads = UploadStore::open({folder_.path() / "uploads", max_bytes}, *meshes_);
    ASSERT_OK(uploads);
    uploads_ = *std::move(uploads);
  }

  UploadState state(const std::string& digest) {
    const auto state = uploads_->query(digest);
    EXPECT_OK(state);
    return state.ok() ? *state : UploadState{-1, false};
  }

  TemporaryFolder folder_;
  std::unique_ptr<MeshStore> meshes_;
  std::unique_ptr<UploadStore> uploads_;
};

TEST_F(UploadStoreTest, PiecesBecomeAMeshUnderItsDigest) {
  const std::string bytes = randomBytes(300'000, 1);
  const std::string digest = sha256Hex(bytes);
  EXPECT_EQ(state(digest).committed_size, 0);
  for (std::size_t at = 0; at < bytes.size(); at += 70'000) {
    const auto after = uploads_->append(digest, static_cast<std::int64_t>(at),
                                        std::string_view(bytes).substr(at, 70'000));
    ASSERT_OK(after);
    EXPECT_FALSE(after->complete);
  }
  EXPECT_FALSE(meshes_->contains(digest));
  const auto pin = uploads_->finish(digest, std::ssize(bytes));
  ASSERT_OK(pin);
  EXPECT_EQ(pin->digest(), digest);
  EXPECT_TRUE(*meshes_->read(digest) == bytes);
  EXPECT_TRUE(state(digest).complete);
  EXPECT_EQ(state(digest).committed_size, std::ssize(bytes));
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path() / "uploads"));
}

TEST_F(UploadStoreTest, AnUploadGoesOnAfterARestart) {
  const std::string bytes = randomBytes(100'000, 2);
  const std::string digest = sha256Hex(bytes);
  ASSERT_OK(uploads_->append(digest, 0, std::string_view(bytes).substr(0, 60'000)));
  reopen();
  EXPECT_EQ(state(digest).committed_size, 60'000);
  ASSERT_OK(uploads_->append(digest, 60'000, std::string_view(bytes).substr(60'000)));
  ASSERT_OK(uploads_->finish(digest, 100'000));
  EXPECT_TRUE(*meshes_->read(digest) == bytes);
}

TEST_F(UploadStoreTest, AWrongOffsetChangesNothingAndNamesTheRightOne) {
  const std::string digest = sha256Hex("abcdef");
  ASSERT_OK(uploads_->append(digest, 0, "abc"));
  for (const std::int64_t offset : {0, 2, 4, 1000, -1}) {
    const auto result = uploads_->append(digest, offset, "xyz");
    EXPECT_THAT(result, FailsWith(Reason::kUploadOffsetMismatch));
    EXPECT_THAT(result.status().message(), HasSubstr("committed size is 3"));
  }
  EXPECT_THAT(uploads_->finish(digest, 6), FailsWith(Reason::kUploadOffsetMismatch));
  ASSERT_OK(uploads_->append(digest, 3, "def"));
  ASSERT_OK(uploads_->finish(digest, 6));
}

TEST_F(UploadStoreTest, AWrongDigestDropsTheBytes) {
  const std::string digest = sha256Hex("abcdef");
  ASSERT_OK(uploads_->append(digest, 0, "abcdeX"));
  EXPECT_THAT(uploads_->finish(digest, 6), FailsWith(Reason::kUploadDigestMismatch));
  EXPECT_EQ(state(digest).committed_size, 0);
  EXPECT_FALSE(meshes_->contains(digest));
  ASSERT_OK(uploads_->append(digest, 0, "abcdef"));
  ASSERT_OK(uploads_->finish(digest, 6));
}

TEST_F(UploadStoreTest, WhatIsThereAlreadyIsAnsweredAtOnce) {
  const std::string digest = meshes_->put("abcdef")->digest();
  const auto after = uploads_->append(digest, 0, "abc");
  ASSERT_OK(after);
  EXPECT_TRUE(after->complete);
  EXPECT_EQ(after->committed_size, 6);
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path() / "uploads"));
  ASSERT_OK(uploads_->finish(digest, 6));
  EXPECT_THAT(uploads_->finish(digest, 7), FailsWith(Reason::kUploadOffsetMismatch));
}

TEST_F(UploadStoreTest, TheEmptyFileCanBeUploaded) {
  const std::string digest = sha256Hex("");
  ASSERT_OK(uploads_->append(digest, 0, ""));
  ASSERT_OK(uploads_->finish(digest, 0));
  EXPECT_EQ(*meshes_->read(digest), "");
}

TEST_F(UploadStoreTest, LimitsAndNamesAreChecked) {
  reopen(10);
  const std::string digest = sha256Hex("0123456789a");
  ASSERT_OK(uploads_->append(digest, 0, "01234567"));
  EXPECT_THAT(uploads_->append(digest, 8, "89a"), FailsWith(Reason::kMeshTooLarge));
  EXPECT_EQ(state(digest).committed_size, 8);
  ASSERT_OK(uploads_->append(digest, 8, "89"));
  EXPECT_THAT(uploads_->query("../x"), FailsWith(Reason::kInvalidRequest));
  EXPECT_THAT(uploads_->append("../x", 0, "a"), FailsWith(Reason::kInvalidRequest));
  EXPECT_THAT(uploads_->finish("", 0), FailsWith(Reason::kInvalidRequest));
}

TEST_F(UploadStoreTest, UnfinishedUploadsExpire) {
  const std::string digest = sha256Hex("abcdef");
  ASSERT_OK(uploads_->append(digest, 0, "abc"));
  EXPECT_EQ(*uploads_->expire(Timestamp{}), 0U);
  EXPECT_EQ(state(digest).committed_size, 3);
  EXPECT_EQ(*uploads_->expire(kFarFuture), 1U);
  EXPECT_EQ(state(digest).committed_size, 0);
  ASSERT_OK(uploads_->append(digest, 0, "abcdef"));
  ASSERT_OK(uploads_->finish(digest, 6));
}

// Each sender does what the protocol says: on a mismatch ask, and go on from there. One of them
// lies about the bytes now and then.
TEST_F(UploadStoreTest, ManySendersOfOneFileDoNoHarm) {
  const std::string bytes = randomBytes(40'000, 4);
  const std::string digest = sha256Hex(bytes);
  std::atomic<int> restarts = 0;
  const auto send = [&](bool liar) {
    for (int tries = 0; tries < 10'000; ++tries) {
      const auto now = uploads_->query(digest);
      ASSERT_OK(now);
      if (now->complete) return;
      const auto at = static_cast<std::size_t>(now->committed_size);
      std::string piece = bytes.substr(std::min(at, bytes.size()), 3'000);
      if (liar && tries == 1 && !piece.empty()) piece[0] = static_cast<char>(piece[0] + 1);
      const auto after = uploads_->append(digest, now->committed_size, piece);
      if (after.ok() && (after->complete || after->committed_size < std::ssize(bytes))) continue;
      const auto pin = uploads_->finish(digest, std::ssize(bytes));
      if (pin.ok()) return;
      if (pin.status().reason() == Reason::kUploadDigestMismatch) ++restarts;
    }
    FAIL() << "the upload never ends";
  };
  std::vector<std::thread> senders;
  for (int t = 0; t < 4; ++t) senders.emplace_back(send, t == 0);
  for (std::thread& sender : senders) sender.join();
  EXPECT_TRUE(*meshes_->read(digest) == bytes);
  EXPECT_LE(restarts, 1);
}

TEST_F(UploadStoreTest, DifferentFilesArriveSideBySide) {
  std::vector<std::thread> senders;
  for (unsigned t = 0; t < 4; ++t) {
    senders.emplace_back([&, t] {
      const std::string bytes = randomBytes(20'000, 10 + t);
      const std::string digest = sha256Hex(bytes);
      for (std::size_t at = 0; at < bytes.size(); at += 1'000) {
        ASSERT_OK(uploads_->append(digest, static_cast<std::int64_t>(at),
                                   std::string_view(bytes).substr(at, 1'000)));
      }
      ASSERT_OK(uploads_->finish(digest, std::ssize(bytes)));
      EXPECT_TRUE(*meshes_->read(digest) == bytes);
    });
  }
  for (std::thread& sender : senders) sender.join();
}

}  // namespace
}  // namespace moduli
