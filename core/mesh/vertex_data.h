#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/mesh/gifti.h"

namespace moduli {

/// One number a vertex, such as sulcal depth, curvature or thickness.
struct VertexData {
  std::vector<double> values;  ///< V of them, in the order of the surface's vertices.
  std::string name;            ///< As a GIFTI file calls them ("sulc"); "" elsewhere.
};

/// Reads one number a vertex. The content tells the format:
/// - GIFTI (.shape.gii, .func.gii, also gzipped): the one array with NIFTI_INTENT_SHAPE or
///   NIFTI_INTENT_NONE, V or V x 1 numbers; arrays with other intents are passed over, but a
///   NIFTI_INTENT_NODE_INDEX (values for some vertices only) is refused;
/// - FreeSurfer's "new curv" (lh.sulc, lh.curv, lh.thickness, lh.area): float32, big-endian;
/// - text: one number a line, with blank lines and comments from '#' on.
/// NaN and infinity are read as such. vertex_count: V; another number of values is an error.
/// `name`: the file's, for messages.
///
/// Fails with kEmpty, kUnknownFormat, kSyntaxError, kTruncatedFile, kCountTooLarge, kCancelled, and
/// kUnsupportedContent (several values a vertex, several arrays, a surface instead of values,
/// another number of vertices). Messages are as those of readMesh(). O(bytes read and inflated).
Result<VertexData> readVertexData(Context& context, std::string_view bytes, std::string_view name,
                                  std::size_t vertex_count);

/// The bytes of a .shape.gii file with one NIFTI_INTENT_SHAPE array. Of the options' tags only
/// those of the file play a part: programs look there for AnatomicalStructurePrimary.
/// Fails with kInvalidOption as writeGiftiSurface() does. O(V).
Result<std::string> writeGiftiShape(const VertexData& data, const GiftiWriteOptions& options = {});

}  // namespace moduli
