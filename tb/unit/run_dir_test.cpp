// sw/fovea/results/run_dir.h and checked_file.h: no result is lost, no foreign file is removed.
#include "sw/fovea/results/run_dir.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <thread>

#include "sw/fovea/files/output_file.h"
#include "tb/unit/support.h"

namespace fovea::app {
namespace {

namespace fs = std::filesystem;
using test::read_text;
using test::TempDir;
using test::user_error;
using testing::AllOf;
using testing::HasSubstr;

const std::string kConfig = R"({"format": "fovea run 1"})";

TEST(RunDirTest, FilesAppearUnderTheNameOnlyWhenComplete) {
  TempDir dir;
  RunDir run(dir / "r", "run");
  run.write("config.json", kConfig);
  EXPECT_FALSE(fs::exists(dir / "r"));
  EXPECT_FALSE(fs::exists(dir / "r.tmp/frames"));
  run.make_folder("frames");
  EXPECT_TRUE(fs::is_directory(dir / "r.tmp/frames"));
  EXPECT_EQ(run.commit(true), "");
  EXPECT_EQ(read_text(dir / "r/config.json"), kConfig);
  EXPECT_FALSE(fs::exists(dir / "r.tmp"));
  EXPECT_EQ(run.folder(), fs::canonical(dir / "r"));
}

TEST(RunDirTest, AbandonedRunLeavesNothingButTheOldResult) {
  TempDir dir;
  dir.write("r/config.json", kConfig);
  dir.write("r/uart.log", "1");
  {
    RunDir run(dir / "r", "run");
    run.write("uart.log", "2");
  }
  EXPECT_EQ(read_text(dir / "r/uart.log"), "1");
  EXPECT_FALSE(fs::exists(dir / "r.tmp"));
}

TEST(RunDirTest, TmpOfARefusedRunIsRemovedOnlyByTheRunThatHasIt) {
  TempDir dir;
  RunDir first(dir / "r", "run");
  first.write("uart.log", "2");
  EXPECT_THAT(user_error([&] { RunDir second(dir / "r", "run"); }), HasSubstr("another run"));
  EXPECT_EQ(read_text(dir / "r.tmp/uart.log"), "2");
}

TEST(RunDirTest, PreviousRunIsReplacedAsAWhole) {
  TempDir dir;
  dir.write("r/config.json", kConfig);
  dir.write("r/frames/frame_000099.png", "old");
  RunDir run(dir / "r", "run");
  run.write("config.json", kConfig);
  run.commit(true);
  EXPECT_FALSE(fs::exists(dir / "r/frames/frame_000099.png"));
  EXPECT_FALSE(fs::exists(dir / "r.tmp"));
}

TEST(RunDirTest, LeftoverTmpOfARunIsEmptied) {
  TempDir dir;
  dir.write("r.tmp/config.json", kConfig);
  dir.write("r.tmp/frames/frame_000000.png", "old");
  RunDir run(dir / "r", "run");
  EXPECT_FALSE(fs::exists(dir / "r.tmp/frames/frame_000000.png"));
}

// A run that is killed while it writes the first file, or while it removes the files of an earlier run in whatever
// order (Fovea has removed config.json in the middle), leaves a folder that the next run takes.
TEST(RunDirTest, WhatAKilledRunLeftIsTakenWhateverIsMissing) {
  for (const auto& [name, text] : {std::pair("stats.json", "{}"), {"uart.log", ""}, {"config.json", ""},
                                   {"config.json", R"({"format": "fov)"}, {"frames/frame_000000.png", ""}}) {
    TempDir dir;
    dir.write(std::string("r.tmp/") + name, text);
    if (std::string(name).starts_with("frames")) dir.write("r.tmp/host.json", "{}");
    {
      RunDir run(dir / "r", "run");
      run.write("config.json", kConfig);
      run.commit(true);
    }
    EXPECT_EQ(read_text(dir / "r/config.json"), kConfig) << name;
    EXPECT_FALSE(fs::exists(dir / "r.tmp")) << name;
  }
}

TEST(RunDirTest, TheFileThatTellsWhoseTheFolderIsGoesLast) {
  TempDir dir;
  dir.write("r/config.json", kConfig);
  dir.write("r/uart.log", "1");
  dir.write("r/frames/frame_000000.png", "1");
  dir.write("r/frames/mine.png", "1");  // keeps what cannot be removed
  EXPECT_FALSE(remove_folder(dir / "r", kRunKind));
  EXPECT_TRUE(fs::exists(dir / "r/config.json"));
  EXPECT_FALSE(fs::exists(dir / "r/uart.log"));
  fs::remove(dir / "r/frames/mine.png");
  EXPECT_TRUE(remove_folder(dir / "r", kRunKind));
  EXPECT_FALSE(fs::exists(dir / "r"));
}

TEST(RunDirTest, ForeignFoldersAndFilesAreRefusedUntouched) {
  TempDir dir;
  dir.write("home/letter.txt", "dear");
  EXPECT_THAT(user_error([&] { RunDir run(dir / "home", "run"); }),
              AllOf(HasSubstr("home"), HasSubstr("not the folder of a Fovea run")));
  dir.write("other/config.json", R"({"format": "something else"})");
  EXPECT_THAT(user_error([&] { RunDir run(dir / "other", "run"); }), HasSubstr("other"));
  dir.write("broken/config.json", "{");
  EXPECT_THAT(user_error([&] { RunDir run(dir / "broken", "run"); }), HasSubstr("broken"));
  dir.write("file", "x");
  EXPECT_THAT(user_error([&] { RunDir run(dir / "file", "run"); }), HasSubstr("file"));
  dir.write("s.tmp/config.json", R"({"format": "something else"})");
  EXPECT_THAT(user_error([&] { RunDir run(dir / "s", "run"); }), HasSubstr("not left by a Fovea run"));
  dir.write("r.tmp/letter.txt", "dear");
  EXPECT_THAT(user_error([&] { RunDir run(dir / "r", "run"); }), HasSubstr("r.tmp"));
  EXPECT_EQ(read_text(dir / "home/letter.txt"), "dear");
  EXPECT_EQ(read_text(dir / "r.tmp/letter.txt"), "dear");
  EXPECT_THAT(user_error([] { RunDir run("/", "run"); }), HasSubstr("output folder"));
  EXPECT_THAT(user_error([] { RunDir run("", "run"); }), HasSubstr("name"));
}

TEST(RunDirTest, FolderThatBecameForeignDuringTheRunIsNotReplaced) {
  TempDir dir;
  {
    RunDir run(dir / "r", "run");
    run.write("uart.log", "2");
    dir.write("r/letter.txt", "dear");
    EXPECT_THAT(user_error([&] { run.commit(true); }), HasSubstr("r.new"));
  }
  EXPECT_EQ(read_text(dir / "r/letter.txt"), "dear");
  EXPECT_EQ(read_text(dir / "r.new/uart.log"), "2");  // the message says that the results are here
}

TEST(RunDirTest, FilesOfTheUserInAnyPlaceAreNoRunFiles) {
  for (const char* name : {"config.json", "stats.json", "host.json", "frames.csv", "timeline.csv",
                           "stalls.csv", "latency.csv", "slowest.csv", "requests.csv", "uart.log", "registers.log",
                           "display.mp4",
                           "camera/frame_000000.png",
                           "frames/frame_000000.png", "frames/frame_1234567.png"})
    EXPECT_TRUE(is_run_file(name)) << name;
  for (const char* name : {"", "stats.json~", "stats", "frames", "frames/", "frames/frame_.png",
                           "frames/frame_1.png.bak", "frames/frame_1a.png", "frames/1.png",
                           "frames/x/frame_1.png", "frame_000000.png", "frames.csv/x"})
    EXPECT_FALSE(is_run_file(name)) << name;
  TempDir dir;
  dir.write("r/config.json", kConfig);
  fs::create_directory(dir / "r/uart.log");  // a folder by the name of a file of ours
  EXPECT_THAT(user_error([&] { RunDir run(dir / "r", "run"); }), HasSubstr("uart.log"));
  fs::remove(dir / "r/uart.log");
  fs::create_symlink(dir / "elsewhere", dir / "r/uart.log");
  EXPECT_THAT(user_error([&] { RunDir run(dir / "r", "run"); }), HasSubstr("uart.log"));
  fs::remove(dir / "r/uart.log");
  fs::create_directories(dir / "r/frames/mine");
  EXPECT_THAT(user_error([&] { RunDir run(dir / "r", "run"); }), HasSubstr("frames/mine"));
}

TEST(RunDirTest, AnEmptyFolderIsTakenAndOneWithPicturesOnlyIsNot) {
  TempDir dir;
  fs::create_directories(dir / "empty/frames");
  { RunDir run(dir / "empty", "run"); }
  dir.write("pictures/frames/frame_000000.png", "mine");
  EXPECT_THAT(user_error([&] { RunDir run(dir / "pictures", "run"); }),
              HasSubstr("not the folder of a Fovea run"));
  dir.write("r.tmp/frames/frame_000000.png", "mine");
  EXPECT_THAT(user_error([&] { RunDir run(dir / "r", "run"); }), HasSubstr("r.tmp"));
  EXPECT_EQ(read_text(dir / "r.tmp/frames/frame_000000.png"), "mine");
}

TEST(RunDirTest, LinksInTheUnfinishedFolderAreNotFollowed) {
  TempDir dir;
  dir.write("victim", "mine");
  RunDir run(dir / "r", "run");
  fs::create_symlink(dir / "victim", dir / "r.tmp/uart.log");
  fs::create_symlink(dir / "victim", dir / "r.tmp/frames.csv");
  EXPECT_THAT(user_error([&] { run.create("frames.csv"); }),
              AllOf(HasSubstr("frames.csv"), HasSubstr("File exists")));
  run.write("uart.log", "ours");  // takes the place of the link
  EXPECT_EQ(read_text(dir / "victim"), "mine");
  EXPECT_FALSE(fs::is_symlink(dir / "r.tmp/uart.log"));
}

TEST(RunDirTest, AFolderPutInThePlaceOfTheUnfinishedOneGetsNoFiles) {
  TempDir dir;
  RunDir run(dir / "r", "run");
  const int frames = run.make_folder("frames");
  fs::rename(dir / "r.tmp", dir / "moved");
  fs::create_directories(dir / "r.tmp/frames");
  run.write("uart.log", "2");
  CheckedFile(dir / "r.tmp/frames/frame_000000.png", frames).close();
  EXPECT_TRUE(fs::is_empty(dir / "r.tmp/frames"));
  EXPECT_FALSE(fs::exists(dir / "r.tmp/uart.log"));
  EXPECT_TRUE(fs::exists(dir / "moved/frames/frame_000000.png"));
  EXPECT_EQ(read_text(dir / "moved/uart.log"), "2");
}

TEST(RunDirTest, OnlyItsOwnerMayEnterTheUnfinishedFolder) {
  TempDir dir;
  const mode_t mask = ::umask(027);
  {
    RunDir run(dir / "r", "run");
    EXPECT_EQ(fs::status(dir / "r.tmp").permissions(), fs::perms::owner_all);
    run.write("config.json", kConfig);
    run.commit(true);
  }
  EXPECT_EQ(fs::status(dir / "r").permissions(), static_cast<fs::perms>(0750));
  ::umask(mask);
}

TEST(RunDirTest, FoldersOfAnotherUserAreRefused) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root can make a folder that belongs to another user";
  TempDir dir;
  for (const char* name : {"r.tmp", "done"}) {
    dir.write(std::string(name) + "/config.json", kConfig);
    ASSERT_EQ(::chown((dir / name).c_str(), 65534, 65534), 0);
    EXPECT_THAT(user_error([&] { RunDir run(dir / fs::path(name).stem().string(), "run"); }),
                AllOf(HasSubstr(name), HasSubstr("another user")));
    EXPECT_EQ(read_text(dir / (std::string(name) + "/config.json")), kConfig);
  }
}

TEST(RunDirTest, TwoRunsIntoOneFolderAtATimeAreRefused) {
  TempDir dir;
  RunDir first(dir / "r", "run");
  EXPECT_THAT(user_error([&] { RunDir second(dir / "r", "run"); }), HasSubstr("another run"));
}

TEST(RunDirTest, ParentFoldersAreMadeAndTrailingSlashesAndLinksUnderstood) {
  TempDir dir;
  {
    RunDir run(dir / "a/b/r/", "run");
    run.write("config.json", kConfig);
    run.commit(true);
  }
  EXPECT_TRUE(fs::exists(dir / "a/b/r/config.json"));
  fs::create_directory_symlink(dir / "a/b/r", dir / "link");
  RunDir run(dir / "link", "run");
  run.write("config.json", kConfig);
  run.commit(true);
  EXPECT_TRUE(fs::is_symlink(dir / "link"));
  EXPECT_FALSE(fs::exists(dir / "link.tmp"));
}

TEST(RunDirTest, UnwritablePlaceShowsBeforeTheRun) {
  TempDir dir;
  dir.write("file", "x");
  EXPECT_THAT(user_error([&] { RunDir run(dir / "file/r", "run"); }),
              AllOf(HasSubstr("file/r"), HasSubstr("Not a directory")));
  EXPECT_THAT(user_error([] { RunDir run("/proc/fovea-run", "run"); }), HasSubstr("/proc/fovea-run"));
  if (::geteuid() != 0) {  // root may write anywhere
    fs::create_directory(dir / "locked");
    fs::permissions(dir / "locked", fs::perms::owner_read | fs::perms::owner_exec);
    EXPECT_THAT(user_error([&] { RunDir run(dir / "locked/r", "run"); }), HasSubstr("Permission denied"));
  }
}

TEST(CheckedFileTest, FullDiskIsAnErrorThatNamesTheFile) {
  const auto full = [] { return CheckedFile("/dev/full", CheckedFile::Open{::open("/dev/full", O_WRONLY)}); };
  EXPECT_THAT(user_error([&] {
                CheckedFile file = full();
                file.write("x");
                file.close();
              }),
              AllOf(HasSubstr("'/dev/full'"), HasSubstr("No space left")));
  // More than the buffer: the error shows in write() already.
  CheckedFile file = full();
  EXPECT_THAT(user_error([&] { file.write(std::string(1 << 20, 'x')); }), HasSubstr("/dev/full"));
}

TEST(CheckedFileTest, ShortWriteIsContinuedAndThenReported) {
  TempDir dir;
  const auto old = ::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  rlimit limit = before;
  limit.rlim_cur = 1000;  // the first write() accepts 1000 of 4096 bytes
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &limit), 0);
  const std::string error = user_error([&] {
    CheckedFile file(dir / "f", CheckedFile::New{});
    file.write(std::string(4096, 'x'));
    file.close();
  });
  ::setrlimit(RLIMIT_FSIZE, &before);
  ::signal(SIGXFSZ, old);
  EXPECT_THAT(error, AllOf(HasSubstr("/f'"), HasSubstr("File too large")));
  EXPECT_EQ(fs::file_size(dir / "f"), 1000u);
}

