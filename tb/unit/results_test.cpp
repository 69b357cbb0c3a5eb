// What happens to earlier results and to the user's own files when a command writes into their
// folder: every combination of old result, new result, foreign file and command.
#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>

#include "sw/fovea/cli/cli.h"
#include "tb/unit/fake_board.h"
#include "tb/unit/support.h"

namespace fovea::app {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::read_text;
using test::TempDir;
using testing::HasSubstr;

enum class Old { kNone, kEmpty, kComplete, kPartial, kFailed };
enum class New { kComplete, kStopped, kFailed };
enum class Foreign { kNone, kBefore, kInFrames, kDuring };
constexpr std::array kOld = {Old::kNone, Old::kEmpty, Old::kComplete, Old::kPartial, Old::kFailed};
constexpr std::array kNew = {New::kComplete, New::kStopped, New::kFailed};
constexpr std::array kForeign = {Foreign::kNone, Foreign::kBefore, Foreign::kInFrames,
                                 Foreign::kDuring};

/// The stand-in board, which lets something happen while it runs.
class BoardWithVisitor : public test::FakeBoard {
 public:
  explicit BoardWithVisitor(std::function<void()>& visitor) : visitor_(visitor) {}
  Result run(const Request& request) override {
    if (visitor_) visitor_();
    return test::FakeBoard::run(request);
  }

 private:
  std::function<void()>& visitor_;
};

class ResultsTest : public testing::Test {
 protected:
  /// One command into `to`. The experiments differ in the number of frames, so that each result
  /// says which run it is of.
  int start(const std::string& command, const fs::path& to, New how, unsigned frames) {
    out.str("");
    err.str("");
    stop = how == New::kStopped;
    signal = how == New::kStopped ? SIGINT : 0;
    std::vector<std::string> args;
    if (command == "run") {
      args = {"run", experiment, "-s", "run.frames=" + std::to_string(frames)};
      if (how == New::kFailed) args.insert(args.end(), {"-s", "run.mode=late_failure"});
    } else {
      // Two requests more than 10 ms apart: a signal is looked at between them.
      std::string trace = "# dramtrace 1\n# master 3 window 2 cpu\n";
      trace += "0 3 R 0x1000 " + std::to_string(32 * frames) + "\n20000000000 3 R 0x0 32\n";
      args = {"replay", dir.write("t" + std::to_string(frames) + ".txt", trace).string()};
    }
    args.insert(args.end(), {"-o", to.string()});
    return run_cli(args, {.out = out,
                          .err = err,
                          .make_machine = [this](MachineKind) {
                            return std::make_unique<BoardWithVisitor>(visitor);
                          },
                          .signal = &signal,
                          .stop = &stop});
  }
  static int status_of(New how) {
    return how == New::kComplete ? 0 : how == New::kStopped ? 128 + SIGINT : 3;
  }
  /// All files below a folder, with their contents.
  static std::map<std::string, std::string> files(const fs::path& folder) {
    std::map<std::string, std::string> all;
    if (fs::exists(folder))
      for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_regular_file())
          all[fs::relative(entry.path(), folder).string()] = read_text(entry.path());
    return all;
  }
  static bool complete(const fs::path& folder) {
    return json::parse(read_text(folder / "stats.json"))["complete"];
  }
  /// The configuration says which run it was.
  static bool is_of(const fs::path& folder, unsigned frames) {
    const std::string config = read_text(folder / "host.json");
    return config.find("frames=" + std::to_string(frames)) != std::string::npos ||
           config.find("t" + std::to_string(frames) + ".txt") != std::string::npos;
  }
  bool only(std::vector<std::string> names) const {
    std::vector<std::string> found;
    for (const auto& entry : fs::directory_iterator(dir.path()))
      if (const auto name = entry.path().filename().string(); name.starts_with("r"))
        found.push_back(name);
    std::sort(found.begin(), found.end());
    std::sort(names.begin(), names.end());
    EXPECT_EQ(found, names);
    return found == names;
  }

  TempDir dir;
  std::string experiment = dir.write("exp.yaml", "run.frames: 4\n").string();
  fs::path r = dir / "r";
  std::function<void()> visitor;
  std::ostringstream out, err;
  std::atomic<int> signal{0};
  std::atomic<bool> stop{false};
};

struct Case {
  std::string command;
  Old old;
  New now;
  Foreign foreign;
};

