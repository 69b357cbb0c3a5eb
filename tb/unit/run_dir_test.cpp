// sw/fovea/run_dir.h and checked_file.h: nothing is lost, nothing foreign is removed.
#include "sw/fovea/run_dir.h"

#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

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
  RunDir run(dir / "r");
  run.write("config.json", kConfig);
  EXPECT_FALSE(fs::exists(dir / "r"));
  EXPECT_TRUE(fs::is_directory(dir / "r.tmp/frames"));
  run.commit();
  EXPECT_EQ(read_text(dir / "r/config.json"), kConfig);
  EXPECT_FALSE(fs::exists(dir / "r.tmp"));
  EXPECT_EQ(run.folder(), fs::canonical(dir / "r"));
}

TEST(RunDirTest, AbandonedRunLeavesNothingButTheOldResult) {
  TempDir dir;
  dir.write("r/config.json", kConfig);
  dir.write("r/old", "1");
  {
    RunDir run(dir / "r");
    run.write("new", "2");
  }
  EXPECT_EQ(read_text(dir / "r/old"), "1");
  EXPECT_FALSE(fs::exists(dir / "r.tmp"));
}

TEST(RunDirTest, TmpOfARefusedRunIsRemovedOnlyByTheRunThatHasIt) {
  TempDir dir;
  RunDir first(dir / "r");
  first.write("new", "2");
  EXPECT_THAT(user_error([&] { RunDir second(dir / "r"); }), HasSubstr("another run"));
  EXPECT_EQ(read_text(dir / "r.tmp/new"), "2");
}

TEST(RunDirTest, PreviousRunIsReplacedAsAWhole) {
  TempDir dir;
  dir.write("r/config.json", kConfig);
  dir.write("r/frames/frame_000099.png", "old");
  RunDir run(dir / "r");
  run.write("config.json", kConfig);
  run.commit();
  EXPECT_FALSE(fs::exists(dir / "r/frames/frame_000099.png"));
  EXPECT_FALSE(fs::exists(dir / "r.tmp"));
}

TEST(RunDirTest, LeftoverTmpOfARunIsEmptied) {
  TempDir dir;
  dir.write("r.tmp/config.json", kConfig);
  dir.write("r.tmp/frames/frame_000000.png", "old");
  RunDir run(dir / "r");
  EXPECT_FALSE(fs::exists(dir / "r.tmp/frames/frame_000000.png"));
}

TEST(RunDirTest, ForeignFoldersAndFilesAreRefusedUntouched) {
  TempDir dir;
  dir.write("home/letter.txt", "dear");
  EXPECT_THAT(user_error([&] { RunDir run(dir / "home"); }),
              AllOf(HasSubstr("home"), HasSubstr("not the folder of a Fovea run")));
  dir.write("other/config.json", R"({"format": "something else"})");
  EXPECT_THAT(user_error([&] { RunDir run(dir / "other"); }), HasSubstr("other"));
  dir.write("broken/config.json", "{");
  EXPECT_THAT(user_error([&] { RunDir run(dir / "broken"); }), HasSubstr("broken"));
  dir.write("file", "x");
  EXPECT_THAT(user_error([&] { RunDir run(dir / "file"); }), HasSubstr("file"));
  dir.write("r.tmp/letter.txt", "dear");
  EXPECT_THAT(user_error([&] { RunDir run(dir / "r"); }), HasSubstr("r.tmp"));
  EXPECT_EQ(read_text(dir / "home/letter.txt"), "dear");
  EXPECT_EQ(read_text(dir / "r.tmp/letter.txt"), "dear");
  EXPECT_THAT(user_error([] { RunDir run("/"); }), HasSubstr("output folder"));
  EXPECT_THAT(user_error([] { RunDir run(""); }), HasSubstr("name"));
}

TEST(RunDirTest, FolderThatBecameForeignDuringTheRunIsNotReplaced) {
  TempDir dir;
  {
    RunDir run(dir / "r");
    run.write("new", "2");
    dir.write("r/letter.txt", "dear");
    EXPECT_THAT(user_error([&] { run.commit(); }), HasSubstr("r.tmp"));
  }
  EXPECT_EQ(read_text(dir / "r/letter.txt"), "dear");
  EXPECT_EQ(read_text(dir / "r.tmp/new"), "2");  // the message says that the results are here
}

TEST(RunDirTest, TwoRunsIntoOneFolderAtATimeAreRefused) {
  TempDir dir;
  RunDir first(dir / "r");
  EXPECT_THAT(user_error([&] { RunDir second(dir / "r"); }), HasSubstr("another run"));
}

TEST(RunDirTest, ParentFoldersAreMadeAndTrailingSlashesAndLinksUnderstood) {
  TempDir dir;
  {
    RunDir run(dir / "a/b/r/");
    run.write("config.json", kConfig);
    run.commit();
  }
  EXPECT_TRUE(fs::exists(dir / "a/b/r/config.json"));
  fs::create_directory_symlink(dir / "a/b/r", dir / "link");
  RunDir run(dir / "link");
  run.write("config.json", kConfig);
  run.commit();
  EXPECT_TRUE(fs::is_symlink(dir / "link"));
  EXPECT_FALSE(fs::exists(dir / "link.tmp"));
}

TEST(RunDirTest, UnwritablePlaceShowsBeforeTheRun) {
  TempDir dir;
  dir.write("file", "x");
  EXPECT_THAT(user_error([&] { RunDir run(dir / "file/r"); }),
              AllOf(HasSubstr("file/r"), HasSubstr("Not a directory")));
  EXPECT_THAT(user_error([] { RunDir run("/proc/fovea-run"); }), HasSubstr("/proc/fovea-run"));
  if (::geteuid() != 0) {  // root may write anywhere
    fs::create_directory(dir / "locked");
    fs::permissions(dir / "locked", fs::perms::owner_read | fs::perms::owner_exec);
    EXPECT_THAT(user_error([&] { RunDir run(dir / "locked/r"); }), HasSubstr("Permission denied"));
  }
}

TEST(CheckedFileTest, FullDiskIsAnErrorThatNamesTheFile) {
  EXPECT_THAT(user_error([] { write_file("/dev/full", "x"); }),
              AllOf(HasSubstr("'/dev/full'"), HasSubstr("No space left")));
  // More than the buffer: the error shows in write() already.
  CheckedFile file("/dev/full");
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
  const std::string error = user_error([&] { write_file(dir / "f", std::string(4096, 'x')); });
  ::setrlimit(RLIMIT_FSIZE, &before);
  ::signal(SIGXFSZ, old);
  EXPECT_THAT(error, AllOf(HasSubstr("/f'"), HasSubstr("File too large")));
  EXPECT_EQ(fs::file_size(dir / "f"), 1000u);
}

TEST(CheckedFileTest, WritesEverythingInOrderAcrossTheBuffer) {
  TempDir dir;
  std::string expected;
  CheckedFile file(dir / "f");
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

TEST(CheckedFileTest, MissingFolderIsNamed) {
  EXPECT_THAT(user_error([] { write_file("/nonexistent/f", ""); }),
              AllOf(HasSubstr("/nonexistent/f"), HasSubstr("No such file")));
}

TEST(OneLineTest, EscapesControlCharactersAndCutsLongText) {
  EXPECT_EQ(one_line("a\nb\tc\x1b[31m"), "a\\nb c\\x1b[31m");
  EXPECT_EQ(one_line(std::string(500, 'x'), 10), "xxxxxxxxxx...");
}

}  // namespace
}  // namespace fovea::app
