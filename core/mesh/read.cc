#include "core/mesh/read.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "core/mesh/read_formats.h"
#include "core/mesh/scanner.h"

namespace moduli {
namespace {

class FileDescriptor {
 public:
  explicit FileDescriptor(int number) : number_(number) {}
  ~FileDescriptor() {
    if (number_ >= 0) ::close(number_);
  }
  FileDescriptor(const FileDescriptor&) = delete;
  FileDescriptor& operator=(const FileDescriptor&) = delete;
  int number() const { return number_; }

 private:
  int number_;
};

Status unreadable(const std::string& path, int problem) {
  const std::string message = path + ": " + std::strerror(problem);
  if (problem == ENOENT || problem == ENOTDIR) {
    return {Reason::kFileNotFound, message, "check the path"};
  }
  return {Reason::kFileUnreadable, message, "check that it is a file and that you may read it"};
}

// In steps, so that a cancelled caller does not wait for a slow disk, and so that pipes work.
Result<std::string> readWholeFile(Context& context, const std::string& path) {
  const FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (file.number() < 0) return unreadable(path, errno);
  struct stat about {};
  if (::fstat(file.number(), &about) != 0) return unreadable(path, errno);
  if (S_ISDIR(about.st_mode)) return unreadable(path, EISDIR);
  constexpr std::size_t kStep = std::size_t{1} << 22;
  std::string bytes;
  std::size_t used = 0;
  const auto expected = static_cast<std::size_t>(about.st_size);
  for (;;) {
    RETURN_IF_ERROR(context.check());
    // One byte more than expected, so that the end shows without another step.
    if (used == bytes.size())
      bytes.resize(std::max(expected + 1, used + std::min(used + 1, kStep)));
    const std::size_t wanted = std::min(bytes.size() - used, kStep);
    const ssize_t got = ::read(file.number(), bytes.data() + used, wanted);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return unreadable(path, errno);
    if (got == 0) break;
    used += static_cast<std::size_t>(got);
  }
  bytes.resize(used);
  return bytes;
}

Result<TriangleSoup> readAs(MeshFormat format, ReadJob& job) {
  switch (format) {
    case MeshFormat::kObj:
      return readObj(job);
    case MeshFormat::kOff:
      return readOff(job);
    case MeshFormat::kPly:
      return readPly(job);
    case MeshFormat::kStl:
      return readStl(job);
    case MeshFormat::kGifti:
      return readGifti(job);
    case MeshFormat::kFreeSurfer:
      return readFreeSurfer(job);
    case MeshFormat::kJson:
      return job.scanner.byteError(
          Reason::kUnsupportedContent, job.scanner.at(),
          "an intrinsic triangulation has no positions in space, which are needed here",
          "give the surface as an OBJ, OFF, PLY, STL or GIFTI file");
  }
  return Status(Reason::kInternal, "a mesh format without a reader");
}

}  // namespace

ReadJob readJob(Context& context, std::string_view bytes, const ReadOptions& options) {
  constexpr std::size_t kMostFaces = std::numeric_limits<Index>::max() / 3;
  return {context, Scanner(options.name, bytes), std::min(options.max_faces, kMostFaces)};
}

Status checkNotEmpty(const ReadJob& job) {
  if (!job.scanner.atEnd()) return {};
  return job.scanner.byteError(Reason::kEmpty, job.scanner.at(), "the file is empty",
                               "export the mesh again");
}

std::string countMessage(std::uint64_t count, std::string_view what, std::size_t bytes_left) {
  return "declares " + std::to_string(count) + " " + std::string(what) + ", which the " +
         std::to_string(bytes_left) + " bytes that follow cannot hold";
}

std::string indexMessage(std::int64_t index, std::uint64_t vertex_count) {
  return "a face uses vertex " + std::to_string(index) + ", but the file has " +
         std::to_string(vertex_count) + " vertices";
}

std::string_view roomHint(Reason reason) {
  return reason == Reason::kTruncatedFile ? "the file was cut off; copy or export it again"
                                          : "the count is wrong; export the file again";
}

std::string tooManyFacesMessage(std::size_t max_faces) {
  return "has more than " + std::to_string(max_faces) + " faces";
}

Result<TriangleSoup> readMesh(Context& context, std::string_view bytes,
                              const ReadOptions& options) {
  RETURN_IF_ERROR(context.check());
  ReadJob job = readJob(context, bytes, options);
  RETURN_IF_ERROR(checkNotEmpty(job));
  const auto format = options.format ? options.format : detectFormat(bytes, options.name);
  if (!format) {
    return job.scanner.byteError(Reason::kUnknownFormat, bytes.data(),
                                 "the content is not OBJ, OFF, PLY, STL, GIFTI, FreeSurfer or JSON",
                                 "convert the mesh to one of these formats");
  }
  return readAs(*format, job);
}

Result<TriangleSoup> readMeshFile(Context& context, const std::string& path, ReadOptions options) {
  if (options.name == ReadOptions().name) options.name = path;
  ASSIGN_OR_RETURN(const std::string bytes, readWholeFile(context, path));
  return readMesh(context, bytes, options);
}

}  // namespace moduli
