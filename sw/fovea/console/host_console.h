// Uses the process's own streams as the console of a program's semihosting calls.
#pragma once
#include <atomic>
#include <iosfwd>

#include "sw/fovea/console/semihosting.h"

namespace fovea::app {

class HostConsole : public SemihostingConsole {
 public:
  /// @param stop ends a waiting read when set; null: only the end of input does
  HostConsole(std::ostream& out, std::ostream& err, const std::atomic<bool>* stop)
      : out_(out), err_(err), stop_(stop) {}
  std::size_t read(std::span<std::uint8_t> to) override;
  bool write(bool error_stream, std::string_view text) override;
  bool lost() const override { return lost_; }

 private:
  std::ostream& out_;
  std::ostream& err_;
  const std::atomic<bool>* stop_;
  bool lost_ = false;
};

}  // namespace fovea::app
