#include "server/service/access.h"

#include <array>
#include <cstddef>
#include <optional>
#include <sstream>

#include "core/base/digest.h"

namespace moduli {
namespace {

constexpr std::array<std::string_view, 3> kRoleNames = {"reader", "writer", "admin"};

std::optional<Role> roleFromName(std::string_view name) {
  for (std::size_t i = 0; i < kRoleNames.size(); ++i) {
    if (kRoleNames[i] == name) return static_cast<Role>(i);
  }
  return {};
}

bool isSha256(std::string_view text) {
  return text.size() == 64 && text.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

/// Looks at every byte whatever the first difference.
bool equalInConstantTime(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned int difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]);
  }
  return difference == 0;
}

}  // namespace

Result<AccessList> AccessList::parse(std::string_view text, std::string_view name) {
  AccessList list;
  list.required_ = true;
  std::istringstream lines{std::string(text)};
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    std::istringstream words(line.substr(0, line.find('#')));
    std::string sha256, role_name, rest;
    if (!(words >> sha256)) continue;
    words >> role_name;
    const std::optional<Role> role = roleFromName(role_name);
    if (!isSha256(sha256) || !role || (words >> rest)) {
      return Status(Reason::kInvalidConfiguration,
                    std::string(name) + ":" + std::to_string(number) +
                        ": not a SHA-256 in lower-case hexadecimal and a role",
                    "write lines such as \"$(printf %s TOKEN | sha256sum | cut -d' ' -f1) "
                    "reader\"; roles are reader, writer, admin");
    }
    list.entries_.push_back({sha256, *role});
  }
  if (list.entries_.empty()) {
    return Status(Reason::kInvalidConfiguration, std::string(name) + ": holds no token",
                  "add one, or leave the token file out");
  }
  return list;
}

Status AccessList::check(std::string_view authorization, Role needed) const {
  if (!required_) return {};
  constexpr std::string_view kScheme = "Bearer ";
  if (!authorization.starts_with(kScheme)) {
    return {Reason::kUnauthenticated, "the server asks for a token", "give one with --token"};
  }
  const std::string digest = sha256Hex(authorization.substr(kScheme.size()));
  const Entry* found = nullptr;
  for (const Entry& entry : entries_) {
    if (equalInConstantTime(entry.sha256, digest)) found = &entry;
  }
  if (found == nullptr) {
    return {Reason::kUnauthenticated, "the server does not know this token",
            "ask its administrator for a valid one"};
  }
  if (found->role < needed) {
    return {Reason::kPermissionDenied,
            "this token's role is " +
                std::string(kRoleNames[static_cast<std::size_t>(found->role)]) +
                ", and the call needs " + std::string(kRoleNames[static_cast<std::size_t>(needed)]),
            "use a token with that role"};
  }
  return {};
}

}  // namespace moduli
