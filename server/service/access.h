#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/status.h"

namespace moduli {

/// What a caller may do; each role may do all that the ones before it may.
enum class Role : std::uint8_t {
  kReader,  ///< Compute, upload for computing, read and search the catalogue.
  kWriter,  ///< Make collections, add and remove shapes.
  kAdmin,   ///< Remove collections.
};

/// Who may do what, by API tokens of which only the SHA-256 is known here. Immutable; thread-safe.
class AccessList {
 public:
  /// Lets everybody do everything.
  AccessList() = default;

  /// From lines "SHA256-OF-TOKEN ROLE", ROLE one of reader writer admin, "#" starts a comment.
  /// name: of the file, for messages. Fails with kInvalidConfiguration, naming the line, and for a
  /// text without any token.
  static Result<AccessList> parse(std::string_view text, std::string_view name);

  /// authorization: the value of that header, "" if it was not sent. Fails with kUnauthenticated
  /// (no token, unknown token) and kPermissionDenied. Takes the same time for every unknown token.
  Status check(std::string_view authorization, Role needed) const;

 private:
  struct Entry {
    std::string sha256;
    Role role = Role::kReader;
  };

  bool required_ = false;
  std::vector<Entry> entries_;
};

}  // namespace moduli