std::vector<Case> all_cases() {
  std::vector<Case> cases;
  for (const std::string command : {"run", "replay"})
    for (const Old old : kOld)
      for (const New now : kNew)
        for (const Foreign foreign : kForeign) {
          // A replay has no guest that could fail, and calls no visitor here.
          const bool replay = command == "replay";
          if (replay && (old == Old::kFailed || now == New::kFailed || foreign == Foreign::kDuring))
            continue;
          // There is no place for a foreign file.
          if (foreign != Foreign::kNone && foreign != Foreign::kDuring &&
              (old == Old::kNone || old == Old::kEmpty))
            continue;
          if (foreign == Foreign::kInFrames && replay) continue;
          cases.push_back({command, old, now, foreign});
        }
  return cases;
}

class EveryResultTest : public ResultsTest, public testing::WithParamInterface<Case> {};

TEST_P(EveryResultTest, NothingIsLost) {
  const Case& c = GetParam();
  const auto outcome = [](Old old) {
    return old == Old::kComplete ? New::kComplete
           : old == Old::kPartial ? New::kStopped
                                  : New::kFailed;
  };
  const bool had = c.old != Old::kNone && c.old != Old::kEmpty;
  if (c.old == Old::kEmpty) fs::create_directory(r);
  if (had) {
    ASSERT_EQ(start(c.command, r, outcome(c.old), 2), status_of(outcome(c.old))) << err.str();
  }
  const std::string letter = c.foreign == Foreign::kInFrames ? "frames/mine.png" : "letter.txt";
  if (c.foreign == Foreign::kBefore || c.foreign == Foreign::kInFrames)
    dir.write("r/" + letter, "dear");
  if (c.foreign == Foreign::kDuring) visitor = [&] { dir.write("r/" + letter, "dear"); };
  auto before = files(r);
  if (c.foreign == Foreign::kDuring) before[letter] = "dear";

  const int status = start(c.command, r, c.now, 3);
  const bool done = c.now == New::kComplete;
  if (c.foreign == Foreign::kBefore || c.foreign == Foreign::kInFrames) {
    EXPECT_EQ(status, 2);
    EXPECT_THAT(err.str(), HasSubstr(letter));
    const std::string said = err.str();
    EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
    EXPECT_EQ(files(r), before);
    only({"r"});
  } else if (c.foreign == Foreign::kDuring) {
    EXPECT_EQ(status, 2);
    EXPECT_THAT(err.str(), HasSubstr("r.new"));
    EXPECT_EQ(files(r), before);
    ASSERT_TRUE(only({"r", "r.new"}));
    EXPECT_EQ(complete(dir / "r.new"), done);
    EXPECT_TRUE(is_of(dir / "r.new", 3));
  } else if (c.old == Old::kComplete && !done) {
    EXPECT_EQ(status, status_of(c.now));
    EXPECT_EQ(files(r), before);
    ASSERT_TRUE(only({"r", "r.partial"}));
    EXPECT_FALSE(complete(dir / "r.partial"));
    EXPECT_TRUE(is_of(dir / "r.partial", 3));
    EXPECT_THAT(err.str(), HasSubstr("r' keeps the results of 2"));
    EXPECT_THAT(out.str(), HasSubstr("r.partial"));
  } else {
    EXPECT_EQ(status, status_of(c.now));
    ASSERT_TRUE(only({"r"}));
    EXPECT_EQ(complete(r), done);
    EXPECT_TRUE(is_of(r, 3));
    const std::string text =
        c.old == Old::kComplete ? "replaces the results of 2" : "replaces the partial results of 2";
    if (had)
      EXPECT_THAT(err.str(), HasSubstr(text));
    else
      EXPECT_THAT(err.str(), Not(HasSubstr("replaces")));
  }
}

INSTANTIATE_TEST_SUITE_P(All, EveryResultTest, testing::ValuesIn(all_cases()),
                         [](const testing::TestParamInfo<Case>& i) {
                           return i.param.command + "_old" +
                                  std::to_string(static_cast<int>(i.param.old)) + "_new" +
                                  std::to_string(static_cast<int>(i.param.now)) + "_foreign" +
                                  std::to_string(static_cast<int>(i.param.foreign));
                         });

