// The one place that knows FLANN. Its traps are fenced here and by the preconditions of the header:
// it crashes on empty sets, keeps pointers into the caller's rows, draws random numbers that no one
// can repeat, and loses neighbours by its float32 rounding unless the limits leave room for that.
#include "core/retrieval/flann_trees.h"

#include "core/retrieval/flann_random.h"

// FLANN's headers rely on each other's order.
#include <flann/algorithms/dist.h>

#include <flann/algorithms/kdtree_single_index.h>
#include <flann/algorithms/kmeans_index.h>

#include <cmath>
#include <exception>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace moduli {
namespace {

constexpr int kLeafRows = 32;
constexpr int kBranching = 32;
constexpr int kIterations = 5;

// Squared distance of float32 rows in float32, given up as soon as it exceeds `limit`. Eight lanes,
// so that compilers for any machine keep them in vector registers. Relative error below
// (size / 8 + 6) 2^-23.
// Scalar: what FLANN keeps sums, bounds and centres in.
template <typename Scalar>
struct FloatL2 {
  using is_kdtree_distance = bool;
  using is_vector_space_distance = bool;
  using ElementType = float;
  using ResultType = Scalar;

  template <typename Other>
  Scalar operator()(const float* a, const Other* b, std::size_t size,
                    Scalar limit = std::numeric_limits<Scalar>::max()) const {
    float lanes[8] = {};
    std::size_t i = 0;
    for (; i + 8 <= size; i += 8) {
      for (int lane = 0; lane < 8; ++lane) {
        const float d = a[i + lane] - static_cast<float>(b[i + lane]);
        lanes[lane] += d * d;
      }
      if (i % 16 == 8 && sum(lanes) > limit) return sum(lanes);
    }
    float rest = 0;
    for (; i < size; ++i) {
      const float d = a[i] - static_cast<float>(b[i]);
      rest += d * d;
    }
    return sum(lanes) + rest;
  }
  // FLANN compares its k-means centres with rows both ways round.
  Scalar operator()(const double* a, const float* b, std::size_t size) const {
    return (*this)(b, a, size);
  }
  Scalar accum_dist(Scalar a, Scalar b, int) const { return (a - b) * (a - b); }

 private:
  static float sum(const float (&lanes)[8]) {
    return ((lanes[0] + lanes[4]) + (lanes[1] + lanes[5])) +
           ((lanes[2] + lanes[6]) + (lanes[3] + lanes[7]));
  }
};

// FLANN's side of a visitor.
template <typename Scalar>
class Results final : public flann::ResultSet<Scalar> {
 public:
  Results(TreeVisitor& visitor, double widening) : visitor_(visitor), widening_(widening) {}

  bool full() const override { return visitor_.full() || limit_ < 0; }

  void addPoint(Scalar squared, std::size_t row) override {
    if (squared <= limit_) visitor_.offer(row);
  }

  Scalar worstDist() const override {
    const double limit = visitor_.limit() * widening_;
    constexpr double kLargest = std::numeric_limits<Scalar>::max();
    limit_ = static_cast<Scalar>(limit < 0 ? -1 : std::min(limit, kLargest));
    return limit_;
  }

 private:
  TreeVisitor& visitor_;
  const double widening_;
  mutable Scalar limit_ = std::numeric_limits<Scalar>::max();
};

// FLANN's comparisons of sums with the limit are strict, and its bounds of nodes are sums and
// differences of up to 1e6 squares in double precision.
double wideningOf(std::size_t dimension) {
  return 1 + (static_cast<double>(dimension) + 16) * 0x1p-23;
}

class ReorderedTree final : public flann::KDTreeSingleIndex<FloatL2<double>> {
 public:
  using KDTreeSingleIndex::KDTreeSingleIndex;
  // A reordered tree searches its own copy: the pointers to the caller's rows can go.
  void forgetRows() { std::vector<float*>().swap(this->flann::NNIndex<FloatL2<double>>::points_); }
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
  Results<double> results(visitor, inside_->widening);
  inside_->tree.findNeighbors(results, query, flann::SearchParams());
}

struct KMeansTree::Inside {
  flann::KMeansIndex<FloatL2<float>> tree;
  double widening;
};

KMeansTree::KMeansTree(std::unique_ptr<Inside> inside) : inside_(std::move(inside)) {}
KMeansTree::KMeansTree(KMeansTree&&) noexcept = default;
KMeansTree& KMeansTree::operator=(KMeansTree&&) noexcept = default;
KMeansTree::~KMeansTree() = default;

Result<KMeansTree> KMeansTree::build(float* rows, std::size_t count, std::size_t columns,
                                     std::size_t stride) {
  std::unique_ptr<Inside> inside;
  RETURN_IF_ERROR(guarded([&] {
    flann::seed_random(1);
    const flann::Matrix<float> matrix(rows, count, columns, stride * sizeof(float));
    inside.reset(new Inside{flann::KMeansIndex<FloatL2<float>>(
                                matrix, flann::KMeansIndexParams(kBranching, kIterations)),
                            wideningOf(columns)});
    inside->tree.buildIndex();
  }));
  return KMeansTree(std::move(inside));
}

void KMeansTree::search(const float* query, int checks, TreeVisitor& visitor) const {
  Results<float> results(visitor, inside_->widening);
  inside_->tree.findNeighbors(results, query, flann::SearchParams(checks));
}

}  // namespace moduli
