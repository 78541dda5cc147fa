#pragma once

#include <string>
#include <vector>

#include "core/base/status.h"

namespace moduli::cli {

struct IngestFilesOptions {
  bool recursive = false;
  bool label_from_dir = false;
  bool name_from_path = false;  ///< Otherwise from the file's stem.
};

/// A file to add, or one that cannot be added and why.
struct IngestFile {
  std::string path;
  std::string shape_id;
  std::string label;
  Status status;
};

/// What a list of files and folders stands for, in its order; folders by name, with the mesh files
/// (by extension; .json files only if their beginning says that they are intrinsic triangulations)
/// directly in them, or in all folders below. A file named twice counts once. Two
/// different files that would get one name both fail with kNameClash; what is not there fails with
/// kFileNotFound. Opens no other file. O(n log n).
std::vector<IngestFile> ingestFiles(const std::vector<std::string>& paths,
                                    const IngestFilesOptions& options);

/// The lines of a list of paths: from a file, or from standard input for "-". Empty lines do not
/// count. Fails with kFileNotFound, kFileUnreadable.
Result<std::vector<std::string>> readPathList(const std::string& list);

}  // namespace moduli::cli
