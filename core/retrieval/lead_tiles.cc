#include "core/retrieval/lead_tiles.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <utility>

#include "core/base/parallel.h"

namespace moduli {
namespace {

constexpr std::size_t kTileRows = 256;

float below(double value) {
  return std::nextafter(static_cast<float>(value), -std::numeric_limits<float>::infinity());
}

// Of a point from an interval.
float outside(float value, float low, float high) {
  return std::max(std::max(low - value, value - high), 0.0F);
}

}  // namespace

LeadTiles::LeadTiles(const LeadRows& leads, std::size_t part_rows) : columns_(leads.columns()) {
  order_.resize(leads.count());
  std::iota(order_.begin(), order_.end(), 0);
  divide(leads, 0, order_.size(), part_rows);
  boxes_.resize(tiles_.size() * 2 * columns_);
  values_.resize(order_.size() * width());
  tiles_.push_back(order_.size());
  parallelBlocks(tiles_.size() - 1, 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t tile = begin; tile < end; ++tile) fill(leads, tile);
  });
  tiles_.pop_back();
}

// part_rows: 0 within a part.
void LeadTiles::divide(const LeadRows& leads, std::size_t first, std::size_t rows,
                       std::size_t part_rows) {
  const auto begin = order_.begin() + static_cast<std::ptrdiff_t>(first);
  const auto end = begin + static_cast<std::ptrdiff_t>(rows);
  std::vector<float> low(leads.row(*begin), leads.row(*begin) + columns_), high = low;
  for (auto row = begin; row != end; ++row) {
    for (std::size_t i = 0; i < columns_; ++i) {
      low[i] = std::min(low[i], leads.row(*row)[i]);
      high[i] = std::max(high[i], leads.row(*row)[i]);
    }
  }
  if (part_rows > 0 && (rows <= part_rows || rows <= kTileRows)) {
    parts_.push_back({first, rows, low, high});
    part_rows = 0;
  }
  if (rows <= kTileRows) {
    tiles_.push_back(first);
    return;
  }
  std::size_t widest = 0;
  for (std::size_t i = 1; i < columns_; ++i) {
    if (high[i] - low[i] > high[widest] - low[widest]) widest = i;
  }
  // Of even parts, so that full tiles are left but for the last.
  const std::size_t tiles = (rows + kTileRows - 1) / kTileRows;
  const std::size_t left = tiles / 2 * kTileRows;
  std::nth_element(begin, begin + static_cast<std::ptrdiff_t>(left), end,
                   [&](std::uint32_t a, std::uint32_t b) {
                     return leads.row(a)[widest] < leads.row(b)[widest];
                   });
  divide(leads, first, left, part_rows);
  divide(leads, first + left, rows - left, part_rows);
}

void LeadTiles::fill(const LeadRows& leads, std::size_t tile) {
  const std::size_t first = tiles_[tile], rows = tiles_[tile + 1] - first;
  float* values = values_.data() + first * width();
  float* low = boxes_.data() + tile * 2 * columns_;
  float* high = low + columns_;
  std::copy_n(leads.row(order_[first]), columns_, low);
  std::copy_n(low, columns_, high);
  for (std::size_t row = 0; row < rows; ++row) {
    const float* lead = leads.row(order_[first + row]);
    double squared = 0;
    for (std::size_t i = 0; i < columns_; ++i) {
      values[i * rows + row] = lead[i];
      low[i] = std::min(low[i], lead[i]);
      high[i] = std::max(high[i], lead[i]);
      squared += static_cast<double>(lead[i]) * lead[i];
    }
    values[columns_ * rows + row] = static_cast<float>(-squared / 2);
  }
}

double LeadTiles::Part::squaredDistance(std::span<const float> lead) const {
  double sum = 0;
  for (std::size_t i = 0; i < low.size(); ++i) {
    const double far = outside(lead[i], low[i], high[i]);
    sum += far * far;
  }
  return sum * (1 - 0x1p-20);
}

LeadTiles::Query LeadTiles::query(std::vector<float> lead) {
  const Eigen::Map<const Eigen::VectorXf> w(lead.data(), static_cast<Eigen::Index>(lead.size()));
  Query query{{}, w.cast<double>().squaredNorm(), 0};
  // A sum of n float32 products, whatever its order: below n 2^-24 of |u||w| + |u|^2 / 2, where
  // |u| <= 1; and |u|^2 / 2 itself is rounded.
  query.error =
      static_cast<double>(lead.size() + 4) * 0x1p-24 * (1 + std::sqrt(query.squared_norm));
  query.lead = std::move(lead);
  return query;
}

/// One pass of several queries.
class LeadTiles::Scan {
 public:
  Scan(const LeadTiles& tiles, std::span<const Query* const> queries,
       std::span<ExactNearest* const> nearest)
      : tiles_(tiles), queries_(queries), nearest_(nearest) {
    leads_.resize(static_cast<Eigen::Index>(queries.size()),
                  static_cast<Eigen::Index>(tiles.columns_));
    for (std::size_t q = 0; q < queries.size(); ++q) {
      std::copy_n(queries[q]->lead.data(), tiles.columns_, &leads_(q, 0));
    }
    limits_.resize(queries.size());
    for (std::size_t q = 0; q < queries.size(); ++q) updateLimit(q);
  }

