// sw/fovea/cli/cli.h with a fake board: files, exit statuses, messages; and how the real program reacts
// to signals and a full disk.
#include "sw/fovea/cli/cli.h"

#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "sw/fovea/cli/help.h"
#include "sw/fovea/explain/wrapped.h"
#include "sw/fovea/files/png.h"
#include "sw/fovea/results/provenance.h"
#include "tb/unit/fake_board.h"
#include "tb/unit/support.h"

namespace fovea::app {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::read_text;
using test::TempDir;
using testing::AllOf;
using testing::HasSubstr;

class CliTest : public testing::Test {
 protected:
  CliTest() { experiment = dir.write("exp.yaml", "run.frames: 4\n").string(); }
  int cli(std::vector<std::string> args) {
    out.str("");
    err.str("");
    return run_cli(args, {.out = out,
                          .err = err,
                          .make_machine = [](MachineKind) { return std::make_unique<test::FakeBoard>(); },
                          .tools = test::fake_tools(),
                          .signal = &signal,
                          .stop = &stop});
  }
  /// `fovea run` of the experiment into r, with more arguments.
  int run(std::vector<std::string> more = {}) {
    std::vector<std::string> args{"run", experiment, "-o", result.string()};
    args.insert(args.end(), more.begin(), more.end());
    return cli(args);
  }
  json stats() { return json::parse(read_text(result / "stats.json")); }

  TempDir dir;
  std::string experiment;
  fs::path result = dir / "r";
  std::ostringstream out, err;
  std::atomic<int> signal{0};
  std::atomic<bool> stop{false};
};

TEST_F(CliTest, RunLeavesAllFilesOfTheContract) {
  ASSERT_EQ(run(), 0) << err.str();
  for (const char* name : {"config.json", "stats.json", "host.json", "frames.csv", "timeline.csv",
                           "stalls.csv", "latency.csv", "slowest.csv", "uart.log", "frames/frame_000000.png",
                           "frames/frame_000003.png", "camera/frame_000001.png", "camera/frame_000003.png"})
    EXPECT_TRUE(fs::is_regular_file(result / name)) << name;
  EXPECT_FALSE(fs::exists(dir / "r.tmp"));
  EXPECT_EQ(stats()["complete"], true);
  EXPECT_EQ(stats()["frame.displayed"]["value"], 4);
  EXPECT_EQ(read_text(result / "uart.log"), "hello from the guest\n");
  EXPECT_EQ(read_png(result / "frames/frame_000003.png").width, 32u);
  const auto host = json::parse(read_text(result / "host.json"));
  EXPECT_GT(host["wall_time"]["value"], 0.0);
  EXPECT_GT(host["realtime_factor"]["value"], 0.0);
  EXPECT_EQ(host["command"][0], "run");
  EXPECT_THAT(out.str(), AllOf(HasSubstr("results in "), HasSubstr("\npictures in its frames/")));
}

TEST_F(CliTest, TwoRunsAreEqualInAllButHostJson) {
  ASSERT_EQ(run(), 0);
  std::vector<std::string> first;
  const auto names = {"config.json", "stats.json", "frames.csv", "timeline.csv",
                      "stalls.csv", "frames/frame_000002.png"};
  for (const char* name : names) first.push_back(read_text(result / name));
  ASSERT_EQ(run(), 0);
  std::size_t i = 0;
  for (const char* name : names) EXPECT_EQ(read_text(result / name), first[i++]) << name;
}

TEST_F(CliTest, RowsAreWrittenInOrderWhetherEarlyOrLate) {
  for (const unsigned frames : {1u, 3u, 4u}) {
    ASSERT_EQ(run({"-s", "run.frames=" + std::to_string(frames)}), 0) << err.str();
    std::istringstream csv(read_text(result / "frames.csv"));
    std::string line;
    std::getline(csv, line);
    EXPECT_THAT(line, testing::StartsWith("frame,camera,"));
    for (unsigned i = 0; i < frames; ++i) {
      ASSERT_TRUE(std::getline(csv, line));
      EXPECT_THAT(line, testing::StartsWith(std::to_string(i) + ","));
    }
    EXPECT_FALSE(std::getline(csv, line));
  }
  EXPECT_EQ(read_text(result / "timeline.csv"),
            "start_ns,end_ns,arm_d.read_bytes,arm_d.write_bytes\n"
            "0.000,1000000.000,32,8\n1000000.000,2000000.000,64,0\n");
}

TEST_F(CliTest, CommandLineWinsAndIsRecorded) {
  ASSERT_EQ(run({"-s", "run.frames=2", "-s", "run.mode=slow", "--sync=strict"}), 0) << err.str();
  EXPECT_EQ(stats()["frame.displayed"]["value"], 2);
  EXPECT_EQ(stats()["sync.strict"]["value"], 1);
  const auto config = json::parse(read_text(result / "config.json"));
  EXPECT_EQ(config["params"]["run.frames"]["origin"], "command line");
  ASSERT_EQ(run({"-s", "run.list=[1.5, -2]"}), 0) << err.str();
  EXPECT_EQ(json::parse(read_text(result / "config.json"))["params"]["run.list"]["value"],
            "[1.5, -2]");
}

TEST_F(CliTest, SetMayStandBeforeTheExperiment) {
  EXPECT_EQ(cli({"run", "-s", "run.frames=1", experiment, "-o", result.string()}), 0) << err.str();
  EXPECT_EQ(stats()["frame.displayed"]["value"], 1);
}

TEST_F(CliTest, NoFramesWritesNoPictures) {
  ASSERT_EQ(run({"--no-frames"}), 0);
  EXPECT_FALSE(fs::exists(result / "frames"));
  EXPECT_FALSE(fs::exists(result / "camera"));
}

TEST_F(CliTest, WrongInputIsOneLineAndStatusTwo) {
  const auto expect = [&](int status, const std::string& part) {
    EXPECT_EQ(status, 2);
    EXPECT_THAT(err.str(), HasSubstr(part));
    const std::string text = err.str();
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1) << text;
  };
  expect(run({"-s", "run.frmes=2"}), "did you mean 'run.frames'?");
  expect(run({"-s", "run.frames=0"}), "1 .. 100000");
  expect(run({"--sync=loose"}), "strict");
  expect(run({"--nonsense"}), "--nonsense");
  expect(cli({"run"}), "experiment");
  expect(cli({"run", (dir / "none.yaml").string()}), "none.yaml");
  expect(cli({}), "fovea --help");
  expect(cli({"fly"}), "'fly'");
  expect(run({"-s", "run.list=[1, x]"}), "2 plain numbers");
  expect(run({"-s", "run.mode=user_error"}), "footage 'x'");
  expect(cli({"run", experiment, "-o", ""}), "output folder ''");
  expect(cli({"run", experiment, "--out="}), "--out");
  dir.write("file", "");
  expect(cli({"run", experiment, "-o", (dir / "file/r").string()}), "file/r");
}

