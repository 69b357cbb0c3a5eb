// Semihosting calls with a fake machine: flat memory and two registers.
#include "sw/fovea/console/semihosting.h"

#include <errno.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <random>

#include "model/common/check.h"
#include "tb/own_diagnostics.h"

namespace fovea::app {
namespace {

namespace fs = std::filesystem;
constexpr std::uint32_t kFailed = 0xFFFF'FFFFu;

struct Machine : SemihostingTarget {
  std::uint32_t r0 = 0, r1 = 0;
  std::vector<std::uint8_t> memory = std::vector<std::uint8_t>(0x20000);
  Picoseconds time = 0;
  std::uint32_t r(unsigned n) const override { return n == 0 ? r0 : r1; }
  void set_r0(std::uint32_t v) override { r0 = v; }
  bool read(std::uint32_t a, std::span<std::uint8_t> to) override {
    if (a > memory.size() || to.size() > memory.size() - a) return false;
    std::memcpy(to.data(), memory.data() + a, to.size());
    return true;
  }
  bool write(std::uint32_t a, std::span<const std::uint8_t> from) override {
    if (a > memory.size() || from.size() > memory.size() - a) return false;
    std::memcpy(memory.data() + a, from.data(), from.size());
    return true;
  }
  Picoseconds now() const override { return time; }
  std::uint32_t word(std::uint32_t a) const {
    std::uint32_t v;
    std::memcpy(&v, memory.data() + a, 4);
    return v;
  }
};

struct Console : SemihostingConsole {
  std::string input, out, err;
  std::size_t read(std::span<std::uint8_t> to) override {
    const std::size_t n = std::min(to.size(), input.size());
    std::memcpy(to.data(), input.data(), n);
    input.erase(0, n);
    return n;
  }
  bool full = false;
  bool write(bool error_stream, std::string_view text) override {
    if (!full) (error_stream ? err : out) += text;
    return !full;
  }
};

class SemihostingTest : public testing::Test {
 protected:
  static constexpr std::uint32_t kBlock = 0x100, kText = 0x200, kText2 = 0x300, kData = 0x1000;
  fs::path top, root;
  OwnDiagnostics diagnostics;
  Machine machine;
  Console console;
  std::unique_ptr<Semihosting> semihosting;

  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "semihosting-XXXXXX").string();
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    top = name;
    root = top / "root";
    fs::create_directories(root / "sub");
    std::ofstream(top / "secret") << "outside";
    std::ofstream(root / "inside") << "hello";
    start();
  }
  void TearDown() override { fs::remove_all(top); }
  void start(SemihostingSettings s = {}) {
    if (s.root.empty()) s.root = root;
    semihosting = std::make_unique<Semihosting>(s, console);
  }
  std::uint32_t call(std::uint32_t operation, std::initializer_list<std::uint32_t> block) {
    std::uint32_t at = kBlock;
    for (const std::uint32_t w : block) {
      std::memcpy(machine.memory.data() + at, &w, 4);
      at += 4;
    }
    return call_with(operation, kBlock);
  }
  std::uint32_t call_with(std::uint32_t operation, std::uint32_t r1) {
    machine.r0 = operation;
    machine.r1 = r1;
    semihosting->call(machine);
    return machine.r0;
  }
  std::uint32_t put(std::uint32_t at, std::string_view text) {
    std::memcpy(machine.memory.data() + at, text.data(), text.size());
    machine.memory[at + text.size()] = 0;
    return static_cast<std::uint32_t>(text.size());
  }
  std::uint32_t open(std::string_view name, std::uint32_t mode) {
    const std::uint32_t n = put(kText, name);
    return call(0x01, {kText, mode, n});
  }
  std::uint32_t remove(std::string_view name) {
    const std::uint32_t n = put(kText, name);
    return call(0x0E, {kText, n});
  }
  std::uint32_t rename(std::string_view from, std::string_view to) {
    const std::uint32_t a = put(kText, from), b = put(kText2, to);
    return call(0x0F, {kText, a, kText2, b});
  }
  std::uint32_t write(std::uint32_t handle, std::string_view text) {
    const std::uint32_t n = put(kData, text);
    return call(0x05, {handle, kData, n});
  }
  /// What SYS_READ left in memory; the count that was not read is in `missing`.
  std::string read(std::uint32_t handle, std::uint32_t bytes) {
    missing = call(0x06, {handle, kData, bytes});
    if (missing > bytes) return "(error)";
    return {reinterpret_cast<char*>(machine.memory.data()) + kData, bytes - missing};
  }
  std::uint32_t last_errno() { return call_with(0x13, 0); }
  std::string host_text(const fs::path& file) {
    std::ifstream in(file);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  std::uint32_t missing = 0;
};

TEST_F(SemihostingTest, NumbersOfTheCallDependOnTheState) {
  EXPECT_TRUE(Semihosting::is_call(0x123456, false));
  EXPECT_TRUE(Semihosting::is_call(0xAB, true));
  EXPECT_FALSE(Semihosting::is_call(0xAB, false));
  EXPECT_FALSE(Semihosting::is_call(0x56, true));
}

TEST_F(SemihostingTest, ConsoleCarriesThreeStreams) {
  console.input = "typed";
  const auto in = open(":tt", 0), out = open(":tt", 4), err = open(":tt", 8);
  EXPECT_EQ(write(out, "to out"), 0u);
  EXPECT_EQ(write(err, "to err"), 0u);
  EXPECT_EQ(read(in, 100), "typed");
  EXPECT_EQ(missing, 95u);
  EXPECT_EQ(read(in, 100), "");
  EXPECT_EQ(missing, 100u);
  machine.memory[kText] = '!';
  call_with(0x03, kText);
  put(kText, " and a line\n");
  call_with(0x04, kText);
  EXPECT_EQ(console.out, "to out! and a line\n");
  EXPECT_EQ(console.err, "to err");
  EXPECT_EQ(call(0x09, {out}), 1u);
  EXPECT_EQ(write(in, "x"), 1u);  // not written
  console.input = "k";
  EXPECT_EQ(call_with(0x07, 0), std::uint32_t{'k'});
  EXPECT_EQ(call_with(0x07, 0), kFailed);
}

TEST_F(SemihostingTest, OutputThatTheConsoleDoesNotTakeIsNotWritten) {
  const auto out = open(":tt", 4);
  console.full = true;
  EXPECT_EQ(write(out, "to out"), 6u);
  machine.memory[kText] = '!';
  EXPECT_EQ(call_with(0x03, kText), kFailed);
  put(kText, "a line");
  EXPECT_EQ(call_with(0x04, kText), kFailed);
}

TEST_F(SemihostingTest, FileIsWrittenReadSoughtAndMeasured) {
  const auto w = open("sub/new.txt", 4);
  ASSERT_NE(w, kFailed);
  EXPECT_EQ(write(w, "0123456789"), 0u);
  EXPECT_EQ(call(0x0C, {w}), 10u);
  EXPECT_EQ(call(0x09, {w}), 0u);
  EXPECT_EQ(call(0x02, {w}), 0u);
  EXPECT_EQ(call(0x02, {w}), kFailed);
  EXPECT_EQ(last_errno(), std::uint32_t{EBADF});
  EXPECT_EQ(host_text(root / "sub/new.txt"), "0123456789");
  const auto a = open("sub/new.txt", 8);
  EXPECT_EQ(write(a, "ab"), 0u);
  call(0x02, {a});
  const auto r = open("./sub//new.txt", 0);
  EXPECT_EQ(call(0x0A, {r, 8}), 0u);
  EXPECT_EQ(read(r, 10), "89ab");
  EXPECT_EQ(missing, 6u);
  EXPECT_EQ(write(r, "x"), 1u);
  EXPECT_EQ(open("absent", 0), kFailed);
  EXPECT_EQ(last_errno(), std::uint32_t{ENOENT});
}

TEST_F(SemihostingTest, LargeTransferGoesInPieces) {
  std::string big(50'000, 'x');
  for (std::size_t i = 0; i < big.size(); ++i) big[i] = static_cast<char>('a' + i % 23);
  const auto w = open("big", 5);
  EXPECT_EQ(write(w, big), 0u);
  call(0x02, {w});
  EXPECT_EQ(host_text(root / "big"), big);
  std::fill(machine.memory.begin() + kData, machine.memory.end(), 0);
  EXPECT_EQ(read(open("big", 1), 60'000), big);
}

TEST_F(SemihostingTest, RemoveAndRenameStayInside) {
  EXPECT_EQ(rename("inside", "sub/moved"), 0u);
  EXPECT_EQ(host_text(root / "sub/moved"), "hello");
  EXPECT_EQ(remove("sub/moved"), 0u);
  EXPECT_FALSE(fs::exists(root / "sub/moved"));
  EXPECT_EQ(remove("sub"), kFailed);
  EXPECT_EQ(rename("../secret", "mine"), kFailed);
  EXPECT_EQ(remove("../secret"), kFailed);
  std::ofstream(root / "inside") << "again";
  EXPECT_EQ(rename("inside", "../gone"), kFailed);
  EXPECT_EQ(last_errno(), std::uint32_t{EACCES});
  EXPECT_TRUE(fs::exists(top / "secret"));
  EXPECT_FALSE(fs::exists(top / "gone"));
}

TEST_F(SemihostingTest, ParentFolderIsRefused) {
  for (const char* name : {"../secret", "sub/../../secret", "sub/../inside", "..", "sub/.."}) {
    EXPECT_EQ(open(name, 0), kFailed) << name;
    EXPECT_EQ(last_errno(), std::uint32_t{EACCES}) << name;
  }
  EXPECT_EQ(open("../made", 4), kFailed);
  EXPECT_FALSE(fs::exists(top / "made"));
}

TEST_F(SemihostingTest, AbsoluteNameIsRefused) {
  EXPECT_EQ(open((top / "secret").string(), 0), kFailed);
  EXPECT_EQ(last_errno(), std::uint32_t{EACCES});
  EXPECT_EQ(open((root / "inside").string(), 0), kFailed);
  EXPECT_EQ(open((top / "made").string(), 4), kFailed);
  EXPECT_FALSE(fs::exists(top / "made"));
}

TEST_F(SemihostingTest, SymbolicLinkIsRefused) {
  fs::create_symlink(top / "secret", root / "file_link");
  fs::create_symlink("inside", root / "inner_link");
  fs::create_directory_symlink(top, root / "folder_link");
  fs::create_symlink(top / "made", root / "dangling");
  for (const char* name : {"file_link", "inner_link", "folder_link/secret", "dangling"}) {
    for (const std::uint32_t mode : {0u, 4u, 8u}) {
      EXPECT_EQ(open(name, mode), kFailed) << name;
      EXPECT_EQ(last_errno(), std::uint32_t{EACCES}) << name;
    }
  }
  EXPECT_EQ(remove("folder_link/secret"), kFailed);
  EXPECT_EQ(rename("inside", "folder_link/x"), kFailed);
  EXPECT_EQ(host_text(top / "secret"), "outside");
  EXPECT_FALSE(fs::exists(top / "made"));
}

TEST_F(SemihostingTest, OnlyRegularFilesAreOpened) {
  ASSERT_EQ(::mkfifo((root / "pipe").c_str(), 0600), 0);
  EXPECT_EQ(open("pipe", 0), kFailed);
  EXPECT_EQ(open("sub", 0), kFailed);
  EXPECT_EQ(last_errno(), std::uint32_t{EISDIR});
  const std::string hidden("inside\0x", 8);
  EXPECT_EQ(open(hidden, 0), kFailed);
}

TEST_F(SemihostingTest, NoFolderMeansNoFiles) {
  Semihosting none({}, console);
  const std::uint32_t n = put(kText, "inside");
  const std::array<std::uint32_t, 3> block = {kText, 0, n};
  std::memcpy(machine.memory.data() + kBlock, block.data(), 12);
  machine.r0 = 1;
  machine.r1 = kBlock;
  none.call(machine);
  EXPECT_EQ(machine.r0, kFailed);
  SemihostingSettings file;
  file.root = root / "inside";
  EXPECT_THROW(start(file), UserError);
}

TEST_F(SemihostingTest, CommandLineAndHeapAreThoseOfTheSettings) {
  const std::vector<std::string> arguments = {"prog", "two words", "say \"hi\""};
  start({.root = root, .command_line = guest_command_line(arguments),
         .heap_base = 1, .heap_limit = 2, .stack_base = 3, .stack_limit = 4});
  EXPECT_EQ(call(0x15, {kData, 80}), 0u);
  EXPECT_STREQ(reinterpret_cast<char*>(machine.memory.data()) + kData,
               "prog \"two words\" 'say \"hi\"'");
  EXPECT_EQ(machine.word(kBlock + 4), 27u);
  EXPECT_EQ(call(0x15, {kData, 28}), 0u) << "27 and the 0 behind them";
  EXPECT_EQ(call(0x15, {kData, 27}), kFailed);
  EXPECT_EQ(call(0x16, {kData}), 0u);
  for (std::uint32_t k = 0; k < 4; ++k) EXPECT_EQ(machine.word(kData + 4 * k), k + 1);
  EXPECT_THROW(guest_command_line(std::vector<std::string>{"both \"'"}), UserError);
}

TEST_F(SemihostingTest, ExitCodePasses) {
  call(0x20, {0x20026, 41});
  EXPECT_EQ(semihosting->exit_code(), 41);
  start();
  call_with(0x18, 0x20026);
  EXPECT_EQ(semihosting->exit_code(), 0);
  start();
  call_with(0x18, 0x20023);  // a run-time error
  EXPECT_EQ(semihosting->exit_code(), 1);
  start();
  EXPECT_FALSE(semihosting->exit_code());
}

TEST_F(SemihostingTest, ClocksAreSimulated) {
  machine.time = 12'345'678'901'234;
  EXPECT_EQ(call_with(0x10, 0), 1234u);
  EXPECT_EQ(call_with(0x11, 0), 12u);
  EXPECT_EQ(call_with(0x30, kData), 0u);
  EXPECT_EQ(machine.word(kData) | std::uint64_t{machine.word(kData + 4)} << 32, 12'345'678'901u);
  EXPECT_EQ(call_with(0x31, 0), 1'000'000'000u);
}

TEST_F(SemihostingTest, FeaturesSayExtendedExit) {
  const auto f = open(":semihosting-features", 0);
  EXPECT_EQ(call(0x0C, {f}), 5u);
  EXPECT_EQ(read(f, 8), std::string("SHFB\x03", 5));
  EXPECT_EQ(call(0x0A, {f, 4}), 0u);
  EXPECT_EQ(read(f, 8), "\x03");
  EXPECT_EQ(call(0x0A, {f, 5}), 0u) << "the end";
  EXPECT_EQ(read(f, 8), "");
  EXPECT_EQ(call(0x0A, {f, 6}), kFailed);
  EXPECT_EQ(last_errno(), std::uint32_t{EINVAL});
  EXPECT_EQ(open(":semihosting-features", 4), kFailed);
}

TEST_F(SemihostingTest, SystemIsRefusedAndNoted) {
  const std::uint32_t n = put(kText, "true");
  EXPECT_EQ(call(0x12, {kText, n}), kFailed);
  EXPECT_EQ(diagnostics.counts().size(), 1u);
  EXPECT_EQ(call_with(0x77, 0), kFailed);
  EXPECT_EQ(diagnostics.counts().size(), 2u);
}

TEST_F(SemihostingTest, BadPointersAndHandlesAreErrorsOfTheCall) {
  EXPECT_EQ(call_with(0x05, 0xFFFF'FFF0u), kFailed);
  EXPECT_EQ(last_errno(), std::uint32_t{EFAULT});
  EXPECT_EQ(call(0x01, {0xFFFF'0000u, 0, 4}), kFailed);
  EXPECT_EQ(call(0x01, {kText, 0, 0xFFFF'FFFFu}), kFailed);
  EXPECT_EQ(call(0x01, {kText, 0, 4097}), kFailed);
  EXPECT_EQ(last_errno(), 91u) << "ENAMETOOLONG of newlib";
  EXPECT_EQ(call(0x01, {kText, 12, 1}), kFailed);
  const auto out = open(":tt", 4);
  EXPECT_EQ(call(0x05, {out, 0x1FFF0, 0x100}), 0x100u);
  EXPECT_EQ(call(0x05, {99, kText, 3}), 3u);
  EXPECT_EQ(call(0x06, {open("inside", 0), 0xFFFF'0000u, 3}), kFailed);
  for (unsigned k = 0; k < 100; ++k) open("inside", 0);
  EXPECT_EQ(last_errno(), std::uint32_t{EMFILE});
}

/// Names put together from everything that could lead out of the folder, in every call that takes
/// one, and calls of random numbers and blocks: nothing outside changes, and all of them return.
TEST_F(SemihostingTest, NoNameAndNoCallReachesOutside) {
  fs::create_symlink("../secret", root / "link");
  fs::create_directory_symlink("..", root / "up");
  ::mkfifo((root / "pipe").c_str(), 0600);
  const std::string pieces[] = {"..",   ".",        "",      "sub",  "inside",
                                "link", "up",       "pipe",  "secret", "root",
                                top.string(), "\x80\xff", ":tt", "~",    std::string(300, 'n')};
  std::mt19937 rng(11);
  const auto name = [&] {
    std::string out = rng() % 3 ? "" : "/";
    for (unsigned n = 1 + rng() % 4; n > 0; --n)
      out += pieces[rng() % std::size(pieces)] + (n > 1 ? "/" : "");
    return out;
  };
  unsigned opened = 0;
  for (unsigned k = 0; k < 6'000; ++k) {
    const std::string a = name(), b = name();
    switch (rng() % 3) {
      case 0: {
        const std::uint32_t f = open(a, rng() % 12);
        if (f == kFailed) break;
        ++opened;
        write(f, "overwritten");
        call(0x02, {f});
        break;
      }
      case 1: remove(a); break;
      default: {
        const std::uint32_t n = put(kText, a), m = put(kData, b);
        call(0x0F, {kText, n, kData, m});
      }
    }
  }
  EXPECT_GT(opened, 20u);
  for (unsigned k = 0; k < 20'000; ++k) {
    for (std::uint32_t at = kBlock; at < kBlock + 16; at += 4) {
      const std::uint32_t w = rng() % 4 == 0 ? rng() : rng() % 4 == 0 ? rng() % 0x20000 : rng() % 600;
      std::memcpy(machine.memory.data() + at, &w, 4);
    }
    const std::uint32_t operation = rng() % 8 ? rng() % 0x32 : rng();
    call_with(operation, rng() % 8 ? kBlock : rng());
  }
  EXPECT_EQ(host_text(top / "secret"), "outside");
  std::vector<std::string> there;
  for (const auto& entry : fs::directory_iterator(top)) there.push_back(entry.path().filename());
  std::sort(there.begin(), there.end());
  EXPECT_EQ(there, (std::vector<std::string>{"root", "secret"}));
}

TEST_F(SemihostingTest, TemporaryNamesDifferAndFit) {
  EXPECT_EQ(call(0x0D, {kData, 7, 20}), 0u);
  EXPECT_STREQ(reinterpret_cast<char*>(machine.memory.data()) + kData, "guest007.tmp");
  EXPECT_EQ(call(0x0D, {kData, 7, 12}), kFailed);
  EXPECT_EQ(call(0x0D, {kData, 256, 20}), kFailed);
  EXPECT_EQ(call(0x08, {kFailed}), 1u);
  EXPECT_EQ(call(0x08, {5}), 0u);
}

}  // namespace
}  // namespace fovea::app
