// A recorded run against its replay, and a replay with other memory against a real run with that
// memory.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <numeric>
#include <optional>
#include <sstream>
#include <systemc>

#include "model/trace/core/trace_file.h"
#include "sw/fovea/probes/bus_trace_run.h"
#include "sw/fovea/replay/replay_path.h"
#include "tb/e2e/in_child.h"
#include "tb/e2e/rig.h"

namespace fovea::replay {
namespace {

using Figures = std::map<std::string, double>;
using Keys = std::vector<std::pair<std::string, std::string>>;

/// What is changed against the firmware's settings, for the whole window. 0: nothing.
struct Change {
  std::uint64_t ddr_hertz = 0;
  unsigned CL = 0;
  bool sleeps = false;
  Keys keys = {};      ///< of the run and of the replay
  Keys of_trace = {};  ///< of the replay alone: what another run's trace holds
  std::string text() const {
    if (!keys.empty()) return keys.front().first + " " + keys.front().second;
    if (sleeps) return "self-refresh";
    return ddr_hertz ? "DDR clock " + std::to_string(ddr_hertz) : "CL " + std::to_string(CL);
  }
};

/// What is compared. In the same window a faster memory does more: times are those up to the same count.
struct Watched {
  bool remaps = true;          // the mean remap
  bool latencies = true;
  std::optional<Master> writes = {};  // when which of its writes was acknowledged
};
constexpr unsigned kFrames = 2;
/// After so long nothing is under way any more that was before the window.
constexpr Picoseconds kUnderWay = 10 * kPsPerUs;
/// Every so many writes of Watched::writes.
constexpr std::size_t kWritesApart = 10'000;
/// A 99th percentile needs so many requests of a master and direction, a mean so many.
constexpr std::size_t kForP99 = 1'000, kForMean = 100;

/// Latencies, each as it is: the statistics' histogram is too coarse for 1 %. A read's ends with its
/// first beat, a write's with its acknowledgement.
class Latencies : public MemObserver {
 public:
  bool on = false;
  /// Earlier requests are not in the sum of times. A trace does not hold what was under way when the window
  /// opened, so its first requests may find a memory at rest that was busy.
  Picoseconds exact_from = 0;
  void submitted(const MemRequest&, bool) override {}
  void responded(const MemRequest& r) override {
    if (on && r.issued >= exact_from)
      for (const Picoseconds t : {r.issued, r.first, r.last})
        times_[index(r.master)] = (times_[index(r.master)] ^ t) * 0x100'0000'01B3u;
    if (on)
      all_[index(r.master)][r.write].push_back((r.write ? r.last : r.first) - r.issued);
    if (on && r.write) written_[index(r.master)].push_back(r.last);
  }
  /// Of each master that asked: all times of its requests, as a sum that any other time changes.
  void add_times_to(Figures& f) {
    for (std::size_t m = 0; m < kMasterCount; ++m)
      if (times_[m] != kNoTimes)
        f["times." + std::string(kMasterNames[m])] = static_cast<double>(times_[m] >> 12);
  }
  /// Since `start`.
  void add_writes_to(Figures& f, Master m, Picoseconds start) {
    const auto& v = written_[index(m)];
    for (std::size_t n = kWritesApart; n <= v.size(); n += kWritesApart)
      f["until." + std::to_string(n)] = static_cast<double>(v[n - 1] - start) * 1e-12;
  }
  void add_to(Figures& f) {
    for (std::size_t m = 0; m < kMasterCount; ++m)
      for (const bool write : {false, true}) {
        auto& v = all_[m][write];
        if (v.size() < kForMean) continue;
        std::sort(v.begin(), v.end());
        const std::string name = std::string(kMasterNames[m]) + (write ? ".write" : ".read");
        f[name + ".mean"] = std::accumulate(v.begin(), v.end(), 0.0) /
                            static_cast<double>(v.size()) * 1e-12;
        if (v.size() >= kForP99)
          f[name + ".p99"] = static_cast<double>(v[v.size() * 99 / 100]) * 1e-12;
      }
  }

