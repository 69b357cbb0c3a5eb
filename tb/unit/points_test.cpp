// The runner of points, with a shell script in the place of the program.
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <fstream>
#include <thread>

#include "sw/fovea/points/runner.h"
#include "tb/unit/support.h"

namespace fovea::points {
namespace {

using test::read_text;
using test::TempDir;
using test::user_error;
using ::testing::HasSubstr;

// Arguments: run INPUT [--option]... [-s KEY=VALUE]... -o DIR. INPUT says what to do.
constexpr const char* kScript = R"(#!/bin/sh
what=$2
for last; do :; done
dir=$last
echo "$what" >> "$LOG"
case $what in
  fail*) echo "fovea: warning (model): a wish" >&2; echo "fovea: error: no such thing" >&2; exit ${what#fail} ;;
  quiet) exit 3 ;;
  shot) kill -9 $$ ;;
  dying) until [ -e "$LOG.go" ]; do sleep 0.01; done; echo dying >> "$LOG.ended"; kill -9 $$ ;;
  late) until [ -e "$LOG.go" ]; do sleep 0.01; done ;;
  sleep) trap 'exit 143' TERM; while :; do sleep 0.02; done ;;
  stubborn) trap '' TERM; while :; do sleep 0.02; done ;;
  hang) exec sleep 1000 ;;
  compute) n=0; until [ -e "$LOG.go" ]; do n=$((n + 1)); done ;;
  write) for n in 1 2 3 4 5 6 7 8 9 10 11 12; do echo "$n"; sleep 0.1; done ;;
esac
mkdir -p "$dir"
printf '{"complete": true, "a": {"value": 2.5, "unit": "s"}, "b": {"value": null, "unit": "1"}}' > "$dir/stats.json"
echo "$@" > "$dir/arguments"
echo "$what" >> "$LOG.ended"
)";

class RunnerTest : public ::testing::Test {
 protected:
  RunnerTest() {
    script_ = dir_.write("program", kScript);
    ::chmod(script_.c_str(), 0755);
    ::setenv("LOG", (dir_ / "log").c_str(), 1);
  }
  Point point(const std::string& input, const std::string& identity = "") const {
    Point p;
    p.input = input;
    p.identity = identity.empty() ? input : identity;
    p.label = input;
    return p;
  }
  RunnerOptions options(unsigned jobs = 2) {
    return {.program = script_, .jobs = jobs, .stop = &stop_, .progress = &progress_,
            .patience = std::chrono::milliseconds(200)};
  }
  /// Runs these points in the folder `store`; results by their inputs.
  std::vector<PointResult> run(const std::vector<Point>& points, unsigned jobs = 2) {
    PointStore store(dir_ / "store");
    Runner runner(store, options(jobs));
    std::vector<PointResult> results(points.size());
    for (std::size_t i = 0; i < points.size(); ++i)
      runner.add(points[i], [&results, i](const PointResult& r) { results[i] = r; });
    complete_ = runner.run();
    return results;
  }
  std::string log() const { return read_text(log_file()); }
  std::string log_file() const { return dir_ / "log"; }
  TempDir dir_;
  std::filesystem::path script_;
  std::atomic<bool> stop_{false};
  std::ostringstream progress_;
  bool complete_ = false;
};

TEST(PointTest, TheKeyIsThatOfCommandOptionsAndIdentity) {
  Point p;
  p.identity = "x=1\n";
  const std::string key = key_of(p);
  EXPECT_EQ(key.size(), 64u);
  Point q = p;
  q.label = "other";
  q.input = "other.yaml";
  q.settings = {"x=1"};
  EXPECT_EQ(key_of(q), key);
  q.identity = "x=2\n";
  EXPECT_NE(key_of(q), key);
  q = p;
  q.command = "replay";
  EXPECT_NE(key_of(q), key);
  q = p;
  q.options = {"--no-frames"};
  EXPECT_NE(key_of(q), key);
  // sha256 of "fovea point 1\nrun\n\nx=1\n", by sha256sum.
  EXPECT_EQ(key, "5dda4595270f57a64c11b235a886c13ccc61facde92759b50c7f48f196a0c7e8");
}

