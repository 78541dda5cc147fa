#include "server/store/search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <tuple>
#include <unordered_set>
#include <utility>

#include "core/base/log.h"

namespace moduli {
namespace {

constexpr std::size_t kReadAtOnce = 16;
constexpr int kAttempts = 3;

using Accept = std::function<bool(std::int64_t)>;

bool comesBefore(const SearchHit& a, const SearchHit& b) {
  return std::tie(a.distance, a.name) < std::tie(b.distance, b.name);
}

/// The first k hits of those shown, by distance and name.
class BestHits {
 public:
  explicit BestHits(std::size_t k) : k_(k) {}

  void add(SearchHit hit) {
    // A shape that was replaced during the search can turn up twice; the later row counts.
    for (auto it = hits_.begin(); it != hits_.end(); ++it) {
      if (it->name != hit.name) continue;
      if (it->id >= hit.id) return;
      hits_.erase(it);
      break;
    }
    const auto place = std::upper_bound(hits_.begin(), hits_.end(), hit, comesBefore);
    if (place == hits_.end() && hits_.size() == k_) return;
    hits_.insert(place, std::move(hit));
    if (hits_.size() > k_) hits_.pop_back();
  }

  bool full() const { return hits_.size() == k_; }
  double worst() const { return hits_.back().distance; }
  std::vector<SearchHit> take() { return std::move(hits_); }

 private:
  std::size_t k_;
  std::vector<SearchHit> hits_;
};

/// How far the distance of two float32 vectors can be from that of the double ones they were
/// rounded from. Rounding moves a vector x by at most 2^-24 |x| (and next to nothing where
/// components underflow); the stored one is no longer than |query| + distance. Twice that covers
/// the rounding of the sums.
class RoundingBound {
 public:
  explicit RoundingBound(std::span<const float> query) {
    double sum = 0;
    for (const float value : query) sum += static_cast<double>(value) * value;
    norm_ = std::sqrt(sum);
  }
  double at(double distance) const {
    return std::ldexp(2 * norm_ + distance, -23) + std::numeric_limits<float>::min();
  }

 private:
  double norm_ = 0;
};

class Search {
 public:
  Search(Context& context, const Catalog& catalog, const IndexKeeper& keeper,
         const SearchQuery& query)
      : context_(context), catalog_(catalog), keeper_(keeper), query_(query), best_(query.k) {}

  Result<SearchAnswer> run() {
    if (query_.k == 0) return Status(Reason::kInvalidOption, "k is at least 1");
    ASSIGN_OR_RETURN(collection_, catalog_.getCollection(query_.collection));
    if (query_.space == Space::kConformal &&
        (query_.type == conformalTypeName(ConformalType::kSphere) ||
         query_.type == conformalTypeName(ConformalType::kDisk))) {
      return firstOfClass();
    }
    RETURN_IF_ERROR(applyFilter());
    for (int attempt = 1;; ++attempt) {
      best_ = BestHits(query_.k);
      seen_.clear();
      exact_ = true;
      vanished_ = false;
      RETURN_IF_ERROR(query_.space == Space::kConformal ? compareAll() : widen());
      // A candidate that is gone may have been replaced, and its successor overlooked.
      if (!vanished_ || attempt == kAttempts) return SearchAnswer{best_.take(), exact_};
    }
  }

 private:
  // All spheres are conformally the same, and all disks: the first names win.
  Result<SearchAnswer> firstOfClass() {
    SearchAnswer answer;
    const auto take = [&](const ShapeRecord& shape) {
      if (shape.topology.type == query_.type &&
          shape.descriptor_version == query_.descriptor_version) {
        answer.hits.push_back({shape.name, shape.label, 0, shape.id});
      }
      return answer.hits.size() < query_.k;
    };
    RETURN_IF_ERROR(catalog_.scanShapes(context_, query_.collection, query_.filter, take));
    return answer;
  }

  Status applyFilter() {
    if (query_.filter.matchesAll()) return {};
    RETURN_IF_ERROR(catalog_.scanShapes(context_, query_.collection, query_.filter,
                                        [&](const ShapeRecord& shape) {
                                          passing_.insert(shape.id);
                                          return true;
                                        }));
    accept_ = [this](std::int64_t id) { return passing_.contains(id); };
    return {};
  }

