#include "server/service/access.h"

#include "core/base/digest.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

AccessList twoTokens() {
  const Result<AccessList> list =
      AccessList::parse("# who may do what\n\n" + sha256Hex("reading") + " reader\n" +
                            sha256Hex("ruling") + "  admin  # the boss\n",
                        "tokens");
  EXPECT_OK(list);
  return *list;
}

TEST(AccessList, WithoutTokensEverybodyMayDoEverything) {
  EXPECT_OK(AccessList().check("", Role::kAdmin));
}

TEST(AccessList, ARoleMayDoWhatTheLesserOnesMay) {
  const AccessList list = twoTokens();
  EXPECT_OK(list.check("Bearer reading", Role::kReader));
  EXPECT_THAT(list.check("Bearer reading", Role::kWriter), FailsWith(Reason::kPermissionDenied));
  EXPECT_OK(list.check("Bearer ruling", Role::kReader));
  EXPECT_OK(list.check("Bearer ruling", Role::kWriter));
  EXPECT_OK(list.check("Bearer ruling", Role::kAdmin));
}

TEST(AccessList, UnknownMissingAndBareTokensAreTurnedAway) {
  const AccessList list = twoTokens();
  for (const char* header : {"", "reading", "Bearer ", "Bearer wrong", "Basic reading"}) {
    EXPECT_THAT(list.check(header, Role::kReader), FailsWith(Reason::kUnauthenticated)) << header;
  }
  // Who has stolen the file of hashes has no token yet.
  EXPECT_THAT(list.check("Bearer " + sha256Hex("reading"), Role::kReader),
              FailsWith(Reason::kUnauthenticated));
}

TEST(AccessList, AWrongLineIsNamed) {
  for (const std::string& line : {sha256Hex("x"), sha256Hex("x") + " owner",
                                  std::string("abc reader"), sha256Hex("x") + " reader more"}) {
    const Result<AccessList> list = AccessList::parse("# first\n" + line, "tokens");
    EXPECT_THAT(list, FailsWith(Reason::kInvalidConfiguration)) << line;
    EXPECT_THAT(list.status().message(), testing::HasSubstr("tokens:2:")) << line;
  }
  EXPECT_THAT(AccessList::parse("# nobody\n", "tokens"), FailsWith(Reason::kInvalidConfiguration));
}

}  // namespace
}  // namespace moduli
