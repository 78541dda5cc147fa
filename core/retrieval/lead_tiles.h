#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/retrieval/exact_nearest.h"
#include "core/retrieval/lead_rows.h"

namespace moduli {

/// Lead rows in tiles of at most 256 that lie near each other. A tile whose box is too far from a
/// query is passed over; the rows of the others are compared with all queries at once by a float32
/// matrix product,
///
///   u.w - |u|^2 / 2 >= (|w|^2 - limit) / 2   <=>   |u - w|^2 <= limit,
///
/// with a margin for its rounding; what stays within the limit is measured exactly. Immutable.
class LeadTiles {
 public:
  /// Of one query.
  struct Query {
    std::vector<float> lead;
    double squared_norm = 0;
    double error = 0;  ///< Of the matrix product, at most.
  };

  /// Rows order()[first], ..., order()[first + rows - 1], which lie near each other.
  struct Part {
    std::size_t first = 0;
    std::size_t rows = 0;
    std::vector<float> low, high;  ///< Their box.

    /// Of a query from the box, rounded down.
    double squaredDistance(std::span<const float> lead) const;
  };

  /// Halves the rows across their widest side until tiles are left. leads: at least one row, of
  /// norm at most 1. O(n log n).
  LeadTiles(const LeadRows& leads, std::size_t part_rows);

  /// Row of the set at each place of the tiles.
  const std::vector<std::uint32_t>& order() const { return order_; }
  /// All rows in parts of at most part_rows.
  const std::vector<Part>& parts() const { return parts_; }

  /// lead: as from LeadRows::leadOf.
  static Query query(std::vector<float> lead);

  /// Offers to `nearest` every row within its limit, nearest tile first; of the tiles
  /// share, share + shares, ... only, and of the `most` nearest of those only.
  Status scan(Context& context, const Query& query, ExactNearest& nearest,
              std::size_t most = static_cast<std::size_t>(-1), std::size_t share = 0,
              std::size_t shares = 1) const;

  /// Offers to nearest[q] every row within its limit of query q; the better the limits, the faster.
  /// queries and nearest: of one length.
  Status scanTogether(Context& context, std::span<const Query* const> queries,
                      std::span<ExactNearest* const> nearest) const;

 private:
  class Scan;

  void divide(const LeadRows& leads, std::size_t first, std::size_t rows, std::size_t part_rows);
  void fill(const LeadRows& leads, std::size_t tile);
  std::size_t width() const { return columns_ + 1; }
  const float* low(std::size_t tile) const { return boxes_.data() + tile * 2 * columns_; }
  const float* high(std::size_t tile) const { return low(tile) + columns_; }

  std::size_t columns_;
  std::vector<std::uint32_t> order_;
  std::vector<Part> parts_;
  std::vector<std::size_t> tiles_;  ///< First place of each.
  std::vector<float> boxes_;        ///< Lowest, then highest of each column, tile after tile.
  std::vector<float> values_;       ///< Tile after tile, column after column; last -|u|^2 / 2.
};

}  // namespace moduli