  void all(std::size_t tile) {
    picked_.clear();
    for (std::size_t q = 0; q < queries_.size(); ++q) {
      if (squaredDistance(tile, q, limits_[q]) <= limits_[q]) {
        picked_.push_back(static_cast<Eigen::Index>(q));
      }
    }
    if (!picked_.empty()) multiply(tile);
  }

  void only(std::size_t tile) {
    picked_.assign(1, 0);
    multiply(tile);
  }

  float limit(std::size_t q) const { return limits_[q]; }

  // Of query q from a tile's box, or less if more than `limit`. Right to 2^-20.
  float squaredDistance(std::size_t tile, std::size_t q, float limit) const {
    const float* low = tiles_.low(tile);
    const float* high = tiles_.high(tile);
    const float* lead = &leads_(static_cast<Eigen::Index>(q), 0);
    float sum = 0;
    for (std::size_t i = 0; i < tiles_.columns_ && sum <= limit; ++i) {
      const float far = outside(lead[i], low[i], high[i]);
      sum += far * far;
    }
    return sum;
  }

 private:
  void multiply(std::size_t tile) {
    const std::size_t first = tiles_.tiles_[tile];
    const std::size_t rows = std::min(kTileRows, tiles_.order_.size() - first);
    const auto count = static_cast<Eigen::Index>(picked_.size());
    chosen_.resize(static_cast<Eigen::Index>(tiles_.width()), count);
    for (Eigen::Index i = 0; i < count; ++i) {
      chosen_.col(i).head(chosen_.rows() - 1) = leads_.row(picked_[i]).transpose();
    }
    chosen_.row(chosen_.rows() - 1).setOnes();
    const Eigen::Map<const Eigen::MatrixXf> values(tiles_.values_.data() + first * tiles_.width(),
                                                   static_cast<Eigen::Index>(rows), chosen_.rows());
    products_.resize(values.rows(), count);
    if (count == 1) {
      products_.col(0).noalias() = values * chosen_.col(0);
    } else {
      products_.noalias() = values * chosen_;
    }
    for (Eigen::Index i = 0; i < count; ++i) offerRows(first, rows, &products_(0, i), picked_[i]);
  }

  void updateLimit(std::size_t q) {
    limits_[q] = std::min(static_cast<float>(nearest_[q]->limit() * (1 + 0x1p-20)),
                          std::numeric_limits<float>::max());
  }

  void offerRows(std::size_t first, std::size_t rows, const float* products, Eigen::Index q) {
    const auto least = [&] {
      return below((queries_[q]->squared_norm - nearest_[q]->limit()) / 2 - queries_[q]->error);
    };
    float lowest = least();
    for (std::size_t begin = 0; begin < rows; begin += 32) {
      const std::size_t end = std::min(rows, begin + 32);
      int within = 0;
      for (std::size_t row = begin; row < end; ++row) {
        within |= static_cast<int>(products[row] >= lowest);
      }
      if (within == 0) continue;
      for (std::size_t row = begin; row < end; ++row) {
        if (products[row] < lowest) continue;
        nearest_[q]->offer(tiles_.order_[first + row]);
        lowest = least();
      }
    }
    updateLimit(static_cast<std::size_t>(q));
  }

  const LeadTiles& tiles_;
  const std::span<const Query* const> queries_;
  const std::span<ExactNearest* const> nearest_;
  Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> leads_;
  std::vector<float> limits_;
  std::vector<Eigen::Index> picked_;
  Eigen::MatrixXf chosen_, products_;
};

Status LeadTiles::scan(Context& context, const Query& query, ExactNearest& nearest,
                       std::size_t most, std::size_t share, std::size_t shares) const {
  const Query* const queries[] = {&query};
  ExactNearest* const all[] = {&nearest};
  Scan scan(*this, queries, all);
  std::vector<std::pair<float, std::uint32_t>> near;
  for (std::size_t tile = share; tile < tiles_.size(); tile += shares) {
    const float squared = scan.squaredDistance(tile, 0, scan.limit(0));
    if (squared <= scan.limit(0)) near.emplace_back(squared, static_cast<std::uint32_t>(tile));
  }
  const auto farther = std::greater<std::pair<float, std::uint32_t>>();
  std::make_heap(near.begin(), near.end(), farther);
  for (; !near.empty() && near.front().first <= scan.limit(0) && most > 0; --most) {
    RETURN_IF_ERROR(context.check());
    scan.only(near.front().second);
    std::pop_heap(near.begin(), near.end(), farther);
    near.pop_back();
  }
  return {};
}

Status LeadTiles::scanTogether(Context& context, std::span<const Query* const> queries,
                               std::span<ExactNearest* const> nearest) const {
  Scan scan(*this, queries, nearest);
  for (std::size_t tile = 0; tile < tiles_.size(); ++tile) {
    RETURN_IF_ERROR(context.check());
    scan.all(tile);
  }
  return {};
}

}  // namespace moduli