 private:
  static constexpr std::uint64_t kNoTimes = 0xCBF2'9CE4'8422'2325u;
  std::array<std::array<std::vector<Picoseconds>, 2>, kMasterCount> all_;  // reads, writes
  std::array<std::vector<Picoseconds>, kMasterCount> written_;
  std::array<std::uint64_t, kMasterCount> times_ = [] {
    std::array<std::uint64_t, kMasterCount> none;
    none.fill(kNoTimes);
    return none;
  }();
};

bool ends_a_remap(std::uint32_t pins) {
  return static_cast<board::Phase>(pins & 15u) == board::Phase::kRemapEnd;
}
void add_ends_to(Figures& f, const std::vector<Picoseconds>& ends, Picoseconds start) {
  for (std::size_t n = 0; n < ends.size(); ++n)
    f["until." + std::to_string(n + 1)] = static_cast<double>(ends[n] - start) * 1e-12;
}

/// A run of the whole board, in a process of its own: a simulation elaborates once.
Figures run_board(const Keys& keys_set, const Watched& watched, const Change& change,
                  const std::string& trace) {
  const std::string text = test::in_child([&] {
    e2e::Rig rig;
    rig.set("run.frames", std::to_string(kFrames)).set("camera.stamp", "false");
    for (const auto& [key, value] : keys_set) rig.set(key, value);
    for (const auto& [key, value] : change.keys) rig.set(key, value);
    auto& board = rig.build();
    auto& soc = board.dm365;
    ParamSet keys;
    rig.params.declare(keys);
    std::unique_ptr<app::BusTraceRun> recording;
    if (!trace.empty()) recording = std::make_unique<app::BusTraceRun>(trace, keys, board);
    Figures f;
    Latencies latencies;
    const Subscription observing = soc.scr.crossbar().observe(latencies);
    Picoseconds opened = 0;
    std::vector<Picoseconds> remap_ends;
    const Subscription pins = soc.gpio.observe_outputs([&](unsigned bank, std::uint32_t out, Picoseconds at) {
      if (bank == 2 && latencies.on && ends_a_remap(out)) remap_ends.push_back(at);
    });
    const Subscription window = board.observe_window([&](bool open) {
      latencies.on = open;
      if (!open && recording) recording->close();
      if (!open) return;
      opened = kernel_time();
      latencies.exact_from = opened + kUnderWay;
      mem::DdrConfig c = soc.ddr.programmed();
      if (change.CL) {
        c.timing.CL = c.read_latency = change.CL;
        soc.ddr.controller().configure(c, kernel_time());
      }
      if (change.sleeps) {
        c.low_power = mem::LowPower::kSelfRefresh;
        soc.ddr.controller().configure(c, kernel_time());
      }
      if (change.ddr_hertz)
        soc.ddr.controller().set_clocks(Frequency(change.ddr_hertz), soc.scr.clk.read(),
                                        kernel_time());
      if (recording) recording->open();
    });
    rig.run(10 * kPsPerSecond);
    if (watched.latencies) latencies.add_to(f);
    latencies.add_times_to(f);
    if (watched.writes) latencies.add_writes_to(f, *watched.writes, opened);
    if (recording) recording->finish();
    if (watched.remaps) {
      f["remap"] = board.frame_stats().remap_mean * 1e-12;
      f["remaps"] = static_cast<double>(board.frame_stats().remaps);
    } else if (!watched.writes) {
      add_ends_to(f, remap_ends, opened);
    }
    std::ostringstream out;
    out.precision(17);
    for (const auto& [name, value] : f) out << name << ' ' << value << '\n';
    return out.str();
  });
  Figures f;
  std::istringstream in(text);
  std::string name;
  double value = 0;
  while (in >> name >> value) f[name] = value;
  return f;
}

/// What a trace has lost: all that its records depend on, or what they depend on in other streams.
enum class Lost { kNothing, kAll, kOthers };

/// Records that have lost that go at the time they went when they were recorded.
class Unchained : public trace::RecordSource {
 public:
  Unchained(trace::RecordSource& from, std::vector<std::vector<Picoseconds>> times, Lost lost)
      : from_(from), times_(std::move(times)), next_(times_.size()), lost_(lost) {}
  bool next(unsigned stream, trace::Record& r) override {
    if (!from_.next(stream, r)) return false;
    const Picoseconds at = times_[stream][next_[stream]++];
    const bool other = r.release == trace::Release::kWhen && r.source != trace::kInterrupt;
    if (lost_ == Lost::kOthers && !other) return true;
    changed_ += lost_ == Lost::kOthers;
    r.release = trace::Release::kAt;
    r.at = at;
    return true;
  }
  std::uint64_t changed() const { return changed_; }

