// Random programs on the channel controller and four transfer controllers, against the interpreter
// in reference.h: the same requests in the same order, the same registers after every step, the
// same interrupts, and in the end the same parameter RAM and the same bytes in memory.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <deque>
#include <iostream>
#include <memory>
#include <utility>

#include "model/dma/core/channel_controller.h"
#include "model/dma/core/transfer_controller.h"
#include "tb/dma/random_program.h"
#include "tb/dma/reference.h"

namespace fovea::dma {
namespace {

/// Sixteen zones of 64 KB, of which programs begin in three; addresses wrap within a zone.
class Zones {
 public:
  Zones() {
    static const Bytes start = [] {
      Bytes b{};
      Dice dice(1);
      for (auto& zone : b)
        for (auto& byte : zone) byte = static_cast<std::uint8_t>(dice.below(256));
      return b;
    }();
    bytes_ = std::make_unique<Bytes>(start);
  }
  std::uint8_t& at(std::uint32_t address) {
    return (*bytes_)[address >> 28][address & 0xFFFF];  // indices may lead out of a zone
  }
  bool operator==(const Zones& o) const { return *bytes_ == *o.bytes_; }

 private:
  using Bytes = std::array<std::array<std::uint8_t, 1 << 16>, 16>;
  std::unique_ptr<Bytes> bytes_;
};

/// A transfer controller with ports whose bursts end when the test wants it. Memory changes then.
class Port : public TransferController::Host {
 public:
  Port(Zones& memory, TransferController::Sizes sizes, unsigned outstanding)
      : memory_(memory), outstanding_(outstanding), tc(*this, sizes) {}

  Picoseconds edge(Picoseconds t, unsigned clocks) const override { return t + clocks; }
  Picoseconds read_free() const override { return reads_.size() < outstanding_ ? 0 : kNever; }
  Picoseconds write_free() const override { return writes_.size() < outstanding_ ? 0 : kNever; }
  void read(Command c, Picoseconds) override {
    check(c);
    reads_.push_back(c);
  }
  void write(Command c, std::span<const std::uint8_t> data, Picoseconds) override {
    check(c);
    writes_.push_back({c, {data.begin(), data.end()}});
  }
  void program_free(Picoseconds) override {}
  void completed(const TransferRequest& r, Picoseconds) override { done.push_back(r); }
  void failed(const TransferRequest& r, TransferController::Failure f, Picoseconds) override {
    EXPECT_EQ(f, TransferController::Failure::kRequest);
    dropped.push_back(r);
  }
  /// All requests to their end, reads and writes ending in a random interleaving.
  void run(Dice& dice, Picoseconds now) {
    while (!reads_.empty() || !writes_.empty()) {
      if (writes_.empty() || (!reads_.empty() && dice.percent(50))) {
        const Command c = reads_.front();
        reads_.pop_front();
        std::vector<std::uint8_t> data;
        for (unsigned i = 0; i < c.bytes; ++i) data.push_back(memory_.at(c.address + i));
        tc.read_done(data, false, now);
      } else {
        const auto [c, data] = writes_.front();
        writes_.pop_front();
        for (unsigned i = 0; i < c.bytes; ++i) memory_.at(c.address + i) = data[i];
        tc.write_done(false, now);
      }
    }
    EXPECT_TRUE(tc.idle());
  }
  std::vector<TransferRequest> done, dropped;

 private:
  void check(Command c) {
    EXPECT_EQ(c.address / 64, (c.address + c.bytes - 1) / 64) << "a burst crosses a multiple of 64";
  }
  Zones& memory_;
  const unsigned outstanding_;
  std::deque<Command> reads_;
  std::deque<std::pair<Command, std::vector<std::uint8_t>>> writes_;

 public:
  TransferController tc;
};

struct Covered {
  std::uint64_t requests = 0, refused = 0, links = 0, missed = 0, programs = 0, pulses = 0,
                errors = 0, in_flight = 0;
};

class Execution : ChannelController::Host {
 public:
  Execution(EdmaRegs& regs, std::uint64_t seed)
      : regs_(regs), core_(regs, *this), seed_(seed), dice_(seed ^ 0x5EED) {
    static constexpr unsigned kBursts[] = {16, 32, 64}, kFifos[] = {128, 256, 192},
                              kDepths[] = {1, 2, 4};
    for (auto& p : ports_)
      p = std::make_unique<Port>(
          model_memory_,
          TransferController::Sizes{kBursts[dice_.below(3)], kFifos[dice_.below(3)],
                                    kDepths[dice_.below(3)]},
          1 + dice_.below(4));
  }

