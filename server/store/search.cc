#include "server/store/search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <unordered_set>
#include <utility>

#include "core/base/log.h"
#include "server/store/best_hits.h"

namespace moduli {
namespace {

constexpr std::size_t kReadAtOnce = 16;
// Neighbours asked for beyond the hits wanted: one tells that there are more, the next one that it
// comes later.
constexpr std::size_t kBeyond = 4;
constexpr int kAttempts = 3;
// Shapes that a batch keeps in memory, some kilobytes each, and queries that it takes together.
constexpr std::size_t kRemembered = 30000;
constexpr std::size_t kLargestBlock = 256;

using Accept = std::function<bool(std::int64_t)>;

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

/// What all queries of a batch share.
struct Place {
  const Catalog& catalog;
  const IndexKeeper& keeper;
  CollectionRecord collection;
  std::unordered_set<std::int64_t> passing;  ///< The filter, if there is one.
  Accept accept;

  static Result<std::unique_ptr<Place>> find(Context& context, const Catalog& catalog,
                                             const IndexKeeper& keeper, const SearchQuery& query) {
    if (query.k == 0) return Status(Reason::kInvalidOption, "k is at least 1");
    auto place = std::make_unique<Place>(Place{catalog, keeper, {}, {}, {}});
    ASSIGN_OR_RETURN(place->collection, catalog.getCollection(query.collection));
    if (query.filter.matchesAll() || isOneClass(query)) return place;
    RETURN_IF_ERROR(
        catalog.scanShapes(context, query.collection, query.filter, [&](const ShapeRecord& shape) {
          place->passing.insert(shape.id);
          return true;
        }));
    place->accept = [&passing = place->passing](std::int64_t id) { return passing.contains(id); };
    return place;
  }

  /// All spheres are conformally the same, and all disks.
  static bool isOneClass(const SearchQuery& query) {
    return query.space == Space::kConformal &&
           (query.type == conformalTypeName(ConformalType::kSphere) ||
            query.type == conformalTypeName(ConformalType::kDisk));
  }
};

/// As many neighbours as usually hold the page.
std::size_t firstCount(const SearchQuery& query) {
  return (query.after ? query.after->count : 0) + query.k + kBeyond;
}

class Search {
 public:
  Search(Context& context, const Place& place, CandidateShapes& shapes, const SearchQuery& query)
      : context_(context),
        place_(place),
        shapes_(shapes),
        query_(query),
        best_(query.k + 1, query.after) {}

  /// first: the nearest firstCount(query) rows, if they are known (metric and shape space).
  Result<SearchAnswer> run(const NearestRows* first = nullptr) {
    if (Place::isOneClass(query_)) return firstOfClass();
    for (int attempt = 1;; ++attempt) {
      best_ = BestHits(query_.k + 1, query_.after);
      seen_.clear();
      exact_ = true;
      recall_.reset();
      vanished_ = false;
      RETURN_IF_ERROR(query_.space == Space::kConformal ? compareAll() : widen(first));
      // A candidate that is gone may have been replaced, and its successor overlooked.
      if (!vanished_ || attempt == kAttempts) return finished(best_.take());
      first = nullptr;
    }
  }

 private:
  // One hit more than wanted tells that there are more.
  SearchAnswer finished(std::vector<SearchHit> hits) const {
    SearchAnswer answer{std::move(hits), exact_, recall_};
    answer.more = answer.hits.size() > query_.k;
    if (answer.more) answer.hits.pop_back();
    return answer;
  }

  // The first names win.
  Result<SearchAnswer> firstOfClass() {
    std::vector<SearchHit> hits;
    const auto take = [&](const ShapeRecord& shape) {
      const bool earlier = query_.after && shape.name <= query_.after->name;
      if (!earlier && shape.topology.type == query_.type &&
          shape.descriptor_version == query_.descriptor_version) {
        hits.push_back({shape.name, shape.label, 0, shape.id});
      }
      return hits.size() <= query_.k;
    };
    RETURN_IF_ERROR(place_.catalog.scanShapes(context_, query_.collection, query_.filter, take));
    return finished(std::move(hits));
  }

