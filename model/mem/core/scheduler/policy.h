// What distinguishes one scheduler of the SDRAM controller from another.
#pragma once

namespace fovea::mem {

/// The controller's planning asks these questions (core/ddr_schedule.cpp). A new scheduler is a file of its
/// own with answers, and a word of `ddr.scheduler` (policies.h); a question that no policy asks yet is a
/// member here.
struct SchedulerPolicy {
  const char* name;
  /// Column commands follow the age of their requests.
  bool in_order = false;
  /// Reads go before writes, and priorities of masters count.
  bool kinds_count = true;
  /// Requests of one master pass each other, unless one of two to the same 64 bytes writes.
  bool free_order = false;
  /// Among open rows the one goes first whose column command is legal first.
  bool first_ready = false;
  /// A row is closed after its access, if no other request wants it.
  bool closes_rows = false;
};

}  // namespace fovea::mem
