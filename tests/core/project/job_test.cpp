// Operations and the jobs that run them, with an operation made for the purpose.
#include "core/project/job.h"

#include <atomic>
#include <stdexcept>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/version.h"
#include "tests/support/project_samples.h"
#include "tests/support/temporary_folder.h"

namespace tiltmap {
namespace {

using namespace test;
using ::testing::HasSubstr;
using namespace std::chrono_literals;

enum class Behaviour { Note, Nothing, Fail, Throw, Wait };

struct ToySettings {
  Behaviour behaviour = Behaviour::Note;
  double distance_m = 0.5;
  int rounds = 3;
  std::string word = "toy";
};

const ParameterTable<ToySettings>& toyTable() {
  static const ParameterTable<ToySettings> table = [] {
    ParameterTable<ToySettings> t("toy");
    t.choice("behaviour", &ToySettings::behaviour,
             {{"note", Behaviour::Note},
              {"nothing", Behaviour::Nothing},
              {"fail", Behaviour::Fail},
              {"throw", Behaviour::Throw},
              {"wait", Behaviour::Wait}},
             "What it does.", "ours");
    t.real("max-distance", &ToySettings::distance_m, "m", 0.01, 100.0, "A distance.", "ours");
    t.integer("rounds", &ToySettings::rounds, "", 1, 1000, "How often it reports.", "ours");
    t.text("word", &ToySettings::word, "What it notes.", "ours");
    ToySettings far;
    far.distance_m = 10.0;
    t.preset("far", "looks further", far);
    return t;
  }();
  return table;
}

// Writes the word into the first scan's note.
class ToyOperation : public SettingsOperation<ToySettings> {
 public:
  ToyOperation() : SettingsOperation(toyTable()) {}
  std::string title() const override { return "Toy"; }
  std::string help() const override { return "For tests."; }
  std::atomic<bool>* gate = nullptr;

 protected:
  Status checkSettings(const ProjectSnapshot& snapshot, const ToySettings&) const override {
    if (snapshot.scans().empty()) return fail("there are no scans", "toy", "import some");
    return {};
  }
  Result<OperationResult> runSettings(const SnapshotPtr& snapshot, const ToySettings& settings,
                                      const JobControl& control) const override {
    while (settings.behaviour == Behaviour::Wait && !(gate && *gate)) {
      if (control.stopRequested()) return fail(kCancelled, "toy", "");
      std::this_thread::sleep_for(1ms);
    }
    for (int i = 1; i <= settings.rounds; ++i)
      control.tell(static_cast<double>(i) / (settings.rounds + 1), "round " + std::to_string(i));
    if (settings.behaviour == Behaviour::Fail) return fail("the toy broke", "toy", "mend it");
    if (settings.behaviour == Behaviour::Throw) throw std::logic_error("a defect");
    OperationResult result;
    result.warnings = {"squeaks"};
    result.report_json = "{}";
    if (settings.behaviour == Behaviour::Nothing) return result;
    const ScanEntry& scan = snapshot->scans()[0];
    result.edit.steps.push_back(
        SetNote{scan.id, settings.word + " " + std::to_string(must(scan.image())->validCells())});
    result.edit.base = snapshot;
    result.edit.concerned = {scan.id};
    return result;
  }
};

class JobTest : public ::testing::Test {
 protected:
  void SetUp() override {
    project_ = must(Project::create(folder_ / "p.tiltmap"));
    must(project_->apply(importEdit(sampleScans(2))));
  }
  std::unique_ptr<Job> started(const ParameterValues& values, const std::string& preset = "default",
                               Job::Notify notify = {}) {
    return must(Job::start(toy_, project_->snapshot(), preset, values, std::move(notify)));
  }
  std::string note() const { return project_->snapshot()->scans()[0].note; }

