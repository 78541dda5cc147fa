#pragma once

// Stands in for FLANN's own flann/util/random.h, which draws from std::random_device and the
// process's std::rand: two trees of the same rows would differ. Include it before any header of
// FLANN's: it takes over that header's include guard.
#ifdef FLANN_RANDOM_H
#error "flann_random.h comes before the headers of FLANN"
#endif
#define FLANN_RANDOM_H

#include <numeric>
#include <random>
#include <utility>
#include <vector>

namespace flann {

/// One generator a thread; seed it before a tree is built.
inline std::mt19937& generator() {
  thread_local std::mt19937 bits;
  return bits;
}

inline void seed_random(unsigned seed) {
  generator().seed(seed);
}

/// In [low, high).
inline double rand_double(double high = 1.0, double low = 0) {
  return low + (high - low) * static_cast<double>(generator()()) * 0x1p-32;
}

/// In [low, high).
inline int rand_int(int high = 0x7fffffff, int low = 0) {
  return static_cast<int>(rand_double(high, low));
}

/// 0, ..., n - 1 in random order, then -1. Draws as it goes, where FLANN shuffles all n first.
class UniqueRandom {
 public:
  explicit UniqueRandom(int n) { init(n); }

  void init(int n) {
    values_.resize(static_cast<std::size_t>(n));
    std::iota(values_.begin(), values_.end(), 0);
    drawn_ = 0;
  }

  int next() {
    if (drawn_ == values_.size()) return -1;
    const int left = static_cast<int>(values_.size() - drawn_);
    std::swap(values_[drawn_], values_[drawn_ + static_cast<std::size_t>(rand_int(left))]);
    return values_[drawn_++];
  }

 private:
  std::vector<int> values_;
  std::size_t drawn_ = 0;
};

}  // namespace flann