  /// False after the first difference.
  bool run(Covered& covered) {
    const Program p = random_program(seed_);
    staged_ = p.staged;
    for (const Action& a : p.setup) act(a);
    if (!same("set-up")) return false;
    for (const Action& a : p.actions) {
      act(a);
      if (!same(a.text())) return false;
    }
    for (int i = 0; i < 150; ++i) {  // chains to themselves have no end
      for (const Action& a : {Action{Action::kQueue}, Action{Action::kServe},
                              Action{Action::kTransfer, static_cast<std::uint32_t>(i % 4)}}) {
        act(a);
        if (!same("end: " + a.text())) return false;
      }
    }
    for (std::uint32_t tc = 0; tc < 4; ++tc) act({Action::kTransfer, tc});
    if (!same("end") || !same_in_the_end()) return false;
    covered.programs += 1;
    covered.requests += reference_.requests().size();
    covered.links += core_.counts().links;
    covered.missed += core_.counts().missed;
    covered.refused += refused_;
    covered.in_flight += in_flight_;
    for (int n : reference_.region_pulses()) covered.pulses += static_cast<unsigned>(n);
    covered.errors += static_cast<unsigned>(reference_.error_pulses());
    return true;
  }

 private:
  // ChannelController::Host
  bool can_submit(unsigned controller) const override {
    return !ports_[controller]->tc.program_busy();
  }
  void submit(unsigned controller, const TransferRequest& r) override {
    requests_.push_back({controller, r.source.address, r.destination.address, r.acnt, r.bcnt,
                         r.source.index, r.destination.index, r.source.constant,
                         r.destination.constant, r.fifo_bytes, r.tcc, r.interrupt, r.chain});
    ports_[controller]->tc.submit(r, now_);
  }
  bool forms_request() const override { return false; }
  void pulse_completion(unsigned region) override { ++region_pulses_[region]; }
  void pulse_error() override { ++error_pulses_; }
  void work_arrived() override {}
  void events_enabled(std::uint64_t) override {}
  void warn(const std::string&) override {}

  void write(std::uint32_t offset, std::uint32_t value) {
    EXPECT_EQ(regs_.write(offset, 4, value), Access::kOk) << offset;
    reference_.write(offset, value);
  }

  void act(const Action& a) {
    ++now_;
    switch (a.kind) {
      case Action::kWrite:
        write(a.where, a.value);
        break;
      case Action::kFill:
        for (unsigned w = 0; w < 8; ++w) write(0x4000 + 32 * a.where + 4 * w, a.words[w]);
        break;
      case Action::kEvent:
        core_.event(a.where);
        reference_.hardware_event(a.where);
        break;
      case Action::kQueue:
        agree("queued", core_.prioritise(now_ + a.where), reference_.queue_one(now_ + a.where));
        break;
      case Action::kServe:
        serve();
        break;
      case Action::kTransfer:
        transfer(a.where);
        break;
    }
  }

  void agree(const char* what, bool model, bool reference) {
    if (model != reference)
      difference_ += std::string(what) + ": model " + (model ? "yes" : "no") + "\n";
  }

  void serve() {
    std::array<bool, 4> accepts;
    for (unsigned tc = 0; tc < 4; ++tc) accepts[tc] = can_submit(tc);
    agree("served", core_.process(now_), reference_.serve_one(now_, accepts));
    while (waiting_from_ < reference_.requests().size()) {
      const reference::Request& r = reference_.requests()[waiting_from_++];
      if (reference::refused(r)) {
        ++refused_;
        reference_.abandoned(r);
      } else {
        waiting_[r.controller].push_back(r);
        if (waiting_[r.controller].size() > 1) ++in_flight_;
      }
    }
    for (auto& p : ports_) {
      for (const TransferRequest& r : std::exchange(p->dropped, {})) core_.dropped(r);
      EXPECT_TRUE(staged_ || p->done.empty());
    }
    if (staged_)
      for (unsigned tc = 0; tc < 4; ++tc) transfer(tc);
  }

  /// Everything that a transfer controller has, then its completion codes.
  void transfer(unsigned controller) {
    ports_[controller]->run(dice_, now_);
    const std::vector<TransferRequest> done = std::exchange(ports_[controller]->done, {});
    auto& waiting = waiting_[controller];
    agree("completions", !done.empty(), !waiting.empty());
    if (done.size() != waiting.size()) difference_ += "another number of completions\n";
    for (const TransferRequest& r : done) core_.completed(r);
    for (const reference::Request& r : std::exchange(waiting, {})) {
      reference::transfer(
          r, [&](std::uint32_t a) { return reference_memory_.at(a); },
          [&](std::uint32_t a, std::uint8_t b) { reference_memory_.at(a) = b; });
      reference_.finished(r);
    }
  }

