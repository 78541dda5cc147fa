#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <vector>

#include "core/mesh/base64.h"
#include "core/mesh/deflate.h"

/// GIFTI files put together by hand: every attribute can be given another value.
namespace moduli {

/// The bytes of numbers in a byte order.
template <typename Number>
std::string bytesOf(const std::vector<Number>& numbers, bool big_endian) {
  std::string bytes;
  for (const Number number : numbers) {
    using Bits = std::conditional_t<sizeof(Number) == 8, std::uint64_t, std::uint32_t>;
    const auto bits = std::bit_cast<Bits>(number);
    for (std::size_t i = 0; i < sizeof(Number); ++i) {
      const std::size_t place = big_endian ? sizeof(Number) - 1 - i : i;
      bytes += static_cast<char>(bits >> (8 * place) & 0xFFU);
    }
  }
  return bytes;
}

/// A DataArray element.
struct ArrayText {
  std::string intent;
  std::string type;
  std::string dimensions;  ///< "4 3": Dim0 and Dim1.
  std::string data;
  std::string encoding = "ASCII";
  std::string endian = "LittleEndian";
  std::string order = "RowMajorOrder";
  std::string inside = "";  ///< Elements before Data.

  std::string text() const {
    std::string attributes;
    int rank = 0;
    std::string rest = dimensions + " ";
    for (std::size_t blank = 0; (blank = rest.find(' ')) != std::string::npos;
         rest.erase(0, blank + 1)) {
      attributes += " Dim" + std::to_string(rank++) + "=\"" + rest.substr(0, blank) + "\"";
    }
    return "<DataArray Intent=\"NIFTI_INTENT_" + intent + "\" DataType=\"NIFTI_TYPE_" + type +
           "\" ArrayIndexingOrder=\"" + order + "\" Dimensionality=\"" + std::to_string(rank) +
           "\"" + attributes + " Encoding=\"" + encoding + "\" Endian=\"" + endian + "\">" +
           inside + "<Data>" + data + "</Data></DataArray>\n";
  }
};

inline std::string giftiFile(const std::string& arrays, const std::string& before = "") {
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
         "<!DOCTYPE GIFTI SYSTEM \"http://www.nitrc.org/frs/download.php/115/gifti.dtd\">\n"
         "<GIFTI Version=\"1.0\">\n" +
         before + arrays + "</GIFTI>\n";
}

inline ArrayText tetrahedronPoints() {
  return {"POINTSET", "FLOAT32", "4 3", "0 0 0 1 0 0 0 1 0 0 0 1"};
}
inline ArrayText tetrahedronTriangles() {
  return {"TRIANGLE", "INT32", "4 3", "0 2 1 0 1 3 1 2 3 2 0 3"};
}
inline std::string tetrahedronGifti(const ArrayText& points = tetrahedronPoints(),
                                    const ArrayText& triangles = tetrahedronTriangles()) {
  return giftiFile(points.text() + triangles.text());
}

}  // namespace moduli
