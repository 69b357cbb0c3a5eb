// The commands compare, check, bless and trend as a user gives them: words, exit statuses, files.
#include <sqlite3.h>
#include <unistd.h>

#include <atomic>
#include <nlohmann/json.hpp>
#include <thread>

#include "sw/fovea/compare/compare.h"
#include "sw/fovea/regression/trend.h"
#include "tb/regression/command_fixture.h"

namespace fovea::regression {
namespace {

namespace fs = std::filesystem;
using test::read_text;
using test::TempDir;
using test::user_error;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

TEST_F(RegressionCommandTest, EqualRunsEndWithZeroDifferentOnesWithOne) {
  EXPECT_EQ(cli({"compare", a, a}), 0) << err.str();
  EXPECT_THAT(out.str(), HasSubstr("equal: all 6 figures"));
  EXPECT_EQ(cli({"compare", a, b}), 1) << err.str();
  EXPECT_THAT(out.str(), AllOf(HasSubstr("different: 3 of 7 figures"), HasSubstr("+5.0 %"),
                               HasSubstr("missing"), HasSubstr("largest slow-down: remap (remap.c:21)"),
                               HasSubstr("unexplained: +0 clocks (0.0 %)")));
  EXPECT_EQ(cli({"compare", a, b, "--only", "frame.*", "--tolerance", "5%"}), 0) << out.str();
  EXPECT_EQ(cli({"compare", a, b, "--only", "frame.*", "--tolerance", "4.9%"}), 1) << out.str();
  EXPECT_EQ(cli({"compare", a, b, "--only", "nothing"}), 2);
}

TEST_F(RegressionCommandTest, ThirtyFiguresAreShownAndTheOthersCounted) {
  for (const unsigned figures : {30u, 31u, 33u}) {
    RunMaker one = profiled(), two = profiled();
    for (unsigned n = 0; n < figures; ++n) {
      one.figure(fmt::format("f.{:02}", n), "1");
      two.figure(fmt::format("f.{:02}", n), "2");
    }
    const std::vector<std::string> words = {"compare", one.write(dir, "one").string(), two.write(dir, "two").string()};
    EXPECT_EQ(cli(words), 1);
    EXPECT_THAT(out.str(), HasSubstr(fmt::format("different: {} of", figures)));
    const std::string rest = fmt::format("\n  {} more figures; --all lists them\n", figures - 30);
    EXPECT_THAT(out.str(), figures > 30 ? testing::Matcher<std::string>(HasSubstr(rest))
                                        : Not(HasSubstr("more figures")));
    auto all = words;
    all.push_back("--all");
    EXPECT_EQ(cli(all), 1);
    EXPECT_THAT(out.str(), AllOf(Not(HasSubstr("more figures")), HasSubstr("f.29")));
  }
}

TEST_F(RegressionCommandTest, AFieldThatIsNoNumberIsShownByItsBegin) {
  RunMaker damaged = profiled();
  const std::string field = std::string(39, '1') + "x" + std::string(10, '2');
  damaged.stalls = "dcache,lut,bridge," + field + "\n";
  damaged.profile.clear();
  EXPECT_EQ(cli({"compare", a, damaged.write(dir, "damaged").string()}), 2);
  EXPECT_THAT(err.str(),
              HasSubstr("stalls.csv:2: '" + field.substr(0, 40) + "...' is not a whole number"));
  for (const char* wrong : {"12x", "x12", "18446744073709551616"}) {
    damaged.stalls = std::string("dcache,lut,bridge,") + wrong + "\n";
    EXPECT_EQ(cli({"compare", a, damaged.write(dir, "damaged").string()}), 2) << wrong;
    EXPECT_THAT(err.str(), HasSubstr(std::string("'") + wrong + "' is not a whole number"));
  }
}

TEST_F(RegressionCommandTest, AFigureThatOnlyOneRunHasOrThatChangedItsUnitDiffers) {
  const auto changed = [&](const std::string& value, const std::string& unit) {
    RunMaker r = profiled();
    r.figure("frame.remap_time.mean", value, unit);
    return cli({"compare", a, r.write(dir, "c").string(), "--tolerance", "100%"});
  };
  EXPECT_EQ(changed("0.004", "s"), 0);
  // A count and a number with decimals: 1.1 - 1 is 0.10000000000000009 in double precision.
  RunMaker one = profiled(), decimal = profiled();
  one.figure("extra", "1");
  decimal.figure("extra", "1.1");
  EXPECT_EQ(
      cli({"compare", one.write(dir, "one").string(), decimal.write(dir, "decimal").string(), "--tolerance", "0.1"}),
      0);
  EXPECT_EQ(changed("0.004", "ms"), 1);
  EXPECT_THAT(out.str(), HasSubstr("other unit"));
  EXPECT_EQ(changed("null", "s"), 1);
  EXPECT_THAT(out.str(), HasSubstr("no value"));
  RunMaker r = profiled();
  r.figures.erase("frame.remap_time.mean");
  EXPECT_EQ(cli({"compare", a, r.write(dir, "c").string(), "--tolerance", "100%"}), 1);
}

TEST_F(RegressionCommandTest, CsvAndJsonHoldTheSameFigures) {
  EXPECT_EQ(cli({"compare", a, b, "--csv"}), 1);
  EXPECT_EQ(out.str(),
            "figure,unit,a,b,difference,relative\ncpu.idle,cycles,300,280,-20,-0.06666666666666667\n"
            "extra,1,,1,,\nframe.remap_time.mean,s,0.004,0.0042,0.00019999999999999966,0.04999999999999991\n");
  EXPECT_EQ(cli({"compare", a, b, "--json"}), 1);
  const auto json = nlohmann::json::parse(out.str());
  EXPECT_EQ(json["equal"], false);
  EXPECT_EQ(json["figures"].size(), 3u);
  EXPECT_EQ(json["clocks"]["busy"]["change"], 20);
  EXPECT_EQ(json["clocks"]["unexplained"], 0);
  EXPECT_EQ(json["clocks"]["functions"][0]["function"], "remap");
  EXPECT_EQ(json["clocks"]["functions"][0]["lines"][0]["b"], 21);
  EXPECT_EQ(cli({"compare", a, b, "--json", "--csv"}), 2);
}

TEST_F(RegressionCommandTest, FoldersThatAreNoCompleteRunAreRefusedInOneLine) {
  const auto refused = [&](const std::string& folder, const std::string& why) {
    for (const auto& args : {std::vector<std::string>{"compare", folder, a},
                             {"compare", a, folder},
                             {"check", folder, "--against", base},
                             {"trend", folder, "--database", (dir / "t.db").string()}}) {
      if (args[0] == "check") cli({"bless", a, "--against", base, "--why", "first"});
      EXPECT_EQ(cli(args), 2) << args[0];
      EXPECT_THAT(err.str(), HasSubstr(why)) << args[0];
      EXPECT_EQ(out.str(), "");
    }
  };
  refused((dir / "nowhere").string(), "is not a folder");
  fs::create_directory(dir / "empty");
  refused((dir / "empty").string(), "not a folder of results");
  RunMaker r = profiled();
  r.complete = false;
  refused(r.write(dir, "partial").string(), "partial results");
  dir.write("partial/stats.json", "{\"band\": \"not run\"}");
  refused((dir / "partial").string(), "does not say whether its results are complete");
  r.no_stats = true;
  refused(r.write(dir, "unfinished").string(), "has no stats.json");
  profiled().write(dir, "damaged");
  dir.write("damaged/stats.json", "{\"complete\": tr");
  refused((dir / "damaged").string(), "not a file of JSON");
}

TEST_F(RegressionCommandTest, OtherVersionsAreRefusedOrListed) {
  slow.version = "0.2.0";
  slow.parameters["ddr.new"] = "7";
  slow.write(dir, "b");
  EXPECT_EQ(cli({"compare", a, b}), 2);
  EXPECT_THAT(err.str(), AllOf(HasSubstr("0.2.0"), HasSubstr("--across-versions")));
  RunMaker modified = profiled();
  modified.modified = true;
  EXPECT_EQ(cli({"compare", a, modified.write(dir, "modified").string()}), 2)
      << "a commit with changes is another simulator";
  EXPECT_EQ(cli({"compare", a, b, "--across-versions"}), 1);
  EXPECT_THAT(out.str(), AllOf(HasSubstr("simulator: 0.1.0"), HasSubstr("parameter ddr.new is new: 7")));
  EXPECT_EQ(cli({"bless", a, "--against", base, "--why", "first"}), 0);
  EXPECT_EQ(cli({"check", b, "--against", base}), 2);
  EXPECT_EQ(cli({"check", b, "--against", base, "--across-versions"}), 1);
  EXPECT_THAT(out.str(), HasSubstr("parameter ddr.new is new: 7"));
}

TEST_F(RegressionCommandTest, BlessCheckBlessCheck) {
  EXPECT_EQ(cli({"check", a, "--against", base}), 2);
  EXPECT_EQ(cli({"bless", a, "--against", base, "--why", " "}), 2);
  ASSERT_EQ(cli({"bless", a, "--against", base, "--why", "the first one"}), 0) << err.str();
  EXPECT_THAT(out.str(), AllOf(HasSubstr("+    why: \"the first one\""), HasSubstr("reference in")));
  EXPECT_EQ(cli({"check", a, "--against", base}), 0) << err.str();
  EXPECT_EQ(cli({"check", b, "--against", base, "--junit", (dir / "j.xml").string()}), 1);
  EXPECT_THAT(out.str(), HasSubstr("blamed: remap (remap.c:21) waits"));
  EXPECT_THAT(read_text(dir / "j.xml"), HasSubstr("blamed: remap (remap.c:21)"));
  const std::string before = read_text(base);
  ASSERT_EQ(cli({"bless", b, "--against", base, "--why", "more accurate"}), 0) << err.str();
  EXPECT_THAT(out.str(),
              AllOf(HasSubstr("-    value: 0.004\n+    value: 0.0042\n"), HasSubstr("why: \"more accurate\"")));
  EXPECT_THAT(read_text(dir / "base/profile.csv"), HasSubstr("vpbe,70")) << "the reference is the new run's";
  EXPECT_EQ(cli({"check", b, "--against", base}), 0) << out.str();
  EXPECT_EQ(cli({"check", a, "--against", base}), 0) << "faster is not worse";
  EXPECT_THAT(out.str(), AllOf(HasSubstr("better"), HasSubstr("fovea bless")));
  EXPECT_EQ(cli({"bless", b, "--against", base, "--why", "again"}), 0);
  EXPECT_THAT(out.str(), HasSubstr("nothing to bless"));
  EXPECT_NE(read_text(base), before);
}

TEST_F(RegressionCommandTest, BlessingLeavesALimitThatFails) {
  dir.write("base.yaml",
            "format: fovea baseline 1\nexperiment: tiny\nsimulator: {version: 0.1.0, commit: aaaaaaaaaaaa}\n"
            "metrics:\n  frame.remap_time.mean: {value: 0.004, unit: s, kind: budget, worse: higher, reason: 250 Hz}\n"
            "  cpu.idle: {value: 300, unit: cycles}\n");
  EXPECT_EQ(cli({"bless", b, "--against", base, "--why", "slower"}), 1);
  EXPECT_THAT(err.str(), AllOf(HasSubstr("frame.remap_time.mean still fails"), HasSubstr("budget")));
  EXPECT_THAT(read_text(base), AllOf(HasSubstr("value: 0.004,"), HasSubstr("value: 280,")));
}

// Written by hand, with a reference that is not there yet; then one without functions gets them.
TEST_F(RegressionCommandTest, BlessingMakesAReferenceThatIsMissingOrPoorer) {
  dir.write("base.yaml",
            "format: fovea baseline 1\nexperiment: tiny\nsimulator: {version: 0.1.0, commit: aaaaaaaaaaaa}\n"
            "reference: kept\nmetrics:\n  cpu.idle: {value: 300, unit: cycles}\n");
  RunMaker plain = profiled();
  plain.profile.clear();
  EXPECT_EQ(cli({"bless", plain.write(dir, "plain").string(), "--against", base, "--why", "x"}), 0) << err.str();
  EXPECT_THAT(out.str(), AllOf(HasSubstr("+reference_sha256: "), HasSubstr("reference in"), Not(HasSubstr("why"))));
  EXPECT_THAT(read_text(dir / "kept/profile.csv"), Not(HasSubstr("remap.c")));
  RunMaker placeless = profiled();
  placeless.functions.clear();
  EXPECT_EQ(cli({"bless", placeless.write(dir, "placeless").string(), "--against", base, "--why", "x"}), 0);
  EXPECT_THAT(read_text(dir / "kept/profile.csv"), HasSubstr("remap.c,21")) << "functions, though not where they lie";
  EXPECT_EQ(cli({"bless", (dir / "plain").string(), "--against", base, "--why", "x"}), 0);
  EXPECT_THAT(read_text(dir / "kept/profile.csv"), HasSubstr("remap.c,21")) << "a poorer one takes nothing away";
  EXPECT_EQ(cli({"bless", a, "--against", base, "--why", "x"}), 0);
  EXPECT_THAT(read_text(dir / "kept/profile.csv"), HasSubstr("remap.c,21"));
  EXPECT_EQ(cli({"bless", a, "--against", base, "--why", "x"}), 0);
  EXPECT_THAT(out.str(), Not(HasSubstr("reference in")));
  EXPECT_EQ(cli({"check", b, "--against", base}), 1);
  EXPECT_THAT(out.str(), HasSubstr("blamed: remap (remap.c:21)"));
  EXPECT_THAT(read_text(dir / "kept/functions.csv"), HasSubstr("irq,irq.c,0x00000100,64,aa"));
  // One with functions, but not where they lie.
  std::filesystem::remove(dir / "kept/functions.csv");
  EXPECT_EQ(cli({"bless", a, "--against", base, "--why", "x"}), 0);
  EXPECT_THAT(read_text(dir / "kept/functions.csv"), HasSubstr("irq,irq.c,0x00000100,64,aa"));
}

// A reference is never written into a folder that holds something else: another name is taken.
TEST_F(RegressionCommandTest, BlessingWritesNoReferenceIntoAnotherFolder) {
  const std::string stats = read_text(dir / "a/stats.json");
  dir.write("full/mine.txt", "mine\n");
  for (const char* name : {"a", "full"}) {
    const std::string file = (dir / (std::string(name) + ".yaml")).string();
    EXPECT_EQ(cli({"bless", a, "--against", file, "--why", "x"}), 0) << name << err.str();
    EXPECT_THAT(out.str(), HasSubstr(std::string(name) + "-reference\n"));
    EXPECT_TRUE(fs::exists(dir / (std::string(name) + "-reference/figures.csv")));
    EXPECT_FALSE(fs::exists(dir / (std::string(name) + "/figures.csv")));
    EXPECT_EQ(cli({"check", b, "--against", file}), 1);
    EXPECT_THAT(out.str(), HasSubstr("blamed: remap (remap.c:21)"));
    fs::remove(file);
    fs::remove_all(dir / (std::string(name) + "-reference"));
    dir.write(std::string(name) + "-reference/mine.txt", "mine\n");
    EXPECT_EQ(cli({"bless", a, "--against", file, "--why", "x"}), 2) << name;
    EXPECT_THAT(err.str(), HasSubstr("beside it hold something else, and one of them would be the reference"));
    EXPECT_FALSE(fs::exists(file)) << "a baseline without its reference";
  }
  EXPECT_EQ(read_text(dir / "a/stats.json"), stats);
  EXPECT_EQ(read_text(dir / "full/mine.txt"), "mine\n");
  // A reference that is named by hand.
  dir.write("hand.yaml",
            "format: fovea baseline 1\nexperiment: tiny\nsimulator: {version: 0.1.0, commit: aaaaaaaaaaaa}\n"
            "reference: full\nmetrics:\n  cpu.idle: {value: 299, unit: cycles}\n");
  EXPECT_EQ(cli({"bless", a, "--against", (dir / "hand.yaml").string(), "--why", "x"}), 2);
  EXPECT_THAT(err.str(), HasSubstr("would be the reference, but it holds something else"));
}

// SHA-256 of names, sizes and contents, by the program of the system and not by Fovea's.
std::string hash_by_sha256sum(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  std::ofstream all(folder.string() + ".all", std::ios::binary);
  for (const std::string& name : names) {
    const std::string text = read_text(folder / name);
    all << name << " " << text.size() << "\n" << text;
  }
  all.close();
  const std::string command = "sha256sum '" + folder.string() + ".all'";
  FILE* const pipe = ::popen(command.c_str(), "r");
  std::string line(64, '\0');
  EXPECT_EQ(::fread(line.data(), 1, line.size(), pipe), line.size());
  ::pclose(pipe);
  return line;
}

class BlessTogetherTest : public RegressionCommandTest {
 protected:
  /// The baselines of `a` and of `b`, each with its reference, and the runs that they are of.
  BlessTogetherTest() {
    EXPECT_EQ(cli({"bless", a, "--against", base, "--why", "first"}), 0) << err.str();
    old_text = read_text(base);
    fs::copy(dir / "base", dir / "old");
    EXPECT_EQ(cli({"bless", b, "--against", base, "--why", "second"}), 0) << err.str();
    new_text = read_text(base);
    fs::copy(dir / "base", dir / "new");
  }
  void state(const std::string& text, const char* in_place, const char* beside) {
    for (const char* name : {"base", "base.tmp", "base.old"}) fs::remove_all(dir / name);
    dir.write("base.yaml", text);
    if (*in_place) fs::copy(dir / in_place, dir / "base");
    if (*beside) fs::copy(dir / beside, dir / "base.tmp");
  }
  void expect_same(const char* x, const char* y) {
    EXPECT_EQ(hash_by_sha256sum(dir / x), hash_by_sha256sum(dir / y)) << x << " is not " << y;
  }
  std::string old_text, new_text;
};

TEST_F(BlessTogetherTest, TheBaselineHasTheHashOfItsReference) {
  EXPECT_THAT(new_text, HasSubstr("\nreference: base\nreference_sha256: " + hash_by_sha256sum(dir / "new") + "\n"));
  EXPECT_THAT(old_text, HasSubstr("\nreference_sha256: " + hash_by_sha256sum(dir / "old") + "\n"));
}

// In every state in which a killed bless may leave the two, the baseline finds its own reference; the next bless has
// both in their places, and leaves nothing beside them.
TEST_F(BlessTogetherTest, WhatAKilledBlessLeftIsPutRight) {
  struct State {
    const std::string& text;
    const char *in_place, *beside;
  };
  for (const auto& [text, in_place, beside] :
       {State{old_text, "old", "new"}, {old_text, "new", "old"}, {old_text, "", "old"}, {new_text, "new", "old"}}) {
    const bool is_old = text == old_text;
    state(text, in_place, beside);
    EXPECT_EQ(cli({"check", b, "--against", base}), is_old ? 1 : 0) << err.str();
    if (is_old) EXPECT_THAT(out.str(), HasSubstr("blamed: remap (remap.c:21)"));
    EXPECT_EQ(cli({"bless", a, "--against", base, "--why", "again"}), 0) << err.str();
    EXPECT_EQ(cli({"check", b, "--against", base}), 1) << err.str();
    EXPECT_THAT(out.str(), HasSubstr("blamed: remap (remap.c:21)"));
    expect_same("base", "old");
    state(text, in_place, beside);
    EXPECT_EQ(cli({"bless", b, "--against", base, "--why", "again"}), 0) << err.str();
    expect_same("base", "new");
    EXPECT_EQ(cli({"check", a, "--against", base}), 0) << err.str();
    EXPECT_FALSE(fs::exists(dir / "base.tmp")) << "left beside";
    EXPECT_FALSE(fs::exists(dir / "base.yaml.tmp"));
  }
}

TEST_F(BlessTogetherTest, AReferenceOfAnotherBaselineIsNotBlamedWith) {
  state(old_text, "new", "");
  EXPECT_EQ(cli({"check", b, "--against", base}), 2);
  EXPECT_THAT(err.str(), AllOf(HasSubstr("has other files than 'reference_sha256' says"), HasSubstr("fovea bless")));
  state(old_text, "old", "");
  dir.write("base/figures.csv", "");  // cut off
  EXPECT_EQ(cli({"check", b, "--against", base}), 2);
  EXPECT_EQ(cli({"bless", a, "--against", base, "--why", "again"}), 0) << err.str();
  EXPECT_EQ(cli({"check", b, "--against", base}), 1);
  expect_same("base", "old");
}

// As people write it, and as earlier versions did.
TEST_F(BlessTogetherTest, ABaselineWithoutAHashGetsOne) {
  std::string bare = old_text;
  const auto at = bare.find("reference_sha256");
  bare.erase(at, bare.find('\n', at) + 1 - at);
  bare.replace(bare.find("reference: base"), 15, "reference: base   # as before");
  state(bare, "old", "");
  EXPECT_EQ(cli({"check", b, "--against", base}), 1) << err.str();
  EXPECT_EQ(cli({"bless", a, "--against", base, "--why", "x"}), 0);
  EXPECT_EQ(read_text(base), bare) << "nothing changed, and nothing is written";
  EXPECT_EQ(cli({"bless", b, "--against", base, "--why", "second"}), 0) << err.str();
  EXPECT_THAT(read_text(base), HasSubstr("\nreference: base   # as before\nreference_sha256: " +
                                         hash_by_sha256sum(dir / "new") + "\n"));
  expect_same("base", "new");
}

TEST_F(BlessTogetherTest, NoLinkIsFollowedAndNoFolderElsewhereIsTaken) {
  const auto bless = [&] { return cli({"bless", a, "--against", base, "--why", "x"}); };
  dir.write("victim.txt", "mine\n");
  fs::remove(dir / "base/figures.csv");
  fs::create_symlink("../victim.txt", dir / "base/figures.csv");
  EXPECT_EQ(bless(), 2);
  EXPECT_THAT(err.str(), HasSubstr("'figures.csv' is no file of a reference"));
  fs::remove_all(dir / "base");
  fs::create_directory_symlink("old", dir / "base");
  EXPECT_EQ(bless(), 2);
  EXPECT_THAT(err.str(), HasSubstr("is no folder"));
  expect_same("old", "old");
  fs::remove(dir / "base");
  EXPECT_EQ(read_text(dir / "victim.txt"), "mine\n");
  for (const std::string name : {"../base", "/tmp/base", "..", ".", "a/b"}) {
    std::string text = new_text;
    text.replace(text.find("reference: base"), 15, "reference: " + name);
    dir.write("base.yaml", text);
    EXPECT_EQ(bless(), 2);
    EXPECT_THAT(err.str(), HasSubstr("allowed: a name without '/'")) << name;
  }
  fs::remove(base);
  dir.write("mine.yaml", new_text);
  fs::create_symlink("mine.yaml", base);
  EXPECT_EQ(bless(), 2);
  EXPECT_THAT(err.str(), HasSubstr("symbolic link"));
  EXPECT_EQ(read_text(dir / "mine.yaml"), new_text);
  if (::geteuid() != 0) return;
  fs::remove(base);
  state(new_text, "new", "");
  ASSERT_EQ(::chown((dir / "base").c_str(), 65534, 65534), 0);
  EXPECT_EQ(bless(), 2);
  EXPECT_THAT(err.str(), HasSubstr("belongs to another user"));
}

// The lock is held from reading to the last rename: every history entry of a bless that ended with 0 is there.
TEST_F(BlessTogetherTest, OfManyAtOnceNoneIsLost) {
  constexpr int kEach = 25;
  std::atomic<int> done = 0;
  std::vector<std::thread> people;
  for (const std::string& run : {a, b, a, b})
    people.emplace_back([&, run] {
      for (int n = 0; n < kEach; ++n) {
        std::ostringstream said, wrong;
        const int status = app::run_cli({"bless", run, "--against", base, "--why", "many"},
                                        {.out = said, .err = wrong});
        if (status == 0 && said.str().find("+    why: \"many\"") != std::string::npos) ++done;
        if (status != 0) EXPECT_THAT(wrong.str(), HasSubstr("another run is writing it"));
      }
    });
  for (auto& p : people) p.join();
  const std::string text = read_text(base);
  int entries = 0;
  for (auto at = text.find("\"many\""); at != text.npos; at = text.find("\"many\"", at + 1)) ++entries;
  EXPECT_GT(done, 0);
  EXPECT_EQ(entries, done);
  EXPECT_THAT(text, HasSubstr("reference_sha256: " + hash_by_sha256sum(dir / "base") + "\n"));
  EXPECT_FALSE(fs::exists(dir / "base.tmp"));
}

TEST_F(RegressionCommandTest, OtherFilesAreNotReplaced) {
  dir.write("notes.yaml", "my: notes\n");
  EXPECT_EQ(cli({"bless", a, "--against", (dir / "notes.yaml").string(), "--why", "x"}), 2);
  EXPECT_EQ(read_text(dir / "notes.yaml"), "my: notes\n");
  cli({"bless", a, "--against", base, "--why", "first"});
  EXPECT_EQ(cli({"check", a, "--against", base, "--junit", (dir / "notes.yaml").string()}), 2);
  EXPECT_EQ(read_text(dir / "notes.yaml"), "my: notes\n");
  dir.write("other.db", "my: notes\n");
  EXPECT_EQ(cli({"trend", a, "--database", (dir / "other.db").string()}), 2);
  EXPECT_EQ(read_text(dir / "other.db"), "my: notes\n");
  sqlite3* db = nullptr;
  ASSERT_EQ(sqlite3_open((dir / "foreign.db").c_str(), &db), SQLITE_OK);
  sqlite3_exec(db, "CREATE TABLE theirs (x)", nullptr, nullptr, nullptr);
  sqlite3_close(db);
  EXPECT_EQ(cli({"trend", a, "--database", (dir / "foreign.db").string()}), 2);
  EXPECT_THAT(err.str(), HasSubstr("another program"));
  EXPECT_EQ(cli({"trend", a, "--database", (dir / "own.db").string(), "--commit", "x"}), 0) << err.str();
  const std::string own = read_text(dir / "own.db");
  fs::create_symlink("own.db", dir / "link.db");
  EXPECT_EQ(cli({"trend", b, "--database", (dir / "link.db").string(), "--commit", "y"}), 2);
  EXPECT_THAT(err.str(), HasSubstr("symbolic link"));
  EXPECT_EQ(read_text(dir / "own.db"), own);
  ASSERT_EQ(sqlite3_open((dir / "own.db").c_str(), &db), SQLITE_OK);
  sqlite3_exec(db, "UPDATE runs SET units = '{\"cpu.cycles\": 1}'", nullptr, nullptr, nullptr);
  sqlite3_close(db);
  EXPECT_EQ(cli({"trend", "--database", (dir / "own.db").string(), "--plot", (dir / "t.svg").string()}), 2);
  EXPECT_THAT(err.str(), HasSubstr("the line of commit x cannot be read"));
}

}  // namespace
}  // namespace fovea::regression
