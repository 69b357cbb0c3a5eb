// `--command-trace`: read back and held against the part's rules and the statistics; and latencies of a
// whole replay against the sums of its waits.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "sw/fovea/tools/command_trace.h"
#include "tb/dram/bench.h"
#include "tb/replay/played.h"
#include "tb/replay/support.h"

namespace fovea::replay {
namespace {

namespace fs = std::filesystem;
using mem::check::Command;

std::string mixed_requests(int count) {
  Rng rng(7);
  std::string text = master_lines(3, 4);
  Picoseconds at = 1'000'000;
  for (int n = 0; n < count; ++n) {
    at += rng.below(n % 500 == 0 ? 20'000'000 : 200'000);  // pauses in which the part is refreshed
    text += fmt::format("{} {} {} 0x{:x} {}\n", at, rng.below(3), rng.below(3) ? 'R' : 'W',
                        rng.below(1u << 14) * 64, 8u << rng.below(4));
  }
  return text;
}

struct Traced {
  std::string text;
  std::map<std::string, double> figures;
};

/// A replay with a trace of its commands.
Traced traced(const std::string& requests, const Keys& keys = {}) {
  const fs::path file = fs::path(testing::TempDir()) / "fovea_commands.csv";
  trace::TextTrace source("t", requests);
  app::ReplayParams params;
  ParamSet set;
  params.declare(set);
  for (const auto& [key, value] : keys) set.set(key, value);
  app::ReplayPath path("t", source.info(), source, params, false);
  app::CommandTrace commands(file);
  commands.begin(path.controller(), path.start());
  EXPECT_TRUE(path.run_before(kNever));
  path.finish();
  commands.finish();
  Traced out;
  std::stringstream text;
  text << std::ifstream(file).rdbuf();
  out.text = text.str();
  fs::remove(file);
  for (const app::StatRow& row : path.stats())
    out.figures[row.name] = std::visit([](auto v) { return static_cast<double>(v); }, row.value);
  return out;
}

/// Reads a trace as its documentation has it: what the independent checker says of it, and the number of
/// each command.
struct Reader {
  dram::CommandChecker checker{dram::sheet_of(mem::DdrConfig{})};
  std::map<std::string, std::uint64_t> count;
  explicit Reader(const std::string& text) {
    static const std::map<std::string, Command> kWords = {
        {"ACT", Command::kAct}, {"PRE", Command::kPre}, {"PREA", Command::kPreAll},
        {"RD", Command::kRd},   {"WR", Command::kWr},   {"RDA", Command::kRda},
        {"WRA", Command::kWra}, {"REF", Command::kRef}, {"PDE", Command::kPde},
        {"PDX", Command::kPdx}, {"SRE", Command::kSre}, {"SRX", Command::kSrx}};
    std::istringstream lines(text);
    std::string line;
    std::getline(lines, line);
    EXPECT_EQ(line, "clock,command,bank,row");
    while (std::getline(lines, line)) {
      std::istringstream cells(line);
      std::string clock, command, bank, row;
      std::getline(cells, clock, ',');
      std::getline(cells, command, ',');
      std::getline(cells, bank, ',');
      std::getline(cells, row, ',');
      ++count[command];
      const auto word = kWords.find(command);
      if (word == kWords.end()) {
        ADD_FAILURE() << line;
        return;
      }
      const bool any_bank = command != "REF" && command != "PREA" && command[0] != 'S' &&
                            !command.starts_with("PD");
      EXPECT_EQ(!bank.empty(), any_bank) << line;
      EXPECT_EQ(!row.empty(), any_bank && command != "PRE") << line;
      checker.command(word->second, bank.empty() ? 0 : static_cast<unsigned>(std::stoul(bank)),
                      row.empty() ? 0 : static_cast<std::uint32_t>(std::stoul(row)),
                      std::stoull(clock));
    }
  }
  std::uint64_t of(const std::string& command) const {
    const auto found = count.find(command);
    return found == count.end() ? 0 : found->second;
  }
};

TEST(CommandTraceTest, KeepsTheRulesAndHasAsManyCommandsAsTheStatistics) {
  const Traced t = traced(mixed_requests(3000));
  const Reader r(t.text);
  EXPECT_EQ(r.checker.total(), 0u) << r.checker.text();
  EXPECT_GT(r.of("REF"), 10u);
  EXPECT_EQ(static_cast<double>(r.of("ACT")), t.figures.at("ddr.activates"));
  EXPECT_EQ(static_cast<double>(r.of("REF")), t.figures.at("ddr.refreshes"));
  const auto columns = static_cast<double>(r.of("RD") + r.of("WR") + r.of("RDA") + r.of("WRA"));
  EXPECT_EQ(columns, t.figures.at("ddr.bursts"));
  EXPECT_DOUBLE_EQ(t.figures.at("ddr.command_hit_rate"), 1 - static_cast<double>(r.of("ACT")) / columns);
  EXPECT_GT(r.of("PRE"), 0u);
}

TEST(CommandTraceTest, NamesSleepAndAutoPrecharge) {
  const Traced sleeps = traced(mixed_requests(300), {{"ddr.low_power", "power_down"}});
  const Reader r(sleeps.text);
  EXPECT_EQ(static_cast<double>(r.of("PDE")), sleeps.figures.at("ddr.power_downs"));
  EXPECT_GT(r.of("PDX"), 0u);
  const Traced closed = traced(mixed_requests(300), {{"ddr.scheduler", "closed_page"}});
  EXPECT_GT(Reader(closed.text).of("RDA"), 0u);
}

// The reader above can complain: a row that is not opened, a command a clock early.
TEST(CommandTraceTest, AMissingOrEarlyLineIsFound) {
  const std::string text = traced(mixed_requests(50)).text;
  const std::size_t act = text.find(",ACT,"), line = text.rfind('\n', act) + 1;
  std::string missing = text;
  missing.erase(line, text.find('\n', act) + 1 - line);
  EXPECT_GT(Reader(missing).checker.total(), 0u);
  const std::size_t read = text.find(",RD,", act), begin = text.rfind('\n', read) + 1;
  std::string early = text;
  early.replace(begin, read - begin, std::to_string(std::stoull(text.substr(begin)) - 1));
  EXPECT_GT(Reader(early).checker.total(), 0u);
}

// A trace that begins while rows are open says so.
TEST(CommandTraceTest, BeginsWithTheOpenRows) {
  const fs::path file = fs::path(testing::TempDir()) / "fovea_open_rows.csv";
  mem::DdrParams params;
  mem::BackingStore store(params.size_bytes());
  mem::DdrController ddr(params, store, {});
  ddr.set_clocks(dram::kDdr, dram::kDdr, 0);
  mem::DdrConfig config;
  config.refresh_interval = 0;
  ddr.configure(config, 0);
  dram::Request r;
  r.path.data = r.data.data();
  r.path.bytes = 16;
  ddr.submit(r.path, dram::at(77, 3), dram::kTck);
  while (ddr.next_decision() != kNever) {
    ddr.step();
    ddr.news().clear();
  }
  app::CommandTrace commands(file);
  commands.begin(ddr, 1000 * dram::kTck);
  commands.finish();
  std::stringstream text;
  text << std::ifstream(file).rdbuf();
  fs::remove(file);
  EXPECT_EQ(text.str(), "clock,command,bank,row\n1000,OPEN,3,77\n");
}

// Every picosecond of a read up to its first beat, and of a write up to its acknowledgement, has a
// culprit: the sums of the waits are those of the latencies.
TEST(ReplayLatencyTest, SumsAreThoseOfTheWaits) {
  trace::TextTrace source("t", mixed_requests(3000));
  const Played p(source);
  const auto value = figures(p);
  for (unsigned m = 0; m < 3; ++m) {
    const bus::LatencyStats& l = p.path->latency(trace::TextTrace::port(m));
    std::map<std::string, double> waited;
    const std::string wait = fmt::format("ddr.m{}.wait.", m);
    for (const auto& [name, v] : value)
      if (name.starts_with(wait)) waited[name.substr(wait.size(), name.find('.', wait.size()) - wait.size())] += v;
    const auto reads = l.read_first();
    const auto writes = l.histogram(&bus::PortLatencies::write, &bus::BeatLatencies::last);
    ASSERT_GT(reads.count(), 500u);
    ASSERT_GT(writes.count(), 100u);
    EXPECT_NEAR(reads.mean() * static_cast<double>(reads.count()) * 1e-12, waited.at("read"), 1e-11);
    EXPECT_NEAR(writes.mean() * static_cast<double>(writes.count()) * 1e-12, waited.at("write"), 1e-11);
  }
  std::uint64_t firsts = 0, lasts = 0;
  for (const app::LatencyRow& row : p.path->latency_rows())
    (row.beat == "first" ? firsts : lasts) += row.count;
  EXPECT_EQ(firsts, p.path->requests());
  EXPECT_EQ(lasts, p.path->requests());
}

// Without the crossbar a write's first and last beat are its acceptance by the controller.
TEST(ReplayLatencyTest, MemoryAloneHasLatenciesToo) {
  trace::TextTrace source("t", mixed_requests(500));
  const Played p(source, true);
  std::uint64_t n = 0;
  for (const app::LatencyRow& row : p.path->latency_rows()) n += row.count;
  EXPECT_EQ(n, 2 * p.path->requests());
}

}  // namespace
}  // namespace fovea::replay