TEST_F(CliTest, BadInputLeavesAnOlderResultAlone) {
  ASSERT_EQ(run(), 0);
  EXPECT_EQ(run({"-s", "run.mode=user_error"}), 2);
  EXPECT_EQ(stats()["complete"], true);
}

TEST_F(CliTest, ARunWithoutAResultLeavesNoFolder) {
  for (const auto& [mode, status] : std::vector<std::pair<std::string, int>>{
           {"user_error", 2}, {"guest_failure", 3}, {"defect", 4}}) {
    EXPECT_EQ(run({"-s", "run.mode=" + mode}), status);
    EXPECT_FALSE(fs::exists(result)) << mode;
    EXPECT_FALSE(fs::exists(dir / "r.tmp")) << mode;
  }
}

TEST_F(CliTest, GuestFailureIsStatusThreeAndADefectFour) {
  EXPECT_EQ(run({"-s", "run.mode=guest_failure"}), 3);
  EXPECT_THAT(err.str(), HasSubstr("PC 0x0"));
  EXPECT_EQ(run({"-s", "run.mode=defect"}), 4);
  EXPECT_THAT(err.str(), HasSubstr("own defect: broken"));
}

TEST_F(CliTest, AMissingFeatureThatAProcessFindsIsNoDefect) {
  EXPECT_EQ(run({"-s", "run.mode=not_modelled_in_kernel"}), 3);
  EXPECT_THAT(err.str(), AllOf(HasSubstr("fovea: not modelled: field X of Y\n"),
                               Not(HasSubstr("defect")), Not(HasSubstr("E549"))));
}

