#pragma once

#include <string>
#include <vector>

/// What reports are made of.
namespace moduli::cli {

/// "  label      text".
inline std::string line(const std::string& label, const std::string& text) {
  constexpr std::size_t kLabelWidth = 13;
  std::string padded = label;
  if (padded.size() < kLabelWidth) padded.resize(kLabelWidth, ' ');
  return "  " + padded + " " + text + "\n";
}

/// The parts with commas between them; "" where there are none.
inline std::string joinedLine(const std::string& label, const std::vector<std::string>& parts) {
  std::string joined;
  for (const std::string& part : parts) joined += (joined.empty() ? "" : ", ") + part;
  return joined.empty() ? "" : line(label, joined);
}

}  // namespace moduli::cli
