// Runs an EngineBackend on a memory in which every request takes the same time, and which answers addresses that it has
// not with errors: the counterpart of tb/rtl's
// engine_bench, without back-pressure. Jobs go through the registers.
#pragma once
#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "model/engine/core/engine_registers.h"
#include "model/engine/core/tlm_backend.h"
#include "tb/rtl/golden.h"

namespace fovea::engine {

/// Bits of EVENTS.
enum Event : std::uint32_t { kDone = 1, kRefused = 2, kReadError = 4, kWriteError = 8, kAborted = 16, kOverflow = 32,
                             kDropped = 64 };

class ModelBench : private EngineBackend::Host {
 public:
  static constexpr std::uint32_t kBase = 0x8000'0000;  ///< byte address of the memory
  static constexpr Picoseconds kPeriod = 1000;
  struct Memory {
    unsigned latency = 8;  ///< clocks from a request to its first data, at least 1
    std::optional<std::uint32_t> read_fault{}, write_fault{};  ///< the 64 bytes with this address fail
  };
  struct Asked {
    bool write;
    unsigned id;
    std::uint32_t address;
    unsigned bytes;
    Picoseconds at;
    friend bool operator==(const Asked& a, const Asked& b) {
      return a.write == b.write && a.id == b.id && a.address == b.address && a.bytes == b.bytes;
    }
  };

  using Maker = std::function<std::unique_ptr<EngineBackend>(const Clock& clock, EngineBackend::Host& host)>;
  static std::unique_ptr<EngineBackend> tlm(const Clock& clock, EngineBackend::Host& host) {
    return std::make_unique<TlmBackend>(clock, host);
  }
  explicit ModelBench(std::size_t bytes, const Maker& make = tlm)
      : owned_(make(clock, *this)), backend(*owned_), words_(bytes / 4) {}
  std::uint32_t& word(std::uint32_t word_address) { return words_.at(word_address - kBase / 4); }
  /// Accesses at the present time, by the name of the register.
  void set(const Reg& reg, std::uint32_t value, unsigned strobes = 15);
  std::uint32_t get(const Reg& reg) { return backend.read(reg.offset(), now_); }
  /// Writes the job window.
  void window(const rtl::Job& job, std::uint32_t map_base, std::uint32_t map_words, std::uint32_t border);
  /// Goes on for a number of clocks, or until nothing more can happen.
  void advance(std::uint64_t clocks);
  void finish();
  /// A whole job: window, SUBMIT, and to its end. @return its bits of ENDED
  std::uint32_t run(const rtl::Job& job, std::uint32_t map_base, std::uint32_t border, Memory memory,
                    std::optional<unsigned> abort_after = {});

  Clock clock{Frequency(kPsPerSecond / kPeriod)};

 private:
  std::unique_ptr<EngineBackend> owned_;

 public:
  EngineBackend& backend;
  EngineRegs regs;
  Memory memory;
  std::vector<Asked> asked;  ///< requests since the last run()
  Picoseconds now() const { return now_; }
  unsigned calls = 0;        ///< of backend.run()
  std::vector<bool> interrupts;  ///< levels of the line, as it changed

 private:
  struct Pending {
    Burst burst;
    std::array<std::uint8_t, 64> data;
    std::uint64_t first, last;  // clocks in which the beats arrive
    bool fault;
  };
  void issue(const Burst& burst, Picoseconds at) override;
  void interrupt(bool level) override { interrupts.push_back(level); }
  void go_until(Picoseconds limit);

  std::vector<std::uint32_t> words_;
  Picoseconds now_ = 100 * kPeriod, call_ = 0;
  std::uint64_t read_free_ = 0, write_free_ = 0;
  std::deque<Pending> reads_, writes_;
};

}  // namespace fovea::engine