TEST_F(CliTest, WhatTheHostRefusesIsStatusTwoAndNoDefect) {
  for (const char* mode : {"out_of_memory", "out_of_memory_in_kernel"}) {
    EXPECT_EQ(run({"-s", std::string("run.mode=") + mode}), 2);
    EXPECT_THAT(err.str(), AllOf(HasSubstr("error: out of memory"), Not(HasSubstr("defect"))));
    const std::string text = err.str();
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1) << text;
  }
  EXPECT_EQ(run({"-s", "run.mode=no_thread"}), 2);
  EXPECT_THAT(err.str(), AllOf(HasSubstr("the host refused"), HasSubstr("temporarily")));
  EXPECT_FALSE(fs::exists(dir / "r.tmp"));
}

TEST_F(CliTest, AnOutputBesideTheResultsTakesThemNotAlong) {
  EXPECT_EQ(run({"-s", "run.mode=lost_output"}), 2);
  EXPECT_THAT(err.str(), HasSubstr("error: the toy is missing: out of memory; all other results are kept\n"));
  EXPECT_TRUE(fs::exists(result / "stats.json"));
}

TEST_F(CliTest, ASignalBeforeTheSimulationLeavesNoFolder) {
  signal = SIGTERM;
  EXPECT_EQ(run({"-s", "run.mode=stopped_decoding"}), 143);
  EXPECT_THAT(err.str(), HasSubstr("stopped before the simulation began; there are no results"));
  EXPECT_FALSE(fs::exists(result));
  EXPECT_FALSE(fs::exists(dir / "r.tmp"));
}

TEST_F(CliTest, TextOfTheGuestDoesNotDriveTheTerminal) {
  EXPECT_EQ(run({"-s", "run.mode=escape"}), 3);
  EXPECT_EQ(err.str(), "fovea: the guest failed: at \\x1b[31mmain\nsecond line\n");
}

TEST_F(CliTest, GuestFailureWithFiguresKeepsThem) {
  EXPECT_EQ(run({"-s", "run.mode=late_failure"}), 3);
  EXPECT_EQ(stats()["complete"], false);
  EXPECT_THAT(err.str(), HasSubstr("last access: 0x0"));
}

TEST_F(CliTest, MissingFeatureIsAWarningAndUnderStrictAnError) {
  EXPECT_EQ(run({"-s", "run.mode=not_modelled"}), 0);
  EXPECT_THAT(err.str(), HasSubstr("fovea: warning (model): not modelled: field X of Y\n"));
  EXPECT_EQ(stats()["warnings"][0]["what"], "not modelled: field X of Y");
  EXPECT_EQ(stats()["warnings"][0]["kind"], "model");
  EXPECT_EQ(run({"-s", "run.mode=not_modelled", "--strict"}), 3);
}

TEST_F(CliTest, StoppedRunLeavesAValidPartialResult) {
  stop = true;
  signal = SIGINT;
  EXPECT_EQ(run(), 130);
  EXPECT_EQ(stats()["complete"], false);
  EXPECT_EQ(stats()["frame.displayed"]["value"], 0);
}

TEST_F(CliTest, ParamsListsAndFilters) {
  EXPECT_EQ(cli({"params"}), 0);
  EXPECT_THAT(out.str(), AllOf(HasSubstr("run.frames"), HasSubstr("run.mode"), HasSubstr("assumed"),
                               HasSubstr("1 .. 100000")));
  EXPECT_EQ(cli({"params", "*.mode"}), 0);
  EXPECT_THAT(out.str(), Not(HasSubstr("run.frames")));
  EXPECT_EQ(cli({"params", "mode", "--markdown"}), 0);
  EXPECT_THAT(out.str(), AllOf(HasSubstr("|---|"), HasSubstr("how it ends \\| or not")));
  EXPECT_EQ(cli({"params", "run.frame_"}), 2);
  EXPECT_THAT(err.str(), HasSubstr("did you mean 'run.frames'?"));
}

