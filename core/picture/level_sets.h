#pragma once

#include <cstddef>
#include <vector>

#include "core/picture/shapes.h"

namespace moduli {

/// Values at the points (i, j) of a grid, 0 <= i < columns, 0 <= j < rows, row by row.
struct GridValues {
  int columns = 0;
  int rows = 0;
  std::vector<double> values;

  double at(int i, int j) const { return values[static_cast<std::size_t>(j) * columns + i]; }
};

/// Where a function has the value `level`, by linear interpolation along the sides of the grid's
/// squares: lines as long as they go, in units of the grid; closed ones end where they begin. Their
/// larger values are on the left, y up. Squares with a value that is not finite are left out;
/// where a square's diagonals disagree its mean decides. O(size of the grid).
std::vector<Outline> levelSet(const GridValues& grid, double level);

}  // namespace moduli
