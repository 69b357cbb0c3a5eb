// What reaches the disk, and in which order: the system calls that finish files and folders of
// results are replaced by functions that record them and fail on demand.
#include <fcntl.h>
#include <sys/file.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <utility>

#include "sw/fovea/files/output_file.h"
#include "sw/fovea/results/run_dir.h"
#include "tb/unit/support.h"

namespace {

/// Set by a test; empty: the real call alone. Each returns the error to fail with, or 0.
std::function<int(int fd)> on_close, on_fsync;
std::function<void()> before_lock;
std::function<int(const std::string& from, const std::string& to, unsigned flags)> on_rename;

int refuse(int error) {
  errno = error;
  return -1;
}

std::string name_of(int fd) {
  return std::filesystem::read_symlink("/proc/self/fd/" + std::to_string(fd)).string();
}

int do_rename(const char* from, const char* to, unsigned flags) {
  if (on_rename)
    if (const int error = on_rename(from, to, flags)) return refuse(error);
  return static_cast<int>(::syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, flags));
}

}  // namespace

// These take the place of the C library's.
extern "C" int close(int fd) {
  const int error = on_close ? on_close(fd) : 0;
  const int result = static_cast<int>(::syscall(SYS_close, fd));
  return error ? refuse(error) : result;
}
extern "C" int fsync(int fd) {
  const int error = on_fsync ? on_fsync(fd) : 0;
  return error ? refuse(error) : static_cast<int>(::syscall(SYS_fsync, fd));
}
extern "C" int flock(int fd, int operation) noexcept {
  if (before_lock) std::exchange(before_lock, nullptr)();
  return static_cast<int>(::syscall(SYS_flock, fd, operation));
}
extern "C" int rename(const char* from, const char* to) noexcept { return do_rename(from, to, 0); }
extern "C" int renameat2(int, const char* from, int, const char* to, unsigned flags) noexcept {
  return do_rename(from, to, flags);
}