TEST_F(RunnerTest, GivesTheProgramItsArgumentsAndReadsTheFigures) {
  Point p = point("good");
  p.settings = {"a=1", "b=2 3"};
  p.options = {"--no-frames", "--bus-trace", "{folder}/bus.trace"};
  const auto r = run({p});
  EXPECT_TRUE(complete_);
  ASSERT_EQ(r[0].status, 0);
  EXPECT_EQ(r[0].stat("a"), 2.5);
  EXPECT_EQ(r[0].stat("b"), std::nullopt);
  EXPECT_EQ(r[0].units.at("b"), "1");
  const std::string tmp = r[0].folder.string() + ".tmp";
  EXPECT_EQ(read_text(r[0].folder / "run" / "arguments"),
            "run good --no-frames --bus-trace " + tmp + "/bus.trace -s a=1 -s b=2 3 -o " + tmp + "/run\n");
  EXPECT_EQ(r[0].folder.filename(), folder_name(key_of(p)));
}

TEST_F(RunnerTest, EqualPointsRunOnceAlsoWhenOneComesLater) {
  PointStore store(dir_ / "store");
  Runner runner(store, options());
  int called = 0;
  runner.add(point("good", "same"), [&](const PointResult&) {
    ++called;
    runner.add(point("good", "same"), [&](const PointResult&) { ++called; });
  });
  runner.add(point("good", "same"), [&](const PointResult&) { ++called; });
  EXPECT_TRUE(runner.run());
  EXPECT_EQ(called, 3);
  EXPECT_EQ(log(), "good\n");
  EXPECT_EQ(runner.ran(), 1u);
}

TEST_F(RunnerTest, AFailureOfTheGuestIsAResultThatIsKept) {
  auto r = run({point("fail3"), point("quiet")});
  EXPECT_EQ(r[0].status, 3);
  EXPECT_EQ(r[0].message, "error: no such thing");
  EXPECT_FALSE(r[0].reused);
  EXPECT_EQ(r[1].status, 3);
  EXPECT_EQ(r[1].message, "");
  EXPECT_THAT(progress_.str(), HasSubstr("fail3: status 3, error: no such thing"));
  const std::string before = log();
  r = run({point("fail3"), point("quiet")});
  EXPECT_EQ(log(), before);
  EXPECT_EQ(r[0].message, "error: no such thing");
  EXPECT_TRUE(r[0].reused);
}

// The disk may have been full, or an input missing: the next call asks again, also without --retry-failed.
TEST_F(RunnerTest, WhatMayBeTheHostsFaultIsSaidAndNotKept) {
  for (int round = 0; round < 2; ++round) {
    const auto r = run({point("fail2"), point("fail4")}, 1);
    EXPECT_EQ(r[0].status, 2);
    EXPECT_EQ(r[1].status, 4);
    EXPECT_EQ(r[1].message, "error: no such thing");
    EXPECT_TRUE(std::filesystem::exists(r[1].folder / "messages.txt")) << "to be looked at";
  }
  EXPECT_EQ(log(), "fail2\nfail4\nfail2\nfail4\n");
}

TEST_F(RunnerTest, AFolderThatACrashLeftUnfinishedIsTaken) {
  dir_.write("store/points.json.tmp", "{\"form");
  std::filesystem::create_directory(dir_ / "store/points");
  EXPECT_EQ(run({point("good")})[0].status, 0);
  EXPECT_EQ(read_text(dir_ / "store/points.json"), "{\"format\": \"fovea points 1\"}\n");
  EXPECT_FALSE(std::filesystem::exists(dir_ / "store/points.json.tmp"));
}

TEST_F(RunnerTest, LinksAreNotFollowedAndFoldersOfAnotherUserRefused) {
  const auto victim = dir_.write("victim", "mine");
  { PointStore store(dir_ / "store"); }
  std::filesystem::create_symlink(victim, dir_ / "store/answer.txt");
  std::filesystem::create_symlink(victim, dir_ / "store/answer.txt.tmp");
  PointStore(dir_ / "store").write("answer.txt", "42\n");
  EXPECT_EQ(read_text(dir_ / "store/answer.txt"), "42\n");
  EXPECT_EQ(read_text(victim), "mine");
  std::filesystem::remove(dir_ / "store/points");
  std::filesystem::create_directory(dir_ / "elsewhere");
  std::filesystem::create_directory_symlink(dir_ / "elsewhere", dir_ / "store/points");
  EXPECT_THAT(user_error([&] { PointStore store(dir_ / "store"); }), HasSubstr("not a folder"));
  if (::geteuid() != 0) return;
  std::filesystem::remove(dir_ / "store/points");
  ASSERT_EQ(::chown((dir_ / "store").c_str(), 65534, 65534), 0);
  EXPECT_THAT(user_error([&] { PointStore store(dir_ / "store"); }), HasSubstr("another user"));
}

