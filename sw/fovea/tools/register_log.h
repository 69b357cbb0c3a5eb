// A log of the last register accesses: master, time, code address, register and value. What follows itself, as in a
// loop that waits for a register, is one entry with a count.
#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "model/common/masters.h"
#include "model/common/observers.h"
#include "model/common/reg_observer.h"
#include "model/common/regbank.h"
#include "model/common/units.h"

namespace re2 {
class RE2;
}

namespace fovea::app {

/// A peripheral's registers, for the debugger and the log.
struct RegisterBlock {
  std::string name;
  RegBank* registers = nullptr;
  std::function<bool()> gated;  ///< true while its clock is gated, so that accesses have no effect
  std::function<Subscription(RegisterObserver&)> observe;
};

inline constexpr std::size_t kRegisterLogMost = 100'000'000;

/// The request of `--log-registers`.
struct RegisterLogRequest {
  std::string pattern;      ///< RE2 regular expression on part of "block.REGISTER"; empty: no log
  std::size_t kept = 4096;  ///< entries, at least 1
};

class RegisterLog final : private RegisterObserver {
 public:
  struct Sources {
    std::function<Picoseconds()> now;
    std::function<Master()> master;                      ///< master of the current access
    std::function<std::uint32_t()> pc;                   ///< pc of the core
    std::function<std::string(std::uint32_t)> describe;  ///< symbol of a code address; may be empty
  };
  RegisterLog(std::vector<RegisterBlock> blocks, Sources sources);
  ~RegisterLog();
  RegisterLog(const RegisterLog&) = delete;
  RegisterLog& operator=(const RegisterLog&) = delete;

  /// Clears the log and starts it. @throws UserError if the pattern is not a regular expression, or matches no register
  void start(const RegisterLogRequest& request);
  void stop();
  /// Sets the number of entries to keep, including those already logged; also for later starts.
  void keep(std::size_t most);
  std::size_t kept() const { return kept_; }
  bool running() const { return running_; }
  /// The last `most` entries, oldest first, one per line, preceded by the number of accesses left out.
  std::string text(std::size_t most = ~std::size_t{0}) const;

 private:
  struct Record {
    Picoseconds at;
    std::uint32_t pc;
    Master master;
    RegisterAccess access;
    std::uint64_t times = 1;
    Picoseconds last = 0;  ///< of them
  };
  void accessed(const RegisterAccess& access) override;
  void check_matches(const std::string& pattern) const;
  bool wanted(const RegisterAccess& access);
  Record& newest() { return ring_[(oldest_ + ring_.size() - 1) % ring_.size()]; }
  std::string line(const Record& r) const;
  const std::string& block_name(const RegBank* bank) const;

  std::vector<RegisterBlock> blocks_;
  std::vector<Subscription> observing_;
  Sources sources_;
  std::unique_ptr<re2::RE2> pattern_;
  std::unordered_map<const Reg*, bool> matches_;
  std::vector<Record> ring_;
  std::size_t kept_ = RegisterLogRequest{}.kept;
  std::size_t oldest_ = 0;  // index of the oldest record in a full ring
  std::uint64_t count_ = 0;
  bool running_ = false;
};

}  // namespace fovea::app