  Result<std::vector<Neighbor>> candidates(std::size_t count) {
    return keeper_.search(context_, collection_.id, query_.space, query_.type, query_.vector, count,
                          accept_);
  }

  // The vectors only hint at the distance: every candidate has to be compared.
  Status compareAll() {
    ASSIGN_OR_RETURN(std::vector<Neighbor> found, candidates(query_.exhaustive_limit + 1));
    if (found.size() > query_.exhaustive_limit) {
      exact_ = false;
      found.pop_back();
    }
    for (std::size_t i = 0; i < found.size(); i += kReadAtOnce) {
      RETURN_IF_ERROR(
          compare(std::span(found).subspan(i, std::min(kReadAtOnce, found.size() - i)), nullptr));
    }
    return {};
  }

  // The vectors' distance is the true one but for rounding: compares by ascending vector distance
  // until no later candidate, known or not, can come before the k-th hit.
  Status widen() {
    const RoundingBound bound(query_.vector);
    for (std::size_t count = query_.k + kReadAtOnce;; count *= 2) {
      ASSIGN_OR_RETURN(const std::vector<Neighbor> found, candidates(count));
      for (std::size_t i = 0; i < found.size(); i += kReadAtOnce) {
        if (best_.full() && found[i].distance - bound.at(found[i].distance) > best_.worst()) {
          return {};
        }
        RETURN_IF_ERROR(
            compare(std::span(found).subspan(i, std::min(kReadAtOnce, found.size() - i)), &bound));
      }
      if (found.size() < count) return {};
    }
  }

  // Shows the true distances of candidates to best_. With a bound, checks it on the way.
  Status compare(std::span<const Neighbor> neighbors, const RoundingBound* bound) {
    RETURN_IF_ERROR(context_.check());
    std::map<std::int64_t, double> fresh;
    std::vector<std::int64_t> ids;
    for (const Neighbor& neighbor : neighbors) {
      if (!seen_.insert(neighbor.id).second) continue;
      fresh.emplace(neighbor.id, neighbor.distance);
      ids.push_back(neighbor.id);
    }
    ASSIGN_OR_RETURN(std::vector<ShapeRecord> shapes,
                     catalog_.getShapesById(ids, ShapeView::kFull));
    if (shapes.size() < ids.size()) vanished_ = true;
    for (ShapeRecord& shape : shapes) {
      const Result<std::optional<double>> distance = query_.distance(shape);
      if (!distance.ok()) {
        RETURN_IF_ERROR(skip(shape, distance.status()));
        continue;
      }
      if (!*distance) continue;
      const double stand_in = fresh[shape.id];
      if (bound != nullptr && std::abs(**distance - stand_in) > bound->at(stand_in)) {
        log(LogLevel::kWarning, "the vector of shape \"" + shape.name + "\" of collection \"" +
                                    shape.collection + "\" is not that of its signature");
        exact_ = false;
      }
      best_.add({std::move(shape.name), std::move(shape.label), **distance, shape.id});
    }
    return {};
  }

  Status skip(const ShapeRecord& shape, const Status& why) {
    if (why.reason() == Reason::kCancelled || why.reason() == Reason::kDeadlineExceeded) return why;
    log(LogLevel::kWarning, "shape \"" + shape.name + "\" of collection \"" + shape.collection +
                                "\" cannot be compared: " + why.toString());
    exact_ = false;
    return {};
  }

  Context& context_;
  const Catalog& catalog_;
  const IndexKeeper& keeper_;
  const SearchQuery& query_;
  CollectionRecord collection_;
  std::unordered_set<std::int64_t> passing_;
  Accept accept_;
  BestHits best_;
  std::unordered_set<std::int64_t> seen_;
  bool exact_ = true;
  bool vanished_ = false;
};

}  // namespace

Result<SearchAnswer> searchShapes(Context& context, const Catalog& catalog,
                                  const IndexKeeper& keeper, const SearchQuery& query) {
  return Search(context, catalog, keeper, query).run();
}

}  // namespace moduli
