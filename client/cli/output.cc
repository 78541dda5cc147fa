#include "client/cli/output.h"

#include <google/protobuf/util/json_util.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include "core/base/text.h"

namespace moduli::cli {
namespace {

// Length of the well-formed UTF-8 character at the front, 0 if there is none.
std::size_t characterLength(std::string_view text) {
  for (std::size_t length = 1; length <= 4 && length <= text.size(); ++length) {
    if (isPrintableUtf8(text.substr(0, length))) return length;
  }
  return 0;
}

std::size_t displayWidth(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0) != 0x80;
  }));
}

bool looksNumeric(const std::string& cell) {
  return cell.empty() || cell == "-" || parseDouble(cell).has_value();
}

std::string padded(const std::string& cell, std::size_t width, bool right) {
  const std::string blanks(width - std::min(width, displayWidth(cell)), ' ');
  return right ? blanks + cell : cell + blanks;
}

std::string oneLine(std::string_view text) {
  std::string line(text);
  std::replace(line.begin(), line.end(), '\n', ' ');
  return safe(line);
}

}  // namespace

Result<std::string> toJson(const google::protobuf::Message& message) {
  google::protobuf::util::JsonPrintOptions options;
  options.add_whitespace = true;
  options.preserve_proto_field_names = true;
  options.always_print_primitive_fields = true;
  std::string text;
  if (!google::protobuf::util::MessageToJsonString(message, &text, options).ok()) {
    return Status(Reason::kInternal, "the answer cannot be printed as JSON");
  }
  return text;
}

void JsonWriter::separate() {
  if (after_key_) {
    after_key_ = false;
    return;
  }
  if (!first_) text_ += ",";
  if (depth_ > 0) text_ += "\n" + std::string(static_cast<std::size_t>(depth_), ' ');
  first_ = false;
}

JsonWriter& JsonWriter::open(std::string_view bracket) {
  separate();
  text_ += bracket;
  ++depth_;
  first_ = true;
  return *this;
}

JsonWriter& JsonWriter::close(std::string_view bracket) {
  --depth_;
  if (!first_) text_ += "\n" + std::string(static_cast<std::size_t>(depth_), ' ');
  text_ += bracket;
  first_ = false;
  return *this;
}

JsonWriter& JsonWriter::key(std::string_view name) {
  string(name);
  text_ += ": ";
  after_key_ = true;
  return *this;
}

JsonWriter& JsonWriter::string(std::string_view text) {
  separate();
  text_ += '"';
  while (!text.empty()) {
    const auto byte = static_cast<unsigned char>(text.front());
    std::size_t length = characterLength(text);
    if (byte == '"' || byte == '\\') {
      text_ += '\\';
      text_ += text.front();
    } else if (byte < 0x20 || byte == 0x7F) {
      char escape[8];
      std::snprintf(escape, sizeof escape, "\\u%04x", byte);
      text_ += escape;
    } else if (length == 0) {
      text_ += "\xEF\xBF\xBD";
    } else {
      text_ += text.substr(0, length);
    }
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
  text_ += '"';
  return *this;
}

JsonWriter& JsonWriter::number(double value) {
  separate();
  text_ += shortestDouble(value);
  return *this;
}

JsonWriter& JsonWriter::document(std::string_view json) {
  separate();
  while (!json.empty() && json.back() == '\n') json.remove_suffix(1);
  for (const char c : json) {
    text_ += c;
    if (c == '\n') text_.append(static_cast<std::size_t>(depth_), ' ');
  }
  return *this;
}

std::string safe(std::string_view text) {
  std::string result;
  while (!text.empty()) {
    const std::size_t length = characterLength(text);
    if (length == 0) {
      result += '?';
    } else {
      result += text.substr(0, length);
    }
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return result;
}

std::string alignedTable(const std::vector<std::string>& header,
                         const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths;
  std::vector<bool> numeric(header.size(), true);
  for (const std::string& cell : header) widths.push_back(displayWidth(cell));
  for (const auto& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      widths[i] = std::max(widths[i], displayWidth(row[i]));
      if (!looksNumeric(row[i])) numeric[i] = false;
    }
  }
  std::string text;
  const auto add = [&](const std::vector<std::string>& row) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (i > 0) line += "  ";
      line += padded(row[i], widths[i], numeric[i]);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  };
  add(header);
  for (const auto& row : rows) add(row);
  return text;
}

std::string brief(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

std::string counted(long long count, const std::string& one, const std::string& many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

Status writeAll(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t done = ::write(descriptor, bytes.data(), bytes.size());
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) {
      return {Reason::kFileUnwritable,
              std::string("standard output: cannot be written (") + std::strerror(errno) + ")",
              errno == EPIPE ? "" : "check where it goes"};
    }
    bytes.remove_prefix(static_cast<std::size_t>(done));
  }
  return {};
}

std::string errorLine(const Status& status) {
  std::string line = "moduli: error: " + oneLine(status.message()) + " (" +
                     std::string(reasonName(status.reason())) + ")";
  if (!status.hint().empty()) line += "; " + oneLine(status.hint());
  return line + "\n";
}

Status about(const std::string& what, const Status& status) {
  if (status.ok() || what.empty() || status.message().starts_with(what)) return status;
  return status.withContext(what);
}

}  // namespace moduli::cli