TEST_F(CliTest, ParamsTakesSeveralPatterns) {
  const auto rows = [&] {
    const std::string text = out.str();
    return std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(text.find("\n\n")), '\n');
  };
  EXPECT_EQ(cli({"params", "run.frames", "run.mode"}), 0);
  EXPECT_THAT(out.str(), AllOf(HasSubstr("run.frames"), HasSubstr("run.mode")));
  EXPECT_EQ(rows(), 2);
  // A key that two patterns match is listed once, in the order of the keys.
  EXPECT_EQ(cli({"params", "run.mode", "run.frames", "*.mode"}), 0);
  EXPECT_EQ(rows(), 2);
  EXPECT_LT(out.str().find("run.frames"), out.str().find("run.mode"));
  // Each pattern has to match.
  EXPECT_EQ(cli({"params", "run.frames", "run.mod_"}), 2);
  EXPECT_THAT(err.str(), HasSubstr("no parameter matches 'run.mod_'; did you mean 'run.mode'?"));
}

TEST_F(CliTest, VersionAndHelp) {
  EXPECT_EQ(cli({"version"}), 0);
  EXPECT_EQ(out.str(), "fovea " + version_text() + "\n");
  EXPECT_EQ(cli({"--help"}), 0);
  EXPECT_THAT(out.str(), AllOf(HasSubstr("run"), HasSubstr("params"), HasSubstr("Exit status")));
  EXPECT_EQ(cli({"run", "--help"}), 0);
  EXPECT_THAT(out.str(), HasSubstr("--set"));
}

TEST_F(CliTest, VersionNamesTheCommit) {
  EXPECT_EQ(cli({"--version"}), 0);
  EXPECT_THAT(out.str(), testing::MatchesRegex("fovea [0-9.]+ \\(commit [0-9a-z]+(, modified)?\\)\n"));
}

TEST_F(CliTest, HelpFitsEightyColumnsAndShowsDefaults) {
  for (const std::vector<std::string>& args : std::vector<std::vector<std::string>>{
           {"--help"}, {"run", "--help"}, {"exec", "--help"}, {"replay", "--help"},
           {"params", "--help"}, {"report", "--help"}, {"completion", "--help"},
           {"trace", "--help"}, {"trace", "convert", "--help"}, {"trace", "info", "--help"}}) {
    ASSERT_EQ(cli(args), 0) << args[0] << err.str();
    std::istringstream lines(out.str());
    for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 80u) << args[0] << ": " << line;
  }
  EXPECT_EQ(cli({"run", "--help"}), 0);
  EXPECT_THAT(out.str(), AllOf(HasSubstr("[default: out/EXPERIMENT]"), HasSubstr("--sync default|strict"),
                               HasSubstr("[default: 4096]"), HasSubstr("-s,--set KEY=VALUE")));
}

TEST_F(CliTest, WrappedTextFillsTheWidthExactly) {
  EXPECT_EQ(wrapped("aaa bbb", 0, 7), "aaa bbb");
  EXPECT_EQ(wrapped("aaa bbb", 0, 6), "aaa\nbbb");
  EXPECT_EQ(wrapped("aaa bbb ccc", 2, 9), "aaa bbb\n  ccc");
  EXPECT_EQ(wrapped("a\nb", 1, 80), "a\n b");
}

/// What bash would offer after these words; the last one is being typed.
std::string offered(const std::string& script, const fs::path& file, const std::string& words) {
  std::ofstream(file) << script;
  const std::string command = "bash -c '. \"" + file.string() + "\"; COMP_WORDS=(" + words +
                              "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _fovea; "
                              "echo \"${COMPREPLY[*]}\"'";
  std::string text;
  FILE* pipe = ::popen(command.c_str(), "r");
  for (int c; (c = std::fgetc(pipe)) != EOF;) text += static_cast<char>(c);
  EXPECT_EQ(::pclose(pipe), 0);
  return text;
}

TEST_F(CliTest, CompletionOffersWhatIsDeclared) {
  ASSERT_EQ(cli({"completion", "bash"}), 0) << err.str();
  const std::string script = out.str();
  const auto offer = [&](const std::string& words) { return offered(script, dir / "c.sh", words); };
  EXPECT_EQ(offer("fovea r"), "run replay report\n");
  EXPECT_EQ(offer("fovea run --no"), "--no-frames\n");
  EXPECT_EQ(offer("fovea run --sync s"), "strict\n");
  EXPECT_EQ(offer("fovea run --sync = s"), "strict\n");
  EXPECT_EQ(offer("fovea run -s run.fr"), "run.frames=\n");
  EXPECT_EQ(offer("fovea replay -s ddr.tRF"), "ddr.tRFC=\n");
  EXPECT_EQ(offer("fovea completion b"), "bash\n");
  EXPECT_EQ(offer("fovea trace conv"), "convert\n");
  EXPECT_EQ(offer("fovea trace convert --wr"), "--wrap\n");
  EXPECT_EQ(offer("fovea trace convert --to dramsim"), "dramsim3\n");
  EXPECT_EQ(offer("fovea run " + experiment.substr(0, experiment.size() - 3)), experiment + "\n");
  EXPECT_EQ(cli({"completion", "tcsh"}), 2);
}

