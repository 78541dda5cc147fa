#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/mesh/triangle_soup.h"
#include "tests/core/mesh/gifti_text.h"

/// Files of FreeSurfer, put together by hand.
namespace moduli {

inline std::string bigEndianCounts(const std::vector<std::uint32_t>& counts) {
  return bytesOf(counts, true);
}

/// A triangle surface with this comment.
inline std::string freeSurferSurface(const TriangleSoup& soup,
                                     const std::string& comment = "created by test\n\n") {
  std::string bytes = "\xFF\xFF\xFE" + comment +
                      bigEndianCounts({static_cast<std::uint32_t>(soup.vertices.size()),
                                       static_cast<std::uint32_t>(soup.faces.size())});
  for (const Eigen::Vector3d& p : soup.vertices) {
    bytes += bytesOf<float>(
        {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])}, true);
  }
  for (const Triangle& t : soup.faces) bytes += bytesOf<std::int32_t>({t[0], t[1], t[2]}, true);
  return bytes;
}

/// "new curv": values of vertices.
inline std::string freeSurferValues(const std::vector<float>& values, std::uint32_t faces = 4,
                                    std::uint32_t per_vertex = 1) {
  return "\xFF\xFF\xFF" +
         bigEndianCounts({static_cast<std::uint32_t>(values.size()), faces, per_vertex}) +
         bytesOf(values, true);
}

/// A surface of quadrangles, as before 1999: counts in 24 bits, coordinates in hundredths of mm.
inline std::string freeSurferQuads(const std::vector<std::uint8_t>& first_point) {
  std::string bytes("\xFF\xFF\xFF\0\0\4\0\0\1", 9);
  for (const std::uint8_t byte : first_point) bytes += static_cast<char>(byte);
  bytes.resize(9 + 6 * 4 + 12 * 1);
  return bytes;
}

}  // namespace moduli
