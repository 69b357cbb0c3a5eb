// Bus traces made by hand.
#pragma once
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "model/trace/core/trace_file.h"

namespace fovea::replay {

/// Random numbers that do not depend on a library's distributions.
class Rng {
 public:
  explicit Rng(std::uint64_t seed) : s_(seed * 0x9E3779B97F4A7C15ull + 0x1234567) { next(); }
  std::uint64_t next() {
    s_ ^= s_ << 13;
    s_ ^= s_ >> 7;
    s_ ^= s_ << 17;
    return s_;
  }
  std::uint64_t below(std::uint64_t n) { return (next() >> 11) % n; }

 private:
  std::uint64_t s_;
};

/// A core with two ports and two video masters, like in the traces of the board.
inline trace::TraceInfo board_info() {
  trace::TraceInfo info;
  info.start = 1'000'000;
  info.end = 900'000'000;
  info.refresh = 700'000;
  info.scr = {Frequency(121'500'000), 500};
  info.ddr = {Frequency(243'000'000), 500};
  info.streams = {{Frequency(297'000'000), 300, 2, 1}, {}, {}};
  info.masters = {{Master::kArmI, "arm_i", 0, 1, 1, true},
                  {Master::kArmD, "arm_d", 0, 1, 1, true},
                  {Master::kVpfe, "vpfe", 1, 4, 4, true},
                  {Master::kVpbe, "vpbe", 2, 4, 4, true}};
  info.interrupts = {{2'000'000}, {5'000'000}, {90'000'000}};
  info.params = {{"ddr.CL", "4 cycles"}};
  return info;
}

/// A transfer of the EDMA, and what its bursts waited for in internal RAM.
inline void make_transfer(Rng& rng, trace::Record& r) {
  r.kind = trace::Kind::kTransfer;
  r.master = Master::kArmD;
  TransferRequest& t = r.transfer;
  for (TransferRequest::Side* side : {&t.source, &t.destination}) {
    side->address = static_cast<std::uint32_t>(rng.next());
    side->index = static_cast<std::int32_t>(rng.below(65'536)) - 32'768;
    side->constant = rng.below(8) == 0;
  }
  t.acnt = static_cast<std::uint16_t>(1 + rng.below(512));
  t.bcnt = static_cast<std::uint16_t>(rng.below(16));
  t.fifo_bytes = static_cast<std::uint8_t>(1u << rng.below(6));
  r.burst = static_cast<std::uint8_t>(16u << rng.below(3));
  r.priority = static_cast<std::uint8_t>(rng.below(8));
  for (auto& waits : r.ram_waits)
    for (std::uint64_t n = rng.below(2) ? rng.below(std::min<std::uint64_t>(t.bytes() + 1, 40)) : 0; n > 0; --n)
      waits.push_back(static_cast<std::uint16_t>(rng.below(300)));
}

/// A random record of a stream (0: the core, 1 and 2: video, 3: transfers) that is valid as its `number`-th.
inline trace::Record random_record(Rng& rng, unsigned stream, std::uint64_t number) {
  using trace::Release;
  trace::Record r;
  const std::uint64_t kind = rng.below(10);
  if (stream == 0 && rng.below(20) == 0) r.kind = trace::Kind::kMark;
  else if (stream == 0 && rng.below(20) == 0) r.kind = trace::Kind::kStep;
  else if (stream == 0 && rng.below(20) == 0) r.kind = trace::Kind::kAside;
  r.master = stream == 0 ? static_cast<Master>(rng.below(2))
                         : (stream == 1 ? Master::kVpfe : Master::kVpbe);
  if (r.kind == trace::Kind::kMark) {
    r.master = Master::kArmD;
    r.address = static_cast<std::uint32_t>(rng.below(256));
  } else if (r.kind == trace::Kind::kStep) {
    r.master = Master::kArmD;
    r.service = rng.below(10'000);
  } else if (stream == 3) {
    make_transfer(rng, r);
  } else {
    r.write = stream == 1 || (stream == 0 && rng.below(2));
    r.bytes = static_cast<std::uint8_t>(4u << rng.below(stream == 0 ? 4 : 5));
    r.address = static_cast<std::uint32_t>(rng.below(1u << 20) * 64);
    if (!r.write && r.bytes == 32) r.critical = static_cast<std::uint8_t>(4 * rng.below(8));
    if (r.kind == trace::Kind::kAside) {
      r.critical = 0;
      r.service = rng.below(1'000'000);
    }
    r.priority = static_cast<std::uint8_t>(rng.below(8));
  }
  r.release = number == 0 || kind < 2 ? Release::kAt
              : kind == 2 ? Release::kWhen
                                         : Release::kAfter;
  if (r.release == Release::kAt) {
    r.at = 1'000'000 + number * 10'000 + rng.below(10'000);
    return r;
  }
  r.back = static_cast<std::uint32_t>(1 + rng.below(std::min<std::uint64_t>(number, 9)));
  r.from_first = rng.below(2);
  r.gap = rng.below(40);
  if (r.write && r.on_bus() && r.release == Release::kAfter)
    r.room = static_cast<std::uint32_t>(rng.below(std::min<std::uint64_t>(number, 9) + 1));
  if (r.release == Release::kWhen) {
    if (stream == 0) {
      r.event = rng.below(3);
    } else {  // from an earlier iteration
      r.source = static_cast<std::uint8_t>((stream + 1 + rng.below(2)) % 3);
      r.event = rng.below(number);
      r.point = static_cast<trace::Point>(rng.below(trace::kPoints));
    }
    r.wake_gap = static_cast<std::uint32_t>(rng.below(100));
  }
  return r;
}

/// The same with a transfer controller of the EDMA, in stream 3.
inline trace::TraceInfo edma_info() {
  trace::TraceInfo info = board_info();
  info.streams.emplace_back();
  info.masters.push_back({edma_read(1), "edma_tc1", 3, 4, 4, false});
  info.masters.push_back({edma_write(1), "edma_tc1", 3, 4, 4, false});
  info.edma = {8, 256, 4, 2, 2, 40'000};
  info.core_until = info.end - 1'000;
  return info;
}

struct MadeTrace {
  trace::TraceInfo info = edma_info();
  std::vector<std::vector<trace::Record>> records;
  std::string bytes;
};

inline MadeTrace make_trace(std::uint64_t seed, std::size_t per_stream) {
  MadeTrace t;
  Rng rng(seed);
  t.records.resize(t.info.streams.size());
  trace::TraceWriter writer(static_cast<unsigned>(t.records.size()));
  for (std::size_t n = 0; n < per_stream; ++n)
    for (unsigned s = 0; s < t.records.size(); ++s) {
      t.records[s].push_back(random_record(rng, s, n));
      writer.add(s, t.records[s].back());
    }
  writer.finish(t.info, [&](std::string_view piece) { t.bytes += piece; });
  return t;
}

}  // namespace fovea::replay
