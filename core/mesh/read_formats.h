#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/mesh/read.h"
#include "core/mesh/scanner.h"
#include "core/mesh/triangle_soup.h"

/// What the reader of one format and the front door share.
namespace moduli {

/// One reading: the bytes, who asked, and how much is allowed.
struct ReadJob {
  Context& context;
  Scanner scanner;
  std::size_t max_faces;
};

ReadJob readJob(Context& context, std::string_view bytes, const ReadOptions& options);
Status checkNotEmpty(const ReadJob& job);

Result<TriangleSoup> readObj(ReadJob& job);
Result<TriangleSoup> readOff(ReadJob& job);
Result<TriangleSoup> readPly(ReadJob& job);
Result<TriangleSoup> readStl(ReadJob& job);
Result<TriangleSoup> readGifti(ReadJob& job);
Result<TriangleSoup> readFreeSurfer(ReadJob& job);

/// True for the words that may open a statement of an OBJ file.
bool isObjKeyword(std::string_view word);

/// What the first word of an OFF file says about its vertices.
struct OffHeader {
  bool normals = false;
  bool colors = false;
  bool texture = false;
  bool other_dimension = false;  ///< 4OFF, nOFF: not points of space.
};
/// Nothing if the word is no OFF header. "ST", "C", "N", "4" and "n" may stand before "OFF", in any
/// order: programs do not agree on one.
std::optional<OffHeader> parseOffHeader(std::string_view word);

/// Exactly as long as its own count of triangles says.
bool isSizedBinaryStl(std::string_view bytes);
/// Begins with "solid" and with text.
bool looksLikeAsciiStl(std::string_view bytes);

/// The elements after which a reader asks whether it may go on.
inline constexpr std::size_t kCheckInterval = std::size_t{1} << 16;

/// Appends a polygon as a fan from its first corner; false if that makes too many faces.
inline bool appendFan(std::vector<Triangle>& faces, const std::vector<Index>& polygon,
                      std::size_t max_faces) {
  if (polygon.size() - 2 > max_faces - faces.size()) return false;
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    faces.push_back({polygon[0], polygon[i - 1], polygon[i]});
  }
  return true;
}

/// Words for errors that several formats share.
std::string countMessage(std::uint64_t count, std::string_view what, std::size_t bytes_left);
std::string indexMessage(std::int64_t index, std::uint64_t vertex_count);
std::string_view roomHint(Reason reason);
std::string tooManyFacesMessage(std::size_t max_faces);
inline constexpr std::string_view kTooManyFacesHint =
    "simplify the mesh, or raise the limit with --max-faces";
inline constexpr std::string_view kIndexHint =
    "the file is damaged or was written by a faulty program; export it again";
inline constexpr std::string_view kNoFacesHint =
    "points and curves alone are no surface; export the mesh with its faces";

}  // namespace moduli
