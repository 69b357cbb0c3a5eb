// A recorder that is fed by hand, and what it has written.
#pragma once
#include <gtest/gtest.h>

#include <deque>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "model/trace/core/recorder.h"

namespace fovea::replay {

using trace::BusRecorder;
using trace::Record;
using trace::Release;

/// The core counts 4 ns, its AHB two of them.
inline constexpr Picoseconds kClock = 4'000;
inline constexpr std::uint32_t kSdram = 0x8000'0000u;

inline std::vector<BusRecorder::MasterSetup> core_and_video() {
  return {{Master::kArmI, Pace::kCore, 1, 1, true},
          {Master::kArmD, Pace::kCore, 1, 1, true},
          {Master::kVpfe, Pace::kSampled, 2, 2, true},
          {Master::kVpbe, Pace::kLines, 2, 2, true}};
}
inline std::vector<BusRecorder::MasterSetup> copy_of(Pace writer) {
  return {{Master::kArmD, Pace::kCore, 1, 1, true},
          {edma_read(0), Pace::kRepeating, 4, 4, true, edma_write(0)},
          {edma_write(0), writer, 4, 4, true, edma_read(0)}};
}

class Feed {
 public:
  explicit Feed(const std::vector<BusRecorder::MasterSetup>& masters = core_and_video(),
                trace::Surroundings surroundings = {})
      : recorder_(
            masters, 2,
            [this](const MemRequest* r) {
              trace::CoreState s = core;
              if (!r) s.asked = 0;
              return s;
            },
            std::move(surroundings)) {
    open(0);
  }
  explicit Feed(Picoseconds opened) : Feed() { open(opened); }

  trace::CoreState core;  // what it tells at the next request

  void open(Picoseconds at) { recorder_.open(at, Frequency(250'000'000), 0, {Frequency(125'000'000), 0}); }
  MemRequest& put(Master m, bool write, Picoseconds at, unsigned bytes = 4, bool to_sdram = true) {
    MemRequest& r = requests_.emplace_back();
    r.master = m;
    r.write = write;
    r.bytes = static_cast<std::uint8_t>(bytes);
    r.address = kSdram + 64 * static_cast<std::uint32_t>(requests_.size());
    r.issued = at;
    recorder_.submitted(r, to_sdram);
    return r;
  }
  void end(MemRequest& r, Picoseconds first, Picoseconds last, bool error = false) {
    r.first = first;
    r.last = last;
    r.error = error;
    recorder_.responded(r);
  }
  /// Of the core's data port, in its clocks; ends at once.
  void read(std::uint64_t asked, std::uint64_t issued, std::uint64_t first, std::uint64_t last) {
    core.asked = asked;
    end(put(Master::kArmD, false, issued * kClock, 32), first * kClock, last * kClock);
  }
  void store(std::uint64_t asked, std::uint64_t issued, std::uint64_t last, unsigned bytes = 4) {
    core.asked = asked;
    end(put(Master::kArmD, true, issued * kClock, bytes), last * kClock, last * kClock);
  }
  /// A register access that the core waits for; again: the register of the one before.
  void reg(bool write, std::uint64_t issued, std::uint64_t last, bool again = false) {
    core.asked = 0;
    const std::uint32_t before = requests_.empty() ? 0 : requests_.back().address;
    MemRequest& r = requests_.emplace_back();
    r.master = Master::kArmD;
    r.write = write;
    r.bytes = 4;
    r.address = again ? before : kSdram / 2 + 64 * static_cast<std::uint32_t>(requests_.size());
    r.issued = issued * kClock;
    recorder_.submitted(r, false);
    r.first = r.last = last * kClock;
    recorder_.register_done(r);
  }
  BusRecorder& recorder() { return recorder_; }

  /// Closes, and gives the records of a stream back out of the file.
  std::vector<Record> records(unsigned stream = 0, Picoseconds close_at = 1'000'000'000) {
    read_back(close_at);
    std::vector<Record> out;
    for (Record r; file_->next(stream, r);) out.push_back(r);
    return out;
  }
  const trace::TraceInfo& info(Picoseconds close_at) {
    read_back(close_at);
    return file_->info();
  }

 private:
  void read_back(Picoseconds close_at) {
    recorder_.close(close_at);
    trace::TraceInfo info;
    info.scr = {Frequency(125'000'000), 0};
    info.ddr = {Frequency(250'000'000), 0};
    std::string bytes;
    recorder_.finish(info, [&](std::string_view piece) { bytes += piece; });
    file_ = std::make_unique<trace::TraceFile>("t", std::move(bytes));
  }
  std::deque<MemRequest> requests_;
  BusRecorder recorder_;
  std::unique_ptr<trace::TraceFile> file_;
};

struct Expected {
  Release release;
  bool from_first;
  std::uint32_t back, room;
  std::uint64_t gap;
};
inline void expect(const Record& r, const Expected& e, const char* what) {
  EXPECT_EQ(r.release, e.release) << what;
  EXPECT_EQ(r.from_first, e.from_first) << what;
  EXPECT_EQ(r.back, e.back) << what;
  EXPECT_EQ(r.room, e.room) << what;
  EXPECT_EQ(r.gap, e.gap) << what;
}

}  // namespace fovea::replay