TEST_F(RunnerTest, WhatASignalEndedIsNoResultAndRunsAgain) {
  EXPECT_THAT(user_error([&] { run({point("good"), point("shot")}, 1); }),
              HasSubstr("the point 'shot' was ended by signal 9"));
  EXPECT_EQ(log(), "good\nshot\n");
  EXPECT_THAT(user_error([&] { run({point("good"), point("shot")}, 1); }), HasSubstr("signal 9"));
  EXPECT_EQ(log(), "good\nshot\nshot\n");
}

// Both end between two looks of the runner, which the callback of a third point keeps busy meanwhile.
TEST_F(RunnerTest, WhatEndsBesideAKilledPointIsAResult) {
  PointStore store(dir_ / "store");
  Runner runner(store, options(3));
  runner.add(point("quiet"), [&](const PointResult&) {
    dir_.write("log.go", "");
    const auto ended = [&] { return read_text(dir_ / "log.ended"); };
    while (ended().find("late") == std::string::npos || ended().find("dying") == std::string::npos)
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  });
  runner.add(point("dying"), [&](const PointResult&) { FAIL() << "it has no result"; });
  runner.add(point("late"), [&](const PointResult&) { FAIL() << "the search ends with the error"; });
  EXPECT_THAT(user_error([&] { runner.run(); }), HasSubstr("'dying' was ended by signal 9"));
  EXPECT_FALSE(store.find(key_of(point("dying"))));
  const auto late = store.find(key_of(point("late")));
  ASSERT_TRUE(late);
  EXPECT_EQ(late->stat("a"), 2.5);
}

TEST_F(RunnerTest, AHalfWrittenPointRunsAgain) {
  const Point p = point("good");
  const std::string name = folder_name(key_of(p));
  dir_.write("store/points.json", "{\"format\": \"fovea points 1\"}\n");
  dir_.write("store/points/" + name + ".tmp/run/stats.json", "{\"a\": {\"value\": 9");
  dir_.write("store/points/" + name + ".tmp/run/left.txt", "of the interrupted run");
  const auto r = run({p});
  EXPECT_EQ(r[0].stat("a"), 2.5);
  EXPECT_EQ(log(), "good\n");
  EXPECT_FALSE(std::filesystem::exists(dir_ / ("store/points/" + name + ".tmp")));
  EXPECT_TRUE(std::filesystem::exists(r[0].folder / "point.json"));
  EXPECT_FALSE(std::filesystem::exists(r[0].folder / "run/left.txt"));
}

TEST_F(RunnerTest, AResultThatIsNotThisPointsIsRefused) {
  const auto r = run({point("good")});
  std::ofstream(r[0].folder / "point.json") << "{\"key\": \"0\", \"status\": 0}";
  EXPECT_THAT(user_error([&] { run({point("good")}); }), HasSubstr("its point.json is not that of this point"));
}

TEST_F(RunnerTest, StopsItsChildrenAndNobodyElses) {
  Child other({"/bin/sh", "-c", "while :; do sleep 0.02; done"}, dir_ / "o", dir_ / "e");
  PointStore store(dir_ / "store");
  Runner runner(store, options(3));
  std::atomic<int> finished = 0;  // `stopper` reads it
  runner.add(point("good"), [&](const PointResult&) { ++finished; });
  runner.add(point("sleep"), [&](const PointResult&) { ++finished; });
  runner.add(point("stubborn"), [&](const PointResult&) { ++finished; });
  std::thread stopper([&] {
    while (finished == 0 || log().find("stubborn") == std::string::npos)
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    stop_ = true;
  });
  const auto began = std::chrono::steady_clock::now();
  EXPECT_FALSE(runner.run());
  stopper.join();
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(10));
  EXPECT_EQ(finished, 1);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(dir_ / "store/points"), {}), 1);
  EXPECT_FALSE(other.ended());
  // Going on takes up what was left.
  stop_ = false;
  EXPECT_TRUE(store.find(key_of(point("good"))).has_value());
}