  void compare(std::uint32_t offset) {
    std::uint32_t v = 0;
    EXPECT_EQ(regs_.read(offset, 4, v), Access::kOk) << offset;
    if (const std::uint32_t want = reference_.read(offset); v != want) {
      char line[80];
      std::snprintf(line, sizeof line, "0x%04x: 0x%08x, reference 0x%08x\n", offset, v, want);
      difference_ += line;
    }
  }

  bool same(const std::string& after) {
    static constexpr std::uint32_t kPairs[] = {0x00, 0x10, 0x18, 0x20, 0x38, 0x50, 0x68};
    static constexpr std::uint32_t kSingle[] = {0x80, 0x84, 0x90};
    for (std::uint32_t o : {0x300u, 0x304u, 0x310u, 0x318u, 0x600u, 0x604u, 0x608u, 0x60Cu, 0x640u})
      compare(o);
    const std::uint32_t shadow = 0x2000 + 0x200 * dice_.below(4);
    for (std::uint32_t base : {0x1000u, shadow}) {
      for (std::uint32_t o : kPairs) compare(base + o), compare(base + o + 4);
      for (std::uint32_t o : kSingle) compare(base + o);
    }
    if (region_pulses_ != reference_.region_pulses())
      difference_ += "pulses of completion interrupts\n";
    if (error_pulses_ != reference_.error_pulses())
      difference_ += "pulses of the error interrupt\n";
    if (requests_.size() != reference_.requests().size() ||
        (!requests_.empty() && requests_.back() != reference_.requests().back()))
      difference_ += "the last request\n";
    history_ += "  " + after + "\n";
    if (difference_.empty()) return true;
    const std::size_t from = history_.size() > 1500 ? history_.size() - 1500 : 0;
    ADD_FAILURE() << "seed " << seed_ << (staged_ ? " (staged)" : "") << ", after " << after
                  << ":\n"
                  << difference_ << "steps up to here:\n"
                  << history_.substr(from);
    return false;
  }

  bool same_in_the_end() {
    for (std::uint32_t o = 0x4000; o < 0x6000; o += 4) compare(o);
    for (std::uint32_t o = 0x400; o < 0x500; o += 4) compare(o);
    if (requests_ != reference_.requests()) difference_ += "requests\n";
    if (model_memory_ != reference_memory_) difference_ += "bytes in memory\n";
    if (difference_.empty()) return true;
    ADD_FAILURE() << "seed " << seed_ << (staged_ ? " (staged)" : "") << ", in the end:\n"
                  << difference_;
    return false;
  }

  EdmaRegs& regs_;
  ChannelController core_;
  const std::uint64_t seed_;
  Dice dice_;
  Zones model_memory_, reference_memory_;
  std::array<std::unique_ptr<Port>, 4> ports_;
  reference::Interpreter reference_;
  std::vector<reference::Request> requests_;
  std::array<std::vector<reference::Request>, 4> waiting_;  // submitted and not completed
  std::size_t waiting_from_ = 0;
  std::array<int, 4> region_pulses_{};
  int error_pulses_ = 0;
  std::uint64_t refused_ = 0, in_flight_ = 0;
  Picoseconds now_ = 0;
  bool staged_ = false;
  std::string difference_, history_;
};

/// FOVEA_SEED chooses the first program, FOVEA_PROGRAMS how many.
std::uint64_t number(const char* variable, std::uint64_t otherwise) {
  const char* s = std::getenv(variable);
  return s ? std::strtoull(s, nullptr, 0) : otherwise;
}

TEST(DmaRandom, ProgramsDoWhatTheReferenceDoes) {
  const std::uint64_t first = number("FOVEA_SEED", 1), programs = number("FOVEA_PROGRAMS", 1200);
  EdmaRegs regs(7);
  Covered covered;
  for (std::uint64_t seed = first; seed < first + programs; ++seed) {
    regs.reset();
    if (!Execution(regs, seed).run(covered)) break;
  }
  std::cout << covered.programs << " programs from seed " << first << ": " << covered.requests
            << " requests (" << covered.in_flight << " behind another one, " << covered.refused
            << " refused), " << covered.links << " links, " << covered.missed << " missed events, "
            << covered.pulses << " completion pulses, " << covered.errors << " error pulses\n";
  if (HasFailure() || programs < 1000) return;
  // The programs reach what they are meant to compare.
  EXPECT_GT(covered.requests, 50 * programs / 2);
  EXPECT_GT(covered.in_flight, programs);
  EXPECT_GT(covered.refused, programs / 4);
  EXPECT_GT(covered.links, programs);
  EXPECT_GT(covered.missed, programs);
  EXPECT_GT(covered.pulses, programs);
  EXPECT_GT(covered.errors, programs);
}

}  // namespace
}  // namespace fovea::dma