namespace fovea::app {
namespace {

namespace fs = std::filesystem;
using test::read_text;
using test::TempDir;
using test::user_error;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::UnorderedElementsAre;

const std::string kConfig = R"({"format": "fovea run 1"})";

class DiskTest : public testing::Test {
 protected:
  ~DiskTest() override {
    on_close = on_fsync = nullptr;
    on_rename = nullptr;
    before_lock = nullptr;
  }
  /// A result whose uart.log has this text.
  void run_with(const std::string& text) {
    RunDir run(dir / "r", "run");
    run.write("config.json", kConfig);
    run.write("stats.json", R"({"complete": true})");
    run.write("uart.log", text);
    const int frames = run.make_folder("frames");
    CheckedFile(run.folder() / "frames/frame_000000.png", frames).close();
    run.commit(true);
  }
  /// The folders beside each other that hold a whole result with this text.
  std::vector<std::string> where(const std::string& text) {
    std::vector<std::string> found;
    for (const auto& entry : fs::directory_iterator(dir.path()))
      if (read_text(entry.path() / "uart.log") == text && fs::exists(entry.path() / "stats.json"))
        found.push_back(entry.path().filename().string());
    return found;
  }
  TempDir dir;
};

TEST_F(DiskTest, AnErrorOfCloseIsReported) {
  CheckedFile file(dir / "f", CheckedFile::New{});
  file.write("x");
  on_close = [](int) { return ENOSPC; };
  const std::string error = user_error([&] { file.close(); });
  EXPECT_THAT(error, AllOf(HasSubstr("/f'"), HasSubstr("No space left")));
}

TEST_F(DiskTest, AllIsOnTheDiskBeforeTheFolderGetsItsName) {
  std::vector<std::string> synced, before;
  on_fsync = [&](int fd) {
    synced.push_back(fs::path(name_of(fd)).lexically_relative(fs::canonical(dir.path())).string());
    return 0;
  };
  on_rename = [&](const std::string&, const std::string&, unsigned) {
    before = std::exchange(synced, {});
    return 0;
  };
  run_with("new");
  EXPECT_THAT(before, UnorderedElementsAre("r.tmp/config.json", "r.tmp/stats.json", "r.tmp/uart.log",
                                           "r.tmp/frames", "r.tmp/frames/frame_000000.png", "r.tmp"));
  EXPECT_EQ(before.back(), "r.tmp");
  EXPECT_THAT(synced, ElementsAre("."));
}

TEST_F(DiskTest, AFailedSyncIsReportedAndOneThatTheFileSystemLacksIsNot) {
  run_with("old");
  on_fsync = [](int) { return EINVAL; };
  run_with("new");
  EXPECT_THAT(where("new"), ElementsAre("r"));
  on_fsync = [](int fd) { return name_of(fd).ends_with("uart.log") ? EIO : 0; };
  EXPECT_THAT(user_error([&] { run_with("newer"); }),
              AllOf(HasSubstr("uart.log"), HasSubstr("Input/output error")));
  EXPECT_THAT(where("new"), ElementsAre("r"));
}

TEST_F(DiskTest, TheOldResultIsThereUntilTheNewOneIs) {
  run_with("old");
  unsigned exchanges = 0;
  on_rename = [&](const std::string& from, const std::string& to, unsigned flags) {
    EXPECT_EQ(flags, static_cast<unsigned>(RENAME_EXCHANGE));
    EXPECT_EQ(fs::path(from).filename(), "r.tmp");
    EXPECT_EQ(fs::path(to).filename(), "r");
    EXPECT_THAT(where("old"), ElementsAre("r"));
    EXPECT_THAT(where("new"), ElementsAre("r.tmp"));
    ++exchanges;
    return 0;
  };
  run_with("new");
  EXPECT_EQ(exchanges, 1u);
  EXPECT_THAT(where("new"), ElementsAre("r"));
  EXPECT_TRUE(where("old").empty());
}

TEST_F(DiskTest, WithoutExchangeTheOldResultStepsAside) {
  run_with("old");
  fs::create_directory(dir / "r.old");  // not ours: another name is taken
  std::vector<std::string> names;
  on_rename = [&](const std::string& from, const std::string& to, unsigned flags) {
    if (flags != 0) return EINVAL;
    names.push_back(fs::path(from).filename().string() + ">" + fs::path(to).filename().string());
    EXPECT_EQ(where("old").size(), 1u);
    EXPECT_EQ(where("new").size(), 1u);
    return 0;
  };
  run_with("new");
  EXPECT_THAT(names, ElementsAre("r>r.old.2", "r.tmp>r"));
  EXPECT_THAT(where("new"), ElementsAre("r"));
  EXPECT_TRUE(where("old").empty());
  EXPECT_FALSE(fs::exists(dir / "r.old.2"));
  EXPECT_TRUE(fs::exists(dir / "r.old"));
}

TEST_F(DiskTest, AResultThatCannotBePutInPlaceIsKeptAndSoIsTheOldOne) {
  run_with("old");
  on_rename = [&](const std::string& from, const std::string&, unsigned flags) {
    if (flags != 0) return EINVAL;
    return from.ends_with("r.tmp") ? EACCES : 0;
  };
  EXPECT_THAT(user_error([&] { run_with("new"); }),
              AllOf(HasSubstr("Permission denied"), HasSubstr("r.tmp'")));
  EXPECT_THAT(where("old"), ElementsAre("r"));
  EXPECT_THAT(where("new"), ElementsAre("r.tmp"));
}

TEST_F(DiskTest, AFileThatAppearsInTheOldResultAtTheLastMomentStays) {
  run_with("old");
  on_rename = [&](const std::string&, const std::string&, unsigned) {
    dir.write("r/letter.txt", "dear");
    return 0;
  };
  run_with("new");
  EXPECT_THAT(where("new"), ElementsAre("r"));
  EXPECT_EQ(read_text(dir / "r.tmp/letter.txt"), "dear");
}

// The second writer opens NAME.tmp, and the first one renames it before the second has the lock: what is locked then is
// the first one's result.
TEST_F(DiskTest, ALockThatComesWhenTheFileHasItsNameIsNone) {
  const auto open = [&] {
    return std::make_unique<OutputFile>(dir / "f", "--trace", "a trace", [](std::string_view) { return true; });
  };
  auto first = open();
  first->write("trace");
  before_lock = [&] {
    first->commit();
    first.reset();
  };
  EXPECT_THAT(user_error([&] { open(); }), HasSubstr("another run is writing it"));
  EXPECT_EQ(read_text(dir / "f"), "trace");
  run_with("old");
  auto running = std::make_unique<RunDir>(dir / "r", "run");
  running->write("config.json", kConfig);
  running->write("stats.json", R"({"complete": true})");
  running->write("uart.log", "new");
  before_lock = [&] {
    running->commit(true);
    running.reset();
  };
  EXPECT_THAT(user_error([&] { RunDir second(dir / "r", "run"); }), HasSubstr("another run is writing it"));
  EXPECT_THAT(where("new"), ElementsAre("r"));
}

}  // namespace
}  // namespace fovea::app
