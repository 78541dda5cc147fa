#pragma once

#include <string>
#include <vector>

#include "core/base/status.h"

/// Side files: text with one thing a line, "#" comments, blanks or commas between words.
namespace moduli::cli {

struct SideLine {
  int number = 0;  ///< Counted from 1.
  std::vector<std::string> words;
};

/// The lines of a file that say something. Fails with kFileNotFound, kFileUnreadable.
Result<std::vector<SideLine>> readSideFile(const std::string& path);

struct ConeLine {
  int vertex = 0;
  double curvature = 0;
  std::string place;  ///< "cones.txt:3", for messages.
};

/// Lines "vertex curvature", in radians. Fails as readSideFile and, naming file and line, with
/// kSyntaxError and kIndexOutOfRange (a vertex below 0 or beyond 32 bits).
Result<std::vector<ConeLine>> readCones(const std::string& path);

/// Lines of vertices along a seam, two at least. Fails as readCones.
Result<std::vector<std::vector<int>>> readSeams(const std::string& path);

/// Fails with kInvalidOption, naming both lines, where a vertex has two of the cones.
Status checkDistinct(const std::vector<ConeLine>& cones);

}  // namespace moduli::cli
