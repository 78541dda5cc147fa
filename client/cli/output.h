#pragma once

#include <google/protobuf/message.h>

#include <string>
#include <string_view>
#include <vector>

#include "core/base/status.h"

/// What is printed, and how.
namespace moduli::cli {

/// The one JSON document of a command: protobuf's mapping, original field names, primitive fields
/// always there, with a newline at its end.
Result<std::string> toJson(const google::protobuf::Message& message);

/// Builds a JSON document of our own, with the layout of toJson().
///
///   JsonWriter json;
///   json.open("{").key("added").number(3).key("results").open("[");
///   ...
///   json.close("]").close("}");
class JsonWriter {
 public:
  JsonWriter& open(std::string_view bracket);
  JsonWriter& close(std::string_view bracket);
  JsonWriter& key(std::string_view name);
  /// Bytes that are not UTF-8 become U+FFFD.
  JsonWriter& string(std::string_view text);
  JsonWriter& number(double value);
  /// A document of toJson().
  JsonWriter& document(std::string_view json);

  /// The document with a newline at its end.
  std::string finish() { return std::move(text_) + "\n"; }

 private:
  void separate();

  std::string text_;
  int depth_ = 0;
  bool first_ = true;
  bool after_key_ = false;
};

/// Text from elsewhere, safe for a terminal: control characters and broken UTF-8 become "?".
std::string safe(std::string_view text);

/// Rows of cells as lines of aligned columns; columns of numbers are right-aligned.
std::string alignedTable(const std::vector<std::string>& header,
                         const std::vector<std::vector<std::string>>& rows);

/// Six significant digits, for people.
std::string brief(double value);
/// "1 vertex", "3 vertices".
std::string counted(long long count, const std::string& one, const std::string& many);

/// Writes all of it to a descriptor. Fails with kFileUnwritable; the hint is "" where the reader
/// has gone (a broken pipe).
Status writeAll(int descriptor, std::string_view bytes);

/// The line that ends a failed command: "moduli: error: WHAT: WHY (REASON); HINT" and a newline.
std::string errorLine(const Status& status);

/// `status` with "what: " before its message, unless the message starts with it already.
Status about(const std::string& what, const Status& status);

}  // namespace moduli::cli
