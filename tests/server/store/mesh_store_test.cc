#include "server/store/mesh_store.h"

#include <fcntl.h>
#include <sys/stat.h>

#include <atomic>
#include <fstream>
#include <thread>
#include <vector>

#include "tests/server/store/store_testing.h"

namespace moduli {
namespace {

namespace fs = std::filesystem;

constexpr Timestamp kFarFuture{std::chrono::hours(24 * 365 * 100)};

class MeshStoreTest : public testing::Test {
 protected:
  void SetUp() override { reopen(); }

  void reopen() {
    meshes_.reset();
    auto opened = MeshStore::open({folder_.path() / "meshes", {}});
    ASSERT_OK(opened);
    meshes_ = *std::move(opened);
  }

  fs::path fileOf(const std::string& digest) const {
    return folder_.path() / "meshes" / digest.substr(0, 2) / (digest.substr(2) + ".zst");
  }

  std::size_t filesIn(const fs::path& folder) const {
    std::size_t count = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      count += entry.is_regular_file() ? 1 : 0;
    }
    return count;
  }

  void overwrite(const fs::path& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary).write(bytes.data(), std::ssize(bytes));
  }

  std::string contentOf(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {(std::istreambuf_iterator<char>(file)), {}};
  }

  // Returns the number removed.
  std::size_t collect(Timestamp older_than, bool referenced) {
    const auto removed = meshes_->collectGarbage(
        older_than, [&](std::string_view) -> Result<bool> { return referenced; });
    EXPECT_OK(removed);
    return removed.ok() ? *removed : 0;
  }

  TemporaryFolder folder_;
  std::unique_ptr<MeshStore> meshes_;
};

