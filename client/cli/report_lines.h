#pragma once

#include <google/protobuf/repeated_field.h>

#include <cmath>
#include <string>
#include <vector>

#include "client/cli/output.h"
#include "moduli/v1/signature.pb.h"

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

/// The first ones, and how many there are.
inline std::string spectrumText(const google::protobuf::RepeatedField<double>& spectrum) {
  constexpr int kShown = 5;
  std::string text;
  for (int i = 0; i < spectrum.size() && i < kShown; ++i) {
    text += (i == 0 ? "" : "  ") + brief(spectrum.Get(i));
  }
  return spectrum.size() > kShown ? text + "  ... (" + std::to_string(spectrum.size()) + ")" : text;
}

/// "1 - 2 i".
inline std::string complexText(const v1::Complex& z) {
  return brief(z.re()) + (z.im() < 0 ? " - " : " + ") + brief(std::abs(z.im())) + " i";
}

}  // namespace moduli::cli