TEST_F(CliTest, ManPageHasEveryCommandAndOption) {
  ASSERT_EQ(cli({"man"}), 0);
  for (const char* part : {".TH FOVEA 1", ".SS fovea run", ".SS fovea exec", ".SS fovea replay",
                           "\\-\\-bus\\-trace FILE", ".SH EXIT STATUS"})
    EXPECT_THAT(out.str(), HasSubstr(part));
}

TEST_F(CliTest, AKeyOfReplaySaysSo) {
  EXPECT_EQ(run({"-s", "ddr.clock=270MHz"}), 2);
  EXPECT_THAT(err.str(), HasSubstr("key 'ddr.clock' is a key of 'fovea replay'; here clocks.ddr"));
  EXPECT_EQ(run({"-s", "ddr.clok=270MHz"}), 2);
  EXPECT_THAT(err.str(), HasSubstr("did you mean 'ddr.clock'? It is a key of 'fovea replay'"));
}

TEST_F(CliTest, ConfigNamesWhatMadeIt) {
  // SHA-256 of "abc", FIPS 180-2, appendix B.1.
  dir.write("abc", "abc");
  EXPECT_EQ(sha256_of(dir / "abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_THAT(test::user_error([&] { sha256_of(dir / "none"); }), HasSubstr("none' cannot be read: No such file"));
  EXPECT_THAT(test::user_error([] { sha256_of("/proc/self/mem"); }), HasSubstr("cannot be read: Input/output error"));
  EXPECT_EQ(sha256_of("/dev/null"), "") << "not a regular file";
  ASSERT_EQ(run({"-s", "run.file=" + (dir / "abc").string()}), 0) << err.str();
  auto config = json::parse(read_text(result / "config.json"));
  EXPECT_EQ(config["sha256"]["run.file"],
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_TRUE(config["commit"].is_string());
  EXPECT_TRUE(config["modified"].is_boolean());
  ASSERT_EQ(run({"-s", "run.file=" + (dir / "none").string()}), 0) << err.str();
  config = json::parse(read_text(result / "config.json"));
  EXPECT_TRUE(config["sha256"]["run.file"].is_null());
  ASSERT_EQ(run(), 0);
  EXPECT_EQ(json::parse(read_text(result / "config.json"))["sha256"].size(), 0u);
}

/// The program itself (main.cpp over the stand-in board), as a process.
class ProgramTest : public testing::Test {
 protected:
  struct Ended {
    int status;
    std::string err;
  };
  /// Starts it; `after` acts on the running process.
  Ended start(std::vector<std::string> args, const std::function<void(pid_t)>& after = {},
              rlim_t file_limit = RLIM_INFINITY, const std::string& output = "/dev/null") {
    args.insert(args.begin(), FAKE_PROGRAM);
    std::vector<char*> argv;
    for (auto& a : args) argv.push_back(a.data());
    argv.push_back(nullptr);
    const std::string err = (dir / "err").string();
    const pid_t pid = ::fork();
    if (pid == 0) {
      if (!std::freopen(err.c_str(), "w", stderr) || !std::freopen(output.c_str(), "w", stdout))
        ::_exit(99);
      const rlimit limit{file_limit, file_limit};
      ::setrlimit(RLIMIT_FSIZE, &limit);
      ::execv(argv[0], argv.data());
      ::_exit(98);
    }
    if (after) after(pid);
    int status = 0;
    ::waitpid(pid, &status, 0);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status), read_text(err)};
  }
  TempDir dir;
  std::string experiment = dir.write("exp.yaml", "run: {frames: 100000, mode: slow}\n").string();
};

TEST_F(ProgramTest, SignalsEndTheRunWithAPartialResult) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const fs::path result = dir / ("r" + std::to_string(signal));
    const fs::path third = result.string() + ".tmp/frames/frame_000002.png";
    const auto ended = start({"run", experiment, "-o", result.string()}, [&](pid_t pid) {
      for (int i = 0; i < 500 && !fs::exists(third); ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
      ::kill(pid, signal);
    });
    EXPECT_EQ(ended.status, 128 + signal) << ended.err;
    const auto stats = json::parse(read_text(result / "stats.json"));
    EXPECT_EQ(stats["complete"], false);
    const auto frames = stats["frame.displayed"]["value"].get<std::uint64_t>();
    EXPECT_GE(frames, 3u);
    EXPECT_TRUE(fs::exists(result / "frames" / FrameWriter::file_name(frames - 1)));
    EXPECT_FALSE(fs::exists(result / "frames" / FrameWriter::file_name(frames)));
  }
}

