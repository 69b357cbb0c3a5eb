// A core with caches beside a DMA master on one flat memory, and the hazard checker between them. A
// program is a list of steps, executed by a small interpreter in internal RAM, so that nothing but the
// steps touches the memory.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "model/cpu/check/hazard_checker.h"
#include "tb/iss/machine.h"

namespace fovea::cpu::test {

/// The numbers are the interpreter's.
enum class Do : std::uint32_t {
  kEnd, kLoad, kStore, kLoadByte, kStoreByte, kLoadHalf, kStoreHalf, kLoadFour, kStoreFour,
  kCleanLine, kInvalidateLine, kCleanInvalidateLine, kDrain, kCleanAll, kCleanInvalidateAll, kDma,
  kSwap, kCall, kInvalidateCode
};

struct Step {
  Do what = Do::kEnd;
  std::uint32_t address = 0;
  std::uint32_t value = 0;  ///< kStore...: the value, one more for each further word
  // kDma: the program waits until it is over.
  bool write = false;
  bool code = false;        ///< it writes one word, code_word(value)
  /// Its write waits in the memory's controller, where reads pass it, although the program sees it complete. It takes
  /// effect with the next step kDma, or before the core's next write to the same bytes; each line by itself.
  bool waits = false;
  unsigned bytes = 0;       ///< a multiple of 4; 0: nothing but what waits
  Picoseconds delay = 0;    ///< from the program's start of the transfer to the access
};

/// What is visible from outside: all loaded words in order, what the DMA read, and the memory.
struct Visible {
  std::vector<std::uint32_t> loaded;
  std::vector<std::uint8_t> dma_read, memory;
  bool operator==(const Visible&) const = default;
};

/// Write-back, write-through and uncached but buffered.
inline constexpr std::uint32_t kRegion[] = {kMemory, kMemory + 0x10'0000, kMemory + 0x20'0000};
/// Each program uses some lines of each region, of which six share a set of the D-cache.
inline constexpr unsigned kLinesUsed = 12;
inline constexpr std::uint32_t line_used(unsigned region, unsigned n) {
  return kRegion[region] + (n < 6 ? n * 0x800 : 0x40 + n * 32);
}

/// Code that the core calls: functions of two words, at even words of a line, that return a number. Six lines
/// share a set of the I-cache.
inline constexpr std::uint32_t kCode = kMemory + 0x30'0000;
inline constexpr std::uint32_t code_line(unsigned n) { return kCode + (n < 6 ? n * 0x1000 : 0x40 + n * 32); }
inline constexpr std::uint32_t code_word(std::uint32_t value) { return 0xE3A0'3000u | (value & 0xFFu); }  // mov r3, #
inline constexpr std::uint32_t kReturn = 0xE12F'FF1E;                                                     // bx lr

inline std::uint8_t initial_byte(std::uint32_t a) { return static_cast<std::uint8_t>(a * 7 + (a >> 8)); }
/// What a DMA write puts at an address; `value`: the step's.
inline std::uint8_t dma_byte(std::uint32_t value, std::uint32_t a) {
  return static_cast<std::uint8_t>(value * 31 + a * 5 + 1);
}

class HazardBench {
 public:
  static constexpr std::uint32_t kOps = 0x1'1000, kLog = 0x1'5000, kFlag = 0x1'7F00;
  Machine m;
  std::unique_ptr<HazardChecker> checker;
  std::vector<Hazard> places;  ///< of the last run
  bool checked = true;         ///< false: no checker observes
  bool follows = true;         ///< the checker is told when bytes move
  unsigned passes = 0;         ///< line fills of the last run that passed a waiting write

  HazardBench() {
    m.section(kRegion[1], kRegion[1], 1, 0);
    m.section(kRegion[2], kRegion[2], 0, 1);
    program_ = assemble(interpreter(), 0);
    m.load(program_);
    m.on_svc = [this](std::uint32_t) { start_dma(); };
    m.port.on_memory = [this](const BusAccess& a) { announce(a); };
  }
  /// @param caches false: MMU and caches stay off, so that the core's accesses reach memory in order
  Visible run(const std::vector<Step>& steps, bool caches = true) {
    for (unsigned region = 0; region < 3; ++region)
      for (std::uint32_t a = kRegion[region]; a < kRegion[region] + kSpan; ++a) *m.port.at(a) = initial_byte(a);
    for (unsigned line = 0; line < kLinesUsed; ++line)
      for (unsigned word = 0; word < 8; ++word)
        m.port.set_word(code_line(line) + 4 * word, word % 2 ? kReturn : code_word(word));
    std::uint32_t* op = tcm(kOps);
    steps_ = steps;
    steps_.push_back({});
    dma_read_.clear();
    places.clear();
    waiting_.clear();
    passes = 0;
    for (std::uint32_t n = 0; n < steps_.size(); ++n) {
      const Step& s = steps_[n];
      *op++ = static_cast<std::uint32_t>(s.what);
      *op++ = s.address;
      *op++ = s.what == Do::kDma ? n + 1 : s.value;
    }
    *tcm(kFlag) = 0;
    m.port.log.clear();
    m.port.sleep_until(m.core.boundary_time() + 10 * kPsPerUs);  // what the last run began has ended
    checker.reset();
    if (caches && checked) {
      checker = std::make_unique<HazardChecker>(m.core);
      if (follows) checker->follow_moves();
      checker->on_place = [this](const Hazard& h) { places.push_back(h); };
    }
    m.first_clock = m.core.clock().edge_after(m.port.now) - spent();
    m.run(caches ? program_.symbols.at("with_caches") : program_.symbols.at("without"));
    if (checker) checker->settle(kNever);
    Visible out;
    const std::uint32_t words = (m.core.reg(9) - kLog) / 4;
    out.loaded.assign(tcm(kLog), tcm(kLog) + words);
    out.dma_read = dma_read_;
    for (unsigned region = 0; region < 3; ++region)
      out.memory.insert(out.memory.end(), m.port.at(kRegion[region]), m.port.at(kRegion[region]) + kSpan);
    return out;
  }
  /// Address of the instruction that accesses memory.
  std::uint32_t handler(Do what) const {
    return program_.symbols.at("table") + 32 * static_cast<std::uint32_t>(what);
  }
  /// The DMA writes a word as soon as memory has read this line for the core, once.
  void write_during_fill(std::uint32_t line) {
    during_ = {Do::kDma, line, 1};
    during_.write = true;
    during_.bytes = 4;
  }
  /// The line's next fill passes that write, which arrived directly before its request.
  void write_passed_by_fill(std::uint32_t line) {
    write_during_fill(line);
    passing_ = true;
  }
  std::uint64_t count(HazardKind k) const { return checker->count(k); }

 private:
  static constexpr std::uint32_t kSpan = 6 * 0x800;
  std::uint32_t* tcm(std::uint32_t a) { return reinterpret_cast<std::uint32_t*>(m.tcm.data() + (a & 0x7FFF)); }
  std::uint64_t spent() const {
    const Counts& c = m.core.counts();
    return c.issue + c.idle + std::accumulate(c.stall.begin(), c.stall.end(), std::uint64_t{0});
  }
  void start_dma() {
    const std::uint32_t id = m.core.reg(2);
    const Step& s = steps_[id - 1];
    m.port.schedule(m.core.boundary_time() + s.delay, [this, &s, id] {
      for (const Part& p : waiting_) take_effect(p);
      waiting_.clear();
      move(s);
      *tcm(kFlag) = id;
    });
    m.core.disturb();
  }
  /// A burst of a step.
  struct Part {
    Step step;
    MemRequest request;
  };
  static bool overlap(const MemRequest& a, const MemRequest& b) {
    return a.address < b.address + b.bytes && b.address < a.address + a.bytes;
  }
  /// In bursts that cross no multiple of 64 bytes, or of 32 if they wait.
  void move(const Step& s) {
    for (std::uint32_t a = s.address; a < s.address + s.bytes;) {
      const std::uint32_t end = std::min((a | (s.waits ? 31u : 63u)) + 1, s.address + s.bytes);
      MemRequest r;
      r.address = a;
      r.bytes = static_cast<std::uint8_t>(end - a);
      r.write = s.write;
      r.master = s.write ? Master::kEdmaTc0Write : Master::kEdmaTc0Read;
      if (checker && !passing_) checker->arrived(r, m.port.now);
      passing_ = false;
      if (s.waits) waiting_.push_back({s, r});
      else take_effect({s, r});
      a = end;
    }
  }
  void take_effect(const Part& p) {
    const MemRequest& r = p.request;
    if (checker) checker->moved(r.master, r.write, r.address, r.bytes);
    for (std::uint32_t a = r.address; a < r.address + r.bytes; ++a) {
      if (p.step.code) *m.port.at(a) = static_cast<std::uint8_t>(code_word(p.step.value) >> 8 * (a & 3u));
      else if (r.write) *m.port.at(a) = dma_byte(p.step.value, a);
      else dma_read_.push_back(*m.port.at(a));
    }
  }
  void announce(const BusAccess& a) {
    MemRequest r;
    r.address = a.kind == BusAccess::Kind::kWrap8 ? a.address & ~31u : a.address;
    r.bytes = a.bytes;
    r.write = a.write;
    r.master = a.port == BusAccess::Port::kData ? Master::kArmD : Master::kArmI;
    const auto waits = [&](const Part& p) { return overlap(p.request, r); };
    if (r.write) {
      for (const Part& p : waiting_)
        if (waits(p)) take_effect(p);
      std::erase_if(waiting_, waits);
    } else if (a.kind == BusAccess::Kind::kWrap8) {
      passes += std::any_of(waiting_.begin(), waiting_.end(), waits);
    }
    if (!checker) return;
    const bool hit = during_.bytes && r.address == during_.address;
    if (hit && passing_) {
      MemRequest w;
      w.address = during_.address;
      w.bytes = static_cast<std::uint8_t>(during_.bytes);
      w.write = true;
      w.master = Master::kEdmaTc0Write;
      checker->arrived(w, a.issued);
    }
    checker->arrived(r, a.issued);
    checker->moved(r.master, r.write, r.address, r.bytes);
    if (!hit) return;
    m.port.schedule(m.port.now, [this, s = during_] { move(s); });
    during_ = {};
  }
  static std::string interpreter() {
    std::string text = "with_caches:\n" + std::string(kCachesOn) + R"(
without:
  ldr r8, =0x11000
  ldr r9, =0x15000
  ldr r10, =0x17f00
  b next
  .ltorg
  .p2align 5
next:
  ldmia r8!, {r0-r2}
  adr r3, table
  add pc, r3, r0, lsl #5
  .p2align 5
table:
)";
    for (const char* body : {"mcr p15, 0, r1, c7, c10, 4\n svc #2", "ldr r3, [r1]\n str r3, [r9], #4", "str r2, [r1]",
                             "ldrb r3, [r1]\n str r3, [r9], #4", "strb r2, [r1]",
                             "ldrh r3, [r1]\n str r3, [r9], #4", "strh r2, [r1]",
                             "ldmia r1, {r3-r6}\n stmia r9!, {r3-r6}",
                             "add r3, r2, #1\n add r4, r2, #2\n add r5, r2, #3\n stmia r1, {r2-r5}",
                             "mcr p15, 0, r1, c7, c10, 1", "mcr p15, 0, r1, c7, c6, 1",
                             "mcr p15, 0, r1, c7, c14, 1", "mcr p15, 0, r1, c7, c10, 4",
                             "mrc p15, 0, r15, c7, c10, 3\n bne .-4",
                             "mrc p15, 0, r15, c7, c14, 3\n bne .-4",
                             "svc #3\n ldr r3, [r10]\n cmp r3, r2\n bne .-8",
                             "swp r3, r2, [r1]\n str r3, [r9], #4",
                             "mov lr, pc\n bx r1\n str r3, [r9], #4", "mcr p15, 0, r1, c7, c5, 1"})
      text += " " + std::string(body) + "\n b next\n .p2align 5\n";
    return text;
  }

  Program program_;
  std::vector<Step> steps_;
  Step during_;
  bool passing_ = false;
  std::vector<Part> waiting_;  // oldest first
  std::vector<std::uint8_t> dma_read_;
};

}  // namespace fovea::cpu::test
