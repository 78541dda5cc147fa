#include "server/store/file_system_kind.h"

#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <sys/vfs.h>

#include <array>
#include <fstream>
#include <sstream>
#include <utility>

namespace moduli {
namespace {

// From linux/magic.h and the file systems' own sources.
constexpr std::array<std::pair<std::uint32_t, std::string_view>, 14> kNetworkMagics{{
    {0x6969, "nfs"},
    {0x517B, "smb"},
    {0xFF534D42, "cifs"},
    {0xFE534D42, "smb2"},
    {0x564C, "ncp"},
    {0x73757245, "coda"},
    {0x5346414F, "afs"},
    {0x6B414653, "kafs"},
    {0x01021997, "9p"},
    {0x00C36400, "ceph"},
    {0x0BD00BD0, "lustre"},
    {0x47504653, "gpfs"},
    {0x013111A8, "ibrix"},
    {0x19830326, "beegfs"},
}};

constexpr std::uint32_t kFuseMagic = 0x65735546;

// FUSE file systems that fetch their files from elsewhere.
constexpr std::array<std::string_view, 16> kNetworkFuse{
    "sshfs",  "glusterfs", "s3fs",    "rclone",    "ceph",     "mfs", "moosefs", "juicefs",
    "davfs2", "goofys",    "gcsfuse", "curlftpfs", "smbnetfs", "afp", "ipfs",    "seaweedfs"};

// Type of the mount that holds a device, from lines such as
// "36 35 98:0 /mnt1 /mnt2 rw,noatime master:1 - fuse.sshfs host:/ rw".
std::string mountTypeOf(dev_t device) {
  const std::string wanted = std::to_string(major(device)) + ":" + std::to_string(minor(device));
  std::ifstream mounts("/proc/self/mountinfo");
  for (std::string line; std::getline(mounts, line);) {
    std::istringstream fields(line);
    std::string id, parent, numbers, word;
    fields >> id >> parent >> numbers;
    if (numbers != wanted) continue;
    while (fields >> word && word != "-") continue;
    fields >> word;
    return word;
  }
  return {};
}

}  // namespace

std::optional<std::string> networkFileSystemName(std::uint32_t magic, std::string_view mount_type) {
  for (const auto& [known, name] : kNetworkMagics) {
    if (known == magic) return std::string(name);
  }
  if (magic != kFuseMagic) return std::nullopt;
  for (const std::string_view name : kNetworkFuse) {
    if (mount_type == "fuse." + std::string(name)) return std::string(mount_type);
  }
  return std::nullopt;
}

std::optional<std::string> networkFileSystemAt(const std::filesystem::path& path) {
  struct statfs info = {};
  struct stat file = {};
  if (::statfs(path.c_str(), &info) != 0 || ::stat(path.c_str(), &file) != 0) return std::nullopt;
  const auto magic = static_cast<std::uint32_t>(info.f_type);
  return networkFileSystemName(magic, magic == kFuseMagic ? mountTypeOf(file.st_dev) : "");
}

}  // namespace moduli