  Result<std::vector<Neighbor>> candidates(std::size_t count) {
    ASSIGN_OR_RETURN(NearestRows found,
                     place_.keeper.search(context_, place_.collection.id, query_.space, query_.type,
                                          query_.vector, count, place_.accept));
    note(found);
    return std::move(found.neighbors);
  }

  void note(const NearestRows& found) {
    if (!found.recall) return;
    exact_ = false;
    recall_ = std::min(recall_.value_or(1), *found.recall);
  }

  // The vectors only hint at the distance: every candidate has to be compared.
  Status compareAll() {
    const std::size_t limit = query_.exhaustive_limit;
    std::size_t count = limit + 1;
    ASSIGN_OR_RETURN(std::vector<Neighbor> found, candidates(count));
    // Which rows are taken must not depend on ids: all that are as near as the last one, then.
    const auto tied = [&] {
      return found.size() == count && found.back().distance == found[limit - 1].distance;
    };
    while (tied()) {
      count *= 2;
      ASSIGN_OR_RETURN(found, candidates(count));
    }
    if (found.size() > limit) {
      const double last = found[limit - 1].distance;
      const auto beyond = std::find_if(found.begin(), found.end(),
                                       [&](const Neighbor& row) { return row.distance > last; });
      if (beyond != found.end()) exact_ = false;
      found.erase(beyond, found.end());
    }
    return compareFrom(found, 0, nullptr);
  }

  // The vectors' distance is the true one but for rounding: compares by ascending vector distance
  // until no later candidate, known or not, can come before the k-th hit.
  Status widen(const NearestRows* first) {
    const RoundingBound bound(query_.vector);
    for (std::size_t count = firstCount(query_);; count *= 2) {
      std::vector<Neighbor> found;
      if (first != nullptr) {
        note(*first);
        found = first->neighbors;
        first = nullptr;
      } else {
        ASSIGN_OR_RETURN(found, candidates(count));
      }
      RETURN_IF_ERROR(compareFrom(found, hitsBefore(found, bound), &bound));
      if (done_ || found.size() < count) return {};
    }
  }

  // How many of the candidates are surely before the page.
  std::size_t hitsBefore(const std::vector<Neighbor>& found, const RoundingBound& bound) const {
    if (!query_.after) return 0;
    const auto begin = std::partition_point(found.begin(), found.end(), [&](const Neighbor& row) {
      return row.distance + bound.at(row.distance) < query_.after->distance;
    });
    return static_cast<std::size_t>(begin - found.begin());
  }

  // From candidate i on. With a bound, ends when no later one can count any more: done_.
  Status compareFrom(const std::vector<Neighbor>& found, std::size_t i,
                     const RoundingBound* bound) {
    const auto beyond = [&](const Neighbor& row) {
      return bound != nullptr && best_.full() &&
             row.distance - bound->at(row.distance) > best_.worst();
    };
    for (; i < found.size() && !beyond(found[i]); i += kReadAtOnce) {
      RETURN_IF_ERROR(
          compare(std::span(found).subspan(i, std::min(kReadAtOnce, found.size() - i)), bound));
    }
    done_ = !found.empty() && beyond(found.back());
    return {};
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
    ASSIGN_OR_RETURN(const CandidateShapes::Shapes shapes, shapes_.get(context_, ids));
    if (shapes.size() < ids.size()) vanished_ = true;
    for (const auto& shape : shapes) {
      if (!shape->status.ok()) {
        exact_ = false;
        continue;
      }
      const std::optional<double> distance = query_.distance(shape->signature);
      if (!distance) continue;
      const double stand_in = fresh[shape->id];
      if (bound != nullptr && std::abs(*distance - stand_in) > bound->at(stand_in)) {
        log(LogLevel::kWarning, "the vector of shape \"" + shape->name + "\" of collection \"" +
                                    query_.collection + "\" is not that of its signature");
        exact_ = false;
      }
      if (best_.wants(*distance, shape->name) || best_.has(shape->name)) {
        best_.add(hitOf(*shape, *distance));
      }
    }
    return {};
  }

  SearchHit hitOf(const CandidateShape& shape, double distance) const {
    SearchHit hit{shape.name, shape.label, distance, shape.id};
    if (query_.explain) hit.parts = query_.explain(shape.signature);
    return hit;
  }

