#pragma once

#include <atomic>
#include <cmath>
#include <cstring>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "server/store/search.h"
#include "server/store/sqlite_catalog.h"
#include "tests/server/store/store_testing.h"

/// A store of shapes whose signatures are a few numbers, and searches in it.
namespace moduli {

using Doubles = std::vector<double>;

// In these tests a signature's bytes are its vector in double precision.
inline std::string encode(const Doubles& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(double)};
}

inline Doubles decode(const std::string& bytes) {
  Doubles values(bytes.size() / sizeof(double));
  std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

inline double euclidean(const Doubles& a, const Doubles& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum);
}

// The conformal distance of these tests: nothing that the vectors tell.
inline double hashed(const Doubles& a, const Doubles& b) {
  return std::abs(std::remainder(1000 * (a[0] - b[0]) + 377 * (a[1] - b[1]), 1.0));
}

inline std::string numbered(char letter, int number) {
  std::string name(1, letter);
  name += std::to_string(number);
  return name;
}

inline std::vector<float> rounded(const Doubles& values) {
  return {values.begin(), values.end()};
}

class SearchTest : public testing::Test {
 protected:
  void SetUp() override {
    auto opened = SqliteCatalog::open(folder_.path() / "catalog.sqlite");
    ASSERT_OK(opened);
    catalog_ = *std::move(opened);
    ASSERT_OK(catalog_->createCollection("c", ""));
    Context context;
    auto keeper = IndexKeeper::open(context, *catalog_, {});
    ASSERT_OK(keeper);
    keeper_ = *std::move(keeper);
  }

  void put(const std::string& name, const Doubles& values, const std::string& type = "TORUS") {
    ShapeRecord shape = sampleShape("c", name);
    shape.topology.type = type;
    shape.topology.genus = static_cast<int>(name.size() % 3);
    shape.signature = encode(values);
    const bool sphere = type == "SPHERE";
    shape.vectors = {sphere ? std::vector<float>() : rounded(values), rounded(values),
                     rounded(values)};
    ASSERT_OK(catalog_->putShape(shape, OnExists::kReplace));
    stored_[name] = {values, shape};
  }

  SearchQuery query(Space space, const Doubles& values, std::size_t k,
                    const std::string& filter = "") {
    SearchQuery query;
    query.collection = "c";
    query.space = space;
    query.type = "TORUS";
    query.vector = rounded(values);
    query.k = k;
    query.filter = *Filter::parse(filter);
    query.read = [this](const ShapeRecord& shape) -> Result<Signature> {
      ++read_;
      Signature signature;
      signature.conformal.emplace().length_spectrum = decode(shape.signature);
      return signature;
    };
    query.distance = [values, space](const Signature& shape) -> std::optional<double> {
      const Doubles& other = shape.conformal->length_spectrum;
      return space == Space::kConformal ? hashed(values, other) : euclidean(values, other);
    };
    return query;
  }

  std::vector<std::pair<double, std::string>> found(const SearchQuery& query, bool exact = true) {
    EXPECT_OK(keeper_->refresh());
    read_ = 0;
    Context context;
    const auto answer = searchShapes(context, *catalog_, *keeper_, query);
    EXPECT_OK(answer);
    std::vector<std::pair<double, std::string>> hits;
    if (!answer.ok()) return hits;
    EXPECT_EQ(answer->exact, exact);
    for (const SearchHit& hit : answer->hits) hits.emplace_back(hit.distance, hit.name);
    return hits;
  }

  // By looking at every shape.
  std::vector<std::pair<double, std::string>> wanted(Space space, const Doubles& values,
                                                     std::size_t k,
                                                     const std::string& filter = "") {
    std::vector<std::pair<double, std::string>> all;
    const Filter condition = *Filter::parse(filter);
    for (const auto& [name, entry] : stored_) {
      const auto& [other, shape] = entry;
      if (!condition.matches(shape)) continue;
      if (space == Space::kConformal && shape.topology.type != "TORUS") continue;
      all.emplace_back(
          space == Space::kConformal ? hashed(values, other) : euclidean(values, other), name);
    }
    std::sort(all.begin(), all.end());
    all.resize(std::min(k, all.size()));
    return all;
  }

  TemporaryFolder folder_;
  std::unique_ptr<Catalog> catalog_;
  std::unique_ptr<IndexKeeper> keeper_;
  std::map<std::string, std::pair<Doubles, ShapeRecord>> stored_;
  std::atomic<int> read_ = 0;
};

}  // namespace moduli
