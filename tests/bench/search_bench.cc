// Vector search beside FLANN's linear index in the same run, on vectors as signatures are.
//
//   moduli_search_bench [--rows N] [--dimension D] [--queries Q] [--decay A] [--spread S]
//
// Without --rows: 1e4, 1e5 and 1e6; without --dimension: 32, 64 and 130. Times are those of all
// cores together (a search's p50 and p95 too), in milliseconds; ratios are of the means against the
// linear index. Every exact answer is compared with looking at every row.
#include <flann/algorithms/dist.h>
#include <flann/algorithms/linear_index.h>
#include <malloc.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <numeric>
#include <string>
#include <thread>
#include <vector>

#include "core/retrieval/approximate_index.h"
#include "core/retrieval/vector_index.h"
#include "server/store/live_index.h"
#include "tests/bench/signature_vectors.h"

namespace moduli::bench {
namespace {

constexpr std::size_t kNeighbors = 10;

struct Options {
  std::vector<std::size_t> rows{10000, 100000, 1000000};
  std::vector<std::size_t> dimensions{32, 64, 130};
  std::size_t queries = 256;
  SignatureVectors::Options vectors;
};

double coreSeconds() {
  timespec time;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// Of this thread alone: what it does, without what other programs take from it.
double threadSeconds() {
  timespec time;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double wallSeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Of what malloc gave out and did not get back.
double heapBytes() {
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks + info.hblkhd);
}

template <typename T>
T must(Result<T> result) {
  if (result.ok()) return *std::move(result);
  std::fprintf(stderr, "%s\n", result.status().toString().c_str());
  std::exit(1);
}

/// Milliseconds.
struct Times {
  std::vector<double> each;

  double share(double part) {
    std::sort(each.begin(), each.end());
    return each[static_cast<std::size_t>(part * static_cast<double>(each.size() - 1))];
  }
  double mean() const {
    return std::accumulate(each.begin(), each.end(), 0.0) / static_cast<double>(each.size());
  }
};

template <typename Search>
Times timed(std::size_t queries, double (*clock)(), const Search& search) {
  Times times;
  for (std::size_t q = 0; q < queries; ++q) {
    const double start = clock();
    search(q);
    times.each.push_back(1e3 * (clock() - start));
  }
  return times;
}

using Queries = std::vector<std::vector<float>>;
using Answers = std::vector<std::vector<Neighbor>>;

Times timeLinear(VectorSet& set, Queries queries) {
  const flann::Matrix<float> rows(set.values.data(), set.ids.size(), set.dimension);
  flann::LinearIndex<flann::L2<float>> index(rows);
  index.buildIndex();
  return timed(std::min<std::size_t>(queries.size(), 64), coreSeconds, [&](std::size_t q) {
    float distances[kNeighbors];
    std::size_t found[kNeighbors];
    flann::Matrix<float> distance_row(distances, 1, kNeighbors);
    flann::Matrix<std::size_t> found_row(found, 1, kNeighbors);
    index.knnSearch(flann::Matrix<float>(queries[q].data(), 1, set.dimension), found_row,
                    distance_row, kNeighbors, flann::SearchParams(-1));
  });
}

/// What an index takes to make.
struct Made {
  double seconds = 0;
  double bytes = 0;  ///< With its rows, over those of the vectors.
};

template <typename Make>
auto made(const VectorSet& set, Made& cost, const Make& make) {
  const double bytes = heapBytes(), start = wallSeconds();
  auto index = make(set);
  cost.seconds = wallSeconds() - start;
  cost.bytes = (heapBytes() - bytes) / (4.0 * static_cast<double>(set.values.size()));
  return index;
}

double recallOf(const Answers& found, const Answers& truth) {
  std::size_t right = 0, all = 0;
  for (std::size_t q = 0; q < truth.size(); ++q) {
    all += truth[q].size();
    for (const Neighbor& neighbor : found[q]) {
      right += neighbor.distance <= truth[q].back().distance ? 1 : 0;
    }
  }
  return static_cast<double>(right) / static_cast<double>(all);
}

/// The worst of the same searches of a changing index, in milliseconds.
struct Worst {
  double wall = 0;
  double thread = 0;

  template <typename Search>
  static Worst of(const Search& search) {
    constexpr std::size_t kSearches = 2000;
    Worst worst;
    worst.wall = timed(kSearches, wallSeconds, search).share(1);
    worst.thread = timed(kSearches, threadSeconds, search).share(1);
    return worst;
  }
};

struct Adding {
  Worst still;   ///< While nothing changes.
  Worst adding;  ///< While rows come in and are folded in.
  std::size_t added = 0;
  std::size_t rebuilt = 0;
  double bytes = 0;
};

Adding timeAdding(VectorSet set, SignatureVectors& vectors, const Queries& queries) {
  Adding result;
  const std::size_t count = set.ids.size();
  const double vector_bytes = 4.0 * static_cast<double>(set.values.size());
  const double bytes = heapBytes() - vector_bytes - 8.0 * static_cast<double>(count);
  const auto index = must(LiveIndex::build(std::move(set), {}));
  result.bytes = (heapBytes() - bytes) / vector_bytes;
  VectorSet fresh = vectors.rows(20000);
  Context context;
  const auto search = [&](std::size_t q) {
    must(index->search(context, queries[q % queries.size()], kNeighbors));
  };
  result.still = Worst::of(search);
  std::atomic<bool> stop = false;
  std::thread rebuilder([&] {
    while (!stop) {
      if (index->rebuildDue() && index->rebuild().ok()) ++result.rebuilt;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
  std::thread adder([&] {
    const std::size_t d = fresh.dimension;
    for (; !stop && result.added < fresh.ids.size(); ++result.added) {
      const auto begin = fresh.values.begin() + static_cast<std::ptrdiff_t>(result.added * d);
      VectorSet one{d,
                    {begin, begin + static_cast<std::ptrdiff_t>(d)},
                    {static_cast<std::int64_t>(count + 1 + result.added)}};
      if (!index->apply(one, {}).ok()) std::abort();
      if (result.added % 8 == 7) std::this_thread::sleep_for(std::chrono::microseconds(500));
    }
  });
  result.adding = Worst::of(search);
  stop = true;
  adder.join();
  rebuilder.join();
  return result;
}

// False if an exact answer was wrong.
bool run(std::size_t rows, std::size_t dimension, const Options& options) {
  SignatureVectors vectors(dimension, options.vectors, 1);
  VectorSet set = vectors.rows(rows);
  const Queries queries = vectors.queries(options.queries);
  Context context;
  Times linear = timeLinear(set, queries);

  Made exact_cost, approximate_cost;
  auto exact = made(set, exact_cost, [](const VectorSet& s) { return must(makeFlannIndex(s)); });
  Answers found(queries.size());
  Times single = timed(queries.size(), coreSeconds, [&](std::size_t q) {
    found[q] = must(exact->search(context, queries[q], kNeighbors));
  });
  Answers together;
  Times batch = timed(1, coreSeconds, [&](std::size_t) {
    together = must(exact->searchMany(context, queries, kNeighbors));
  });
  exact.reset();
  auto brute = must(makeBruteForceIndex(set));
  const Answers truth = must(brute->searchMany(context, queries, kNeighbors));
  brute.reset();

  auto approximate = made(set, approximate_cost, [&](const VectorSet& s) {
    return must(makeApproximateIndex(context, s));
  });
  Answers nearly(queries.size());
  Times few = timed(queries.size(), coreSeconds, [&](std::size_t q) {
    nearly[q] = must(approximate->search(context, queries[q], kNeighbors));
  });
  const MeasuredRecall recall = approximate->recall();
  approximate.reset();
  const Adding adding = timeAdding(std::move(set), vectors, queries);

  std::printf("%zu rows of dimension %zu (decay %g, spread %g)\n", rows, dimension,
              options.vectors.decay, options.vectors.spread);
  std::printf("  linear       p50 %8.3f  p95 %8.3f\n", linear.share(0.5), linear.share(0.95));
  std::printf("  exact        p50 %8.3f  p95 %8.3f  ratio %6.1f (of p50 %6.1f)  %s\n",
              single.share(0.5), single.share(0.95), linear.mean() / single.mean(),
              linear.share(0.5) / single.share(0.5), found == truth ? "identical" : "WRONG");
  std::printf("  batch        each %7.3f                ratio %6.1f  %s\n",
              batch.mean() / static_cast<double>(queries.size()),
              linear.mean() / (batch.mean() / static_cast<double>(queries.size())),
              together == truth ? "identical" : "WRONG");
  std::printf(
      "  approximate  p50 %8.3f  p95 %8.3f  ratio %6.1f (of p50 %6.1f)  recall %.4f, "
      "stated %.4f +- %.4f (%zu tiles)\n",
      few.share(0.5), few.share(0.95), linear.mean() / few.mean(),
      linear.share(0.5) / few.share(0.5), recallOf(nearly, truth), recall.recall,
      recall.standard_error, recall.tiles);
  std::printf(
      "  build        exact %.2f s, %.2f of the vectors' bytes; approximate %.2f s, %.2f; "
      "live %.2f\n",
      exact_cost.seconds, exact_cost.bytes, approximate_cost.seconds, approximate_cost.bytes,
      adding.bytes);
  std::printf(
      "  adding       worst search %.2f ms still, %.2f ms while %zu rows come in (%zu rebuilds); "
      "of its thread's time %.2f and %.2f ms\n\n",
      adding.still.wall, adding.adding.wall, adding.added, adding.rebuilt, adding.still.thread,
      adding.adding.thread);
  std::fflush(stdout);
  return found == truth && together == truth;
}

bool parse(int count, char** words, Options& options) {
  for (int i = 1; i + 1 < count; i += 2) {
    const std::string name = words[i];
    const double value = std::atof(words[i + 1]);
    if (!(value > 0)) return false;
    if (name == "--rows")
      options.rows = {static_cast<std::size_t>(value)};
    else if (name == "--dimension")
      options.dimensions = {static_cast<std::size_t>(value)};
    else if (name == "--queries")
      options.queries = static_cast<std::size_t>(value);
    else if (name == "--decay")
      options.vectors.decay = value;
    else if (name == "--spread")
      options.vectors.spread = value;
    else
      return false;
  }
  return count % 2 == 1;
}

}  // namespace
}  // namespace moduli::bench

int main(int count, char** words) {
  moduli::bench::Options options;
  if (!moduli::bench::parse(count, words, options)) {
    std::fprintf(stderr,
                 "usage: moduli_search_bench [--rows N] [--dimension D] [--queries Q] [--decay A] "
                 "[--spread S]\n");
    return 2;
  }
  bool right = true;
  for (const std::size_t rows : options.rows) {
    for (const std::size_t dimension : options.dimensions) {
      right = moduli::bench::run(rows, dimension, options) && right;
    }
  }
  return right ? 0 : 1;
}
