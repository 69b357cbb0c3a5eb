// The memory map of a program, and files that are not programs.
#include "sw/fovea/program/exec_program.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <fstream>

#include "model/common/check.h"
#include "sw/fovea/cli/exec_command.h"

namespace fovea::app {
namespace {

namespace fs = std::filesystem;
constexpr std::uint64_t kSize = 128u << 20;

class ExecProgramTest : public testing::Test {
 protected:
  fs::path file = fs::temp_directory_path() / ("exec-program-" + std::to_string(::getpid()));
  ~ExecProgramTest() override { fs::remove(file); }
  ExecProgram flat(std::uint32_t load, std::size_t bytes = 64) {
    std::ofstream(file, std::ios::binary) << std::string(bytes, 'x');
    return ExecProgram::flat(file, load, load);
  }
};

TEST_F(ExecProgramTest, DefaultLinkHasRamAtZeroAndNoInternalRam) {
  const ExecMap m = flat(0x8000, 0x1'0000).map(kSize);
  EXPECT_EQ(m.ram_base, 0u);
  EXPECT_FALSE(m.tcm);
  EXPECT_EQ(m.free_base, 0x1'8000u);
  EXPECT_EQ(m.free_end, kSize);
  EXPECT_EQ(m.heap_limit(), kSize - (8u << 20));
}

TEST_F(ExecProgramTest, ChipsMapHasBoth) {
  const ExecMap m = flat(0x8010'0000).map(kSize);
  EXPECT_EQ(m.ram_base, 0x8000'0000u);
  EXPECT_TRUE(m.tcm);
  EXPECT_EQ(m.free_base, 0x8010'0040u);
  const ExecMap inside = flat(0x1'0000).map(kSize);
  EXPECT_EQ(inside.ram_base, 0x8000'0000u);
  EXPECT_TRUE(inside.tcm);
  EXPECT_EQ(inside.free_base, 0x8000'0000u);
}

TEST_F(ExecProgramTest, AnyWindowServes) {
  EXPECT_EQ(flat(0x2345'6780).map(kSize).ram_base, 0x2000'0000u);
  EXPECT_EQ(flat(0x2345'6780).map(kSize / 2).ram_base, 0x2000'0000u);
  EXPECT_EQ(flat(0x2745'6780).map(kSize / 2).ram_base, 0x2400'0000u);
}

TEST_F(ExecProgramTest, ARamBaseThatIsGivenCounts) {
  const ExecMap m = flat(0x2345'6780).map(kSize, 0x2010'0000);
  EXPECT_EQ(m.ram_base, 0x2010'0000u);
  EXPECT_TRUE(m.tcm);
  EXPECT_EQ(m.free_end, 0x2810'0000u);
  const ExecMap low = flat(0x100).map(kSize, 0x4000'0000);  // in the internal RAM
  EXPECT_EQ(low.ram_base, 0x4000'0000u);
  EXPECT_EQ(low.free_base, 0x4000'0000u);
  EXPECT_THROW(flat(0x2000'0000).map(kSize, 0x2010'0000), UserError);
  EXPECT_EQ(parse_ram_base("auto", kSize), std::nullopt);
  EXPECT_EQ(parse_ram_base("0x20100000", kSize), 0x2010'0000u);
  EXPECT_EQ(parse_ram_base("0xf8000000", kSize), 0xF800'0000u);
  for (const char* text : {"", "0x20100001", "0xf8100000", "0x20000000,64MiB", "here"})
    EXPECT_THROW(parse_ram_base(text, kSize), UserError) << text;
}

TEST_F(ExecProgramTest, LargestGapIsFree) {
  const ExecMap m = flat(0x07F0'0000).map(kSize);
  EXPECT_EQ(m.free_base, 64u);  // behind the vectors
  EXPECT_EQ(m.free_end, 0x07F0'0000u);
  const ExecMap last = flat(0xF900'0000, 64).map(kSize);
  EXPECT_EQ(last.ram_base, 0xF800'0000u);
  EXPECT_EQ(last.free_end, 0xFFFF'FFC0u);
}

TEST_F(ExecProgramTest, SegmentAcrossTheEndIsRefused) {
  EXPECT_THROW(flat(0x07FF'FFF0).map(kSize), UserError);
  EXPECT_THROW(flat(0xFFFF'FFF0), UserError);
  EXPECT_THROW(flat(0x8000, 0), UserError);
  EXPECT_THROW(ExecProgram::elf(file), UserError);
}

TEST(ParseAddressTest, TakesHexAndDecimalOnly) {
  EXPECT_EQ(parse_address("--load", "0x8000"), 0x8000u);
  EXPECT_EQ(parse_address("--load", "4294967295"), 0xFFFF'FFFFu);
  for (const char* text : {"", "0x", "8000h", "-1", "0x100000000", "1 "})
    EXPECT_THROW(parse_address("--load", text), UserError) << text;
}

TEST(TakeProgramArgumentsTest, LeavesItsOwnOptionsOnEitherSide) {
  using Words = std::vector<std::string>;
  CLI::App app;
  ExecOptions options;
  const CLI::App& exec = *add_exec_command(app, options);
  Words args = {"exec", "-s", "a=b", "prog", "x", "--fast-memory", "-o", "dir", "-v", "--", "-s"};
  EXPECT_EQ(take_program_arguments(exec, args), (Words{"x", "-v", "-s"}));
  EXPECT_EQ(args, (Words{"exec", "-s", "a=b", "prog", "--fast-memory", "-o", "dir"}));
  args = {"exec", "--bad", "prog", "--root=here"};
  EXPECT_EQ(take_program_arguments(exec, args), Words{});
  EXPECT_EQ(args, (Words{"exec", "--bad", "prog", "--root=here"}));
  args = {"exec", "prog", "--set=a=b", "--other=1", "-", "--gdb", "--", "--"};
  EXPECT_EQ(take_program_arguments(exec, args), (Words{"--other=1", "-"}));
  EXPECT_EQ(args, (Words{"exec", "prog", "--set=a=b", "--gdb", "--"})) << "a value may be '--'";
}

}  // namespace
}  // namespace fovea::app
