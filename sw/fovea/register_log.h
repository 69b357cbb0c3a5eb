// The last accesses to registers, with names: who, when, from where, what.
#pragma once
#include <functional>
#include <optional>
#include <regex>
#include <string>
#include <unordered_map>
#include <vector>

#include "model/common/masters.h"
#include "model/common/reg_observer.h"
#include "model/common/regbank.h"
#include "model/common/units.h"

namespace fovea::app {

/// A peripheral's registers as debugger and log see them.
struct RegisterBlock {
  std::string name;
  RegBank* registers = nullptr;
  std::function<bool()> gated;  ///< its clock is off: accesses do nothing
  std::function<void(RegisterObserver*)> observe;
};

inline constexpr std::size_t kRegisterLogMost = 100'000'000;

/// What `--log-registers` asks for.
struct RegisterLogRequest {
  std::string
      pattern;  ///< ECMAScript regular expression on part of "block.REGISTER"; empty: no log
  std::size_t kept = 4096;  ///< at least 1
};

class RegisterLog final : private RegisterObserver {
 public:
  struct Sources {
    std::function<Picoseconds()> now;
    std::function<Master()> master;                      ///< of the access under way
    std::function<std::uint32_t()> pc;                   ///< of the core
    std::function<std::string(std::uint32_t)> describe;  ///< a code address; may be empty
  };
  RegisterLog(std::vector<RegisterBlock> blocks, Sources sources);
  ~RegisterLog() { stop(); }
  RegisterLog(const RegisterLog&) = delete;
  RegisterLog& operator=(const RegisterLog&) = delete;

  /// Forgets what it has and begins. @throws UserError: no regular expression
  void start(const RegisterLogRequest& request);
  void stop();
  /// How many it keeps from now on, of those that it has too; also the default of later starts.
  void keep(std::size_t most);
  std::size_t kept() const { return kept_; }
  bool running() const { return running_; }
  /// The last `most` accesses, oldest first, a line each; before them how many are not there.
  std::string text(std::size_t most = ~std::size_t{0}) const;

 private:
  struct Record {
    Picoseconds at;
    std::uint32_t pc;
    Master master;
    RegisterAccess access;
  };
  void accessed(const RegisterAccess& access) override;
  bool wanted(const RegisterAccess& access);
  std::string line(const Record& r) const;
  const std::string& block_name(const RegBank* bank) const;

  std::vector<RegisterBlock> blocks_;
  Sources sources_;
  std::optional<std::regex> pattern_;
  std::unordered_map<const Reg*, bool> matches_;
  std::vector<Record> ring_;
  std::size_t kept_ = RegisterLogRequest{}.kept;
  std::size_t oldest_ = 0;  // in a full ring
  std::uint64_t count_ = 0;
  bool running_ = false;
};

}  // namespace fovea::app