 private:
  trace::RecordSource& from_;
  std::vector<std::vector<Picoseconds>> times_;
  std::vector<std::size_t> next_;
  Lost lost_;
  std::uint64_t changed_ = 0;
};

std::string file_bytes(const std::string& file) { return app::read_file(file, 1u << 30); }

app::ReplayParams& configure(app::ReplayParams& params, const trace::TraceInfo& info,
                             const Change& change) {
  ParamSet set;
  params.declare(set);
  for (const auto& [key, value] : info.params) set.set(key, value);
  if (change.ddr_hertz) set.set("ddr.clock", std::to_string(change.ddr_hertz) + "Hz");
  if (change.CL) {
    set.set("ddr.CL", std::to_string(change.CL) + "cycles");
    set.set("ddr.RL", std::to_string(change.CL) + "cycles");
  }
  if (change.sleeps) set.set("ddr.low_power", "self_refresh");
  for (const auto& [key, value] : change.of_trace) set.set(key, value);
  for (const auto& [key, value] : change.keys)
    if (set.find(key)) set.set(key, value);
  return params;
}

Figures replay(const std::string& file, const Watched& watched, const Change& change,
               Lost lost = Lost::kNothing, Picoseconds refresh_earlier = 0) {
  trace::TraceFile source("trace", file_bytes(file));
  trace::TraceInfo info = source.info();
  info.refresh -= refresh_earlier;
  app::ReplayParams params;
  configure(params, source.info(), change);
  std::vector<std::vector<Picoseconds>> times(source.info().streams.size());
  std::unique_ptr<Unchained> unchained;
  trace::TraceFile again("trace", file_bytes(file));
  if (lost != Lost::kNothing) {  // the times of the recorded configuration, from a replay of it
    app::ReplayParams same;
    configure(same, again.info(), {});
    app::ReplayPath path("trace", again.info(), again, same, false);
    path.on_issue = [&](unsigned stream, Picoseconds at) { times[stream].push_back(at); };
    path.run_before(kNever);
    unchained = std::make_unique<Unchained>(source, times, lost);
  }
  trace::RecordSource& records =
      unchained ? *unchained : static_cast<trace::RecordSource&>(source);
  app::ReplayPath path("trace", info, records, params, false);
  Latencies latencies;
  latencies.on = true;
  latencies.exact_from = info.start + kUnderWay;
  const Subscription observing = path.observe(latencies);
  path.run_before(kNever);
  path.finish();
  Figures f;
  if (lost == Lost::kOthers) {
    EXPECT_GT(unchained->changed(), 1'000u) << "no master waits for others";
  }
  if (watched.latencies) latencies.add_to(f);
  latencies.add_times_to(f);
  if (watched.writes) latencies.add_writes_to(f, *watched.writes, source.info().start);
  if (!watched.remaps) {
    std::vector<Picoseconds> ends;
    for (const auto& m : path.marks())
      if (ends_a_remap(m.value)) ends.push_back(m.at);
    if (!watched.writes) add_ends_to(f, ends, source.info().start);
    return f;
  }
  double sum = 0;
  for (const Picoseconds t : path.remap_times()) sum += static_cast<double>(t) * 1e-12;
  f["remaps"] = static_cast<double>(path.remap_times().size());
  f["remap"] = sum / f["remaps"];
  return f;
}

/// The largest relative difference; prints all. Of the times up to a count, the longest that both have.
double worst(Figures real, Figures replayed, const std::string& what) {
  double largest = 0, longest = 0;
  for (const auto& [name, value] : real)
    if (name.starts_with("until.") && replayed.count(name)) longest = std::max(longest, value);
  for (const auto& [name, value] : real) {
    if (name.starts_with("times.") || (name.starts_with("until.") && value != longest)) continue;
    if (!replayed.count(name)) continue;  // a few requests fewer than are needed
    const double d = replayed.at(name) / value - 1;
    std::printf("  %-18s %-16s real %.6g  replay %.6g  %+.3f %%\n", what.c_str(), name.c_str(),
                value, replayed.at(name), 100 * d);
    largest = std::max(largest, std::abs(d));
  }
  return largest;
}

/// A percentile moves by whole clocks of a bus, a few percent of it each: so much, of the crossbar's
/// slowest clock here.
constexpr double kCrossbarClock = 1 / 121.5e6 + 2e-12;

/// Outcomes of the core's requests lie at edges of its AHB, half of 297 MHz.
constexpr double kAhbClock = 1 / 148.5e6 + 1e-12;
double in_ahb_clocks(double seconds) { return std::ceil(seconds / kAhbClock) * kAhbClock; }

/// The largest difference of a 99th percentile of the core's masters, or of all others, in seconds.
double largest_p99(const Figures& real, const Figures& replayed, bool of_core) {
  double largest = 0;
  for (const auto& [name, value] : real)
    if (name.starts_with("arm_") == of_core && name.ends_with(".p99") && replayed.count(name))
      largest = std::max(largest, std::abs(replayed.at(name) - value));
  return largest;
}

Figures without_p99(Figures f) {
  std::erase_if(f, [](const auto& figure) { return figure.first.ends_with(".p99"); });
  return f;
}

/// Masters whose requests did not all go out and end at the very picosecond.
unsigned other_times(const Figures& real, const Figures& replayed) {
  unsigned masters = 0;
  for (const auto& [name, value] : real)
    masters += name.starts_with("times.") && replayed.at(name) != value;
  return masters;
}

std::string file() {
  return (std::filesystem::temp_directory_path() /
          ("fovea_replay_" + std::to_string(::getpid()) + ".trace"))
      .string();
}

class RunsTest : public testing::TestWithParam<const char*> {
 protected:
  ~RunsTest() override { std::filesystem::remove(file()); }
};

TEST_P(RunsTest, ReplayFollowsTheRun) {
  const Keys keys = {{"firmware.kernel", GetParam()}};
  const Watched watched;
  const Figures recorded = run_board(keys, watched, {}, file());
  ASSERT_GE(recorded.at("remaps"), 2);
  const Figures same = replay(file(), watched, {});
  EXPECT_LE(worst(recorded, same, "same"), 0.01);
  // Nothing is lost: all but what was under way when the window opened is as it was.
  EXPECT_EQ(other_times(recorded, same), 0u);
  EXPECT_GT(other_times(recorded, replay(file(), watched, {}, Lost::kNothing, 30'000)), 0u)
      << "refreshes a few clocks earlier";
  for (const Change& change :
       {Change{270'000'000, 0}, Change{162'000'000, 0}, Change{0, 3}, Change{0, 7}}) {
    const Figures real = run_board(keys, watched, change, "");
    const Figures replayed = replay(file(), watched, change);
    EXPECT_LE(worst(without_p99(real), replayed, change.text()), 0.015);
    // Outcomes lie at edges of the SDRAM's clock and, on their way back, of the crossbar's.
    const double ddr_clock = 1.0 / static_cast<double>(change.ddr_hertz ? change.ddr_hertz : 243'000'000);
    const double edges = kCrossbarClock + ddr_clock;
    EXPECT_LE(largest_p99(real, replayed, false), edges) << change.text();
    EXPECT_LE(largest_p99(real, replayed, true), in_ahb_clocks(edges)) << change.text();
    // The loss shows when memory gets faster; with slower memory the core's one port is always taken,
    // and that alone keeps its requests apart.
    const double lost =
        worst(real, replay(file(), watched, change, Lost::kAll), "unchained " + change.text());
    if (change.ddr_hertz > 243'000'000) {
      EXPECT_GT(lost, 0.03);
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Kernels, RunsTest, testing::Values("plain", "ldm"));

/// The figures of those whose name begins so.
Figures only(const Figures& all, const std::vector<std::string>& beginnings) {
  Figures out;
  for (const auto& [name, value] : all)
    for (const auto& b : beginnings)
      if (name.starts_with(b)) out[name] = value;
  return out;
}

/// The chip's own clock presets, with all that the firmware programs for them: SDRAM and crossbar change
/// together. In both directions.
TEST_P(RunsTest, OtherClocksOfThePllFollowTheRun) {
  const Watched watched;
  const auto other_file = file() + ".other";
  struct Side {
    Keys keys;
    std::string file;
    Figures figures;
    trace::TraceInfo info;
  };
  std::array<Side, 2> sides = {Side{{{"clocks.preset", "297/243"}}, file(), {}, {}},
                               Side{{{"clocks.preset", "297/270"}}, other_file, {}, {}}};
  for (Side& s : sides) {
    s.keys.emplace_back("firmware.kernel", GetParam());
    s.figures = run_board(s.keys, watched, {}, s.file);
    s.info = trace::TraceFile("trace", file_bytes(s.file)).info();
  }
  for (const unsigned from : {0u, 1u}) {
    const Side& to = sides[1 - from];
    Change change;
    change.of_trace = to.info.params;
    const Figures replayed = replay(sides[from].file, watched, change);
    const std::string what = "to " + to.keys.front().second;
    // LDM waits for the later words of a line, which come with the crossbar's clock (README.md, Limits).
    const double remap = GetParam() == std::string("ldm") ? 0.025 : 0.005;
    EXPECT_LE(worst(only(to.figures, {"remap"}), replayed, what), remap);
    // Not what capture waits, which differs more: its lines meet the display's elsewhere, as start-up
    // takes another time with other clocks. That this is the reason has not been shown (README.md, Limits).
    EXPECT_LE(worst(without_p99(only(to.figures, {"arm_", "vpbe"})), replayed, what), 0.015);
    for (const bool of_core : {false, true})
      EXPECT_LE(largest_p99(only(to.figures, {"arm_", "vpbe"}), replayed, of_core), kCrossbarClock) << what;
  }
  std::filesystem::remove(other_file);
}

/// Bridges much faster than recorded, and back: buffered stores no longer hold the core up, and then do.
/// The limits grow towards no latency at all, where a read would find more stores out that it went before
/// in the recording (README.md, Limits). Chained to their port, as up to version 2 of the file, stores
/// made the remap 0.5, 6 and 15 % too short.
TEST_P(RunsTest, FasterBridgesThanRecordedFollowTheRun) {
  const Watched watched;
  struct Bridges {
    const char *request, *response;
    double remap, latency;  // limits
  };
  const auto change = [](const Bridges& b) {
    Change c;
    c.keys = {{"bus.arm_d.request_latency", b.request}, {"bus.arm_d.response_latency", b.response}};
    return c;
  };
  const Bridges recorded = {"3cycles", "3cycles", 0.015, 0.02};
  const Bridges faster[] = {{"1cycles", "1cycles", 0.01, 0.03},
                            {"1cycles", "0cycles", 0.03, 0.05},
                            {"0cycles", "0cycles", 0.03, 0.08}};
  const Keys keys = {{"firmware.kernel", GetParam()}};
  const auto compare = [&](const Figures& real, const Bridges& b, const std::string& what) {
    const Figures replayed = replay(file(), watched, change(b));
    EXPECT_LE(worst(only(real, {"remap"}), replayed, what), b.remap);
    EXPECT_LE(worst(only(real, {"arm_d.read.mean", "arm_d.write.mean"}), replayed, what), b.latency);
    worst(only(real, {"arm_d.read.p99", "arm_d.write.p99", "vpbe", "vpfe"}), replayed, what);
  };
  const Figures slow = run_board(keys, watched, change(recorded), file());
  for (const Bridges& b : faster)
    compare(run_board(keys, watched, change(b), ""), b, change(b).text() + " " + b.response);
  run_board(keys, watched, change(faster[2]), file());
  compare(slow, recorded, "and back");
}

/// Remaps back to back, as in the experiment `throughput`: total time.
class UnpacedTest : public RunsTest {
 protected:
  void follow(const std::vector<Change>& changes) {
    const Keys keys = {{"firmware.kernel", GetParam()}, {"firmware.repeat", "10"}};
    const Watched watched{false, false, {}};
    const Figures recorded = run_board(keys, watched, {}, file());
    ASSERT_GE(recorded.size(), 2u);
    // Nothing between two remaps: the last one's end is that of so many in a row.
    EXPECT_LE(worst(recorded, replay(file(), watched, {}), "same"), 0.01);
    for (const Change& change : changes) {
      const Figures real = run_board(keys, watched, change, "");
      EXPECT_LE(worst(real, replay(file(), watched, change), change.text()), 0.03);
      const double lost =
          worst(real, replay(file(), watched, change, Lost::kAll), "unchained " + change.text());
      if (change.ddr_hertz > 300'000'000) {
        EXPECT_GT(lost, 0.03);
      }
    }
  }
};
TEST_P(UnpacedTest, TotalTimeFollowsTheRun) { follow({{340'000'000, 0}}); }
TEST_P(UnpacedTest, NightlyTotalTimeFollowsTheRun) {
  follow({{270'000'000, 0}, {162'000'000, 0}, {0, 3}, {0, 7}});
}
INSTANTIATE_TEST_SUITE_P(Kernels, UnpacedTest, testing::Values("plain", "ldm"));

/// A transfer controller that copies: its write side waits for its read side's data, and its read side
/// for a place that an acknowledgement makes free.
class CopyTest : public testing::Test {
 protected:
  ~CopyTest() override { std::filesystem::remove(file()); }
};
TEST_F(CopyTest, SidesOfATransferControllerFollowEachOther) {
  const Keys keys = {{"video.width", "160"},     {"video.height", "32"},
                     {"load.port", "edma_tc0"},  {"load.kind", "copy"},
                     {"load.outstanding", "2"},  {"load.start", "300ms"},
                     {"load.pattern", "random"}};
  const Watched watched{false, false, edma_write(0)};
  const Figures recorded = run_board(keys, watched, {}, file());
  ASSERT_GE(recorded.size(), 5u);
  EXPECT_LE(worst(recorded, replay(file(), watched, {}), "same"), 0.01);
  for (const Change& change : {Change{270'000'000, 0}, Change{162'000'000, 0}, Change{0, 7}}) {
    const Figures real = run_board(keys, watched, change, "");
    EXPECT_LE(worst(real, replay(file(), watched, change), change.text()), 0.03);
    const double lost =
        worst(real, replay(file(), watched, change, Lost::kOthers), "lost " + change.text());
    if (change.ddr_hertz > 243'000'000) {
      EXPECT_GT(lost, 0.03) << "each goes when it went with slower memory";
    }
  }
}

/// Transfers of the EDMA go by what triggers them, and by the model's own transfer controller.
class EdmaRunsTest : public RunsTest {
 protected:
  Figures run(const Change& change, const std::string& trace, const std::string& repeat = "1") {
    return run_board({{"firmware.kernel", GetParam()},
                      {"firmware.lut", "fixed_point"},
                      {"firmware.repeat", repeat},
                      {"video.width", "320"},
                      {"video.height", "240"}},
                     {}, change, trace);
  }
};

/// By `staged` core and EDMA work in internal RAM side by side, and wait for each other there. By `runs` the channel
/// controller has requests of four queues at one time.
TEST_P(EdmaRunsTest, EachRequestIsServedAsInTheRun) {
  const Figures recorded = run({}, file());
  ASSERT_GE(recorded.at("remaps"), 2);
  EXPECT_EQ(recorded.count("times.edma_tc0_read"), 1u);
  const Figures same = replay(file(), {}, {});
  EXPECT_EQ(same.size(), recorded.size());
  EXPECT_LE(worst(without_p99(recorded), same, "same"), 0.0001);
  EXPECT_EQ(other_times(recorded, same), 0u);
  EXPECT_GT(other_times(recorded, replay(file(), {}, {}, Lost::kNothing, 30'000)), 0u)
      << "refreshes a few clocks earlier";
  EXPECT_TRUE(trace::TraceFile("trace", file_bytes(file())).info().kept.empty());
}

/// With another memory a remap takes another time, as in a run with that memory; a program that sleeps until it is
/// done, and what it does then, with it. Where remaps follow each other, a frame's interrupts come in another one.
class EdmaSettingsTest : public EdmaRunsTest {};
TEST_P(EdmaSettingsTest, OtherSettingsAreFollowed) {
  const bool waits_for_edma = GetParam() == std::string("copy");
  for (const char* repeat : {"1", "10"}) {
    const Figures recorded = run({}, file(), repeat);
    for (const char* latency : {"16cycles", "0cycles"}) {
      Change change;
      change.keys = {{"ddr.request_latency", latency}};
      const Figures real = run(change, "", repeat);
      if (waits_for_edma) {
        EXPECT_GT(std::abs(real.at("remap") / recorded.at("remap") - 1), 0.03);
      }
      EXPECT_LE(worst(only(real, {"remap"}), replay(file(), {}, change), latency), 0.01) << repeat;
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Kernels, EdmaRunsTest, testing::Values("copy", "staged", "gather", "runs"));
INSTANTIATE_TEST_SUITE_P(Kernels, EdmaSettingsTest, testing::Values("copy", "staged"));

// Recorded with a memory that goes to sleep whenever it is idle and takes tXSRD to give data again.
class SleepTest : public CopyTest {};
TEST_F(SleepTest, ASleepingMemoryIsPlayedAsOne) {
  const Watched watched;
  const Change sleeps{0, 0, true};
  const Figures recorded = run_board({{"firmware.kernel", "plain"}}, watched, sleeps, file());
  EXPECT_LE(worst(recorded, replay(file(), watched, sleeps), "asleep"), 0.01);
  EXPECT_GT(worst(recorded, replay(file(), watched, {}), "awake"), 0.3);
}

}  // namespace
}  // namespace fovea::replay

int sc_main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
