#pragma once

#include <string>
#include <vector>

#include "core/picture/image.h"

namespace moduli {

/// One picture of a contact sheet with its words.
struct SheetCell {
  Image image;
  std::string title;     ///< Bold, cut off where it does not fit.
  std::string subtitle;  ///< Smaller, grey.
  bool highlighted = false;
};

/// Pixels around and between the pictures of a sheet, of its heading, and of the words below each
/// picture: a sheet is margin + columns (picture + margin) wide and heading + rows (picture +
/// words)
/// + margin high.
inline constexpr int kSheetMargin = 16, kSheetHeading = 44, kSheetWords = 46;

/// Pictures of one size in rows of `columns`, each above its words, under a heading.
/// Fails with kInvalidOption without cells or columns, kInternal if the drawing library fails.
Result<Image> composeSheet(const std::string& heading, const std::vector<SheetCell>& cells,
                           int columns);

}  // namespace moduli
