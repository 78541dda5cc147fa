#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/status.h"

namespace moduli {

template <typename Item>
struct ListPage {
  std::vector<Item> items;
  std::string next_token;  ///< "": this was the last page.
};

/// Walks a list of any length, page by page:
///
///   Pager<v1::Shape> shapes = client.listShapes("collections/cups", "");
///   while (true) {
///     ASSIGN_OR_RETURN(const std::optional<v1::Shape> shape, shapes.next());
///     if (!shape) break;
///     use(*shape);
///   }
///
/// Not thread-safe; must not outlive its client.
template <typename Item>
class Pager {
 public:
  using Fetch = std::function<Result<ListPage<Item>>(const std::string& token)>;

  explicit Pager(Fetch fetch) : fetch_(std::move(fetch)) {}

  /// The next item; nothing after the last one. Asks for a page when the one at hand is used up.
  Result<std::optional<Item>> next() {
    while (position_ == page_.items.size()) {
      if (started_ && page_.next_token.empty()) return std::optional<Item>();
      ASSIGN_OR_RETURN(page_, fetch_(page_.next_token));
      started_ = true;
      position_ = 0;
    }
    return std::optional<Item>(std::move(page_.items[position_++]));
  }

 private:
  Fetch fetch_;
  ListPage<Item> page_;
  std::size_t position_ = 0;
  bool started_ = false;
};

}  // namespace moduli
