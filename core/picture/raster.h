#pragma once

#include <limits>
#include <vector>

#include "core/picture/vec3.h"

namespace moduli {

/// What is seen through one sample of a picture.
struct Sample {
  static constexpr int kNothing = -1;

  float depth = -std::numeric_limits<float>::infinity();
  int what = kNothing;          ///< A face, kNothing, or lineOf() of a set of lines.
  float second = 0, third = 0;  ///< Barycentric coordinates in a face; the first is what is left.

  static int ofLine(int set) { return -2 - set; }
  static int lineOf(int what) { return -2 - what; }
};

/// A depth buffer over some rows of a picture: finds out what is seen, not how it looks.
/// Points are in samples: x to the right, y down, z towards the eye. The sample (x, y) lies at
/// (x + 1/2, y + 1/2). Not thread-safe.
class Raster {
 public:
  /// Rows first_row, ..., first_row + rows - 1 of a picture that is `width` samples wide.
  Raster(int width, int first_row, int rows);

  /// Of two faces at one depth the first is kept. Neighbours leave no sample on their common edge
  /// out. Points have to be finite; a face without area is not seen. O(samples of its box).
  void drawTriangle(int face, const Vec3& a, const Vec3& b, const Vec3& c);

  /// A line with round ends; `lift` is added to its depth. Of two lines at one depth the last is
  /// kept. O(samples of its box).
  void drawLine(int set, const Vec3& a, const Vec3& b, double width, double lift);

  const Sample& at(int x, int y) const {
    return samples_[static_cast<std::size_t>(y - first_row_) * width_ + x];
  }

 private:
  struct Range {
    int first, last;
  };
  static Range clip(double low, double high, int first, int last);
  Range columns(double low, double high) const { return clip(low, high, 0, width_ - 1); }
  Range rows(double low, double high) const {
    return clip(low, high, first_row_, first_row_ + rows_ - 1);
  }

  int width_, first_row_, rows_;
  std::vector<Sample> samples_;
};

}  // namespace moduli