TEST_F(ResultsTest, TheDateIsThatOfTheOldResults) {
  ASSERT_EQ(start("run", r, New::kComplete, 2), 0);
  std::tm when{};
  when.tm_year = 2021 - 1900;
  when.tm_mon = 4;
  when.tm_mday = 6;
  when.tm_hour = 7;
  when.tm_min = 8;
  when.tm_sec = 9;
  when.tm_isdst = -1;
  const timespec times[2] = {{std::mktime(&when), 0}, {std::mktime(&when), 0}};
  ASSERT_EQ(::utimensat(AT_FDCWD, (r / "stats.json").c_str(), times, 0), 0);
  ASSERT_EQ(start("run", r, New::kComplete, 3), 0);
  EXPECT_EQ(err.str(), "fovea: replaces the results of 2021-05-06 07:08:09\n");
}

TEST_F(ResultsTest, OneCommandDoesNotReplaceTheResultsOfAnother) {
  for (const std::string old : {"run", "replay"}) {
    const std::string other = old == "run" ? "replay" : "run";
    const fs::path to = dir / ("r_" + old);
    for (const New how : {New::kComplete, New::kStopped}) {
      ASSERT_EQ(start(old, to, how, 2), status_of(how));
      const auto before = files(to);
      EXPECT_EQ(start(other, to, New::kComplete, 3), 2);
      EXPECT_THAT(err.str(), HasSubstr("of 'fovea " + old + "'"));
      EXPECT_EQ(files(to), before);
      fs::remove_all(to);
    }
  }
}

TEST_F(ResultsTest, PartialResultsReplaceOlderPartialOnesBesideACompleteOne) {
  ASSERT_EQ(start("run", r, New::kComplete, 2), 0);
  ASSERT_EQ(start("run", r, New::kStopped, 3), 130);
  ASSERT_EQ(start("run", r, New::kFailed, 5), 3);
  ASSERT_TRUE(only({"r", "r.partial"}));
  EXPECT_TRUE(is_of(r, 2));
  EXPECT_TRUE(is_of(dir / "r.partial", 5));
}

TEST_F(ResultsTest, WhatLiesUnderTheNameForPartialResultsStays) {
  ASSERT_EQ(start("run", dir / "r.partial", New::kComplete, 2), 0);
  dir.write("r.partial.2/letter.txt", "dear");
  ASSERT_EQ(start("run", r, New::kComplete, 3), 0);
  ASSERT_EQ(start("run", r, New::kStopped, 5), 130);
  ASSERT_TRUE(only({"r", "r.partial", "r.partial.2", "r.partial.3"}));
  EXPECT_TRUE(is_of(dir / "r.partial", 2));
  EXPECT_EQ(read_text(dir / "r.partial.2/letter.txt"), "dear");
  EXPECT_TRUE(is_of(dir / "r.partial.3", 5));
  EXPECT_THAT(err.str(), HasSubstr("r.partial.3"));
}

TEST_F(ResultsTest, ResultsThatCannotBeReadCountAsComplete) {
  ASSERT_EQ(start("run", r, New::kStopped, 2), 130);
  dir.write("r/stats.json", "{\"complete\": fal");
  ASSERT_EQ(start("run", r, New::kStopped, 3), 130);
  EXPECT_TRUE(only({"r", "r.partial"}));
}

TEST_F(ResultsTest, AFileOfTheUserInTheUnfinishedFolderStays) {
  ASSERT_EQ(start("run", r, New::kComplete, 2), 0);
  visitor = [&] {
    dir.write("r.tmp/letter.txt", "dear");
    throw UserError("no footage");
  };
  EXPECT_EQ(start("run", r, New::kComplete, 3), 2);
  EXPECT_TRUE(is_of(r, 2));
  // What tells whose the folder is stays with it.
  const auto left = files(dir / "r.tmp");
  EXPECT_EQ(left.size(), 2u);
  EXPECT_TRUE(left.contains("config.json"));
  EXPECT_EQ(left.at("letter.txt"), "dear");
  visitor = nullptr;
  EXPECT_EQ(start("run", r, New::kComplete, 3), 2);
  EXPECT_THAT(err.str(), HasSubstr("r.tmp"));
  EXPECT_EQ(read_text(dir / "r.tmp/letter.txt"), "dear");
}

TEST_F(ResultsTest, OnlyARunThatShowsPicturesHasAFolderForThem) {
  ASSERT_EQ(start("replay", dir / "r_replay", New::kComplete, 2), 0);
  EXPECT_FALSE(fs::exists(dir / "r_replay/frames"));
  ASSERT_EQ(start("run", r, New::kComplete, 2), 0);
  EXPECT_TRUE(fs::is_directory(r / "frames"));
}

}  // namespace
}  // namespace fovea::app