TEST(CheckedFileTest, WritesEverythingInOrderAcrossTheBuffer) {
  TempDir dir;
  std::string expected;
  CheckedFile file(dir / "f", CheckedFile::New{});
  for (int i = 0; i < 3000; ++i) {
    const std::string part(static_cast<std::size_t>(i % 97), static_cast<char>('a' + i % 26));
    file.write(part);
    expected += part;
    if (i == 1500) {
      const std::string large(200'000, '#');
      file.write(large);
      expected += large;
    }
  }
  file.close();
  EXPECT_EQ(read_text(dir / "f"), expected);
}

TEST(ReadFileTest, AFileOfTheLargestSizeIsReadAndOneByteMoreIsNot) {
  TempDir dir;
  const auto file = dir.write("f", "0123456789");
  EXPECT_EQ(read_file(file, 10), "0123456789");
  EXPECT_THAT(user_error([&] { read_file(file, 9); }), HasSubstr("larger than the 9 bytes"));
}

TEST(CheckedFileTest, ANewFileReplacesNoOther) {
  TempDir dir;
  dir.write("f", "mine");
  fs::create_symlink(dir / "elsewhere", dir / "link");
  for (const char* name : {"f", "link"})
    EXPECT_THAT(user_error([&] { CheckedFile file(dir / name, CheckedFile::New{}); }),
                AllOf(HasSubstr(name), HasSubstr("File exists")));
  EXPECT_EQ(read_text(dir / "f"), "mine");
  EXPECT_FALSE(fs::exists(dir / "elsewhere"));
}

bool is_trace(std::string_view bytes) { return bytes.starts_with("trace"); }
struct Trace : OutputFile {
  explicit Trace(const fs::path& name) : OutputFile(name, "--trace", "a trace", is_trace) {}
};

TEST(OutputFileTest, AnEarlierFileStaysUntilTheNewOneIsWhole) {
  TempDir dir;
  dir.write("f", "trace 1");
  {
    Trace unfinished(dir / "f");
    unfinished.write("trace 2");
  }
  EXPECT_EQ(read_text(dir / "f"), "trace 1");
  EXPECT_FALSE(fs::exists(dir / "f.tmp"));
  {
    Trace whole(dir / "f");
    whole.write("trace 3");
    EXPECT_EQ(read_text(dir / "f"), "trace 1");
    whole.commit();
    dir.write("f.tmp", "of another process");
  }
  EXPECT_EQ(read_text(dir / "f"), "trace 3");
  EXPECT_EQ(read_text(dir / "f.tmp"), "of another process");
}

TEST(OutputFileTest, OnlyFilesOfItsKindAndEmptyOnesAreReplaced) {
  TempDir dir;
  dir.write("victim", "mine");
  dir.write("letter", "dear");
  dir.write("empty", "");
  fs::create_directory(dir / "folder");
  fs::create_symlink(dir / "victim", dir / "link");
  EXPECT_THAT(user_error([&] { Trace t(dir / "letter"); }),
              AllOf(HasSubstr("--trace"), HasSubstr("letter"), HasSubstr("is not a trace")));
  EXPECT_THAT(user_error([&] { Trace t(dir / "link"); }), HasSubstr("symbolic link"));
  EXPECT_THAT(user_error([&] { Trace t(dir / "folder"); }), HasSubstr("it is a folder"));
  EXPECT_THAT(user_error([&] { Trace t(dir / "no/f"); }), HasSubstr("No such file"));
  Trace(dir / "empty").commit();
  // What lies under the working name is looked at in the same way.
  dir.write("a.tmp", "dear");
  EXPECT_THAT(user_error([&] { Trace t(dir / "a"); }), HasSubstr("a.tmp"));
  fs::create_symlink(dir / "victim", dir / "b.tmp");
  EXPECT_THAT(user_error([&] { Trace t(dir / "b"); }), HasSubstr("symbolic link"));
  dir.write("c.tmp", "trace, cut off by a cra");
  Trace(dir / "c").commit();
  EXPECT_EQ(read_text(dir / "c"), "");
  EXPECT_EQ(read_text(dir / "victim"), "mine");
  EXPECT_EQ(read_text(dir / "letter"), "dear");
  EXPECT_EQ(read_text(dir / "a.tmp"), "dear");
}

// Both have found a file that a crash left, and only one may write. Many rounds, since it is a question of the moment.
TEST(OutputFileTest, OfManyWritersAtOnceNoneIsLost) {
  TempDir dir;
  constexpr int kWriters = 4, kRounds = 100;
  std::vector<std::thread> writers;
  std::atomic<int> committed = 0;
  for (int w = 0; w < kWriters; ++w)
    writers.emplace_back([&] {
      for (int round = 0; round < kRounds; ++round) try {
          Trace t(dir / "f");
          std::string text = read_text(dir / "f");
          if (text.empty()) text = "trace";
          t.write(text + "x");
          std::this_thread::yield();
          t.commit();
          ++committed;
        } catch (const UserError& e) {
          EXPECT_THAT(e.what(), HasSubstr("another run is writing it"));
        }
    });
  for (auto& w : writers) w.join();
  EXPECT_GT(committed, 0);
  EXPECT_EQ(read_text(dir / "f"), "trace" + std::string(static_cast<std::size_t>(committed), 'x'));
  EXPECT_FALSE(fs::exists(dir / "f.tmp"));
}

TEST(OutputFileTest, AFileWithASecondNameOrOfAnotherUserIsNotEmptied) {
  TempDir dir;
  dir.write("victim", "trace, mine");
  fs::create_hard_link(dir / "victim", dir / "f.tmp");
  EXPECT_THAT(user_error([&] { Trace t(dir / "f"); }), AllOf(HasSubstr("f.tmp"), HasSubstr("second name")));
  EXPECT_EQ(read_text(dir / "victim"), "trace, mine");
  if (::geteuid() != 0) return;
  dir.write("g.tmp", "trace, theirs");
  ASSERT_EQ(::chown((dir / "g.tmp").c_str(), 65534, 65534), 0);
  EXPECT_THAT(user_error([&] { Trace t(dir / "g"); }), AllOf(HasSubstr("g.tmp"), HasSubstr("another user")));
  EXPECT_EQ(read_text(dir / "g.tmp"), "trace, theirs");
}

TEST(ReplaceFileTest, ALinkIsReplacedAndNotFollowed) {
  TempDir dir;
  dir.write("victim", "mine");
  fs::create_symlink(dir / "victim", dir / "f");
  fs::create_symlink(dir / "victim", dir / "f.tmp");
  const int folder = ::open(dir.path().c_str(), O_RDONLY | O_DIRECTORY);
  replace_file(folder, dir / "f", "new");
  fs::create_directory(dir / "g");
  EXPECT_THAT(user_error([&] { replace_file(folder, dir / "g", "new"); }), HasSubstr("/g'"));
  ::close(folder);
  EXPECT_EQ(read_text(dir / "f"), "new");
  EXPECT_FALSE(fs::is_symlink(dir / "f"));
  EXPECT_EQ(read_text(dir / "victim"), "mine");
  EXPECT_FALSE(fs::exists(dir / "f.tmp"));
  EXPECT_FALSE(fs::exists(dir / "g.tmp"));
}

TEST(OutputFileTest, TwoRunsDoNotWriteOneFile) {
  TempDir dir;
  Trace first(dir / "f");
  EXPECT_THAT(user_error([&] { Trace second(dir / "f"); }), HasSubstr("another run"));
  first.write("trace");
  first.commit();
  EXPECT_EQ(read_text(dir / "f"), "trace");
}

TEST(OutputFileTest, ADeviceIsWrittenDirectly) {
  Trace null("/dev/null");
  null.write("trace");
  null.commit();
  Trace full("/dev/full");
  full.write("trace");
  EXPECT_THAT(user_error([&] { full.commit(); }), HasSubstr("No space left"));
}

TEST(CheckedFileTest, MissingFolderIsNamed) {
  EXPECT_THAT(user_error([] { CheckedFile file("/nonexistent/f", CheckedFile::New{}); }),
              AllOf(HasSubstr("/nonexistent/f"), HasSubstr("No such file")));
}

TEST(OneLineTest, EscapesControlCharactersAndCutsLongText) {
  EXPECT_EQ(one_line("a\nb\tc\x1b[31m"), "a\\nb c\\x1b[31m");
  EXPECT_EQ(one_line(std::string(500, 'x'), 10), "xxxxxxxxxx...");
  EXPECT_EQ(one_line("\x7f\r\b"), "\\x7f\\x0d\\x08");
  EXPECT_EQ(one_line("\xc2\x9b" "31m \xc2\x80\xc2\x9f"), "\\xc2\\x9b31m \\xc2\\x80\\xc2\\x9f");
  EXPECT_EQ(one_line("\xc2\xa0 \xc3\xa4\xe2\x80\x9c \xc2"), "\xc2\xa0 \xc3\xa4\xe2\x80\x9c \\xc2")
      << "letters of other languages stay";
  EXPECT_EQ(printable("a\nb\x1b[31m"), "a\nb\\x1b[31m");
  // RFC 3629: the ends of what is a character, and what is none.
  for (const char* good : {"\xc2\xa0", "\xdf\xbf", "\xe0\xa0\x80", "\xed\x9f\xbf", "\xee\x80\x80", "\xef\xbf\xbd",
                           "\xf0\x90\x80\x80", "\xf4\x8f\xbf\xbf"})
    EXPECT_EQ(printable(good), good);
  for (const char* bad : {"\x80", "\xbf", "\xc0\x80", "\xc1\xbf", "\xe0\x9f\xbf", "\xed\xa0\x80", "\xf0\x8f\xbf\xbf",
                          "\xf4\x90\x80\x80", "\xf5\x80\x80\x80", "\xff", "\xe2\x80", "\xf0\x90\x80"}) {
    const std::string text = printable(bad);
    EXPECT_TRUE(std::all_of(text.begin(), text.end(), [](char c) { return c >= 0x20 && c < 0x7f; })) << text;
    EXPECT_EQ(text.size(), 4 * std::string_view(bad).size()) << text;
  }
}

}  // namespace
}  // namespace fovea::app
