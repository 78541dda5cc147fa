#include "server/store/store.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <functional>
#include <map>
#include <random>
#include <thread>
#include <vector>

#include "server/store/file_system_kind.h"
#include "tests/server/store/store_testing.h"

namespace moduli {
namespace {

using testing::HasSubstr;

std::unique_ptr<Store> openStore(const std::filesystem::path& folder) {
  auto store = Store::open({.folder = folder});
  EXPECT_OK(store);
  return store.ok() ? *std::move(store) : nullptr;
}

// The mesh of shape number i: some compress, some do not.
std::string meshOf(int i) {
  return "mesh " + std::to_string(i) +
         (i % 2 == 0 ? randomBytes(3'000, i) : std::string(9'000, 'v'));
}

ShapeRecord shapeOf(int i, const MeshPin& pin) {
  ShapeRecord shape = sampleShape("c", "shape-" + std::to_string(i));
  shape.digest = pin.digest();
  shape.mesh_bytes = pin.size();
  return shape;
}

Status addShape(Store& store, int i, OnExists on_exists) {
  ASSIGN_OR_RETURN(const MeshPin pin, store.meshes().put(meshOf(i)));
  return store.catalog()->putShape(shapeOf(i, pin), on_exists).status();
}

// Runs `work` in a process of its own; returns its exit status as waitpid gives it.
int inChild(const std::function<int()>& work) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(work());
  int status = 0;
  ::waitpid(child, &status, 0);
  return status;
}

TEST(Store, ASecondProcessIsToldWhoHoldsTheFolder) {
  const TemporaryFolder folder(TemporaryFolder::Place::kDisk);
  const auto store = openStore(folder.path());
  const auto again = Store::open({.folder = folder.path()});
  EXPECT_THAT(again, FailsWith(Reason::kStoreLocked));
  const std::string holder = "process " + std::to_string(::getpid()) + " on ";
  EXPECT_THAT(again.status().message(), HasSubstr(holder));
  EXPECT_THAT(again.status().message(), HasSubstr(" since 2"));
  const int status = inChild([&] {
    const auto other = Store::open({.folder = folder.path()});
    const bool named = other.status().message().find(holder) != std::string::npos;
    return other.status().reason() == Reason::kStoreLocked && named ? 0 : 1;
  });
  EXPECT_EQ(status, 0);
}

TEST(Store, TheFolderIsFreeAgainWhenItsHolderIsGone) {
  const TemporaryFolder folder(TemporaryFolder::Place::kDisk);
  const int status = inChild([&] {
    const auto store = Store::open({.folder = folder.path()});
    if (store.ok()) std::raise(SIGKILL);
    return 1;
  });
  EXPECT_TRUE(WIFSIGNALED(status));
  EXPECT_NE(openStore(folder.path()), nullptr);
  EXPECT_NE(openStore(folder.path()), nullptr);  // And after a proper end.
}

TEST(Store, ATemporaryStoreTakesUploadsAndLeavesNothing) {
  std::filesystem::path folder;
  {
    const auto store = Store::openTemporary({});
    ASSERT_OK(store);
    EXPECT_EQ((*store)->catalog(), nullptr);
    const std::string digest = sha256Hex("mesh");
    ASSERT_OK((*store)->uploads().append(digest, 0, "mesh"));
    ASSERT_OK((*store)->uploads().finish(digest, 4));
    EXPECT_EQ(*(*store)->meshes().read(digest), "mesh");
    ASSERT_OK((*store)->collectGarbage());
    EXPECT_TRUE((*store)->meshes().contains(digest));
  }
}

TEST(Store, GarbageCollectionKeepsWhatShapesHave) {
  const TemporaryFolder folder(TemporaryFolder::Place::kDisk);
  auto opened = Store::open({.folder = folder.path(), .upload_ttl = std::chrono::seconds(-10)});
  ASSERT_OK(opened);
  Store& store = **opened;
  ASSERT_OK(store.catalog()->createCollection("c", ""));
  ASSERT_OK(addShape(store, 1, OnExists::kError));
  ASSERT_OK(store.meshes().put(meshOf(2)));
  ASSERT_OK(store.uploads().append(sha256Hex("x"), 0, "y"));
  ASSERT_OK(store.collectGarbage());
  EXPECT_TRUE(store.meshes().contains(sha256Hex(meshOf(1))));
  EXPECT_FALSE(store.meshes().contains(sha256Hex(meshOf(2))));
  EXPECT_EQ(store.uploads().query(sha256Hex("x"))->committed_size, 0);
  ASSERT_OK(store.catalog()->deleteShape("c", "shape-1"));
  ASSERT_OK(store.collectGarbage());
  EXPECT_FALSE(store.meshes().contains(sha256Hex(meshOf(1))));
}

TEST(Store, ADamagedDatabaseIsAClearErrorAndTheFolderIsFreeAgain) {
  const TemporaryFolder folder(TemporaryFolder::Place::kDisk);
  openStore(folder.path());
  const std::string file = (folder.path() / "catalog.sqlite").string();
  ASSERT_EQ(::truncate(file.c_str(), 5000), 0);
  const auto opened = Store::open({.folder = folder.path()});
  EXPECT_THAT(opened, FailsWith(Reason::kStoreCorrupt));
  EXPECT_THAT(opened.status().message(), HasSubstr("catalog.sqlite"));
  EXPECT_NE(opened.status().hint(), "");
  ASSERT_TRUE(std::filesystem::remove(file));
  EXPECT_NE(openStore(folder.path()), nullptr);
}

TEST(Store, AFolderThatCannotBeMadeIsAClearError) {
  const auto opened = Store::open({.folder = "/proc/no/such/place"});
  EXPECT_THAT(opened, FailsWith(Reason::kStoreFailure));
  EXPECT_THAT(opened.status().message(), HasSubstr("/proc"));
}

TEST(NetworkFileSystem, IsToldByItsMagicNumber) {
  EXPECT_EQ(networkFileSystemName(0x6969, ""), "nfs");
  EXPECT_EQ(networkFileSystemName(0xFF534D42, ""), "cifs");
  EXPECT_EQ(networkFileSystemName(0x01021997, ""), "9p");
  EXPECT_EQ(networkFileSystemName(0x0BD00BD0, ""), "lustre");
  EXPECT_EQ(networkFileSystemName(0x65735546, "fuse.sshfs"), "fuse.sshfs");
  EXPECT_EQ(networkFileSystemName(0x65735546, "fuse.ntfs-3g"), std::nullopt);
  for (const std::uint32_t local : {0xEF53U, 0x58465342U, 0x9123683EU, 0x01021994U, 0x794C7630U}) {
    EXPECT_EQ(networkFileSystemName(local, "ext4"), std::nullopt);
  }
  EXPECT_EQ(networkFileSystemAt("/proc"), std::nullopt);
}

// ---- What survives a killed process.

// Adds shapes from number `first` on until killed; writes each number to `acknowledge` once it is
// stored. Every third shape is then replaced, every fifth removed and added again.
int addForEver(const std::filesystem::path& folder, int acknowledge, int first) {
  auto opened = Store::open({.folder = folder});
  if (!opened.ok()) return 1;
  Store& store = **opened;
  const auto created = store.catalog()->createCollection("c", "");
  if (!created.ok() && created.status().reason() != Reason::kCollectionExists) return 2;
  for (int i = first;; ++i) {
    if (!addShape(store, i, OnExists::kError).ok()) return 3;
    if (::write(acknowledge, &i, sizeof i) != sizeof i) return 4;
    if (i % 3 == 0 && !addShape(store, i, OnExists::kReplace).ok()) return 5;
    if (i % 5 == 0) {
      // Half an upload, too: it must neither be lost nor taken for whole.
      const std::string digest = sha256Hex("whole " + std::to_string(i));
      if (!store.uploads().append(digest, 0, "whole").ok()) return 6;
    }
  }
}

// Starts addForEver, lets it acknowledge `count` shapes and go on for a random while, kills it, and
// returns what it acknowledged until then.
std::vector<int> addUntilKilled(const std::filesystem::path& folder, int first, std::size_t count,
                                std::chrono::microseconds while_after) {
  int ends[2] = {};
  EXPECT_EQ(::pipe(ends), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    ::close(ends[0]);
    ::_exit(addForEver(folder, ends[1], first));
  }
  ::close(ends[1]);
  std::vector<int> acknowledged;
  bool killed = false;
  for (int number = 0;;) {
    if (!killed && acknowledged.size() == count) {
      std::this_thread::sleep_for(while_after);  // Only to die anywhere; nothing is waited for.
      ::kill(child, SIGKILL);
      killed = true;
    }
    if (::read(ends[0], &number, sizeof number) != sizeof number) break;
    acknowledged.push_back(number);
  }
  ::close(ends[0]);
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_TRUE(WIFSIGNALED(status)) << "ended by itself with " << status;
  return acknowledged;
}

// Every shape that is there is whole; returns their number.
int checkWholeness(Store& store) {
  Context context;
  std::vector<std::string> names;
  EXPECT_OK(store.catalog()->scanShapes(context, "c", Filter(), [&](const ShapeRecord& shape) {
    names.push_back(shape.name);
    return true;
  }));
  std::map<std::int64_t, int> vectors;
  EXPECT_OK(store.catalog()->forEachVector(context, [&](const VectorRow& row) {
    ++vectors[row.shape_id];
    return Status();
  }));
  EXPECT_EQ(vectors.size(), names.size());
  for (const std::string& name : names) {
    const int i = std::stoi(name.substr(6));
    const auto shape = store.catalog()->getShape("c", name, ShapeView::kFull);
    EXPECT_OK(shape);
    if (!shape.ok()) continue;
    EXPECT_EQ(shape->signature, sampleShape("c", name).signature);
    EXPECT_EQ(shape->tags.size(), 2U);
    EXPECT_EQ(vectors[shape->id], 3);
    const auto mesh = store.meshes().read(shape->digest);
    EXPECT_OK(mesh) << name;
    EXPECT_TRUE(mesh.ok() && *mesh == meshOf(i)) << name;
  }
  EXPECT_EQ(store.catalog()->getCollection("c")->shape_count, std::ssize(names));
  return static_cast<int>(names.size());
}

TEST(KilledProcess, LosesNoAcknowledgedShapeAndLeavesNoHalfOne) {
  const TemporaryFolder folder(TemporaryFolder::Place::kDisk);
  ASSERT_OK(openStore(folder.path())->catalog()->createCollection("c", ""));
  std::mt19937 random(7);
  std::vector<int> acknowledged;
  int next = 0;
  for (int round = 0; round < 12; ++round) {
    const std::size_t count = random() % 6;
    const std::chrono::microseconds while_after(random() % (count == 0 ? 150'000 : 30'000));
    const std::vector<int> more = addUntilKilled(folder.path(), next, count, while_after);
    ASSERT_GE(more.size(), count);
    acknowledged.insert(acknowledged.end(), more.begin(), more.end());
    const auto store = openStore(folder.path());
    ASSERT_NE(store, nullptr);
    checkWholeness(*store);
    for (const int i : acknowledged) {
      ASSERT_OK(store->catalog()->getShape("c", "shape-" + std::to_string(i), ShapeView::kFull));
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder.path() / "meshes" / "tmp"));
    // One shape at most can have been stored but not yet acknowledged.
    const std::int64_t stored = store->catalog()->getCollection("c")->shape_count;
    EXPECT_GE(stored, std::ssize(acknowledged));
    EXPECT_LE(stored, std::ssize(acknowledged) + round + 1);
    next = 1000 * (round + 1);
  }
  EXPECT_GT(acknowledged.size(), 12U);
  std::printf("%zu acknowledged shapes over 12 kills\n", acknowledged.size());
}