  Context& context_;
  const Place& place_;
  CandidateShapes& shapes_;
  const SearchQuery& query_;
  BestHits best_;
  std::unordered_set<std::int64_t> seen_;
  bool exact_ = true;
  std::optional<double> recall_;
  bool vanished_ = false;
  bool done_ = false;
};

/// Many queries at one place.
class Batch {
 public:
  Batch(Context& context, const Place& place, std::span<const SearchQuery> queries)
      : context_(context),
        place_(place),
        queries_(queries),
        shapes_(place.catalog, queries.front().read, kRemembered) {}

  Result<std::vector<SearchAnswer>> run() {
    // As many as have their candidates remembered together.
    const std::size_t block =
        std::clamp<std::size_t>(kRemembered / firstCount(queries_.front()), 1, kLargestBlock);
    for (std::size_t begin = 0; begin < queries_.size(); begin += block) {
      RETURN_IF_ERROR(runBlock(queries_.subspan(begin, std::min(block, queries_.size() - begin))));
      context_.report("search",
                      static_cast<double>(answers_.size()) / static_cast<double>(queries_.size()));
    }
    return std::move(answers_);
  }

 private:
  Status runBlock(std::span<const SearchQuery> block) {
    std::vector<NearestRows> first;
    if (haveOneIndex(block)) {
      std::vector<std::vector<float>> vectors;
      for (const SearchQuery& query : block) vectors.push_back(query.vector);
      ASSIGN_OR_RETURN(first,
                       place_.keeper.searchMany(context_, place_.collection.id, block.front().space,
                                                vectors, firstCount(block.front()), place_.accept));
      RETURN_IF_ERROR(readFirst(first));
    }
    for (std::size_t q = 0; q < block.size(); ++q) {
      ASSIGN_OR_RETURN(SearchAnswer answer,
                       answerOf(block[q], first.empty() ? nullptr : &first[q]));
      answers_.push_back(std::move(answer));
    }
    return {};
  }

  static bool haveOneIndex(std::span<const SearchQuery> block) {
    return block.front().space != Space::kConformal &&
           std::all_of(block.begin(), block.end(), [&](const SearchQuery& query) {
             return query.vector.size() == block.front().vector.size();
           });
  }

  // So that they are read together.
  Status readFirst(const std::vector<NearestRows>& first) {
    std::vector<std::int64_t> ids;
    for (const NearestRows& found : first) {
      for (const Neighbor& neighbor : found.neighbors) ids.push_back(neighbor.id);
    }
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
    return shapes_.get(context_, ids).status();
  }

  Result<SearchAnswer> answerOf(const SearchQuery& query, const NearestRows* first) {
    if (!Place::isOneClass(query)) return Search(context_, place_, shapes_, query).run(first);
    const auto known = of_class_.find(query.type);
    if (known != of_class_.end()) return known->second;
    ASSIGN_OR_RETURN(SearchAnswer answer, Search(context_, place_, shapes_, query).run());
    return of_class_.emplace(query.type, std::move(answer)).first->second;
  }

  Context& context_;
  const Place& place_;
  const std::span<const SearchQuery> queries_;
  CandidateShapes shapes_;
  std::map<std::string, SearchAnswer> of_class_;
  std::vector<SearchAnswer> answers_;
};

}  // namespace

Result<SearchAnswer> searchShapes(Context& context, const Catalog& catalog,
                                  const IndexKeeper& keeper, const SearchQuery& query) {
  ASSIGN_OR_RETURN(const auto place, Place::find(context, catalog, keeper, query));
  CandidateShapes shapes(catalog, query.read, 0);
  return Search(context, *place, shapes, query).run();
}

Result<std::vector<SearchAnswer>> searchShapesMany(Context& context, const Catalog& catalog,
                                                   const IndexKeeper& keeper,
                                                   std::span<const SearchQuery> queries) {
  if (queries.empty()) return std::vector<SearchAnswer>();
  ASSIGN_OR_RETURN(const auto place, Place::find(context, catalog, keeper, queries.front()));
  return Batch(context, *place, queries).run();
}

}  // namespace moduli
