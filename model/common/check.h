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

/// Collects the warnings of one run and counts them. kGuest: caused by the program on the core.
/// kNotModelled: the program used something that the model lacks. kConfiguration: a parameter has
/// no effect or contradicts another one. Each text is passed to the sink once, and only a few of
/// those that differ in nothing but numbers: the addresses of a wild pointer are examples of one
/// warning (see BoundedCounts). The code that runs a model owns one; components hold a DiagnosticsRef.
/// One thread at a time may use it.
class Diagnostics {
 public:
  enum class Kind { kGuest, kNotModelled, kConfiguration };
  using Sink = std::function<void(Kind, const std::string&)>;
  using Counts = std::map<std::pair<Kind, std::string>, std::uint64_t>;

  Diagnostics() = default;
  Diagnostics(const Diagnostics&) = delete;
  Diagnostics& operator=(const Diagnostics&) = delete;
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
  Counts counts() const;

 private:
  void note(Kind kind, const std::string& what);
  BoundedCounts counts_;
  Sink sink_;
  bool strict_ = false;
};

/// Where a component says its warnings: the Diagnostics of its run, or none. Without one a warning is
/// neither counted nor shown, and never an error. The Diagnostics live as long as a component that holds
/// this may warn; no destructor warns.
class DiagnosticsRef {
 public:
  /// None.
  DiagnosticsRef() = default;
  DiagnosticsRef(Diagnostics& to) : to_(&to) {}
  /// Those of the calling thread's innermost DiagnosticsScope; none, if there is no scope.
  static DiagnosticsRef current();
  void guest(const std::string& what) const {
    if (to_) to_->guest(what);
  }
  /// @throws NotModelled with --strict
  void not_modelled(const std::string& what) const {
    if (to_) to_->not_modelled(what);
  }
  /// @throws UserError with --strict
  void configuration(const std::string& what) const {
    if (to_) to_->configuration(what);
  }
  /// Those of the run so far; none, if there is no run.
  Diagnostics::Counts counts() const { return to_ ? to_->counts() : Diagnostics::Counts(); }

 private:
  Diagnostics* to_ = nullptr;
};

/// As long as it lives, these are the current Diagnostics of the thread that made it. The blocks of a
/// chip or a board take the current ones when they are constructed and keep them, as they do SystemC's
/// simulation context; reading parameters and files warns the current ones at once. What has no SystemC
/// (memory system, core) is handed its own. Scopes of a thread end in the reverse order of their
/// beginning; the innermost one counts.
class DiagnosticsScope {
 public:
  explicit DiagnosticsScope(Diagnostics& diagnostics);
  ~DiagnosticsScope();
  DiagnosticsScope(const DiagnosticsScope&) = delete;
  DiagnosticsScope& operator=(const DiagnosticsScope&) = delete;

 private:
  Diagnostics* const own_;
  Diagnostics* const outer_;
};

}  // namespace fovea

/// Checks an invariant of Fovea itself, in every build type. If it is broken, prints `what` and
/// ends the process with exit status 4.
#define FOVEA_CHECK(cond, what)                                                   \
  do {                                                                            \
    if (!(cond)) [[unlikely]]                                                     \
      ::fovea::check_failed(#cond, __FILE__, __LINE__, (what));                   \
  } while (false)