TEST(KilledProcess, AtAnyStepOfAMeshWriteLeavesAllOrNothing) {
  const std::string bytes = meshOf(4);
  const std::string digest = sha256Hex(bytes);
  for (const char* step : {"create", "write", "sync", "rename", "sync-folder", "never"}) {
    const TemporaryFolder folder(TemporaryFolder::Place::kDisk);
    const int status = inChild([&] {
      auto meshes = MeshStore::open({folder.path(), [&](std::string_view at) {
                                       if (at == step) std::raise(SIGKILL);
                                     }});
      return meshes.ok() && (*meshes)->put(bytes).ok() ? 0 : 1;
    });
    EXPECT_EQ(WIFSIGNALED(status), std::string_view(step) != "never") << step << status;
    const auto meshes = MeshStore::open({folder.path(), {}});
    ASSERT_OK(meshes);
    const bool renamed =
        std::string_view(step) == "sync-folder" || std::string_view(step) == "never";
    EXPECT_EQ((*meshes)->contains(digest), renamed) << step;
    EXPECT_TRUE(std::filesystem::is_empty(folder.path() / "tmp")) << step;
    ASSERT_OK((*meshes)->put(bytes));
    EXPECT_TRUE(*(*meshes)->read(digest) == bytes) << step;
  }
}

