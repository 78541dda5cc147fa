#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace moduli {

/// The name ("nfs", "cifs", ...) of the network file system that statfs's magic number stands for.
/// For FUSE the type of the mount ("fuse.sshfs") decides. Nothing for local ones.
std::optional<std::string> networkFileSystemName(std::uint32_t magic, std::string_view mount_type);

/// The same of the file system that holds an existing file or folder.
std::optional<std::string> networkFileSystemAt(const std::filesystem::path& path);

}  // namespace moduli
