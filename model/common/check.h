// The four reactions to a fault: guest, user, not modelled, own defect.
#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>

#include "model/common/bounded_counts.h"

namespace fovea {

/// Wrong input by the user: one line that says what, where and what is allowed. Exit status 2.
struct UserError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The guest program failed beyond recovery (unhandled abort, deadlock, watchdog). Exit status 3.
struct GuestFailure : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A feature the guest used and the model lacks, under --strict. Exit status 3.
struct NotModelled : std::runtime_error {
  using std::runtime_error::runtime_error;
};

[[noreturn]] void check_failed(const char* expression, const char* file, int line,
                               const std::string& what);

/// Counts warnings. kGuest: the program on the core did it; kNotModelled: the model lacks what the
/// program asked for; kConfiguration: a parameter has no effect or does not go with another one.
/// Each text is shown once, and few of those that differ only in numbers: a wild pointer's addresses
/// are examples of one warning.
class Diagnostics {
 public:
  enum class Kind { kGuest, kNotModelled, kConfiguration };
  using Sink = std::function<void(Kind, const std::string&)>;

  static Diagnostics& instance();
  void guest(const std::string& what) { note(Kind::kGuest, what); }
  /// @throws NotModelled when strict
  void not_modelled(const std::string& what);
  /// @throws UserError when strict
  void configuration(const std::string& what);
  void set_strict(bool strict) { strict_ = strict; }
  void set_sink(Sink sink) { sink_ = std::move(sink); }
  void clear() { counts_.clear(); }
  /// By kind and text; what BoundedCounts does not keep is summed up in lines of its own.
  std::map<std::pair<Kind, std::string>, std::uint64_t> counts() const;

 private:
  void note(Kind kind, const std::string& what);
  BoundedCounts counts_;
  Sink sink_;
  bool strict_ = false;
};

}  // namespace fovea

/// A broken invariant of Fovea itself: aborts in every build type. Exit status 4.
#define FOVEA_CHECK(cond, what)                                                   \
  do {                                                                            \
    if (!(cond)) [[unlikely]]                                                     \
      ::fovea::check_failed(#cond, __FILE__, __LINE__, (what));                   \
  } while (false)