/// A program in the place of ffmpeg.
class FakeEncoder {
 public:
  FakeEncoder(const TempDir& dir, const std::string& body) : path_(std::getenv("PATH")) {
    const auto program = dir.write("bin/ffmpeg", "#!/bin/sh\n" + body + "\n");
    fs::permissions(program, fs::perms::owner_all);
    ::setenv("PATH", (program.parent_path().string() + ":" + path_).c_str(), 1);
  }
  ~FakeEncoder() { ::setenv("PATH", path_.c_str(), 1); }

 private:
  std::string path_;
};

TEST_F(ProgramTest, AFilmThatFailsTakesNoResultsAlong) {
  const FakeEncoder fake(dir, "echo 'no room' >&2; exit 1");
  const fs::path result = dir / "r";
  const auto ended =
      start({"run", experiment, "-s", "run.frames=3", "-s", "run.mode=good", "--mp4", "-o", result.string()});
  EXPECT_EQ(ended.status, 2);
  EXPECT_THAT(ended.err,
              AllOf(HasSubstr("display.mp4"), HasSubstr("no room"), HasSubstr("all other results are kept")));
  EXPECT_EQ(json::parse(read_text(result / "stats.json"))["complete"], true);
  EXPECT_TRUE(fs::exists(result / "frames" / FrameWriter::file_name(2)));
  EXPECT_FALSE(fs::exists(result / "display.mp4"));
}

