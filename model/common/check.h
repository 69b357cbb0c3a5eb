// The four kinds of error and what Fovea does for each: guest, user, not modelled, own defect.
#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>

#include "model/common/bounded_counts.h"

namespace fovea {

/// Wrong input by the user. The message is one line: what is wrong, where, and what is allowed.
/// Exit status 2.
struct UserError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The guest program failed and cannot continue (unhandled abort, deadlock, watchdog). Exit status
/// 3.
struct GuestFailure : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// With --strict: the guest used a feature of the chip that the model lacks. Exit status 3.
struct NotModelled : std::runtime_error {
  using std::runtime_error::runtime_error;
};

[[noreturn]] void check_failed(const char* expression, const char* file, int line,
                               const std::string& what);

/// Collects the run's warnings and counts them. kGuest: caused by the program on the core.
/// kNotModelled: the program used something that the model lacks. kConfiguration: a parameter has
/// no effect or contradicts another one. Each text is passed to the sink once, and only a few of
/// those that differ in nothing but numbers: the addresses of a wild pointer are examples of one
/// warning (see BoundedCounts).
class Diagnostics {
 public:
  enum class Kind { kGuest, kNotModelled, kConfiguration };
  using Sink = std::function<void(Kind, const std::string&)>;

  static Diagnostics& instance();
  void guest(const std::string& what) { note(Kind::kGuest, what); }
  /// Warns that the model lacks something. @throws NotModelled with --strict
  void not_modelled(const std::string& what);
  /// Warns about a parameter. @throws UserError with --strict
  void configuration(const std::string& what);
  void set_strict(bool strict) { strict_ = strict; }
  void set_sink(Sink sink) { sink_ = std::move(sink); }
  void clear() { counts_.clear(); }
  /// Counts by kind and text. Texts that BoundedCounts does not keep are summed in lines of their
  /// own.
  std::map<std::pair<Kind, std::string>, std::uint64_t> counts() const;

 private:
  void note(Kind kind, const std::string& what);
  BoundedCounts counts_;
  Sink sink_;
  bool strict_ = false;
};

}  // namespace fovea

/// Checks an invariant of Fovea itself, in every build type. If it is broken, prints `what` and
/// ends the process with exit status 4.
#define FOVEA_CHECK(cond, what)                                                   \
  do {                                                                            \
    if (!(cond)) [[unlikely]]                                                     \
      ::fovea::check_failed(#cond, __FILE__, __LINE__, (what));                   \
  } while (false)
