// A simple interpreter of EDMA3, written from TI's guides SPRUEE4A, SPRUH82C and SPRUH73H. It
// shares neither headers nor tables with model/dma. It has no time: the caller says which step
// comes next.
#pragma once
#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <vector>

namespace fovea::reference {

/// A transfer request (TR) as the channel controller submits it.
struct Request {
  unsigned controller = 0;
  std::uint32_t source = 0, destination = 0;
  unsigned array_bytes = 0, arrays = 0;
  int source_step = 0, destination_step = 0;
  bool source_fixed = false, destination_fixed = false;
  unsigned width = 1;  // of the port of a fixed side, bytes
  unsigned code = 0;
  bool raises = false, chains = false;

  bool operator==(const Request&) const = default;
};

/// A request that a transfer controller refuses with TRERR.
bool refused(const Request& r);

/// Copies the bytes of a request, one after the other.
void transfer(const Request& r, const std::function<std::uint8_t(std::uint32_t)>& read,
              const std::function<void(std::uint32_t, std::uint8_t)>& write);

class Interpreter {
 public:
  Interpreter();
  void write(std::uint32_t offset, std::uint32_t value);
  std::uint32_t read(std::uint32_t offset) const;

  void hardware_event(unsigned channel);
  /// Lets at most one event enter its queue; its turn comes at `turn`.
  bool queue_one(std::uint64_t turn);
  /// Takes at most one event out of a queue whose transfer controller accepts a request.
  bool serve_one(std::uint64_t now, const std::array<bool, 4>& accepts);
  /// The completion of a request, or its refusal.
  void finished(const Request& r);
  void abandoned(const Request& r);

  const std::vector<Request>& requests() const { return requests_; }
  const std::array<int, 4>& region_pulses() const { return region_pulses_; }
  int error_pulses() const { return error_pulses_; }

 private:
  struct DmaChannel {
    bool event = false, manual = false, chained = false, enabled = false;
    bool queued = false, missed = false, interrupt = false, interrupt_enabled = false;
    unsigned queue = 0;
  };
  struct QdmaChannel {
    bool event = false, enabled = false, queued = false, missed = false;
    unsigned queue = 0, set = 0, word = 0;
  };
  struct Entry {
    unsigned kind, number;
    std::uint64_t turn;
  };
  struct EventQueue {
    std::deque<Entry> entries;
    unsigned start = 0, mark = 0, threshold = 16, controller = 0;
    bool exceeded = false, error = false;
    std::array<std::uint32_t, 16> slots{};
  };
  using Words = std::array<std::uint32_t, 8>;

  void write_channels(int region, std::uint32_t offset, std::uint32_t value);
  std::uint32_t read_channels(int region, std::uint32_t offset) const;
  bool owns(int region, unsigned channel) const;
  bool owns_qdma(int region, unsigned channel) const;
  void store(unsigned set, unsigned word, std::uint32_t value);
  bool enter(unsigned queue, Entry e);
  void note_size(EventQueue& q);
  void serve(EventQueue& q);
  void link(unsigned set);
  void report(unsigned code, bool raises, bool chains);
  bool line(unsigned region) const;
  bool any_error() const;
  template <class Action>
  void watching_interrupts(Action action);
  template <class Action>
  void watching_errors(Action action);

  std::array<DmaChannel, 64> dma_;
  std::array<QdmaChannel, 8> qdma_;
  std::array<EventQueue, 4> queues_;
  std::array<std::array<bool, 64>, 4> region_{};
  std::array<std::array<bool, 8>, 4> region_qdma_{};
  std::array<Words, 256> param_{};
  bool too_many_codes_ = false;
  unsigned outstanding_ = 0;
  std::vector<Request> requests_;
  std::array<int, 4> region_pulses_{};
  int error_pulses_ = 0;
};

}  // namespace fovea::reference
