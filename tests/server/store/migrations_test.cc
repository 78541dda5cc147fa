#include "server/store/migrations.h"

#include "server/store/sqlite_catalog.h"
#include "tests/server/store/store_testing.h"

namespace moduli {
namespace {

using testing::HasSubstr;

TEST(Migrations, AreNumberedFromOneWithoutGaps) {
  int expected = 1;
  for (const Migration& migration : allMigrations()) EXPECT_EQ(migration.number, expected++);
  EXPECT_GT(expected, 1);
}

class MigrationTest : public testing::Test {
 protected:
  void SetUp() override {
    auto opened =
        SqliteConnection::open(folder_.path() / "m.sqlite", SqliteConnection::Mode::kReadWrite);
    ASSERT_OK(opened);
    connection_ = *std::move(opened);
  }
  std::int64_t number(std::string_view sql) {
    const auto value = connection_->integerOf(sql);
    EXPECT_OK(value);
    return value.ok() ? *value : -1;
  }
  TemporaryFolder folder_;
  std::unique_ptr<SqliteConnection> connection_;
};

TEST_F(MigrationTest, AnOldStoreIsBroughtUpToDateStepByStep) {
  const Migration steps[] = {
      {1, "0001_a", "CREATE TABLE a (x INTEGER); INSERT INTO a VALUES (1)"},
      {2, "0002_b", "ALTER TABLE a ADD COLUMN y INTEGER; UPDATE a SET y = x + 1"},
      {3, "0003_c", "UPDATE a SET y = y * 10"}};
  ASSERT_OK(migrate(*connection_, std::span(steps).first(1)));
  EXPECT_EQ(number("PRAGMA user_version"), 1);
  ASSERT_OK(migrate(*connection_, steps));
  ASSERT_OK(migrate(*connection_, steps));  // Once only.
  EXPECT_EQ(number("SELECT y FROM a"), 20);
  EXPECT_EQ(number("PRAGMA user_version"), 3);
  EXPECT_THAT(migrate(*connection_, std::span(steps).first(2)), FailsWith(Reason::kStoreTooNew));
}

TEST_F(MigrationTest, CollectionsOfTheFirstSchemaAreExact) {
  ASSERT_OK(migrate(*connection_, allMigrations().first(1)));
  ASSERT_OK(connection_->execute("INSERT INTO collections (name, create_time) VALUES ('old', 7)"));
  const auto catalog = SqliteCatalog::open(folder_.path() / "m.sqlite");
  ASSERT_OK(catalog);
  const auto old = (*catalog)->getCollection("old");
  ASSERT_OK(old);
  EXPECT_FALSE(old->wanted_recall);
  EXPECT_TRUE((*catalog)->wantedRecalls()->empty());
}

TEST_F(MigrationTest, AFailingStepUndoesThoseBeforeIt) {
  const Migration steps[] = {{1, "0001_a", "CREATE TABLE a (x INTEGER)"},
                             {2, "0002_b", "CREATE TABLE b (x INTEGER)"},
                             {3, "0003_c", "INSERT INTO nowhere VALUES (1)"}};
  ASSERT_OK(migrate(*connection_, std::span(steps).first(1)));
  const Status status = migrate(*connection_, steps);
  EXPECT_THAT(status, FailsWith(Reason::kStoreFailure));
  EXPECT_THAT(status.message(), HasSubstr("0003_c"));
  EXPECT_EQ(number("SELECT count(*) FROM sqlite_schema"), 1);
  EXPECT_EQ(number("PRAGMA user_version"), 1);
}

}  // namespace
}  // namespace moduli
