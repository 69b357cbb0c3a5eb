// Two backends of the remap engine side by side: one owns the memory port, the other is its twin and is compared
// with it. Knows neither SystemC nor Verilator.
#pragma once
#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "model/engine/core/engine_backend.h"

namespace fovea::rtl {

/// What the comparison has found, besides no difference.
struct PairSummary {
  std::uint64_t requests = 0;  ///< pairs of requests that were compared, and equal
  std::uint64_t skipped = 0;   ///< requests behind an error or an abort, which were not compared
  /// How many edges later the twin asked, in clocks: number of requests.
  std::map<std::int64_t, std::uint64_t> lag{};
};

/// The twin gets each write to a register, and a copy of each answer at its time; or, if it has not asked by
/// then, when it does. Compared are, for each of the three streams of requests (map, source, writes), address,
/// length, data and order; and each word that software reads from a register whose value does not depend on time.
///
/// Times differ between both, so the twin may be behind the owner of the port, or ahead. Behind an error or an
/// abort both ask for what they had under way, which is not the same: from there until both are quiet the twin is
/// fed zeros, and nothing is compared.
class PairBackend : public engine::EngineBackend {
 public:
  using Maker = std::function<std::unique_ptr<engine::EngineBackend>(Host&)>;
  /// A sentence about the first difference, and when the owner asked, or was asked, for it. From then on the twin is
  /// fed zeros and nothing is compared.
  using OnDifference = std::function<void(const std::string& what, Picoseconds at)>;
  PairBackend(Host& host, const Clock& clock, const Maker& owner, const Maker& twin, OnDifference on_difference);
  ~PairBackend() override;

  Picoseconds run(Picoseconds now) override;
  std::uint32_t read(std::uint32_t offset, Picoseconds now) override;
  void write(std::uint32_t offset, std::uint32_t word, unsigned strobes, Picoseconds now) override;
  void answer(const engine::Answer& answer) override;
  bool busy() const override { return owner_->busy() || twin_->busy(); }
  void reset() override;
  engine::JobPlace job() const override { return owner_->job(); }
  /// Called for each pair of equal requests: clocks that the twin asked later.
  std::function<void(std::int64_t lag)> on_compared;
  /// Called when requests behind an error or an abort are not compared.
  std::function<void(std::uint64_t requests)> on_skipped;
  /// For tests of what a run says of a difference: the write of the twin, counted from 1, of which a bit is wrong.
  std::uint64_t planted = 0;
  const PairSummary& summary() const { return summary_; }
  /// "lag_clocks,requests" and a line for each difference in time that occurred.
  std::string table() const;

 private:
  struct Request {
    std::uint32_t address;
    std::vector<std::uint8_t> data;
    unsigned bytes;
    Picoseconds at;
    engine::JobPlace job;
  };
  struct Reply {
    bool error;
    std::vector<std::uint8_t> data;
    Picoseconds first, last;
  };
  struct Asking {
    std::uint64_t tag;
    unsigned bytes;
    Picoseconds at;
  };
  struct Stream {
    std::deque<Request> owner, twin;  // not compared yet
    std::deque<Asking> asking;        // of the twin, without an answer, in order
    std::deque<Reply> replies;        // that the twin has not got, in order
    std::uint64_t compared = 0;
  };
  class Side : public Host {
   public:
    Side(PairBackend& pair, bool twin) : pair_(pair), twin_(twin) {}
    void issue(const engine::Burst& burst, Picoseconds at) override { pair_.issued(twin_, burst, at); }
    void interrupt(bool level) override {
      if (!twin_) pair_.host_.interrupt(level);
    }

   private:
    PairBackend& pair_;
    bool twin_;
  };

  static unsigned stream_of(bool write, unsigned id) { return write ? 2 : id; }
  void issued(bool twin, const engine::Burst& burst, Picoseconds at);
  void compare(unsigned stream);
  bool feed(Picoseconds now);
  void disturb();
  void settle();
  void skip(std::uint64_t requests);
  void difference(const std::string& what, Picoseconds at);
  void difference(const std::string& what, unsigned stream, const Request& request, const engine::JobPlace& job);

  Host& host_;
  const Clock& clock_;
  const OnDifference on_difference_;
  Side owner_side_{*this, false}, twin_side_{*this, true};
  std::unique_ptr<EngineBackend> owner_, twin_;
  std::array<Stream, 3> streams_;
  struct Open {
    unsigned stream;
    std::uint64_t tag;  // the owner's own; those need not differ from each other
  };
  std::map<std::uint64_t, Open> open_;  // requests of the owner without an answer, by the tag that the host has
  std::uint64_t tags_ = 0, twin_writes_ = 0;
  bool disturbed_ = false, different_ = false;
  PairSummary summary_;
};

}  // namespace fovea::rtl
