#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/mesh/scanner.h"

/// XML, event by event. The one room for expat.
namespace moduli {

struct XmlAttribute {
  std::string_view name;
  std::string_view value;
};

/// What a document's elements mean is for a handler to say. Failures need no place: the reader adds
/// it, and stops.
class XmlHandler {
 public:
  virtual ~XmlHandler() = default;
  /// `place`: the byte of the document at which the element begins. The views last for the call.
  virtual Status open(std::string_view element, const std::vector<XmlAttribute>& attributes,
                      std::size_t place) = 0;
  virtual Status close(std::string_view element) = 0;
  /// A piece of text, in UTF-8; an element's text may come in many pieces.
  virtual Status text(std::string_view piece) = 0;
};

/// Reads a whole document (UTF-8, UTF-16, ISO-8859-1 or US-ASCII). External document types are
/// named but never fetched; declarations of entities and uses of undeclared ones are refused, so
/// nothing can expand. Memory does not grow with the document, but for one long tag.
/// Fails with kSyntaxError, kTruncatedFile, kUnsupportedContent (entities), kCancelled, or as the
/// handler does, with "name:LINE: " before the message. O(document).
Status readXml(Context& context, const Scanner& document, XmlHandler& handler);

}  // namespace moduli