  TemporaryFolder folder_;
  std::unique_ptr<Project> project_;
  ToyOperation toy_;
};

TEST_F(JobTest, ResultWaitsToBeAccepted) {
  std::atomic<int> notified{0};
  const auto job = started({{"word", std::string("hello")}}, "far", [&] { ++notified; });
  job->wait();
  EXPECT_EQ(job->state(), JobState::Waiting);
  EXPECT_TRUE(job->finished());
  EXPECT_EQ(note(), "") << "nothing changes before it is accepted";
  ASSERT_TRUE(job->result());
  EXPECT_EQ(job->result()->warnings, std::vector<std::string>{"squeaks"});
  EXPECT_EQ(job->progress().message, "round 3");
  EXPECT_EQ(job->progress().fraction, 1.0);

  const Change change = must(job->accept(*project_));
  EXPECT_TRUE(change.jobs_changed);
  EXPECT_EQ(change.title, "Toy");
  EXPECT_EQ(job->state(), JobState::Accepted);
  EXPECT_THAT(note(), ::testing::StartsWith("hello "));
  const auto again = job->accept(*project_);
  ASSERT_FALSE(again);
  EXPECT_THAT(again.error().what, HasSubstr("accepted"));
  EXPECT_GE(notified, 1);

  // What computed it is in the file: all parameters, not only those that were named.
  project_.reset();
  project_ = must(Project::open(folder_ / "p.tiltmap", Access::ReadWrite));
  ASSERT_EQ(project_->snapshot()->jobs().size(), 1U);
  const JobRecord& record = project_->snapshot()->jobs()[0];
  EXPECT_EQ(record.operation, "toy");
  EXPECT_EQ(record.preset, "far");
  EXPECT_EQ(record.program_version, programVersion());
  EXPECT_EQ(record.state, JobState::Accepted);
  EXPECT_EQ(record.warnings, std::vector<std::string>{"squeaks"});
  EXPECT_LE(record.started, record.finished);
  EXPECT_EQ(record.values.size(), 4U);
  EXPECT_EQ(std::get<double>(record.values.at("max-distance")), 10.0);
  EXPECT_EQ(std::get<long long>(record.values.at("rounds")), 3);
  EXPECT_EQ(std::get<std::string>(record.values.at("word")), "hello");
  must(project_->undo());
  EXPECT_TRUE(project_->snapshot()->jobs().empty());
  EXPECT_EQ(note(), "");
  must(project_->redo());
  EXPECT_EQ(project_->snapshot()->jobs().size(), 1U);
}

TEST_F(JobTest, DiscardedResultsAreNotApplied) {
  const auto job = started({});
  job->wait();
  job->discard();
  EXPECT_EQ(job->state(), JobState::Discarded);
  EXPECT_FALSE(job->accept(*project_));
  EXPECT_EQ(note(), "");
}

TEST_F(JobTest, CancelledJobsEndWithoutResult) {
  const auto job = started({{"behaviour", std::string("wait")}});
  EXPECT_FALSE(job->waitFor(20ms));
  EXPECT_EQ(job->state(), JobState::Running);
  EXPECT_THROW((void)job->result(), std::logic_error);
  EXPECT_FALSE(job->accept(*project_));
  job->cancel();
  job->wait();
  EXPECT_EQ(job->state(), JobState::Cancelled);
  EXPECT_EQ(job->result().error().what, kCancelled);
  EXPECT_FALSE(job->accept(*project_));
}

TEST_F(JobTest, DestroyingARunningJobEndsIt) {
  const auto job = started({{"behaviour", std::string("wait")}});
}

TEST_F(JobTest, FailuresAndDefectsAreReported) {
  const auto failed = started({{"behaviour", std::string("fail")}});
  failed->wait();
  EXPECT_EQ(failed->state(), JobState::Failed);
  EXPECT_EQ(failed->result().error().what, "the toy broke");
  const auto thrown = started({{"behaviour", std::string("throw")}});
  thrown->wait();
  EXPECT_EQ(thrown->state(), JobState::Failed);
  EXPECT_THAT(thrown->result().error().what, HasSubstr("a defect"));
  EXPECT_FALSE(thrown->accept(*project_));
}

TEST_F(JobTest, BadRequestsStartNothing) {
  const auto refused = [&](const ParameterValues& values, const std::string& preset = "default") {
    const auto job = Job::start(toy_, project_->snapshot(), preset, values);
    return job ? std::string("started") : job.error().what + " -> " + job.error().remedy;
  };
  EXPECT_THAT(refused({{"max-distanse", 1.0}}), HasSubstr("did you mean max-distance?"));
  EXPECT_THAT(refused({{"max-distance", 1000.0}}), HasSubstr("0.01 to 100 m"));
  EXPECT_THAT(refused({{"rounds", std::string("many")}}), HasSubstr("whole number"));
  EXPECT_THAT(refused({}, "near"), HasSubstr("no preset"));
  must(project_->apply(deleteEdit(*project_->snapshot(), scanIds(*project_->snapshot()))));
  EXPECT_THAT(refused({}), HasSubstr("there are no scans"));
}

TEST_F(JobTest, OperationsWithoutAnEditLeaveTheFileAlone) {
  const auto revision = project_->snapshot()->revision();
  const auto job = started({{"behaviour", std::string("nothing")}});
  job->wait();
  must(job->accept(*project_));
  EXPECT_EQ(job->state(), JobState::Accepted);
  EXPECT_EQ(project_->snapshot()->revision(), revision);
}

TEST_F(JobTest, AResultOfAChangedScanIsRefusedAndKept) {
  std::atomic<bool> gate{false};
  toy_.gate = &gate;
  const auto job = started({{"behaviour", std::string("wait")}});
  const ScanId first = project_->snapshot()->scans()[0].id;
  must(project_->apply(posesEdit(Stage::Pairwise, {{first, samplePose(1)}})));
  gate = true;
  job->wait();
  const auto refused = job->accept(*project_);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().what, HasSubstr("pose of scan \"stop 1\" has changed"));
  EXPECT_EQ(job->state(), JobState::Waiting);
  must(project_->undo());
  must(job->accept(*project_));
  EXPECT_NE(note(), "");

