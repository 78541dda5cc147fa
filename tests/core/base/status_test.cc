#include "core/base/status.h"

#include <memory>
#include <set>

#include "tests/core/testing.h"

namespace moduli {
namespace {

TEST(Reason, NamesAreStableUniqueAndReadBack) {
  std::set<std::string> names;
  for (int i = 0; i <= static_cast<int>(Reason::kInternal); ++i) {
    const auto reason = static_cast<Reason>(i);
    const std::string name(reasonName(reason));
    EXPECT_TRUE(names.insert(name).second) << name << " stands twice";
    EXPECT_EQ(reasonFromName(name), reason);
    EXPECT_LE(name.size(), 63U);
    EXPECT_EQ(name.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ_"), std::string::npos) << name;
  }
}

TEST(Reason, AnUnknownNameIsInternal) {
  EXPECT_EQ(reasonFromName("NO_SUCH_REASON"), Reason::kInternal);
}

TEST(Reason, OnlyOkHasTheCodeOk) {
  for (int i = 1; i <= static_cast<int>(Reason::kInternal); ++i) {
    EXPECT_NE(reasonCode(static_cast<Reason>(i)), ErrorCode::kOk);
  }
}

TEST(Status, ContextGoesBeforeTheMessageAndKeepsTheReason) {
  const Status status(Reason::kFoldedMap, "3 faces are folded", "try --repair");
  const Status outer = status.withContext("spot.obj");
  EXPECT_EQ(outer.reason(), Reason::kFoldedMap);
  EXPECT_EQ(outer.toString(), "FOLDED_MAP: spot.obj: 3 faces are folded; try --repair");
  EXPECT_OK(Status().withContext("spot.obj"));
}

Result<int> half(int value) {
  if (value % 2 != 0) return Status(Reason::kInvalidOption, "odd");
  return value / 2;
}

Result<int> quarter(int value) {
  ASSIGN_OR_RETURN(const int once, half(value));
  ASSIGN_OR_RETURN(const int twice, half(once));
  return twice;
}

Status checkQuarter(int value) {
  RETURN_IF_ERROR(quarter(value).status());
  return {};
}

TEST(Result, FailuresTravelThroughTheMacros) {
  ASSERT_OK(quarter(12));
  EXPECT_EQ(*quarter(12), 3);
  EXPECT_THAT(quarter(6), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(checkQuarter(7), FailsWith(Reason::kInvalidOption));
  EXPECT_OK(checkQuarter(8));
}

TEST(Result, HoldsWhatCanOnlyBeMoved) {
  Result<std::unique_ptr<int>> result(std::make_unique<int>(5));
  ASSERT_OK(result);
  const std::unique_ptr<int> value = *std::move(result);
  EXPECT_EQ(*value, 5);
}

}  // namespace
}  // namespace moduli
