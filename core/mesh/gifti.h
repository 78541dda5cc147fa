#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/mesh/read.h"
#include "core/mesh/triangle_soup.h"

/// GIFTI surfaces (.gii, .surf.gii, and .gii.gz: the same gzipped as a whole), as neuroimaging
/// programs exchange them: XML around arrays of numbers. readMesh() and writeMesh() read and write
/// them like any mesh; here is what else such a file says.
///
///   GiftiWriteOptions options;
///   options.tags.points = {{"AnatomicalStructurePrimary", "CortexLeft"}};
///   Result<std::string> bytes = writeGiftiSurface(soup, options);
///
/// Source: "GIFTI Surface Data Format", version 1.0 (2011).
namespace moduli {

/// A name and a value of a MetaData element: "AnatomicalStructurePrimary" and "CortexLeft".
struct GiftiMetaItem {
  std::string name;
  std::string value;
  bool operator==(const GiftiMetaItem&) const = default;
};

/// Where the points are, and how they would get to another space.
struct GiftiCoordinateSystem {
  std::string data_space = "NIFTI_XFORM_UNKNOWN";
  std::string transformed_space = "NIFTI_XFORM_UNKNOWN";
  /// 4 x 4 row by row, from the data space to the transformed one; columns multiply from the right.
  std::array<double, 16> matrix = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  bool operator==(const GiftiCoordinateSystem&) const = default;
};

/// What a GIFTI surface says beside its points and triangles. The matrices are kept, not applied:
/// coordinates are always those of the file, in its data space.
struct GiftiTags {
  std::vector<GiftiMetaItem> file;                 ///< Of the whole file.
  std::vector<GiftiMetaItem> points;               ///< AnatomicalStructurePrimary, GeometricType...
  std::vector<GiftiMetaItem> triangles;            ///< TopologicalType...
  std::vector<GiftiCoordinateSystem> coordinates;  ///< Of the points.
  bool operator==(const GiftiTags&) const = default;
};

struct GiftiSurface {
  TriangleSoup soup;
  GiftiTags tags;
};

/// Reads a GIFTI surface, compressed or not: one array NIFTI_INTENT_POINTSET (V x 3, FLOAT32 or
/// FLOAT64) and one NIFTI_INTENT_TRIANGLE (F x 3, INT32), in ASCII, Base64Binary or
/// GZipBase64Binary, of either byte order, row-major or column-major. ASCII numbers are rounded to
/// the declared type, so that the encoding makes no difference. Arrays with other intents are
/// passed over. options.format plays no part.
///
/// Fails as readMesh() does. kUnsupportedContent also for ExternalFileBinary, for other types, and
/// for a file with several surfaces; kCountTooLarge also where compressed numbers expand to more
/// than InflateAllowance permits. O(bytes read and inflated).
Result<GiftiSurface> readGiftiSurface(Context& context, std::string_view bytes,
                                      const ReadOptions& options);

enum class GiftiEncoding { kAscii, kBase64, kGzipBase64 };

struct GiftiWriteOptions {
  GiftiTags tags;
  GiftiEncoding encoding = GiftiEncoding::kGzipBase64;
  /// NIFTI_TYPE_FLOAT64, which keeps every bit. The format's own list of types ends with FLOAT32,
  /// and some programs read no other; so that one is written unless asked.
  bool doubles = false;
};

/// The bytes of a .surf.gii file, little-endian and row-major. Points without a coordinate system
/// get the neutral one, as the format wants one.
/// Fails with kInvalidOption: a coordinate beyond float32 (without `doubles`), or a tag that is no
/// UTF-8 or has control characters. O(V + F).
Result<std::string> writeGiftiSurface(const TriangleSoup& soup,
                                      const GiftiWriteOptions& options = {});

}  // namespace moduli