  const auto other = must(Project::create(folder_ / "other.tiltmap"));
  const auto stray = started({});
  stray->wait();
  EXPECT_THAT(stray->accept(*other).error().what, HasSubstr("another project"));
}

TEST_F(JobTest, SeveralJobsBesideAWriter) {
  std::vector<std::unique_ptr<Job>> jobs;
  for (int i = 0; i < 6; ++i)
    jobs.push_back(started({{"rounds", 500LL}, {"word", "job " + std::to_string(i)}}));
  for (int i = 0; i < 5; ++i) {
    must(project_->apply(noteEdit(project_->snapshot()->scans()[1].id, "note " + std::to_string(i))));
    for (const auto& job : jobs) EXPECT_LE(job->progress().fraction, 1.0);
  }
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    jobs[i]->wait();
    must(jobs[i]->accept(*project_));
    EXPECT_THAT(note(), HasSubstr("job " + std::to_string(i)));
  }
  EXPECT_EQ(project_->snapshot()->jobs().size(), 6U);
}

TEST(OperationTest, WordsBecomeValues) {
  const ToyOperation toy;
  const auto values = must(toy.parsed("far", {{"rounds", "9"}, {"behaviour", "nothing"}}));
  EXPECT_EQ(std::get<long long>(values.at("rounds")), 9);
  EXPECT_EQ(std::get<double>(values.at("max-distance")), 10.0);
  EXPECT_EQ(values.size(), 4U);
  EXPECT_FALSE(toy.parsed("default", {{"rounds", "9.5"}}));
  EXPECT_THAT(toy.parsed("default", {{"round", "9"}}).error().remedy, HasSubstr("rounds"));
}

TEST(OperationTest, RegistryNamesTheNearest) {
  OperationRegistry registry;
  registry.add(std::make_unique<ToyOperation>());
  EXPECT_THROW(registry.add(std::make_unique<ToyOperation>()), std::logic_error);
  EXPECT_EQ(must(registry.get("toy"))->title(), "Toy");
  EXPECT_THAT(registry.get("toi").error().remedy, HasSubstr("did you mean toy?"));
  EXPECT_EQ(registry.find("register"), nullptr);
  EXPECT_EQ(registry.all().size(), 1U);
}

TEST(OperationTest, EveryOperationDescribesItself) {
  EXPECT_FALSE(operations().all().empty());
  for (const Operation* operation : operations().all()) {
    SCOPED_TRACE(operation->id());
    EXPECT_FALSE(operation->title().empty());
    EXPECT_FALSE(operation->help().empty());
    for (const ParameterPreset& preset : operation->presets()) {
      const auto values = must(operation->presetValues(preset.name));
      EXPECT_EQ(values.size(), operation->parameters().size());
      for (const ParameterInfo& info : operation->parameters()) {
        EXPECT_FALSE(info.help.empty()) << info.name;
        EXPECT_FALSE(info.source.empty()) << info.name;
        EXPECT_TRUE(checkParameter(info, values.at(info.name))) << info.name;
      }
    }
  }
}

TEST_F(JobTest, RenameAndRebaseOperations) {
  const auto run = [&](const std::string& id, const ParameterValues& values) {
    const auto job = must(Job::start(*must(operations().get(id)), project_->snapshot(), "default", values));
    job->wait();
    return job->accept(*project_);
  };
  must(run("rename", {{"scan", 1LL}, {"name", std::string("gate")}}));
  EXPECT_EQ(project_->snapshot()->scans()[1].name, "gate");
  must(run("rebase", {{"scan", 1LL}}));
  EXPECT_EQ(text(project_->snapshot()->scans()[1].odometry()), text(Pose()));
  for (const ParameterValues& values :
       {ParameterValues{{"scan", 7LL}, {"name", std::string("x")}}, {{"scan", 0LL}}})
    EXPECT_FALSE(Job::start(*must(operations().get("rename")), project_->snapshot(), "default", values));
  EXPECT_FALSE(
      Job::start(*must(operations().get("rebase")), project_->snapshot(), "default", {{"scan", 2LL}}));
  EXPECT_EQ(project_->history().size(), 3U);
}

TEST(JobRecordTest, ParametersSurviveJson) {
  const ParameterValues values = {
      {"a", true}, {"b", 12LL}, {"c", 0.1}, {"d", std::string("x \"y\"\n")}, {"e", 3.0}};
  EXPECT_EQ(must(parametersFromJson(parametersToJson(values))), values);
  for (const char* bad : {"", "[]", "{\"a\":[1]}", "{\"a\":null}", "{\"a\""})
    EXPECT_FALSE(parametersFromJson(bad)) << bad;
}

TEST(NamesTest, RoundTripAndNearest) {
  for (const Stage stage : kStages) EXPECT_EQ(must(parseStage(stageName(stage))), stage);
  EXPECT_EQ(stageName(Stage::Relaxed), "relaxed");
  EXPECT_THAT(parseStage("relaxd").error().remedy, HasSubstr("did you mean relaxed?"));
  EXPECT_EQ(must(parseLinkOrigin("by-hand")), LinkOrigin::ByHand);
  EXPECT_EQ(must(parseLinkState("disabled")), LinkState::Disabled);
  EXPECT_EQ(must(parseJobState("discarded")), JobState::Discarded);
}

}  // namespace
}  // namespace tiltmap
