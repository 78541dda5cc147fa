// The one place that knows FLANN. Its traps are fenced here and by the preconditions of the header:
// it crashes on empty sets, keeps pointers into the caller's rows, and loses neighbours by its
// float32 rounding unless the limits leave room for that.
#include "core/retrieval/flann_trees.h"

#include <flann/algorithms/kdtree_single_index.h>

#include <cmath>
#include <exception>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace moduli {
namespace {

constexpr int kLeafRows = 32;

// Squared distance of float32 rows in float32, given up as soon as it exceeds `limit`. Eight lanes,
// so that compilers for any machine keep them in vector registers. Relative error below
// (size / 8 + 6) 2^-23.
struct FloatL2 {
  using is_kdtree_distance = bool;
  using ElementType = float;
  using ResultType = double;

  double operator()(const float* a, const float* b, std::size_t size,
                    double limit = std::numeric_limits<double>::max()) const {
    float lanes[8] = {};
    std::size_t i = 0;
    for (; i + 8 <= size; i += 8) {
      for (int lane = 0; lane < 8; ++lane) {
        const float d = a[i + lane] - b[i + lane];
        lanes[lane] += d * d;
      }
      if (i % 16 == 8 && sum(lanes) > limit) return sum(lanes);
    }
    float rest = 0;
    for (; i < size; ++i) {
      const float d = a[i] - b[i];
      rest += d * d;
    }
    return sum(lanes) + rest;
  }
  double accum_dist(double a, double b, int) const { return (a - b) * (a - b); }

 private:
  static float sum(const float (&lanes)[8]) {
    return ((lanes[0] + lanes[4]) + (lanes[1] + lanes[5])) +
           ((lanes[2] + lanes[6]) + (lanes[3] + lanes[7]));
  }
};

// FLANN's side of a visitor.
class Results final : public flann::ResultSet<double> {
 public:
  Results(TreeVisitor& visitor, double widening) : visitor_(visitor), widening_(widening) {}

  // FLANN's exact search does not ask.
  bool full() const override { return false; }

  void addPoint(double squared, std::size_t row) override {
    if (squared <= limit_) visitor_.offer(row);
  }

  double worstDist() const override {
    const double limit = visitor_.limit() * widening_;
    constexpr double kLargest = std::numeric_limits<double>::max();
    limit_ = limit < 0 ? -1 : std::min(limit, kLargest);
    return limit_;
  }

 private:
  TreeVisitor& visitor_;
  const double widening_;
  mutable double limit_ = std::numeric_limits<double>::max();
};

// FLANN's comparisons of sums with the limit are strict, and its bounds of nodes are sums and
// differences of up to 1e6 squares in double precision.
double wideningOf(std::size_t dimension) {
  return 1 + (static_cast<double>(dimension) + 16) * 0x1p-23;
}

class ReorderedTree final : public flann::KDTreeSingleIndex<FloatL2> {
 public:
  using KDTreeSingleIndex::KDTreeSingleIndex;
  // A reordered tree searches its own copy: the pointers to the caller's rows can go.
  void forgetRows() { std::vector<float*>().swap(this->flann::NNIndex<FloatL2>::points_); }
};

template <typename Build>
Status guarded(const Build& build) {
  try {
    build();
    return {};
  } catch (const std::exception& error) {
    return {Reason::kInternal, std::string("the index cannot be built: ") + error.what()};
  }
}

}  // namespace

struct KdTree::Inside {
  ReorderedTree tree;
  double widening;
};

KdTree::KdTree(std::unique_ptr<Inside> inside) : inside_(std::move(inside)) {}
KdTree::KdTree(KdTree&&) noexcept = default;
KdTree& KdTree::operator=(KdTree&&) noexcept = default;
KdTree::~KdTree() = default;

Result<KdTree> KdTree::build(const float* rows, std::size_t count, std::size_t dimension) {
  std::unique_ptr<Inside> inside;
  RETURN_IF_ERROR(guarded([&] {
    // FLANN takes a mutable pointer but writes only to its own copy.
    const flann::Matrix<float> matrix(const_cast<float*>(rows), count, dimension);
    inside.reset(new Inside{ReorderedTree(matrix, flann::KDTreeSingleIndexParams(kLeafRows, true)),
                            wideningOf(dimension)});
    inside->tree.buildIndex();
    inside->tree.forgetRows();
  }));
  return KdTree(std::move(inside));
}

void KdTree::search(const float* query, TreeVisitor& visitor) const {
  Results results(visitor, inside_->widening);
  inside_->tree.findNeighbors(results, query, flann::SearchParams());
}

}  // namespace moduli