TEST_F(ProgramTest, TheFirstSignalEndsARunWhoseEncoderHangs) {
  const FakeEncoder fake(dir, "echo $$ > '" + (dir / "pid").string() + "'; exec sleep 1000");
  const fs::path result = dir / "r";
  const auto ended = start({"run", experiment, "--mp4", "-o", result.string()}, [&](pid_t pid) {
    for (int i = 0; i < 500 && read_text(dir / "pid").empty(); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    for (int i = 0; i < 2; ++i) {  // as timeout(1) does
      ::kill(pid, SIGTERM);
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  });
  EXPECT_EQ(ended.status, 128 + SIGTERM) << ended.err;
  EXPECT_THAT(ended.err, AllOf(HasSubstr("display.mp4"), HasSubstr("hung")));
  EXPECT_EQ(json::parse(read_text(result / "stats.json"))["complete"], false);
  EXPECT_FALSE(fs::exists(dir / "r.tmp"));
  EXPECT_EQ(::kill(std::stoi(read_text(dir / "pid")), 0), -1) << "the encoder is left";
}

TEST_F(ProgramTest, ASecondSignalEndsTheProgramAndItsEncoder) {
  const FakeEncoder fake(dir, "echo $$ > '" + (dir / "pid").string() + "'; exec sleep 1000");
  const auto begin = std::chrono::steady_clock::now();
  const auto ended = start({"run", experiment, "--mp4", "-o", (dir / "r").string()}, [&](pid_t pid) {
    for (int i = 0; i < 500 && read_text(dir / "pid").empty(); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    ::kill(pid, SIGINT);
    std::this_thread::sleep_for(std::chrono::milliseconds(400));
    ::kill(pid, SIGTERM);
  });
  EXPECT_EQ(ended.status, -SIGTERM) << ended.err;
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(20));
  const std::string stat = "/proc/" + std::to_string(std::stoi(read_text(dir / "pid"))) + "/stat";
  // A zombie until whoever inherits it looks.
  const auto gone = [&] { return read_text(stat).empty() || read_text(stat).find(") Z ") != std::string::npos; };
  for (int i = 0; i < 200 && !gone(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_TRUE(gone()) << "the encoder is left";
}

TEST_F(ProgramTest, FullDiskIsOneLineAndStatusTwo) {
  // 200 bytes per file: config.json is the first that is longer.
  const auto ended = start({"run", experiment, "-o", (dir / "r").string()}, {}, 200);
  EXPECT_EQ(ended.status, 2);
  EXPECT_THAT(ended.err, AllOf(HasSubstr("config.json"), HasSubstr("File too large")));
  EXPECT_FALSE(fs::exists(dir / "r"));
  EXPECT_FALSE(fs::exists(dir / "r.tmp"));
}

TEST_F(ProgramTest, OutputThatCannotBeWrittenIsStatusTwo) {
  const std::string trace = dir.write("t.txt", "# dramtrace 1\n# master 3 window 2 cpu\n0 3 R 0x0 32\n");
  for (const std::vector<std::string>& args : std::vector<std::vector<std::string>>{
           {"version"},
           {"params"},
           {"--help"},
           {"run", experiment, "-s", "run.mode=good", "-s", "run.frames=2", "-o", (dir / "r").string()},
           {"replay", trace, "-o", (dir / "p").string()}}) {
    EXPECT_EQ(start(args).status, 0) << args[0];
    const auto ended = start(args, {}, RLIM_INFINITY, "/dev/full");
    EXPECT_EQ(ended.status, 2) << args[0];
    EXPECT_THAT(ended.err, HasSubstr("error: the standard output cannot be written")) << args[0];
  }
  EXPECT_TRUE(fs::exists(dir / "r/stats.json")) << "the results are there all the same";
  // A status that says more is kept.
  EXPECT_EQ(start({"run", experiment, "-s", "run.mode=late_failure", "-s", "run.frames=1", "-o",
                   (dir / "q").string()}, {}, RLIM_INFINITY, "/dev/full").status, 3);
}

TEST_F(ProgramTest, AReaderThatHasEnoughIsNoError) {
  const std::string command = "'" + std::string(FAKE_PROGRAM) + "' params 2>'" +
                              (dir / "err").string() + "'; echo $? >'" + (dir / "status").string() + "'";
  // The reader is gone before the program starts.
  ASSERT_EQ(std::system(("{ sleep 0.3; " + command + "; } | true").c_str()), 0);
  EXPECT_EQ(read_text(dir / "status"), "0\n");
  EXPECT_EQ(read_text(dir / "err"), "");
}

TEST_F(ProgramTest, ClosedStandardStreamsAreNotTakenByFilesOfResults) {
  // The first files that are open at a time are the folder's lock and the trace; the warning comes
  // while both are.
  for (const char* streams : {">/dev/null 2>&1", ">&- 2>&-", "<&- >&- 2>&-", "2>&- >/dev/null",
                              "<&-  >/dev/null 2>&1"}) {
    const std::string command = "'" + std::string(FAKE_PROGRAM) + "' run '" + experiment +
                                "' -s run.mode=not_modelled -s run.frames=2 --no-frames -o '" +
                                (dir / "r").string() + "' --bus-trace '" +
                                (dir / "r.trace").string() + "' " + streams;
    ASSERT_EQ(std::system(command.c_str()), 0) << streams;
    EXPECT_EQ(read_text(dir / "r.trace"), "the trace\n") << streams;
    const auto stats = json::parse(read_text(dir / "r/stats.json"));
    EXPECT_EQ(stats["frame.displayed"]["value"], 2) << streams;
  }
}

TEST_F(ProgramTest, ABrokenInvariantIsStatusFourAndLeavesNoFolder) {
  const auto ended =
      start({"run", experiment, "-s", "run.mode=broken_check", "-o", (dir / "r").string()});
  EXPECT_EQ(ended.status, 4);
  EXPECT_THAT(ended.err, HasSubstr("own defect: planted"));
  EXPECT_FALSE(fs::exists(dir / "r.tmp"));
  EXPECT_FALSE(fs::exists(dir / "r"));
}

TEST_F(ProgramTest, StatusOfWrongInputReachesTheShell) {
  EXPECT_EQ(start({"run", (dir / "none.yaml").string()}).status, 2);
  EXPECT_EQ(start({"version"}).status, 0);
  EXPECT_EQ(
      start({"run", experiment, "-s", "run.mode=guest_failure", "-o", (dir / "r").string()}).status,
      3);
}

}  // namespace
}  // namespace fovea::app
