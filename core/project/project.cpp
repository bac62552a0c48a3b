#include "core/project/project.h"

#include <random>

#include "core/base/version.h"
#include "core/project/changeset.h"
#include "core/project/edit_check.h"
#include "core/project/edit_writer.h"
#include "core/project/project_state.h"
#include "core/project/schema.h"
#include "core/project/snapshot_reader.h"

namespace tiltmap {

namespace fs = std::filesystem;

namespace {

// 128 random bits: tells projects apart, nothing else hangs on it.
std::string newProjectId() {
  static constexpr char kHex[] = "0123456789abcdef";
  std::random_device device;
  std::string id;
  for (int i = 0; i < 32; ++i) id += kHex[device() & 15U];
  return id;
}

void makeEmptyProject(const fs::path& path) {
  const Database database(path, Database::Mode::Create);
  // Nobody sees the file before it has been brought to the disk as a whole.
  database.execute("PRAGMA synchronous = OFF");
  database.execute("PRAGMA page_size = " + std::to_string(kPageSize));
  database.execute("PRAGMA application_id = " + std::to_string(kApplicationId));
  migrate(database);
  database.run("INSERT INTO project VALUES (1, ?, ?, ?, 0)", newProjectId(), utcNow(), programVersion());
  // Said in the file's header, so that every later connection has it; closing empties the log into the file.
  database.execute("PRAGMA journal_mode = WAL");
}

std::unique_ptr<Database> openForWriting(const fs::path& path) {
  auto database = std::make_unique<Database>(path, Database::Mode::Write);
  if (database->isReadOnly())
    throw StoreFailure(
        "the project cannot be written", path.string(),
        "make the file writable, open it for reading, or copy it to a folder where you may write");
  if (storedSchemaVersion(*database) > schemaVersion())
    throw newerVersion(path, storedSchemaVersion(*database));
  database->execute("PRAGMA journal_mode = WAL");
  migrate(*database);
  return database;
}

void requireReadableVersion(const Database& database) {
  const int version = storedSchemaVersion(database);
  if (version > schemaVersion()) throw newerVersion(database.path(), version);
  if (version < schemaVersion())
    throw StoreFailure("the project was written by an older version of Tiltmap", database.path().string(),
                       "open it for writing once, which brings it up to date");
}

}  // namespace

Project::Project(std::unique_ptr<State> state) : state_(std::move(state)) {}

Project::~Project() {
  // So that the one file is the whole project even while snapshots keep their connection. Without success the
  // log stays beside it, and nothing is lost.
  if (state_->writer) (void)attempt([this] { state_->writer->execute("PRAGMA wal_checkpoint(TRUNCATE)"); });
  state_->publish(nullptr);
  state_->images.reset();
  state_->writer.reset();
}

Result<std::unique_ptr<Project>> Project::create(const fs::path& path) {
  if (auto made = attempt([&] {
        NewProjectFile file(resolvedPath(path));
        makeEmptyProject(file.workingPath());
        file.publish();
      });
      !made)
    return fail(made.error());
  return open(path, Access::ReadWrite);
}

Result<std::unique_ptr<Project>> Project::open(const fs::path& given, Access access) {
  return attempt([&] {
    auto state = std::make_unique<State>();
    state->path = resolvedPath(given);
    state->access = access;
    requireProjectFile(state->path);
    if (access == Access::ReadWrite) {
      state->lock = std::make_unique<WriterLock>(state->path);
      state->mark = std::make_unique<OpenFileMark>(state->path);
      state->writer = openForWriting(state->path);
    }
    state->images = std::make_shared<ImageStore>(state->path);
    const Database& database = state->writer ? *state->writer : state->images->connection().database();
    requireReadableVersion(database);
    const Transaction transaction(database, Transaction::Kind::Read);
    state->publish(SnapshotReader::read(database, state->images));
    return std::unique_ptr<Project>(new Project(std::move(state)));
  });
}

const fs::path& Project::path() const {
  return state_->path;
}
Access Project::access() const {
  return state_->access;
}
SnapshotPtr Project::snapshot() const {
  return state_->current();
}
std::vector<HistoryEntry> Project::history() const {
  return state_->current()->history();
}

Result<bool> Project::refresh() {
  if (state_->writer) return false;
  return attempt([this] {
    const std::lock_guard guard(state_->images->mutex());
    const Database& database = state_->images->connection().database();
    state_->images->connection().requireUnchanged();
    requireReadableVersion(database);
    const Transaction transaction(database, Transaction::Kind::Read);
    if (SnapshotReader::storedRevision(database) == state_->current()->revision()) return false;
    state_->publish(SnapshotReader::read(database, state_->images));
    return true;
  });
}

namespace {

// Moves the revision on and reads what is about to be stored: a snapshot never shows what the file does not
// hold.
SnapshotPtr nextSnapshot(const Database& database, const std::shared_ptr<ImageStore>& images) {
  database.execute("UPDATE project SET revision = revision + 1");
  return SnapshotReader::read(database, images);
}

}  // namespace

Result<Change> Project::apply(const ProjectEdit& edit) {
  return attempt([&] {
    const Database& database = state_->requireWriter();
    const SnapshotPtr before = state_->current();
    if (edit.base) requireUnchanged(*edit.base, *before, edit.concerned);
    Transaction transaction(database, Transaction::Kind::Write);
    state_->requireOwnRevision(database);
    Changeset changes;
    {
      const ChangeRecorder recorder(database);
      EditWriter(database).write(edit);
      changes = recorder.changes();
    }
    if (changes.empty()) return Change{before->revision(), edit.title, {}, {}, {}, {}, {}, {}, {}};
    // A new edit ends the branch that redo would have gone.
    database.execute("DELETE FROM edit WHERE state = 'undone'");
    database.run(
        "INSERT INTO edit(title, time, program_version, state, changeset) VALUES (?, ?, ?, 'done', ?)",
        edit.title, utcNow(), programVersion(), Bytes(changes));
    SnapshotPtr after = nextSnapshot(database, state_->images);
    transaction.commit();
    Change change = changeBetween(*before, *after);
    change.title = edit.title;
    state_->publish(std::move(after));
    return change;
  });
}

namespace {

struct JournalStep {
  std::int64_t id = 0;
  std::string title;
  Changeset changes;
};

JournalStep nextStep(const Database& database, Direction direction) {
  Statement query = database.prepare(
      direction == Direction::Back
          ? "SELECT id, title, changeset FROM edit WHERE state = 'done' ORDER BY id DESC LIMIT 1"
          : "SELECT id, title, changeset FROM edit WHERE state = 'undone' ORDER BY id LIMIT 1");
  if (!query.step())
    throw StoreFailure(direction == Direction::Back ? "there is nothing to undo" : "there is nothing to redo",
                       database.path().string(), "`tiltmap history` lists the edits");
  const Bytes changes = query.blob(2);
  return {query.integer(0), query.text(1), Changeset(changes.begin(), changes.end())};
}

}  // namespace

// Not a member, so that the header need not know of directions.
static Change stepInJournal(const Database& database, const std::shared_ptr<ImageStore>& images,
                            const ProjectSnapshot& before, Direction direction, SnapshotPtr& after) {
  Transaction transaction(database, Transaction::Kind::Write);
  if (SnapshotReader::storedRevision(database) != before.revision())
    throw StoreFailure("the project has been changed by another program", database.path().string(),
                       "open it again");
  const JournalStep step = nextStep(database, direction);
  replay(database, step.changes, direction);
  database.run("UPDATE edit SET state = ? WHERE id = ?", direction == Direction::Back ? "undone" : "done",
               step.id);
  after = nextSnapshot(database, images);
  transaction.commit();
  Change change = changeBetween(before, *after);
  change.title = step.title;
  return change;
}

Result<Change> Project::undo() {
  return attempt([this] {
    SnapshotPtr after;
    Change change =
        stepInJournal(state_->requireWriter(), state_->images, *state_->current(), Direction::Back, after);
    state_->publish(std::move(after));
    return change;
  });
}

Result<Change> Project::redo() {
  return attempt([this] {
    SnapshotPtr after;
    Change change =
        stepInJournal(state_->requireWriter(), state_->images, *state_->current(), Direction::Forth, after);
    state_->publish(std::move(after));
    return change;
  });
}

}  // namespace tiltmap
