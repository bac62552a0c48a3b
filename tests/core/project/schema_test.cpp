// Coming up from older versions of the file.
#include "core/project/schema.h"

#include <array>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/project/changeset.h"
#include "tests/support/temporary_folder.h"

namespace tiltmap {
namespace {

using test::TemporaryFolder;

class SchemaTest : public ::testing::Test {
 protected:
  TemporaryFolder folder_;
  Database database_{folder_ / "s.db", Database::Mode::Create};
};

TEST_F(SchemaTest, MigratesStepByStepFromAnyVersion) {
  constexpr std::array<Migration, 1> kFirst = {
      "CREATE TABLE t(a INTEGER PRIMARY KEY); INSERT INTO t VALUES (7)"};
  constexpr std::array<Migration, 3> kLater = {
      kFirst[0], "ALTER TABLE t ADD COLUMN b INTEGER NOT NULL DEFAULT 5", "UPDATE t SET b = b + a"};
  migrate(database_, kFirst);
  EXPECT_EQ(storedSchemaVersion(database_), 1);
  migrate(database_, kLater);
  EXPECT_EQ(storedSchemaVersion(database_), 3);
  EXPECT_EQ(database_.integer("SELECT b FROM t"), 12);
  migrate(database_, kLater);
  EXPECT_EQ(database_.integer("SELECT b FROM t"), 12) << "done twice";
  EXPECT_THROW(migrate(database_, kFirst), StoreFailure);
}

TEST_F(SchemaTest, AFailedMigrationChangesNothing) {
  constexpr std::array<Migration, 1> kFirst = {"CREATE TABLE t(a); INSERT INTO t VALUES (7)"};
  constexpr std::array<Migration, 3> kBroken = {kFirst[0], "UPDATE t SET a = 8",
                                                "UPDATE no_such_table SET a = 9"};
  migrate(database_, kFirst);
  EXPECT_THROW(migrate(database_, kBroken), StoreFailure);
  EXPECT_EQ(storedSchemaVersion(database_), 1);
  EXPECT_EQ(database_.integer("SELECT a FROM t"), 7);
}

TEST_F(SchemaTest, ChangesRecordedBeforeAMigrationThatAppendsAColumnStillReplay) {
  migrate(database_);
  database_.run("INSERT INTO survey VALUES ('site', 'old')");
  Changeset changes;
  {
    Transaction transaction(database_, Transaction::Kind::Write);
    const ChangeRecorder recorder(database_);
    database_.run("UPDATE survey SET value = 'new'");
    changes = recorder.changes();
    transaction.commit();
  }
  database_.execute("ALTER TABLE survey ADD COLUMN language TEXT");
  replay(database_, changes, Direction::Back);
  EXPECT_EQ(database_.integer("SELECT count(*) FROM survey WHERE value = 'old'"), 1);
  replay(database_, changes, Direction::Forth);
  EXPECT_EQ(database_.integer("SELECT count(*) FROM survey WHERE value = 'new'"), 1);
}

TEST_F(SchemaTest, AProjectOfTheFirstVersionComesUpWithItsJournal) {
  migrate(database_, migrations().first(1));
  database_.execute(
      "INSERT INTO matrix VALUES (1, 1, 1, 0, 0, 0, 0, 0);"
      "INSERT INTO scanner_geometry VALUES (1, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0);");
  Changeset added;
  {
    const ChangeRecorder recorder(database_);
    database_.execute("INSERT INTO scan VALUES (1, 0, 1, 1, 'old', '', '')");
    added = recorder.changes();
  }
  EXPECT_THROW((void)database_.integer("SELECT colour FROM scan"), StoreFailure);
  migrate(database_);
  EXPECT_EQ(storedSchemaVersion(database_), schemaVersion());
  EXPECT_EQ(database_.integer("SELECT count(*) FROM scan WHERE colour IS NULL"), 1);
  replay(database_, added, Direction::Back);
  EXPECT_EQ(database_.integer("SELECT count(*) FROM scan"), 0);
  replay(database_, added, Direction::Forth);
  EXPECT_EQ(database_.integer("SELECT count(*) FROM scan WHERE name = 'old' AND colour IS NULL"), 1);
}

TEST_F(SchemaTest, AChangeThatDoesNotFitIsRefused) {
  migrate(database_);
  Changeset changes;
  {
    const ChangeRecorder recorder(database_);
    database_.run("INSERT INTO survey VALUES ('site', 'a')");
    changes = recorder.changes();
  }
  database_.run("UPDATE survey SET value = 'changed behind our back'");
  try {
    replay(database_, changes, Direction::Back);
    FAIL() << "replayed over a foreign change";
  } catch (const StoreFailure& failure) {
    EXPECT_THAT(failure.error().what, ::testing::HasSubstr("does not fit"));
  }
  EXPECT_EQ(database_.integer("SELECT count(*) FROM survey"), 1);
}

TEST_F(SchemaTest, DurabilityIsAsPromised) {
  EXPECT_EQ(database_.integer("PRAGMA synchronous"), 2);
  EXPECT_EQ(database_.integer("PRAGMA foreign_keys"), 1);
}

}  // namespace
}  // namespace tiltmap