// ---- What a full disk does.

// No file may grow beyond `bytes` while the object lives; writes past that fail with EFBIG.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    std::signal(SIGXFSZ, SIG_IGN);
    ::getrlimit(RLIMIT_FSIZE, &before_);
    rlimit limit = before_;
    limit.rlim_cur = bytes;
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() { ::setrlimit(RLIMIT_FSIZE, &before_); }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit before_ = {};
};

TEST(FullDisk, FailsWritesAndSpoilsNothing) {
  const TemporaryFolder folder(TemporaryFolder::Place::kDisk);
  const auto store = openStore(folder.path());
  ASSERT_OK(store->catalog()->createCollection("c", ""));
  ASSERT_OK(addShape(*store, 1, OnExists::kError));
  const std::string bytes = randomBytes(400'000, 9);
  const std::string digest = sha256Hex(bytes);
  ShapeRecord large = sampleShape("c", "large");
  large.signature = randomBytes(6'000'000, 10);
  for (const rlim_t limit : {0, 1, 4'096, 30'000, 200'000, 390'000}) {
    const FileSizeLimit full(limit);
    EXPECT_THAT(store->meshes().put(bytes), FailsWith(Reason::kStoreFailure)) << limit;
    EXPECT_THAT(store->uploads().append(digest, 0, bytes), FailsWith(Reason::kStoreFailure));
    EXPECT_EQ(store->uploads().query(digest)->committed_size, 0);
    EXPECT_THAT(store->catalog()->putShape(large, OnExists::kError),
                FailsWith(Reason::kStoreFailure));
    EXPECT_FALSE(store->meshes().contains(digest));
    EXPECT_TRUE(std::filesystem::is_empty(folder.path() / "meshes" / "tmp"));
    EXPECT_THAT(store->catalog()->getShape("c", "large", ShapeView::kFull),
                FailsWith(Reason::kShapeNotFound));
  }
  EXPECT_EQ(checkWholeness(*store), 1);
  ASSERT_OK(store->meshes().put(bytes));
  ASSERT_OK(store->catalog()->putShape(large, OnExists::kError));
  ASSERT_OK(addShape(*store, 2, OnExists::kError));
}

TEST(FullDisk, AnUploadKeepsWhatItHadAndGoesOn) {
  const TemporaryFolder folder(TemporaryFolder::Place::kDisk);
  const auto store = openStore(folder.path());
  const std::string bytes = randomBytes(400'000, 11);
  const std::string digest = sha256Hex(bytes);
  ASSERT_OK(store->uploads().append(digest, 0, bytes.substr(0, 100'000)));
  {
    const FileSizeLimit full(150'000);
    EXPECT_THAT(store->uploads().append(digest, 100'000, bytes.substr(100'000)),
                FailsWith(Reason::kStoreFailure));
    EXPECT_EQ(store->uploads().query(digest)->committed_size, 100'000);
  }
  ASSERT_OK(store->uploads().append(digest, 100'000, bytes.substr(100'000)));
  {
    const FileSizeLimit full(150'000);
    EXPECT_THAT(store->uploads().finish(digest, 400'000), FailsWith(Reason::kStoreFailure));
    EXPECT_EQ(store->uploads().query(digest)->committed_size, 400'000);
  }
  ASSERT_OK(store->uploads().finish(digest, 400'000));
  EXPECT_TRUE(*store->meshes().read(digest) == bytes);
}

}  // namespace
}  // namespace moduli
