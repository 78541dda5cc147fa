#include "client/cli/ingest_files.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <unordered_map>

#include "client/cpp/mesh_bytes.h"
#include "core/base/text.h"
#include "core/intrinsic/intrinsic_json.h"
#include "core/mesh/format.h"

namespace moduli::cli {
namespace {

namespace fs = std::filesystem;

// Labels are names of folders: "." and ".." are none.
std::string parentName(const fs::path& path) {
  const std::string name = path.parent_path().filename().string();
  return name == "." || name == ".." ? "" : name;
}

std::string nameFromPath(const fs::path& path) {
  std::string name = path.lexically_normal().generic_string();
  while (name.starts_with("../")) name.erase(0, 3);
  while (name.starts_with('/')) name.erase(0, 1);
  std::replace(name.begin(), name.end(), '/', ':');
  return name;
}

// By the extension; but JSON files are mostly something else.
bool isSurfaceFile(const fs::path& path) {
  const auto format = formatFromExtension(path.filename().string());
  if (format != MeshFormat::kJson) return format.has_value();
  std::string beginning(4096, '\0');
  std::ifstream in(path, std::ios::binary);
  in.read(beginning.data(), static_cast<std::streamsize>(beginning.size()));
  return looksLikeIntrinsicJson(beginning);
}

class Collector {
 public:
  explicit Collector(const IngestFilesOptions& options) : options_(options) {}

  void addNamed(const std::string& path) {
    std::error_code error;
    const fs::file_status facts = fs::status(path, error);
    if (facts.type() == fs::file_type::not_found) {
      fail(path, {Reason::kFileNotFound, path + ": no such file", "check the path"});
    } else if (facts.type() == fs::file_type::none) {
      fail(path, {Reason::kFileUnreadable, path + ": cannot be read (" + error.message() + ")",
                  "check its permissions"});
    } else if (facts.type() == fs::file_type::directory) {
      addFolder(path);
    } else {
      add(path);
    }
  }

  std::vector<IngestFile> take() { return std::move(files_); }

 private:
  void addFolder(const std::string& folder) {
    std::error_code error;
    std::vector<std::string> found;
    const auto keep = [&](const fs::directory_entry& entry) {
      std::error_code ignored;
      if (!entry.is_regular_file(ignored) || !isSurfaceFile(entry.path())) return;
      found.push_back(entry.path().string());
    };
    if (options_.recursive) {
      const auto skip = fs::directory_options::skip_permission_denied;
      for (auto entry = fs::recursive_directory_iterator(folder, skip, error);
           !error && entry != fs::recursive_directory_iterator(); entry.increment(error)) {
        keep(*entry);
      }
    } else {
      for (auto entry = fs::directory_iterator(folder, error);
           !error && entry != fs::directory_iterator(); entry.increment(error)) {
        keep(*entry);
      }
    }
    if (error) {
      fail(folder, {Reason::kFileUnreadable, folder + ": cannot be read (" + error.message() + ")",
                    "check its permissions"});
    }
    std::sort(found.begin(), found.end());
    for (const std::string& path : found) add(path);
  }

  void add(const std::string& path) {
    const fs::path file(path);
    IngestFile entry;
    entry.path = path;
    entry.shape_id = options_.name_from_path ? nameFromPath(file) : file.stem().string();
    if (options_.label_from_dir) entry.label = parentName(file);
    if (!isPrintableUtf8(entry.shape_id) || !isPrintableUtf8(entry.label)) {
      fail(path,
           {Reason::kInvalidName, path + ": its name is not printable UTF-8", "rename the file"});
      return;
    }
    const auto [known, fresh] = by_name_.try_emplace(entry.shape_id, files_.size());
    if (!fresh) {
      IngestFile& other = files_[known->second];
      std::error_code ignored;
      if (other.path == path || fs::equivalent(other.path, path, ignored)) return;
      entry.status = clash(entry, other);
      if (other.status.ok()) other.status = clash(other, entry);
    }
    files_.push_back(std::move(entry));
  }

  static Status clash(const IngestFile& file, const IngestFile& other) {
    return {Reason::kNameClash,
            file.path + ": would be named '" + file.shape_id + "', as would " + other.path,
            "give --name-from path, or add them in separate runs"};
  }

  void fail(const std::string& path, Status status) {
    files_.push_back({path, "", "", std::move(status)});
  }

  const IngestFilesOptions options_;
  std::vector<IngestFile> files_;
  std::unordered_map<std::string, std::size_t> by_name_;
};

}  // namespace

std::vector<IngestFile> ingestFiles(const std::vector<std::string>& paths,
                                    const IngestFilesOptions& options) {
  Collector collector(options);
  for (const std::string& path : paths) collector.addNamed(path);
  return collector.take();
}

Result<std::vector<std::string>> readPathList(const std::string& list) {
  ASSIGN_OR_RETURN(const MeshBytes file, MeshBytes::ofFile(list == "-" ? "/dev/stdin" : list));
  ASSIGN_OR_RETURN(const std::string text, file.read(0, static_cast<std::size_t>(file.size())));
  std::vector<std::string> paths;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    std::string line = text.substr(begin, end - begin);
    if (line.ends_with('\r')) line.pop_back();
    if (!line.empty()) paths.push_back(std::move(line));
    begin = end + 1;
  }
  return paths;
}

}  // namespace moduli::cli