TEST_F(MeshStoreTest, BytesComeBackAsTheyWerePut) {
  for (const std::size_t size : {0UL, 1UL, 1000UL, (1UL << 20) - 1, 1UL << 20, 3UL << 20}) {
    for (const std::string& bytes : {randomBytes(size, 1), std::string(size, 'v')}) {
      const auto pin = meshes_->put(bytes);
      ASSERT_OK(pin);
      EXPECT_EQ(pin->digest(), sha256Hex(bytes));
      EXPECT_EQ(pin->size(), static_cast<std::int64_t>(size));
      reopen();
      const auto back = meshes_->read(pin->digest());
      ASSERT_OK(back);
      EXPECT_TRUE(*back == bytes) << size;
      const auto reader = meshes_->openReader(pin->digest());
      ASSERT_OK(reader);
      EXPECT_EQ((*reader)->size(), static_cast<std::int64_t>(size));
      std::string pieces;
      for (;;) {
        const auto piece = (*reader)->next(100'000);
        ASSERT_OK(piece);
        if (piece->empty()) break;
        EXPECT_LE(piece->size(), 100'000U);
        pieces += *piece;
      }
      EXPECT_TRUE(pieces == bytes) << size;
    }
  }
  EXPECT_EQ(filesIn(folder_.path() / "meshes" / "tmp"), 0U);
}

TEST_F(MeshStoreTest, TheSameBytesAreStoredOnce) {
  ASSERT_OK(meshes_->put("mesh"));
  ASSERT_OK(meshes_->put("mesh"));
  EXPECT_EQ(filesIn(folder_.path()), 1U);
}

TEST_F(MeshStoreTest, MissingMeshesAreSaidToBeMissing) {
  const std::string digest = sha256Hex("nothing");
  EXPECT_FALSE(meshes_->contains(digest));
  EXPECT_THAT(meshes_->read(digest), FailsWith(Reason::kUploadNotFound));
  EXPECT_THAT(meshes_->pin(digest), FailsWith(Reason::kUploadNotFound));
  EXPECT_THAT(meshes_->read("../../etc/passwd"), FailsWith(Reason::kInvalidRequest));
  EXPECT_FALSE(meshes_->contains("../../etc/passwd"));
}

TEST_F(MeshStoreTest, WrongClaimsStoreNothing) {
  const std::string bytes = "some mesh";
  const auto source = [&](const std::string& text) {
    return [text, done = false](std::size_t) mutable -> Result<std::string> {
      return std::exchange(done, true) ? std::string() : text;
    };
  };
  const std::string digest = sha256Hex(bytes);
  const std::int64_t size = std::ssize(bytes);
  EXPECT_THAT(meshes_->put(digest, size, source("some mash")),
              FailsWith(Reason::kUploadDigestMismatch));
  EXPECT_THAT(meshes_->put(digest, size + 1, source(bytes)),
              FailsWith(Reason::kUploadDigestMismatch));
  EXPECT_THAT(meshes_->put(digest, size - 1, source(bytes)),
              FailsWith(Reason::kUploadDigestMismatch));
  EXPECT_EQ(filesIn(folder_.path()), 0U);
  ASSERT_OK(meshes_->put(digest, size, source(bytes)));
  EXPECT_EQ(filesIn(folder_.path()), 1U);
}

TEST_F(MeshStoreTest, EveryKindOfDamageIsNoticedAndMended) {
  const std::string bytes = randomBytes(300'000, 3) + std::string(300'000, 'x');
  const std::string digest = meshes_->put(bytes)->digest();
  const std::string good = contentOf(fileOf(digest));
  std::vector<std::string> damaged = {"", "garbage", good.substr(0, good.size() - 1),
                                      good.substr(0, good.size() / 2), randomBytes(5000, 4)};
  std::mt19937 random(6);
  for (int i = 0; i < 40; ++i) {
    std::string bent = good;
    const std::size_t at = i < 10 ? static_cast<std::size_t>(i) : random() % bent.size();
    bent[at] = static_cast<char>(bent[at] ^ (1 << random() % 8));
    damaged.push_back(bent);
  }
  // A sound frame of other bytes: only the SHA-256 can tell.
  const std::string other = meshes_->put("other bytes")->digest();
  damaged.push_back(contentOf(fileOf(other)));
  std::size_t noticed = 0;
  for (const std::string& content : damaged) {
    overwrite(fileOf(digest), content);
    const auto back = meshes_->read(digest);
    if (back.ok()) {
      EXPECT_TRUE(*back == bytes);  // A flag that does not matter.
      continue;
    }
    ++noticed;
    EXPECT_THAT(back, FailsWith(Reason::kStoreCorrupt));
    ASSERT_OK(meshes_->put(bytes));
    EXPECT_TRUE(meshes_->contains(digest));
    ASSERT_OK(meshes_->read(digest));
  }
  EXPECT_GE(noticed, damaged.size() - 2);
}

TEST_F(MeshStoreTest, AFileFoundDamagedCountsAsMissing) {
  const std::string digest = meshes_->put("mesh")->digest();
  overwrite(fileOf(digest), contentOf(fileOf(meshes_->put("other")->digest())));
  EXPECT_TRUE(meshes_->contains(digest));
  EXPECT_THAT(meshes_->read(digest), FailsWith(Reason::kStoreCorrupt));
  EXPECT_FALSE(meshes_->contains(digest));
  ASSERT_OK(meshes_->put("mesh"));
  EXPECT_TRUE(meshes_->contains(digest));
}

TEST_F(MeshStoreTest, GarbageIsWhatNobodyHasOrHolds) {
  const std::string digest = meshes_->put("mesh")->digest();
  EXPECT_EQ(collect(kFarFuture, true), 0U);    // A shape has it.
  EXPECT_EQ(collect(Timestamp{}, false), 0U);  // Too young.
  {
    auto second = meshes_->pin(digest);
    ASSERT_OK(second);
    const MeshPin moved = *std::move(second);
    EXPECT_EQ(collect(kFarFuture, false), 0U);  // Held.
  }
  EXPECT_EQ(collect(kFarFuture, false), 1U);
  EXPECT_FALSE(meshes_->contains(digest));
}

TEST_F(MeshStoreTest, APinLetsTheTimeToLiveStartAnew) {
  const std::string digest = meshes_->put("mesh")->digest();
  const timespec past[2] = {{1000, 0}, {1000, 0}};
  ASSERT_EQ(::utimensat(AT_FDCWD, fileOf(digest).c_str(), past, 0), 0);
  const Timestamp between{std::chrono::seconds(2000)};
  ASSERT_OK(meshes_->pin(digest));
  EXPECT_EQ(collect(between, false), 0U);
  ASSERT_EQ(::utimensat(AT_FDCWD, fileOf(digest).c_str(), past, 0), 0);
  ASSERT_OK(meshes_->put("mesh"));
  EXPECT_EQ(collect(between, false), 0U);
  ASSERT_EQ(::utimensat(AT_FDCWD, fileOf(digest).c_str(), past, 0), 0);
  EXPECT_EQ(collect(between, false), 1U);
}

TEST_F(MeshStoreTest, AReaderOutlivesTheFile) {
  const std::string bytes = randomBytes(2 << 20, 8);
  const std::string digest = meshes_->put(bytes)->digest();
  const auto reader = meshes_->openReader(digest);
  ASSERT_OK(reader);
  EXPECT_EQ(collect(kFarFuture, false), 1U);
  std::string back;
  for (;;) {
    const auto piece = (*reader)->next(1 << 20);
    ASSERT_OK(piece);
    if (piece->empty()) break;
    back += *piece;
  }
  EXPECT_TRUE(back == bytes);
}

// What a put in flight holds stays, though the collector never rests and no shape has it yet.
TEST_F(MeshStoreTest, CollectionNeverTakesAHeldFile) {
  std::atomic<bool> stop = false;
  std::thread collector([&] {
    while (!stop) collect(kFarFuture, false);
  });
  std::vector<std::thread> putters;
  for (unsigned t = 0; t < 3; ++t) {
    putters.emplace_back([&, t] {
      for (unsigned i = 0; i < 12; ++i) {
        const std::string bytes = "mesh " + std::to_string((t + i) % 4);  // Shared on purpose.
        const auto pin = meshes_->put(bytes);
        ASSERT_OK(pin);
        const auto back = meshes_->read(pin->digest());
        ASSERT_OK(back);
        EXPECT_EQ(*back, bytes);
      }
    });
  }
  for (std::thread& putter : putters) putter.join();
  stop = true;
  collector.join();
}

TEST_F(MeshStoreTest, LeftTemporaryFilesAreRemovedAtStart) {
  overwrite(folder_.path() / "meshes" / "tmp" / "left.0", "half a mesh");
  reopen();
  EXPECT_EQ(filesIn(folder_.path() / "meshes"), 0U);
}

}  // namespace
}  // namespace moduli