TEST_F(RunnerTest, NoMoreProcessesThanJobs) {
  // Each notes how many others run when it starts.
  const std::string counting = R"(#!/bin/sh
for last; do :; done
mkdir "$LOG.$2"
ls -d "$LOG".* | wc -l >> "$LOG"
sleep 0.05
rmdir "$LOG.$2"
mkdir -p "$last"; echo '{}' > "$last/stats.json"
)";
  std::ofstream(script_) << counting;
  run({point("a"), point("b"), point("c"), point("d"), point("e")}, 2);
  std::istringstream counts(log());
  int most = 0, n = 0;
  for (int c; counts >> c; ++n) most = std::max(most, c);
  EXPECT_EQ(n, 5);
  EXPECT_LE(most, 2);
}

TEST_F(RunnerTest, TheTimeLeftCountsWhatIsKnownAndWhatMayFollow) {
  PointStore store(dir_ / "store");
  Runner runner(store, options(1));
  for (const char* p : {"a", "b", "c"}) runner.add(point(p), [](const PointResult&) {});
  EXPECT_TRUE(runner.run());
  EXPECT_THAT(progress_.str(), HasSubstr("[1] a: "));
  EXPECT_THAT(progress_.str(), HasSubstr("; 2 to go, ETA "));
  EXPECT_THAT(progress_.str(), HasSubstr("; 1 to go, ETA "));
  runner.may_follow = [] { return std::size_t{4}; };
  runner.add(point("d"), [](const PointResult&) {});
  EXPECT_TRUE(runner.run());
  EXPECT_THAT(progress_.str(), HasSubstr("; at most 4 to go, ETA "));
}

/// A child that does nothing at all is ended, with its name; one that computes or writes is not, however long it takes.
TEST_F(RunnerTest, AChildWithoutASignOfLifeHangs) {
  PointStore store(dir_ / "store");
  RunnerOptions o = options();
  o.silence = std::chrono::milliseconds(400);
  const auto begin = std::chrono::steady_clock::now();
  Runner runner(store, o);
  bool other = false;
  runner.add(point("hang"), [](const PointResult&) { ADD_FAILURE(); });
  runner.add(point("a"), [&](const PointResult&) { other = true; });
  EXPECT_THAT(user_error([&] { runner.run(); }),
              HasSubstr("the point 'hang' hangs: for 0.4 s it has neither used the processor nor written anything"));
  EXPECT_TRUE(other) << "its result is kept";
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(20));
}

TEST_F(RunnerTest, AChildThatComputesOrWritesDoesNotHang) {
  PointStore store(dir_ / "store");
  RunnerOptions o = options();
  o.silence = std::chrono::milliseconds(400);
  Runner runner(store, o);
  unsigned ended = 0;
  for (const char* p : {"compute", "write"})
    runner.add(point(p), [&](const PointResult& r) { ended += r.status == 0; });
  std::thread go([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(1'500));
    std::ofstream(log_file() + ".go");
  });
  EXPECT_TRUE(runner.run());
  go.join();
  EXPECT_EQ(ended, 2u);
}

TEST_F(RunnerTest, WrongPrograms) {
  PointStore store(dir_ / "store");
  RunnerOptions o = options();
  o.program = dir_ / "nothing";
  EXPECT_THAT(user_error([&] { Runner(store, o); }), HasSubstr("it cannot be executed"));
  std::ofstream(script_) << "#!/no/such/shell\n";
  Runner runner(store, options());
  runner.add(point("a"), [](const PointResult&) {});
  EXPECT_THAT(user_error([&] { runner.run(); }), HasSubstr("cannot be executed"));
}

TEST(ReasonTest, TheLastErrorCounts) {
  EXPECT_EQ(reason_in(""), "");
  EXPECT_EQ(reason_in("something\n"), "something");
  EXPECT_EQ(reason_in("fovea: the guest failed: PC 0\nlast access\n  more\n"), "the guest failed: PC 0");
  EXPECT_EQ(reason_in("fovea: error: a\nfovea: warning (model): b\n"), "error: a");
}

}  // namespace
}  // namespace fovea::points
