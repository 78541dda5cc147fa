#include <algorithm>
#include <utility>

#include "client/cpp/client_impl.h"
#include "client/cpp/events.h"

namespace moduli {
namespace {

// Of the server: hits of a page; queries of a request, their hits and their bytes (half of what a
// request may have).
constexpr int kMostHitsAtOnce = 1000;
constexpr int kMostQueries = 10'000;
constexpr std::int64_t kMostHits = 1'000'000;
constexpr std::size_t kMostBytes = std::size_t{4} << 20;
constexpr int kUsualHits = 10;

void append(v1::SearchResult page, v1::SearchResult& all) {
  const bool first = all.hits().empty();
  all.set_exact(page.exact() && (first || all.exact()));
  if (page.has_recall()) {
    all.set_recall(std::min(page.recall(), all.has_recall() ? all.recall() : page.recall()));
  }
  for (v1::SearchHit& hit : *page.mutable_hits()) *all.add_hits() = std::move(hit);
}

// From `begin` on as many queries as one request holds.
int takeQueries(const v1::BatchSearchShapesRequest& request, int begin,
                v1::BatchSearchShapesRequest& part) {
  const int k = request.k() > 0 ? request.k() : kUsualHits;
  const auto most =
      static_cast<int>(std::clamp<std::int64_t>(kMostHits / k, 1, std::int64_t{kMostQueries}));
  std::size_t bytes = 0;
  int end = begin;
  for (; end < request.queries_size() && end - begin < most; ++end) {
    bytes += request.queries(end).ByteSizeLong();
    if (end > begin && bytes > kMostBytes) break;
    *part.add_queries() = request.queries(end);
  }
  return end;
}

}  // namespace

Result<v1::SearchResult> Client::search(const v1::SearchShapesRequest& request) {
  v1::SearchShapesRequest page = request;
  if (request.k() > kMostHitsAtOnce && request.has_source()) {
    v1::ComputeSignatureRequest sign;
    *sign.mutable_source() = request.source();
    *sign.mutable_prepare() = request.prepare();
    sign.set_space(request.space() == v1::Signature::SPACE_UNSPECIFIED ? v1::Signature::SHAPE
                                                                       : request.space());
    ASSIGN_OR_RETURN(*page.mutable_signature(), computeSignature(sign));
    page.clear_prepare();
  }
  v1::SearchResult all;
  do {
    v1::SearchShapesResponse answer;
    RETURN_IF_ERROR(impl_->runner.run(true, [&](grpc::ClientContext& context) {
      const auto reader = impl_->catalog->SearchShapes(&context, page);
      return readEvents<v1::SearchShapesResponse>(impl_->runner, *reader, [&](auto& response) {
        answer.Swap(&response);
        return true;
      });
    }));
    page.set_page_token(answer.next_page_token());
    append(std::move(*answer.mutable_result()), all);
  } while (!page.page_token().empty());
  return all;
}

Result<std::vector<v1::QueryResult>> Client::searchMany(
    const v1::BatchSearchShapesRequest& request) {
  v1::BatchSearchShapesRequest rest = request;
  rest.clear_queries();
  std::vector<v1::QueryResult> results;
  for (int begin = 0; begin < request.queries_size();) {
    v1::BatchSearchShapesRequest part = rest;
    const int end = takeQueries(request, begin, part);
    std::vector<v1::QueryResult> some;
    RETURN_IF_ERROR(impl_->runner.run(true, [&](grpc::ClientContext& context) {
      some.clear();  // Of an attempt that broke off.
      const auto reader = impl_->catalog->BatchSearchShapes(&context, part);
      return readEvents<v1::BatchSearchShapesResponse>(impl_->runner, *reader, [&](auto& response) {
        some.push_back(std::move(*response.mutable_result()));
        return some.size() == static_cast<std::size_t>(end - begin);
      });
    }));
    std::move(some.begin(), some.end(), std::back_inserter(results));
    begin = end;
  }
  return results;
}

}  // namespace moduli
